//! The page's numbers as its script reads them: one JSON. What is not known or not finite is null.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use crate::packing::{base64, places};
use crate::page::{Curve, FitSteps, Frame, Page, PageCamera, Picture};

/// Digits that count in curves: as many as a plot shows.
const DIGITS: i32 = 5;

/// The JSON.
pub(crate) fn data(page: &Page) -> Value {
    let index: BTreeMap<usize, usize> =
        page.frames.iter().enumerate().map(|(index, frame)| (frame.number, index)).collect();
    let limbs = page.limbs.iter().map(|limb| {
        let parent = limb.parent.map_or(0, |parent| parent + 1);
        json!({"name": limb.name, "joint": limb.joint, "from": parent, "radius": shortened(limb.radius)})
    });
    let at = |number: usize| index.get(&number).copied();
    let pictures =
        page.pictures.iter().filter_map(|picture| Some(self::picture(picture, at(picture.frame)?)));
    let fits = page.fits.iter().filter_map(|fit| Some(self::fit(fit, at(fit.frame)?)));
    let bookmarks = page.bookmarks.iter().map(|bookmark| {
        json!({"frame": bookmark.frame, "camera": bookmark.camera, "joint": bookmark.joint,
            "text": bookmark.text})
    });
    json!({
        "title": page.title,
        "rate": page.frame_rate,
        "up": page.up.to_array(),
        "limbs": limbs.collect::<Vec<_>>(),
        "cameras": page.cameras.iter().map(camera).collect::<Vec<_>>(),
        "frames": page.frames.iter().map(|frame| frame.number).collect::<Vec<_>>(),
        "joints": places(page.frames.iter().flat_map(|frame| &frame.joints)),
        "iou": page.frames.iter().map(|frame| frame.iou.map(shortened)).collect::<Vec<_>>(),
        "lost": lost(&page.frames),
        "doubts": doubts(&page.frames),
        "pictures": pictures.collect::<Vec<_>>(),
        "fits": fits.collect::<Vec<_>>(),
        "curves": page.curves.iter().map(|curve| self::curve(curve, &index)).collect::<Vec<_>>(),
        "bookmarks": bookmarks.collect::<Vec<_>>(),
    })
}

fn camera(camera: &PageCamera) -> Value {
    json!({
        "name": camera.name,
        "size": camera.size,
        "k": camera.intrinsics,
        // Row by row.
        "r": camera.rotation.transpose().to_cols_array(),
        "t": camera.translation.to_array(),
    })
}

/// Why frames are lost, by their place in the list.
fn lost(frames: &[Frame]) -> Map<String, Value> {
    let lost = frames.iter().enumerate().filter_map(|(index, frame)| Some((index, frame.lost.as_ref()?)));
    lost.map(|(index, why)| (index.to_string(), json!(why))).collect()
}

/// By the frame's place in the list: limb, whether it is wrong, the reason's number. And the reasons.
fn doubts(frames: &[Frame]) -> Value {
    let mut reasons: Vec<&str> = Vec::new();
    let mut told = Map::new();
    for (index, frame) in frames.iter().enumerate().filter(|(_, frame)| !frame.doubts.is_empty()) {
        let mut of_frame = Vec::with_capacity(frame.doubts.len());
        for doubt in &frame.doubts {
            let known = reasons.iter().position(|reason| *reason == doubt.reason);
            let reason = known.unwrap_or_else(|| {
                reasons.push(doubt.reason);
                reasons.len() - 1
            });
            of_frame.push(json!([doubt.limb, u8::from(doubt.is_wrong), reason]));
        }
        told.insert(index.to_string(), of_frame.into());
    }
    json!({"reasons": reasons, "frames": told})
}

fn picture(picture: &Picture, frame: usize) -> Value {
    let source = match picture.bytes.is_empty() {
        true => Value::Null,
        false => format!("data:{};base64,{}", picture.media_type, base64(&picture.bytes)).into(),
    };
    json!({"camera": picture.camera, "frame": frame, "source": source, "subject": picture.subject,
        "unknown": picture.unknown})
}

fn fit(fit: &FitSteps, frame: usize) -> Value {
    let steps = fit.steps.iter().map(|step| {
        json!([shortened(step.cost), shortened(step.trial_cost), step.stage, u8::from(step.is_accepted)])
    });
    json!({
        "frame": frame,
        "start": fit.start,
        "ending": fit.ending,
        "joints": places(fit.steps.iter().flat_map(|step| &step.joints)),
        "steps": steps.collect::<Vec<_>>(),
    })
}

fn curve(curve: &Curve, index: &BTreeMap<usize, usize>) -> Value {
    let mut values = vec![Value::Null; index.len()];
    for (number, value) in &curve.values {
        if let (Some(&place), Some(value)) = (index.get(number), value) {
            values[place] = shortened(*value);
        }
    }
    json!({"label": curve.label, "unit": curve.unit, "group": curve.group, "camera": curve.camera,
        "values": values})
}

/// A number to [`DIGITS`] digits; null where it is not finite.
fn shortened(value: f64) -> Value {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { json!(0) } else { Value::Null };
    }
    let decimals = DIGITS - 1 - value.abs().log10().floor() as i32;
    let scale = 10_f64.powi(decimals.abs());
    let rounded =
        if decimals >= 0 { (value * scale).round() / scale } else { (value / scale).round() * scale };
    if rounded.fract() == 0.0 && rounded.abs() < 1e15 { json!(rounded as i64) } else { json!(rounded) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_five_digits() {
        for (value, text) in [
            (0.868_374_9, "0.86837"),
            (123_456_789.0, "123460000"),
            (-0.000_123_456_7, "-0.00012346"),
            (0.0, "0"),
            (2.0, "2"),
            (f64::NAN, "null"),
            (f64::INFINITY, "null"),
            (99_999.9, "100000"),
        ] {
            assert_eq!(shortened(value).to_string(), text);
        }
    }
}
