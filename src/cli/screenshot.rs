//! `backlit screenshot`: the window's picture, without a display.

use std::path::PathBuf;
use std::str::FromStr;

use backlit_tracking::io::images;
use clap::{Args, ValueEnum};
use egui::Vec2;
use image::DynamicImage;

use super::output;
use crate::app::{Opening, PictureOptions, headless_picture, opening_of};
use crate::demonstration::Demonstration;
use crate::document::TakeSource;
use crate::look::Layout;
use crate::theme::Theme;

/// Sides of a picture, pixels.
const SIDES: std::ops::RangeInclusive<u16> = 200..=8192;

/// What `backlit screenshot` is told.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  backlit screenshot TAKE --frame 12 --iteration end --layout debug --out window.png"
)]
pub struct ScreenshotArguments {
    /// Take or project: a take's folder, its take.toml, or a .backlit file [default: the built-in take]
    take: Option<PathBuf>,
    /// A demonstration instead of a take, as its menu shows it
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "take")]
    demonstration: Option<Demonstration>,
    /// Colours
    #[arg(long, value_enum, default_value_t = ThemeWord::Dark)]
    theme: ThemeWord,
    /// Size of the window, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1600x1000")]
    size: WindowSize,
    /// What the window is arranged for
    #[arg(long, value_enum, default_value_t = LayoutWord::Pose)]
    layout: LayoutWord,
    /// Frame, counted from 0
    #[arg(long, value_name = "K", default_value_t = 0, allow_negative_numbers = true)]
    frame: usize,
    /// Iterations of the fit to do on it, or the word end
    #[arg(long, value_name = "I", default_value = "0", allow_negative_numbers = true)]
    iteration: Iterations,
    /// Track the whole take first, so that the timeline shows it
    #[arg(long)]
    track: bool,
    /// Pixels per point: 2 draws everything twice as large
    #[arg(long, value_name = "SCALE", default_value_t = 1.0, allow_negative_numbers = true)]
    scale: f32,
    /// PNG file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ThemeWord {
    Dark,
    Light,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LayoutWord {
    Pose,
    Debug,
    Demonstrate,
}

/// Pixels across and down.
#[derive(Debug, Clone, Copy)]
struct WindowSize {
    width: u16,
    height: u16,
}

impl FromStr for WindowSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let side = |text: &str| text.parse().ok().filter(|side| SIDES.contains(side));
        let sides = text.split_once('x').and_then(|(width, height)| Some((side(width)?, side(height)?)));
        let (width, height) = sides.ok_or_else(|| {
            format!("expected WIDTHxHEIGHT, {} to {} pixels each", SIDES.start(), SIDES.end())
        })?;
        Ok(Self { width, height })
    }
}

/// How many iterations; `None` for all.
#[derive(Debug, Clone, Copy)]
struct Iterations(Option<usize>);

impl FromStr for Iterations {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "end" {
            return Ok(Self(None));
        }
        text.parse().ok().map(|count| Self(Some(count))).ok_or("expected a number, or end")
    }
}

/// Draws the window and writes its picture.
///
/// # Errors
/// What cannot be opened, or a file that cannot be written.
pub fn run(arguments: &ScreenshotArguments) -> anyhow::Result<()> {
    anyhow::ensure!(
        (0.5..=4.0).contains(&arguments.scale),
        "--scale is {}; expected 0.5 to 4",
        arguments.scale
    );
    output::check_folder_of(&arguments.out)?;
    let source = arguments.demonstration.map_or(TakeSource::BuiltIn, TakeSource::Demonstration);
    let opening = arguments.take.as_deref().map_or(Opening::Take(source), opening_of);
    let options = PictureOptions {
        theme: match arguments.theme {
            ThemeWord::Dark => Theme::Dark,
            ThemeWord::Light => Theme::Light,
        },
        layout: match arguments.layout {
            LayoutWord::Pose => Layout::Pose,
            LayoutWord::Debug => Layout::Debug,
            LayoutWord::Demonstrate => Layout::Demonstrate,
        },
        size: Vec2::new(f32::from(arguments.size.width), f32::from(arguments.size.height)),
        frame: arguments.frame,
        steps: arguments.iteration.0,
        track: arguments.track,
        pixels_per_point: arguments.scale,
        ..PictureOptions::default()
    };
    let picture = headless_picture(opening, &options)?;
    images::write_png(&arguments.out, &DynamicImage::ImageRgba8(picture))?;
    Ok(())
}
