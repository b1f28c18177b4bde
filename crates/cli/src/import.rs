//! `backlit import`: a take made of footage and a calibration, in one step.

use std::path::PathBuf;

use backlit_formats::Take;
use backlit_formats::import::{
    self, Background, ImportCamera, ImportOptions, ImportStep, ImportSurvey, MatchedBy, PictureSize,
    Pictures, WriteOptions,
};
use backlit_tracking::cancel::CancelToken;
use clap::Args;
use serde_json::json;

use super::fit_options::{Words, one_of};
use super::numbers::within;
use super::output;
use super::table::Table;

const AFTER_HELP: &str = "\
Looks for videos or numbered pictures, a calibration, plates, masks and keypoints in the folders and files \
that are named, gives each camera its own by names and numbers, and writes a take: take.toml, the cameras \
for its pictures, and backgrounds that are learnt from the footage where there is no plate. Projects of \
Pose2Sim, EasyMocap, Anipose, FreeMoCap, Caliscope and OpenCap are recognised by their files. The footage \
stays where it is.

Masks made elsewhere (in folders or files called masks, seg, silhouettes, alpha, …; as many as there are \
frames) are used instead of backgrounds, with or without footage beside them.

If the cameras do not agree on where the keypoints are in space, they are corrected by bundle adjustment, \
and a message says so.

Pictures of another size than the calibration's were scaled, letterboxed or cut. Backlit finds out which \
from the pictures; with --pictures you say it yourself.

Examples:
  backlit import my_project --out take
  backlit import videos --calibration Calib.toml --out take --fps 50
  backlit import my_project --dry-run";

/// What `backlit import` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct ImportArguments {
    /// Folders and files: a project, footage, a calibration
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    /// Folder of the take; made if it is not there
    #[arg(long, value_name = "TAKE", required_unless_present = "dry_run")]
    out: Option<PathBuf>,
    /// Only print what was found, write nothing
    #[arg(long)]
    dry_run: bool,
    /// The calibration, instead of looking for one
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Metres in one unit of a calibration that does not say its unit [0.000000001 to 1000000000]
    #[arg(long, value_name = "METRES", default_value_t = 1.0, value_parser = within(1e-9..=1e9_f64))]
    metres_per_unit: f64,
    /// Frames a second [0.001 to 100000] [default: what the footage or the project says]
    #[arg(long, value_name = "RATE", value_parser = within(1e-3..=100_000.0_f64))]
    fps: Option<f64>,
    /// How pictures of another size than the calibration's were made: scaled, letterboxed, cut-at-corner or cut-around
    #[arg(long, value_name = "HOW", value_parser = picture_size)]
    pictures: Option<PictureSize>,
    /// Keep the cameras as they were calibrated, though keypoints say that they are off
    #[arg(long)]
    keep_cameras: bool,
    /// Where backgrounds come from
    #[arg(long, value_parser = one_of(BACKGROUNDS), default_value = "plate")]
    background: Background,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

/// Where backgrounds come from.
const BACKGROUNDS: Words<Background> = &[
    (
        "plate",
        "A picture without the subject where there is one, else the footage",
        Background::PlateOrFootage,
    ),
    ("footage", "The footage", Background::Footage),
    ("none", "Nowhere: silhouettes are given in another way", Background::None),
];

pub(crate) fn run(arguments: &ImportArguments) -> anyhow::Result<()> {
    let options = ImportOptions {
        calibration: arguments.calibration.clone(),
        metres_per_unit: arguments.metres_per_unit,
        frame_rate: arguments.fps,
        picture_size: arguments.pictures,
    };
    let found = import::survey(&arguments.paths, &options)?;
    if !arguments.json {
        output::print(&text(&found))?;
    }
    let mut written = None;
    let (mut known, mut adjusted) = (serde_json::Map::new(), None);
    if let (Some(out), false) = (&arguments.out, arguments.dry_run) {
        let background = arguments.background;
        let options = WriteOptions { background, adjust_cameras: !arguments.keep_cameras };
        let file = import::write(&found, out, options, &CancelToken::new(), &mut |step| match step {
            ImportStep::Adjusted { median_px: [before, after] } => {
                output::complain(&format!(
                    "the cameras were adjusted: keypoints were {before:.1} px off, now {after:.1} px (--keep-cameras)"
                ));
                adjusted = Some([before, after]);
            }
            ImportStep::Measuring => {}
            ImportStep::Learning { camera } => {
                output::complain(&format!("{camera}: the background is being learnt from the footage"));
            }
            ImportStep::Learnt { camera, known: share } => {
                if share < 1.0 {
                    let share = 100.0 * (1.0 - share);
                    output::complain(&format!(
                        "{camera}: the subject never leaves {share:.1} % of the picture; these pixels are unknown"
                    ));
                }
                known.insert(camera, share.into());
            }
        })?;
        if let Ok(take) = Take::open(&file)
            && let Some(outside) = take.outside()
        {
            output::complain(&format!("note: {outside}"));
        }
        written = Some(file);
    }
    if arguments.json {
        return output::print_json(&json!({
            "take": written,
            "project": found.project.to_string(),
            "name": found.name,
            "calibration": found.calibration,
            "frame_rate": found.frame_rate,
            "first_frame": found.first,
            "frames": found.count,
            "cameras": found.cameras.iter().map(camera_json).collect::<Vec<_>>(),
            "known_background": known,
            "adjusted_px": adjusted,
            "markers": found.table,
            "left_out": found.left_out.iter().map(|(name, why)| json!({"name": name, "reason": why})).collect::<Vec<_>>(),
        }));
    }
    match written {
        Some(file) => {
            let folder = file.parent().unwrap_or(&file).display();
            output::print(&format!(
                "wrote {}\nnext: backlit {folder}, or backlit track {folder} --out results\n",
                file.display()
            ))
        }
        None => Ok(()),
    }
}

fn camera_json(camera: &ImportCamera) -> serde_json::Value {
    json!({
        "name": camera.camera.name(),
        "footage": camera.pictures.path(),
        "frames": camera.pictures.count(),
        "frame_rate": camera.frame_rate,
        "size": [camera.camera.width(), camera.camera.height()],
        "calibrated_size": camera.calibrated_size,
        "pictures": camera.picture_size.word(),
        "plate": camera.plate,
        "masks": camera.masks.as_ref().map(|masks| masks.pictures.path()),
        "mask_values": camera.masks.as_ref().and_then(|masks| masks.values.as_ref()).map(ToString::to_string),
        "keypoints": camera.keypoints,
        "notes": camera.notes,
    })
}

fn text(found: &ImportSurvey) -> String {
    let mut out = format!("{}: {}, calibration {}\n", found.name, found.project, found.calibration.display());
    let mut table =
        Table::new(["camera", "footage", "frames", "per second", "size", "background", "keypoints"]);
    for camera in &found.cameras {
        let path = camera.pictures.path();
        let kind = match &camera.pictures {
            Pictures::Video(video) => format!(" ({})", video.codec()),
            Pictures::Numbered { .. } => " and following".to_owned(),
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        table.row([
            camera.camera.name().to_owned(),
            name + &kind,
            camera.pictures.count().to_string(),
            camera.frame_rate.or(found.frame_rate).map_or("?".to_owned(), |rate| format!("{rate:.2}")),
            format!("{}×{}", camera.camera.width(), camera.camera.height()),
            match (&camera.masks, &camera.plate) {
                (Some(_), _) => "not needed: masks",
                (None, Some(_)) => "plate",
                (None, None) => "from the footage",
            }
            .to_owned(),
            if camera.keypoints.is_some() { "yes" } else { "no" }.to_owned(),
        ]);
    }
    out += &table.to_text();
    for camera in &found.cameras {
        let name = camera.camera.name();
        if camera.picture_size != PictureSize::Same {
            let [width, height] = camera.calibrated_size;
            let how = camera.picture_size;
            out += &format!("{name}: the calibration is for {width}×{height}; taken as {how} (--pictures)\n");
        }
        if let Some(masks) = &camera.masks {
            let (path, beside) =
                (masks.pictures.path(), if masks.are_alone { ", with no footage" } else { "" });
            let values =
                masks.values.as_ref().map_or_else(|| "\"auto\"".to_owned(), |values| values.to_string());
            out += &format!(
                "{name}: silhouettes are the masks at {}{beside} (mask_values = {values})\n",
                path.display()
            );
        }
        for note in &camera.notes {
            out += &format!("{name}: {note}\n");
        }
    }
    if found.matched_by == MatchedBy::Order {
        out += "no names or numbers match, so footage was given to the cameras in its order\n";
    }
    let longest = found.cameras.iter().map(|camera| camera.pictures.count()).max().unwrap_or(0);
    if found.count < longest {
        let (first, past) = (found.first, found.first + found.count);
        out += &format!(
            "frames {first} to {} are used: those that all cameras have, or that the project chooses\n",
            past - 1
        );
    }
    if let Some(table) = &found.table {
        out += &format!("markers to compare with: backlit track … --reference {}\n", table.display());
    }
    for (name, why) in &found.left_out {
        out += &format!("left out: {name}: {why}\n");
    }
    out
}

fn picture_size(text: &str) -> Result<PictureSize, String> {
    let known = PictureSize::CHOICES;
    known
        .into_iter()
        .find(|choice| choice.word() == text)
        .ok_or_else(|| format!("expected one of {}", known.map(PictureSize::word).join(", ")))
}
