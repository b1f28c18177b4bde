//! `backlit screenshot`: pictures of the window or of one camera's view, without a display; a series of them too.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use anyhow::Context;
use backlit_cli::output;
use backlit_formats::images;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_ui::drawing::ViewMode;
use backlit_ui::style::theme::Theme;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use egui::{Vec2, vec2};
use image::DynamicImage;

use crate::app::{Opening, PictureOptions, headless_export, headless_picture};
use crate::context::preferences::Layout;
use crate::features::export::choices::{DELAYS_MS, MAX_SIDE};
use crate::features::export::{ExportArea, ExportChoices, ExportOrder, SeriesFormat, Subject};

/// Sides of a picture, pixels.
const SIDES: RangeInclusive<u16> = 200..=8192;

/// What `backlit screenshot` is told.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  backlit screenshot TAKE --frame 12 --iteration end --layout debug --out window.png
  backlit screenshot TAKE --frame 12 --camera 2 --mode residual --scale 3 --out view.png
  backlit screenshot TAKE --camera 1 --sequence iterations --out steps.gif
  backlit screenshot TAKE --track --sequence frames --frames 0..59 --out frames")]
pub(crate) struct ScreenshotArguments {
    /// Take or project: a take's folder, its take.toml, or a .backlit file [default: the built-in take]
    take: Option<PathBuf>,
    /// A demonstration instead of a take, as the Demonstrate menu shows it
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "take")]
    demonstration: Option<Demonstration>,
    /// Colours
    #[arg(long, value_parser = one_of(&THEMES), default_value = "dark")]
    theme: Theme,
    /// Size of the window, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = window_size, default_value = "1600x1000")]
    size: Vec2,
    /// What the window is arranged for [default: pose, or as the demonstration opens]
    #[arg(long, value_parser = one_of(&LAYOUTS))]
    layout: Option<Layout>,
    /// Frame, counted from 0
    #[arg(long, value_name = "K", default_value_t = 0)]
    frame: usize,
    /// Joint that is held, as "left elbow", or the limb that ends there
    #[arg(long, value_name = "JOINT")]
    joint: Option<String>,
    /// Iterations of the fit to do on this frame, or the word end [default: 0; of a sequence of iterations: end]
    #[arg(long, value_name = "I", value_parser = iterations)]
    iteration: Option<Iterations>,
    /// Track the whole take first, so that the timeline shows it
    #[arg(long)]
    track: bool,
    /// Pixels per point of the window [0.5 to 4] [default: 1], or per pixel of the footage with --camera [0.25 to 8] [default: 2]
    #[arg(long, value_name = "SCALE")]
    scale: Option<f32>,
    /// Only the view of this camera, counted from 1 as on its badge, with its marks and legend
    #[arg(long, value_name = "N")]
    camera: Option<usize>,
    /// What the views show
    #[arg(long, value_parser = one_of(&MODES))]
    mode: Option<ViewMode>,
    /// Width of a camera's picture, pixels [16 to 16384]; instead of --scale
    #[arg(long, value_name = "PIXELS", requires = "camera", conflicts_with = "scale")]
    width: Option<u32>,
    /// A camera's picture as framed in the window, not the whole frame
    #[arg(long, requires = "camera")]
    framed: bool,
    /// Without joints and limbs
    #[arg(long, requires = "camera")]
    no_marks: bool,
    /// Without the strip that explains the colours
    #[arg(long, requires = "camera")]
    no_legend: bool,
    /// Many pictures: every iteration of the fit, or every frame
    #[arg(long, value_parser = one_of(&SEQUENCES))]
    sequence: Option<Subject>,
    /// Frames of a sequence of frames, first and last [default: all]
    #[arg(long, value_name = "FIRST..LAST", value_parser = frame_range, requires = "sequence")]
    frames: Option<[usize; 2]>,
    /// Time that each picture of an animated file stays, milliseconds [10 to 10000]
    #[arg(long, value_name = "MS", default_value_t = 120, requires = "sequence")]
    delay: u32,
    /// An animated file ends with its last picture; without this it begins again
    #[arg(long, requires = "sequence")]
    once: bool,
    /// Without iterations that were rejected
    #[arg(long, requires = "sequence")]
    accepted_only: bool,
    /// PNG file to write. Of a sequence: a .gif, an animated .png, or a folder for numbered PNGs
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Words of an option, each with what it means.
type Words<T, const N: usize> = [(&'static str, T); N];

const THEMES: Words<Theme, 2> = [("dark", Theme::Dark), ("light", Theme::Light)];
const LAYOUTS: Words<Layout, 3> =
    [("pose", Layout::Pose), ("debug", Layout::Debug), ("demonstrate", Layout::Demonstrate)];
const SEQUENCES: Words<Subject, 2> = [("iterations", Subject::Steps), ("frames", Subject::Frames)];
const MODES: Words<ViewMode, 9> = [
    ("footage", ViewMode::Footage),
    ("data", ViewMode::Data),
    ("prediction", ViewMode::Prediction),
    ("report", ViewMode::ReportOverlay),
    ("tinted", ViewMode::Tinted),
    ("residual", ViewMode::Residual),
    ("owner", ViewMode::OwnerLimb),
    ("gradient", ViewMode::Gradient),
    ("jacobian", ViewMode::JacobianColumn),
];

/// Reads one of some words.
fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    words: &'static Words<T, N>,
) -> impl TypedValueParser<Value = T> {
    let names = PossibleValuesParser::new(words.map(|(word, _)| word));
    names.try_map(|said| {
        words.iter().find(|(word, _)| *word == said).map(|(_, meant)| *meant).ok_or("expected another word")
    })
}

/// First and last frame.
fn frame_range(text: &str) -> Result<[usize; 2], &'static str> {
    let ends = text.split_once("..").and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    ends.filter(|[first, last]| first <= last).ok_or("expected FIRST..LAST, as in 0..59")
}

/// Pixels across and down.
fn window_size(text: &str) -> Result<Vec2, String> {
    let side = |text: &str| text.parse::<u16>().ok().filter(|side| SIDES.contains(side)).map(f32::from);
    let sides = text.split_once('x').and_then(|(width, height)| Some(vec2(side(width)?, side(height)?)));
    sides.ok_or_else(|| format!("expected WIDTHxHEIGHT, {} to {} pixels each", SIDES.start(), SIDES.end()))
}

/// How many iterations; `None` for all.
#[derive(Debug, Clone, Copy)]
struct Iterations(Option<usize>);

fn iterations(text: &str) -> Result<Iterations, &'static str> {
    if text == "end" {
        return Ok(Iterations(None));
    }
    text.parse().ok().map(|count| Iterations(Some(count))).ok_or("expected a number, or end")
}

/// Draws the window, or a part of it, and writes the picture or the pictures. Errors: what cannot be opened, or a
/// file that cannot be written.
pub(crate) fn run(arguments: &ScreenshotArguments) -> anyhow::Result<()> {
    output::check_folder_of(&arguments.out)?;
    let order = order(arguments)?;
    let source = arguments.demonstration.map_or(TakeSource::BuiltIn, TakeSource::Demonstration);
    let opening = arguments.take.as_deref().map_or(Opening::Take(source), Opening::of);
    let is_of_steps = arguments.sequence == Some(Subject::Steps);
    let options = PictureOptions {
        theme: arguments.theme,
        layout: arguments.layout,
        size: arguments.size,
        frame: arguments.frame,
        joint: arguments.joint.clone(),
        steps: arguments.iteration.map_or(if is_of_steps { None } else { Some(0) }, |count| count.0),
        track: arguments.track,
        pixels_per_point: if arguments.camera.is_none() { arguments.scale.unwrap_or(1.0) } else { 1.0 },
        ..PictureOptions::default()
    };
    if arguments.camera.is_none() && arguments.sequence.is_none() && arguments.mode.is_none() {
        let (picture, faults) = headless_picture(opening, &options)?;
        images::write_png(&arguments.out, &DynamicImage::ImageRgba8(picture))?;
        return whole(&arguments.out, &faults);
    }
    let camera = match arguments.camera {
        Some(0) => anyhow::bail!("--camera is 0; cameras are counted from 1, as on their badges"),
        camera => camera.map(|camera| camera - 1),
    };
    let faults = headless_export(opening, &options, camera, arguments.mode, &order)?;
    whole(&arguments.out, &faults)
}

/// A picture in which something is missing is written, but it is an error.
fn whole(out: &Path, faults: &[String]) -> anyhow::Result<()> {
    anyhow::ensure!(
        faults.is_empty(),
        "{} is written, but not all is in it: {}",
        out.display(),
        faults.join("; ")
    );
    Ok(())
}

fn within<T: PartialOrd + Display>(
    option: &str,
    value: T,
    range: RangeInclusive<T>,
    unit: &str,
) -> anyhow::Result<()> {
    let (least, most) = (range.start(), range.end());
    anyhow::ensure!(range.contains(&value), "--{option} is {value}; expected {least} to {most}{unit}");
    Ok(())
}

/// What is to be written.
fn order(arguments: &ScreenshotArguments) -> anyhow::Result<ExportOrder> {
    let is_view = arguments.camera.is_some();
    let (scale, scales) = if is_view { (2.0, 0.25..=8.0) } else { (1.0, 0.5..=4.0) };
    let scale = arguments.scale.unwrap_or(scale);
    within("scale", scale, scales, "")?;
    within("delay", arguments.delay, DELAYS_MS, " milliseconds")?;
    arguments.width.map_or(Ok(()), |width| within("width", width, 16..=MAX_SIDE, " pixels"))?;
    let out = &arguments.out;
    let format = match arguments.sequence {
        None => SeriesFormat::Pngs,
        Some(_) => SeriesFormat::of_path(out).with_context(|| {
            format!("{}: expected a .gif, a .png, or a folder for numbered PNGs", out.display())
        })?,
    };
    anyhow::ensure!(
        arguments.frames.is_none() || arguments.sequence == Some(Subject::Frames),
        "--frames goes with --sequence frames"
    );
    let choices = ExportChoices {
        part: if is_view { ExportArea::View } else { ExportArea::Window },
        view_scale: scale,
        view_width: arguments.width,
        whole_frame: !arguments.framed,
        marks: !arguments.no_marks,
        legend: !arguments.no_legend,
        window_scale: scale,
        format,
        delay_ms: arguments.delay,
        repeats: !arguments.once,
        accepted_only: arguments.accepted_only,
        ..ExportChoices::default()
    };
    let subject = arguments.sequence.unwrap_or(if is_view { Subject::View } else { Subject::Window });
    let frames = arguments.frames.unwrap_or([0, usize::MAX]);
    Ok(ExportOrder { subject, choices, frames, path: out.clone() })
}
