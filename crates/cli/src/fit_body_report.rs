//! What `backlit fit-body` says: a table for people, and the same as JSON.

use std::path::Path;

use backlit_tracking::body::SizeKind;
use backlit_tracking::body_fit::{BodyFit, SizeEstimate};
use backlit_tracking::body_spheres::SphereBody;
use serde::Serialize;

use super::output::{number, percent_change};
use super::table::Table;

/// The result as JSON has it.
#[derive(Debug, Serialize)]
pub(crate) struct BodyReport {
    frames: Vec<usize>,
    /// Factors of the body that the fit began with.
    size: f64,
    girth: f64,
    /// By how many pixels silhouettes are too wide all round; none where they were taken as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    widening: Option<WideningReport>,
    iou: Before<Option<f64>>,
    rms: Before<f64>,
    iterations: usize,
    termination: &'static str,
    /// Of a body of spheres.
    #[serde(skip_serializing_if = "Option::is_none")]
    spheres: Option<SpheresReport>,
    sizes: Vec<SizeReport>,
}

/// By level, the coarsest first; IoU of all frames and cameras.
#[derive(Debug, Serialize)]
struct SpheresReport {
    levels: Vec<usize>,
    iou_of_capsules: Option<f64>,
    iou_as_carved: Option<f64>,
    iou: Option<f64>,
    rms: Before<f64>,
}

#[derive(Debug, Serialize)]
struct Before<T> {
    before: T,
    after: T,
}

/// Pixels.
#[derive(Debug, Serialize)]
struct WideningReport {
    px: f64,
    deviation_px: f64,
    believed: bool,
}

/// Metres.
#[derive(Debug, Serialize)]
struct SizeReport {
    limb: String,
    kind: SizeKind,
    start: f64,
    found: f64,
    deviation: f64,
    prior_deviation: f64,
    held_by_prior: bool,
}

impl BodyReport {
    pub(crate) fn new(fit: &BodyFit, spheres: Option<&SphereBody>) -> Self {
        let size = |size: &SizeEstimate| SizeReport {
            limb: size.name.clone(),
            kind: size.kind,
            start: size.start,
            found: size.found,
            deviation: size.deviation,
            prior_deviation: size.prior_deviation,
            held_by_prior: size.is_held_by_prior(),
        };
        Self {
            frames: fit.frames.clone(),
            size: fit.size,
            girth: fit.girth,
            widening: fit.widening.map(|found| WideningReport {
                px: found.px,
                deviation_px: found.deviation_px,
                believed: found.is_believed,
            }),
            iou: Before { before: fit.iou[0], after: fit.iou[1] },
            rms: Before { before: fit.rms[0], after: fit.rms[1] },
            iterations: fit.iterations,
            termination: fit.termination.name(),
            spheres: spheres.map(|one| SpheresReport {
                levels: one.spheres.clone(),
                iou_of_capsules: one.iou.map(|iou| iou[0]),
                iou_as_carved: one.iou.map(|iou| iou[1]),
                iou: one.iou.map(|iou| iou[2]),
                rms: Before { before: one.rms[0], after: one.rms[1] },
            }),
            sizes: fit.sizes.iter().map(size).collect(),
        }
    }
}

pub(crate) fn text(fit: &BodyFit, spheres: Option<&SphereBody>, written: Option<&Path>) -> String {
    let frames: Vec<String> = fit.frames.iter().map(usize::to_string).collect();
    let mut out = format!(
        "frames {}\nsize {}, girth {} beside it, of the body to begin with\n",
        frames.join(", "),
        percent_change(fit.size),
        percent_change(fit.girth)
    );
    if let [Some(before), Some(after)] = fit.iou {
        out.push_str(&format!("IoU {before:.3} scaled as a whole, {after:.3} with its own sizes\n"));
    }
    if let Some(spheres) = spheres {
        let counts: Vec<String> = spheres.spheres.iter().map(usize::to_string).collect();
        out.push_str(&format!("spheres by level: {}\n", counts.join(", ")));
        if let Some([capsules, carved, end]) = spheres.iou {
            out.push_str(&format!(
                "IoU {capsules:.3} of capsules, {carved:.3} of spheres as carved, {end:.3} moved\n"
            ));
        }
    }
    if let Some(found) = fit.widening.filter(|found| found.is_believed) {
        let word = if found.px > 0.0 { "wide" } else { "narrow" };
        out.push_str(&format!(
            "the silhouettes are {:.1} ± {:.1} px too {word} all round: sizes are those without it\n",
            found.px.abs(),
            found.deviation_px
        ));
    }
    for one in &fit.left_out {
        out.push_str(&format!("left out: camera {} in frame {}: {}\n", one.camera, one.frame, one.because));
    }
    let held = |size: &SizeEstimate| if size.is_held_by_prior() { "held by proportions" } else { "" };
    out.push('\n');
    out += &Table::of(
        &fit.sizes,
        &[
            ("mm", &|size| format!("{}, {}", size.name, size.kind)),
            ("before", &|size| number(1000.0 * size.start, 1)),
            ("found", &|size| number(1000.0 * size.found, 1)),
            ("±", &|size| number(1000.0 * size.deviation, 1)),
            ("", &|size| held(size).to_owned()),
        ],
    );
    let of = |kind: SizeKind| {
        let held = fit.sizes.iter().filter(|size| size.kind == kind && size.is_held_by_prior());
        held.map(|size| size.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    for (kind, plural) in [(SizeKind::Length, "lengths"), (SizeKind::Radius, "radii")] {
        let names = of(kind);
        if !names.is_empty() {
            let sentence = format!("\nThese frames hardly show the {plural} of: {names}.\n");
            out.push_str(&sentence);
        }
    }
    if let Some(path) = written {
        out.push_str(&format!("\nWritten: {}\n", path.display()));
    }
    out
}
