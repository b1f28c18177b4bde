//! `backlit export`: a track, or the poses of a project, as motion files of other programs.

use std::path::{Path, PathBuf};

use backlit_formats::motion::{self, Axes, EulerOrder, MotionFormat, MotionOptions, Names, Unit};
use backlit_runs::results::{self, TrackedMotion};
use clap::Args;
use glam::DVec3;

use super::take_options::FrameSpan;
use crate::{output, track_files};

const AFTER_HELP: &str = "\
Writes to the folder of --out one file a format, named after TRACK:
  bvh  joints and angles for Blender, MotionBuilder, Maya: y up, centimetres
  trc  markers for OpenSim: y up, metres
  mot  coordinates for OpenSim: y up, degrees and metres
  c3d  points for biomechanics: z up, millimetres
  glb  glTF 2.0 with a skinned body: y up, metres
  npz  NumPy arrays: the take's world, metres
  csv  one row a frame and joint: the take's world, metres

Example:
  backlit track TAKE --out results
  backlit export results --to bvh,c3d --up -y --out motion
  backlit export corrected.backlit --to bvh --out motion";

/// What `backlit export` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct ExportArguments {
    /// Track: the track.json that `backlit track` wrote, or its folder; or a project, NAME.backlit, whose poses are written as
    /// they are, those set by hand included
    #[arg(value_name = "TRACK|PROJECT")]
    track: PathBuf,
    /// Formats, with commas between: bvh, trc, mot, c3d, glb, npz, csv
    #[arg(long, value_name = "FORMATS", value_delimiter = ',', required = true, value_parser = format)]
    to: Vec<MotionFormat>,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Body of the track: a built-in name or a body file [default: the body.toml beside the track, else the built-in
    /// body that the track names]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Which way is up in the take's world: x, y, z, -x, -y, -z, or three numbers with commas between [default: z; of a
    /// project, what its cameras say]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = direction)]
    up: Option<DVec3>,
    /// Which way the file's axes point: y-up, z-up or world [default: as the format expects]
    #[arg(long, value_parser = axes)]
    axes: Option<Axes>,
    /// Unit of the file's lengths: m, cm or mm [default: as the format expects]
    #[arg(long, value_parser = unit)]
    unit: Option<Unit>,
    /// Frames: A..B, A.., ..B, A..=B or one frame [default: all]
    #[arg(long, value_name = "FRAMES")]
    frames: Option<FrameSpan>,
    /// What joints are called: anatomical, limbs, opensim or mixamo [default: opensim in TRC, else anatomical]
    #[arg(long, value_parser = names)]
    names: Option<Names>,
    /// Order of angles in BVH: xyz, xzy, yxz, yzx, zxy or zyx
    #[arg(long, value_name = "ORDER", default_value = "zxy", value_parser = order)]
    euler: EulerOrder,
}

pub(crate) fn run(arguments: &ExportArguments) -> anyhow::Result<()> {
    let track = track_files::path_in(&arguments.track);
    let TrackedMotion { motion, up, .. } =
        results::read_tracked(&arguments.track, arguments.model.as_deref())?;
    let range = match arguments.frames {
        Some(FrameSpan { first, past: Some(past) }) if past <= first => {
            anyhow::bail!("--frames: there is no frame from {first} up to {past}")
        }
        Some(FrameSpan { first, past }) => Some(first..=past.map_or(usize::MAX, |past| past - 1)),
        None => None,
    };
    let options = MotionOptions {
        axes: arguments.axes,
        up: arguments.up.or(up).unwrap_or(MotionOptions::default().up),
        unit: arguments.unit,
        range,
        names: arguments.names,
        euler: arguments.euler,
    };
    output::make_folder(&arguments.out)?;
    let stem = track.file_stem().map_or_else(|| Path::new("track"), Path::new);
    for &format in &arguments.to {
        let mut name = stem.as_os_str().to_owned();
        name.push(".");
        name.push(format.extension());
        motion::write(&arguments.out.join(name), format, &motion, &options)?;
    }
    Ok(())
}

/// Reads a direction in the world.
pub(super) fn direction(text: &str) -> Result<DVec3, &'static str> {
    let axis = |letter: &str| match letter {
        "x" => Some(DVec3::X),
        "y" => Some(DVec3::Y),
        "z" => Some(DVec3::Z),
        _ => None,
    };
    let signed = text.strip_prefix('-').and_then(|letter| axis(letter).map(|axis| -axis));
    if let Some(axis) = axis(text).or(signed) {
        return Ok(axis);
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let three = numbers.and_then(|numbers| Some(DVec3::from_array(numbers.try_into().ok()?)));
    three
        .filter(|three| three.try_normalize().is_some())
        .ok_or("expected x, y, z, -x, -y, -z, or three numbers with commas between, not all zero")
}

fn format(text: &str) -> Result<MotionFormat, &'static str> {
    MotionFormat::of_extension(text).ok_or("expected bvh, trc, mot, c3d, glb, npz or csv")
}

fn axes(text: &str) -> Result<Axes, &'static str> {
    match text {
        "y-up" => Ok(Axes::YUp),
        "z-up" => Ok(Axes::ZUp),
        "world" => Ok(Axes::World),
        _ => Err("expected y-up, z-up or world"),
    }
}

fn unit(text: &str) -> Result<Unit, &'static str> {
    let all = [Unit::Metres, Unit::Centimetres, Unit::Millimetres];
    all.into_iter().find(|unit| unit.symbol() == text).ok_or("expected m, cm or mm")
}

fn names(text: &str) -> Result<Names, &'static str> {
    match text {
        "anatomical" => Ok(Names::Anatomical),
        "limbs" => Ok(Names::Limbs),
        "opensim" => Ok(Names::OpenSim),
        "mixamo" => Ok(Names::Mixamo),
        _ => Err("expected anatomical, limbs, opensim or mixamo"),
    }
}

fn order(text: &str) -> Result<EulerOrder, &'static str> {
    let is_it = |order: &EulerOrder| text.chars().map(|c| c.to_ascii_uppercase()).eq(order.letters());
    EulerOrder::ALL.into_iter().find(is_it).ok_or("expected xyz, xzy, yxz, yzx, zxy or zyx")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read() {
        assert_eq!(direction("-y"), Ok(-DVec3::Y));
        assert_eq!(direction("0, 0.5,2"), Ok(DVec3::new(0.0, 0.5, 2.0)));
        for bad in ["w", "1,2", "0,0,0", "nan,0,1", ""] {
            assert!(direction(bad).is_err(), "{bad}");
        }
        assert_eq!(order("zyx"), Ok(EulerOrder::Zyx));
        assert_eq!(format("C3D"), Ok(MotionFormat::C3d));
        assert_eq!(unit("cm"), Ok(Unit::Centimetres));
    }
}
