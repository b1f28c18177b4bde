//! What `backlit fit-body` says: a table for people, and the same as JSON.

use std::path::Path;

use backlit_tracking::body::SizeKind;
use backlit_tracking::body_fit::{BodyFit, SizeEstimate};
use backlit_tracking::body_spheres::SphereBody;
use serde::Serialize;

use super::output::{number, object, percent_change};
use super::table::Table;

/// The answer as JSON has it: sizes in metres, factors of the body that the fit began with.
pub(crate) fn answer(fit: &BodyFit, spheres: Option<&SphereBody>) -> impl Serialize {
    let size = |size: &SizeEstimate| {
        object! {
            limb: size.name.clone(),
            kind: size.kind,
            start: size.start,
            found: size.found,
            deviation: size.deviation,
            prior_deviation: size.prior_deviation,
            held_by_prior: size.is_held_by_prior(),
        }
    };
    // By how many pixels silhouettes are too wide all round; nothing where they were taken as they are.
    let widening = fit.widening.map(|found| {
        object! {
            widening: object! { px: found.px, deviation_px: found.deviation_px, believed: found.is_believed },
        }
    });
    // By level, the coarsest first; IoU of all frames and cameras.
    let spheres = spheres.map(|one| {
        object! {
            spheres: object! {
                levels: one.spheres.clone(),
                iou_of_capsules: one.iou.map(|iou| iou[0]),
                iou_as_carved: one.iou.map(|iou| iou[1]),
                iou: one.iou.map(|iou| iou[2]),
                rms: change(one.rms),
            },
        }
    });
    object! {
        frames: fit.frames.clone(),
        size: fit.size,
        girth: fit.girth,
        #[serde(flatten)]
        widening: widening,
        iou: change(fit.iou),
        rms: change(fit.rms),
        iterations: fit.iterations,
        termination: fit.termination.name(),
        #[serde(flatten)]
        spheres: spheres,
        sizes: fit.sizes.iter().map(size).collect::<Vec<_>>(),
    }
}

fn change<T: Serialize>([before, after]: [T; 2]) -> impl Serialize {
    object! { before: before, after: after }
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
