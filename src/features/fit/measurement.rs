//! The Measurement section: how silhouettes are made from footage.

use backlit_document::edit::Edit;
use backlit_tracking::segment::{
    ChromaOptions, DontKnowOptions, HYSTERESIS, SegmentOptions, ShadowOptions, ShadowTest,
};
use backlit_ui::style::format;
use backlit_ui::widgets::{SliderRow, checkbox, hint, named_row, number_field, section, segmented};
use egui::Ui;

use crate::context::command_button::gesture;
use crate::context::preferences::FRAMES_MB_CHOICES;
use crate::context::{Context, Requests, ShellRequest};

/// Width of the name and of the field of the memory's row.
const MEMORY_NAME: f32 = 78.0;
const MEMORY_FIELD: f32 = 84.0;

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, open: bool) {
    // Cameras differ in their regions only.
    let Some(options) = context.document().measurement.first() else { return };
    let shadows = if options.shadow.is_some() { "shadows on" } else { "shadows off" };
    let summary = format!("z-score {}, {shadows}", format::number(f64::from(options.z_threshold), 1));
    section(ui, "Measurement", &summary, open, |ui| {
        numbers(ui, requests, options);
        switches(ui, requests, options);
        memory(ui, context, requests);
    });
}

fn numbers(ui: &mut Ui, requests: &mut Requests, options: &SegmentOptions) {
    type Number = (SliderRow<'static>, f64, fn(&mut SegmentOptions, f64));
    let differs = "How many standard deviations a pixel of foreground differs, at least";
    let noise = "The least noise assumed of a pixel, in grey levels";
    let rows: [Number; 6] = [
        (SliderRow::new("Z-score", "", 1, 1.0..=20.0, differs), options.z_threshold.into(), set_z),
        (SliderRow::new("Noise", "", 1, 0.5..=20.0, noise), options.noise_floor.into(), |options, floor| {
            options.noise_floor = floor as f32;
        }),
        (
            SliderRow::new("Opening", " px", 0, 0.0..=6.0, "Removes specks up to this radius"),
            options.opening_px as f64,
            |options, px| options.opening_px = whole(px),
        ),
        (
            SliderRow::new("Closing", " px", 0, 0.0..=8.0, "Closes gaps up to this radius"),
            options.closing_px as f64,
            |options, px| options.closing_px = whole(px),
        ),
        (
            SliderRow::new("Smallest", " px", 0, 0.0..=2000.0, "Components with fewer pixels are dropped"),
            options.min_component_px as f64,
            |options, px| options.min_component_px = whole(px),
        ),
        (
            SliderRow::new("Holes", " px", 0, 0.0..=2000.0, "Holes of no more pixels are filled"),
            options.fill_holes_px as f64,
            |options, px| options.fill_holes_px = whole(px),
        ),
    ];
    for (index, (row, value, set)) in rows.into_iter().enumerate() {
        number(ui, requests, options, index, (row, value), set);
    }
}

fn whole(value: f64) -> usize {
    value.round().max(0.0) as usize
}

/// The low threshold stays below the high one by the same factor.
fn set_z(options: &mut SegmentOptions, z: f64) {
    let factor = z as f32 / options.z_threshold.max(0.1);
    options.hysteresis_z = options.hysteresis_z.map(|low| low * factor);
    options.z_threshold = z as f32;
}

/// A slider; what it changes goes with the rest of its drag.
fn number(
    ui: &mut Ui,
    requests: &mut Requests,
    options: &SegmentOptions,
    index: usize,
    (row, mut value): (SliderRow<'_>, f64),
    set: impl FnOnce(&mut SegmentOptions, f64),
) {
    let response = row.show(ui, &mut value);
    let drag = gesture(ui, ("measurement", index), &response);
    if response.changed() {
        let mut options = options.clone();
        set(&mut options, value);
        requests.edits.push((Edit::SetMeasurement(Box::new(options)), drag));
    }
}

/// Switches, and below each the numbers that it brings.
fn switches(ui: &mut Ui, requests: &mut Requests, options: &SegmentOptions) {
    let mut toggles = options.clone();
    shadows(ui, &mut toggles);
    let mut follows = options.hysteresis_z.is_some();
    let tip = "Hysteresis: pixels that differ by less than the z-score, but by more than a share of it, are subject where they touch \
               such pixels";
    if checkbox(ui, &mut follows, "Follow faint parts").on_hover_text(tip).changed() {
        toggles.hysteresis_z = follows.then_some(HYSTERESIS * options.z_threshold);
    }
    if let Some(low) = options.hysteresis_z {
        let row =
            SliderRow::new("Faint", "", 2, 0.2..=1.0, "The share of the z-score by which faint parts differ");
        let share = f64::from(low / options.z_threshold.max(0.1));
        number(ui, requests, options, 6, (row, share), |options, share| {
            options.hysteresis_z = Some(share as f32 * options.z_threshold);
        });
    }
    let mut apart = options.chroma.is_some();
    let tip = "The z-score judges luminance; chroma is judged apart, with its own. A shadow changes luminance alone: with a high \
               z-score it is then background";
    if checkbox(ui, &mut apart, "Chroma apart from luminance").on_hover_text(tip).changed() {
        toggles.chroma = apart.then(ChromaOptions::default);
    }
    if let Some(chroma) = options.chroma {
        let row = SliderRow::new("Chroma", "", 1, 1.0..=20.0, "The z-score of chroma");
        number(ui, requests, options, 7, (row, chroma.z_threshold.into()), |options, z| {
            options.chroma = Some(ChromaOptions { z_threshold: z as f32, ..chroma });
        });
        let row = SliderRow::new(
            "Its noise",
            "",
            1,
            0.5..=20.0,
            "The least noise assumed of chroma, in grey levels",
        );
        number(ui, requests, options, 8, (row, chroma.noise_floor.into()), |options, floor| {
            options.chroma = Some(ChromaOptions { noise_floor: floor as f32, ..chroma });
        });
    }
    let mut dont_know = options.dont_know.is_some();
    let tip = "Where background and frame are both dark, a pixel says nothing and weighs nothing";
    if checkbox(ui, &mut dont_know, "Don’t know where both are dark").on_hover_text(tip).changed() {
        toggles.dont_know = dont_know.then(DontKnowOptions::default);
    }
    let tip = "The frame may be exposed differently from the background";
    checkbox(ui, &mut toggles.match_exposure, "Match exposure").on_hover_text(tip);
    let tip = "Subject that only this camera sees is unknown and weighs nothing: a thing that moves behind, a changed light";
    checkbox(ui, &mut toggles.needs_support, "Other cameras must see it too").on_hover_text(tip);
    if toggles != *options {
        requests.edit(Edit::SetMeasurement(Box::new(toggles)));
    }
}

/// Which shadow test there is, and what a shadow counts as.
fn shadows(ui: &mut Ui, options: &mut SegmentOptions) {
    let before = options.shadow.map(|shadow| shadow.test);
    let mut test = before;
    ui.label("Shadows");
    let choices = [
        (None, "Off"),
        (Some(ShadowTest::Brightness), "Brightness"),
        (Some(ShadowTest::Gradient), "Gradient"),
    ];
    segmented(ui, &mut test, &choices).on_hover_text(
        "Which foreground is taken for shadow.\nBrightness: only darker or brighter than the background, of its colour and texture; takes \
         grey cloth before a grey wall for shadow.\nGradient: as steep as the background (6.12); takes any plain cloth before a \
         plain wall for shadow",
    );
    if test != before {
        let kept = options.shadow.unwrap_or_default();
        options.shadow = test.map(|test| ShadowOptions { test, ..kept });
    }
    if let Some(shadow) = &mut options.shadow {
        let tip = "A shadow neither pulls nor pushes; otherwise it counts as background";
        checkbox(ui, &mut shadow.unknown, "Shadow weighs nothing").on_hover_text(tip);
    }
}

fn memory(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    named_row(ui, "Memory", MEMORY_NAME, |ui| {
        let mut megabytes = context.preferences.frames_mb as f64;
        let field = number_field(ui, "Memory for frames", &mut megabytes, 0, " MB", 8.0, MEMORY_FIELD);
        let tip = "Frames that were read are kept in up to so much memory, decoded videos included; going \
                   back to them is quick";
        if field.on_hover_text(tip).changed() {
            let [least, most] = [*FRAMES_MB_CHOICES.start(), *FRAMES_MB_CHOICES.end()];
            requests.request(ShellRequest::FramesMb((megabytes.max(0.0) as usize).clamp(least, most)));
        }
        hint(ui, "for frames that were read");
    });
}
