//! `backlit cameras`: what a calibration holds, and the same in another format.

use std::path::{Path, PathBuf};

use backlit_formats::atomic;
use backlit_formats::calibration::write::{Format, to_text};
use backlit_formats::calibration::{self, Calibration, CalibrationOptions};
use backlit_tracking::camera::Camera;
use clap::Args;
use clap::builder::PossibleValuesParser;

use super::numbers::within;
use super::output::{self, number};
use super::table::Table;

const AFTER_HELP: &str = "\
Reads all calibrations that a take can name; docs/formats.md lists them. If lenses and places are in two \
files, give both, or one with the other in the same folder.

Examples:
  backlit cameras Calib.qca.txt
  backlit cameras intri.yml extri.yml --size 1920x1080
  backlit cameras calibration.toml --metres-per-unit 0.001 --to opencv-yaml --out cameras.yml";

/// What `backlit cameras` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct CameraArguments {
    /// Calibration: a file, or a folder with one in it; several files, if each holds a camera, or lenses and places are apart
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print the cameras in Backlit's own format
    #[arg(long)]
    json: bool,
    /// Width and height of the pictures, for files that do not say them; other cameras are scaled to this size
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u64; 2]>,
    /// Metres in one unit of a file that does not say its unit [0.000000001 to 1000000000]
    #[arg(long, value_name = "METRES", default_value_t = 1.0, value_parser = within(1e-9..=1e9_f64))]
    metres_per_unit: f64,
    /// Format to write
    #[arg(long, value_name = "FORMAT", requires = "out", value_parser = PossibleValuesParser::new(Format::ALL.map(Format::name)))]
    to: Option<String>,
    /// File to write; of easymocap the folder of intri.yml and extri.yml
    #[arg(long, value_name = "PATH", requires = "to")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &CameraArguments) -> anyhow::Result<()> {
    let options = CalibrationOptions { size: arguments.size, metres_per_unit: arguments.metres_per_unit };
    let found = calibration::load_all(&arguments.files, options)?;
    if let (Some(name), Some(out)) = (&arguments.to, &arguments.out) {
        let format = Format::from_name(name).unwrap_or(Format::Backlit);
        write(out, &to_text(&found.rig, format)?)?;
    }
    for left in &found.left_out {
        output::complain(&format!("left out: camera \"{}\": {}", left.name, left.reason));
    }
    if arguments.json {
        output::print(&calibration::backlit::to_text(&found.rig))
    } else {
        output::print(&table(&found))
    }
}

fn write(out: &Path, texts: &[String]) -> anyhow::Result<()> {
    if let [intri, extri] = texts {
        output::make_folder(out)?;
        atomic::write(&out.join("intri.yml"), intri.as_bytes())?;
        atomic::write(&out.join("extri.yml"), extri.as_bytes())?;
        return Ok(());
    }
    for text in texts {
        atomic::write(out, text.as_bytes())?;
    }
    Ok(())
}

fn table(found: &Calibration) -> String {
    let lens = |camera: &Camera| {
        let coefficients = camera.distortion().coefficients();
        let lens: Vec<String> =
            coefficients.iter().map(|(name, value)| format!("{name} {value:.4}")).collect();
        if lens.is_empty() { "ideal".to_owned() } else { lens.join(" ") }
    };
    Table::of(
        found.rig.cameras(),
        &[
            ("camera", &|camera| camera.name().to_owned()),
            ("size", &|camera| format!("{}×{}", camera.width(), camera.height())),
            ("fx", &|camera| number(camera.intrinsics().fx, 2)),
            ("fy", &|camera| number(camera.intrinsics().fy, 2)),
            ("cx", &|camera| number(camera.intrinsics().cx, 2)),
            ("cy", &|camera| number(camera.intrinsics().cy, 2)),
            ("lens", &|camera| lens(camera)),
            ("x (m)", &|camera| number(camera.centre().x, 3)),
            ("y (m)", &|camera| number(camera.centre().y, 3)),
            ("z (m)", &|camera| number(camera.centre().z, 3)),
        ],
    )
}

fn size(text: &str) -> Result<[u64; 2], String> {
    let sides = text.split_once(['x', '×']).and_then(|(width, height)| {
        let side = |side: &str| side.trim().parse::<u64>().ok().filter(|side| *side > 0);
        Some([side(width)?, side(height)?])
    });
    sides.ok_or_else(|| "expected width and height, such as 1920x1080".to_owned())
}
