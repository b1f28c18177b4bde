//! How choices of the fit are said.

use backlit_tracking::fit::{DataView, FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_words::format;

/// The preset whose choices these are, apart from the renderer, which is chosen by itself.
pub fn preset_like(options: &FitOptions) -> Option<Preset> {
    let mut plain = options.clone();
    Preset::ALL.into_iter().find(|preset| {
        let preset = FitOptions::preset(*preset);
        plain.renderer = preset.renderer;
        plain == preset
    })
}

/// A fit's name: its preset, or its method.
pub fn fit_name(options: &FitOptions) -> String {
    let name = preset_like(options).map(Preset::label).unwrap_or(match options.method {
        Method::LevenbergMarquardt => "Levenberg-Marquardt",
        Method::GaussNewton => "Gauss-Newton",
    });
    name.to_owned()
}

/// What else distinguishes a fit: renderer, ramps, priors.
pub fn fit_detail(options: &FitOptions) -> String {
    let renderer = options.renderer.label().to_lowercase();
    let prior = if options.proximal_weight > 0.0 { ", proximal prior" } else { "" };
    let likely = if options.prior.is_some() { ", likely poses" } else { "" };
    format!("{renderer}, {}{prior}{likely}", ramps(options))
}

/// All renderers, in the order of the report: how a sentence begins that is about all of them.
pub fn renderers() -> String {
    let labels = RendererKind::listed(&RendererKind::in_report_order(), "and", RendererKind::label);
    format::capitalised(&labels.to_lowercase())
}

/// The ramps from the first stage to the last.
pub fn ramps(options: &FitOptions) -> String {
    let word = |ramp: Ramp| match ramp {
        Ramp::Thesis | Ramp::Half => format!("{} ramp", short_ramp(ramp)),
        Ramp::Width { .. } | Ramp::Distance { .. } => format!("ramp {} px", short_ramp(ramp)),
    };
    match (options.stages.first(), options.stages.last()) {
        (Some(first), Some(last)) if options.stages.len() > 1 => {
            let annealed = if first.data == DataView::Distance { "annealed " } else { "" };
            format!("{annealed}{} to {} px", short_ramp(first.ramp), short_ramp(last.ramp))
        }
        (_, Some(last)) => word(last.ramp),
        _ => String::new(),
    }
}

/// A ramp as short as it can be said: a word, or its outer width in pixels.
pub fn short_ramp(ramp: Ramp) -> String {
    match ramp {
        Ramp::Thesis => "thesis".to_owned(),
        Ramp::Half => "half".to_owned(),
        Ramp::Width { px } | Ramp::Distance { outer_px: px, .. } => {
            format::number(px, usize::from(px.fract() != 0.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_are_told_apart_in_words() {
        assert_eq!(renderers(), "Cylinder, capsule and sphere tree");
        let mut options = FitOptions::preset(Preset::Robust);
        options.renderer = RendererKind::Cylinder;
        assert_eq!(fit_name(&options), "Robust");
        assert_eq!(fit_detail(&options), "cylinder, annealed 24 to 1.5 px, proximal prior");
        options.damping = 0.5;
        assert_eq!(fit_name(&options), "Levenberg-Marquardt");
        let report = FitOptions::preset(Preset::Report);
        assert_eq!(
            (fit_name(&report), fit_detail(&report)),
            ("Report 2004".into(), "capsule, thesis ramp".into())
        );
    }
}
