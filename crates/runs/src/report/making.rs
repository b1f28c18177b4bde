//! How a track was made, for a page: settings in words, and the fit that they stand for.

use std::collections::BTreeMap;

use backlit_document::{Document, fit_words, likely_poses};
use backlit_formats::take::measurement_lines;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::segment::SegmentOptions;
use backlit_words::format;

use super::ReportSource;
use crate::track_summary::TrackMaking;

/// The fit of a frame as the settings of a summary say it; the robust preset's where they do not.
pub fn fit_of_settings(settings: &BTreeMap<String, String>) -> FitOptions {
    let said = |name: &str| settings.get(name).map(String::as_str);
    let preset = Preset::ALL.into_iter().find(|preset| said("preset") == Some(preset.label()));
    let mut fit = FitOptions::preset(preset.unwrap_or_default());
    if let Some(renderer) = said("renderer").and_then(|renderer| renderer.parse().ok()) {
        fit.renderer = renderer;
    }
    if said("prior").is_none_or(|prior| prior != "none") && preset != Some(Preset::Report) {
        fit.prior = Some(likely_poses::people());
    }
    fit
}

/// What a document says of how its track was made.
pub(super) fn of_document(document: &Document) -> TrackMaking {
    let by_hand = document.keys.len();
    let mut settings: BTreeMap<String, String> = [
        ("preset", fit_words::fit_name(&document.fit)),
        ("fit", fit_words::fit_detail(&document.fit)),
        ("renderer", document.fit.renderer.to_string()),
        ("motion", document.tracking.motion.name().to_owned()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    if by_hand > 0 {
        settings.insert("poses set by hand".to_owned(), format::counted(by_hand, "frame"));
    }
    TrackMaking { settings, ..TrackMaking::default() }
}

/// All settings of a page: what, and its value.
pub(super) fn settings(source: &ReportSource) -> Vec<[String; 2]> {
    let limbs = source.model.limbs().len();
    let mut rows = vec![
        ["Take".to_owned(), source.name.clone()],
        ["Frames a second".to_owned(), format::short(source.frame_rate)],
        ["Body".to_owned(), format!("{}, {}", source.model.name(), format::counted(limbs, "limb"))],
    ];
    let making = source.making.settings.iter();
    rows.extend(making.map(|(name, value)| [format::capitalised(name), value.clone()]));
    if let Some(footage) = &source.footage {
        let take = footage.take();
        for name in &source.cameras {
            let Ok(index) = take.rig().index(name) else { continue };
            let camera = &footage.cameras[index];
            let size = format!("{} × {} px", camera.width(), camera.height());
            rows.push([format!("Camera {name}"), size]);
        }
        let lines = |options: &SegmentOptions| {
            measurement_lines(&SegmentOptions::default(), options).trim().replace('\n', ", ")
        };
        let all: Vec<String> = take.measurement().iter().map(lines).collect();
        let is_one = all.windows(2).all(|pair| pair[0] == pair[1]);
        for (camera, text) in take.rig().cameras().iter().zip(all).take(if is_one { 1 } else { usize::MAX }) {
            let of = if is_one { String::new() } else { format!(", camera {}", camera.name()) };
            let text = if text.is_empty() { "as usual".to_owned() } else { text };
            rows.push([format!("Silhouettes{of}"), text]);
        }
    }
    rows
}
