//! `backlit render`: predictions Λ and Jacobians ∂Λ/∂X as files.

use std::path::PathBuf;

use anyhow::{Context, bail};
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::{images, model_file, npy};
use backlit_tracking::body::{Kinematics, Parameters};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::prediction::levels;
use backlit_tracking::render::{Ramp, View, dense_jacobian};
use clap::Args;
use image::GrayImage;

use super::fit_options::{MODEL_HELP, PARAMETERS, RendererArguments, one_of};
use super::output;

/// Largest Jacobian of one camera, bytes: a full-HD picture of the full body is half of it.
const MAX_JACOBIAN_BYTES: usize = 2 << 30;

const AFTER_HELP: &str = "\
Writes to the folder of --out, for every camera NAME:
  NAME.png             the prediction, grey: 0 subject … 255 background
  NAME.prediction.npy  with --npy: the same unrounded, height × width doubles
  NAME.jacobian.npy    with --jacobian: its derivative, height·width × columns doubles

Columns of the Jacobian: x y z of the root (metres), then for every limb with a rotation of its own, in the \
order of the model file, w x y z (raw) or three radians of a turn in its parent's frame (tangent). The \
quaternions of the pose file are used as they are, with either Jacobian: one that is not of unit length \
scales its limbs by its squared length, as in the report's equation (4.15). Cameras with lens distortion are \
drawn with the lens: every pixel has its own ray.

Example:
  backlit render --model upper_body --cameras cameras.json --pose pose.json --renderer sphere-tree \\
      --ramp half --out pictures --npy --jacobian tangent";

/// What `backlit render` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct RenderArguments {
    /// Body model.
    #[arg(long, help = MODEL_HELP)]
    model: String,
    /// Calibrated cameras: any file that backlit cameras reads
    #[arg(long)]
    cameras: PathBuf,
    /// Pose: a backlit-pose JSON file
    #[arg(long)]
    pose: PathBuf,
    #[command(flatten)]
    renderer: RendererArguments,
    /// From distance to grey: thesis, half, width=PX or distance=INNER,OUTER (pixels)
    #[arg(long, default_value = "half")]
    ramp: Ramp,
    /// Folder for the results; made if it is not there
    #[arg(long)]
    out: PathBuf,
    /// Also write the unrounded prediction
    #[arg(long)]
    npy: bool,
    /// Also write the Jacobian, in these columns
    #[arg(long, value_name = "COLUMNS", value_parser = one_of(PARAMETERS))]
    jacobian: Option<Parameters>,
}

pub(crate) fn run(arguments: &RenderArguments) -> anyhow::Result<()> {
    let renderer = arguments.renderer.kind()?.unwrap_or_default();
    let model = model_file::resolve(&arguments.model)?;
    let rig = calibration::read(&arguments.cameras, CalibrationOptions::default())?;
    let pose = pose_file::read(&arguments.pose, &model, Quaternions::Raw)?;
    for camera in rig.cameras() {
        output::check_file_stem(camera.name())?;
        if let Some(parameters) = arguments.jacobian {
            check_size(camera, parameters.columns(model.rotation_count()))?;
        }
    }
    output::make_folder(&arguments.out)?;
    let kinematics = Kinematics::new(&model, &pose);
    for camera in rig.cameras() {
        let file = |ending: &str| arguments.out.join(format!("{}.{ending}", camera.name()));
        let (width, height) = (camera.width(), camera.height());
        let view = View::new(&model, &kinematics, camera, renderer, arguments.ramp);
        let levels = levels(&view);
        let bytes = levels.iter().map(|level| level.round() as u8).collect();
        let picture = GrayImage::from_raw(width as u32, height as u32, bytes).context("one level a pixel")?;
        images::write_png(&file("png"), &picture.into())?;
        if arguments.npy {
            npy::write(&file("prediction.npy"), &[height, width], &levels)?;
        }
        if let Some(parameters) = arguments.jacobian {
            let jacobian = dense_jacobian(&view, &kinematics, camera, parameters);
            let shape = [jacobian.nrows(), jacobian.ncols()];
            // Column-major of the transpose is row-major.
            npy::write(&file("jacobian.npy"), &shape, jacobian.transpose().as_slice())?;
        }
    }
    Ok(())
}

fn check_size(camera: &Camera, columns: usize) -> anyhow::Result<()> {
    let (width, height) = (camera.width(), camera.height());
    let bytes = width.saturating_mul(height).saturating_mul(columns).saturating_mul(size_of::<f64>());
    if bytes > MAX_JACOBIAN_BYTES {
        bail!(
            "camera \"{}\": the Jacobian of {width} × {height} pixels × {columns} columns would be a file of {} MiB; \
             expected at most {} MiB: use smaller pictures",
            camera.name(),
            bytes >> 20,
            MAX_JACOBIAN_BYTES >> 20,
        );
    }
    Ok(())
}
