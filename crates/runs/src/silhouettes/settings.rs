//! The settings that tuning tries, and what is said of a change.

use backlit_tracking::segment::{ChromaOptions, HYSTERESIS, SegmentOptions, ShadowOptions, ShadowTest};
use backlit_words::format::number;

const Z_SCORES: [f32; 6] = [2.5, 3.3, 4.149_4, 5.5, 7.5, 10.0];
/// The darkest shadow that is tried beside the usual one, of the background's brightness.
const DARK_SHADOW: f32 = 0.4;

/// Other settings than these, setting by setting.
pub(super) fn candidates(now: &SegmentOptions) -> Vec<Vec<SegmentOptions>> {
    let with = |change: &dyn Fn(&mut SegmentOptions)| {
        let mut options = now.clone();
        change(&mut options);
        options
    };
    let kept = now.shadow.unwrap_or_default();
    let usual = ShadowOptions::default().darkest;
    let shadows = [
        None,
        Some(ShadowOptions { test: ShadowTest::Brightness, darkest: usual, ..kept }),
        Some(ShadowOptions { test: ShadowTest::Brightness, darkest: DARK_SHADOW, ..kept }),
        Some(ShadowOptions { test: ShadowTest::Gradient, ..kept }),
    ];
    let knobs: [Vec<SegmentOptions>; 6] = [
        Z_SCORES
            .map(|z| {
                with(&|options| {
                    options.z_threshold = z;
                    options.hysteresis_z = now.hysteresis_z.map(|_| HYSTERESIS * z);
                })
            })
            .into(),
        shadows.map(|shadow| with(&|options| options.shadow = shadow)).into(),
        [None, Some(HYSTERESIS * now.z_threshold)]
            .map(|low| with(&|options| options.hysteresis_z = low))
            .into(),
        [None, Some(ChromaOptions::default())].map(|chroma| with(&|options| options.chroma = chroma)).into(),
        (0..=3).map(|px| with(&|options| options.opening_px = px)).collect(),
        [0, 1, 2, 3, 5].map(|px| with(&|options| options.closing_px = px)).into(),
    ];
    knobs.into_iter().map(|knob| knob.into_iter().filter(|options| options != now).collect()).collect()
}

/// A camera's own settings with every setting changed that differs between two others.
#[must_use]
pub fn with_changes(own: &SegmentOptions, before: &SegmentOptions, after: &SegmentOptions) -> SegmentOptions {
    fn pick<T: PartialEq + Copy>(own: T, before: T, after: T) -> T {
        if before == after { own } else { after }
    }
    SegmentOptions {
        z_threshold: pick(own.z_threshold, before.z_threshold, after.z_threshold),
        shadow: pick(own.shadow, before.shadow, after.shadow),
        hysteresis_z: pick(own.hysteresis_z, before.hysteresis_z, after.hysteresis_z),
        chroma: pick(own.chroma, before.chroma, after.chroma),
        opening_px: pick(own.opening_px, before.opening_px, after.opening_px),
        closing_px: pick(own.closing_px, before.closing_px, after.closing_px),
        ..own.clone()
    }
}

/// What two settings differ in, in words: "z-score 4.1 → 5.5".
#[must_use]
pub fn changes(before: &SegmentOptions, after: &SegmentOptions) -> Vec<String> {
    let z = |z: f32| number(f64::from(z), 1);
    let shadow = |options: &SegmentOptions| match options.shadow {
        None => "off".to_owned(),
        Some(ShadowOptions { test: ShadowTest::Gradient, .. }) => "gradient".to_owned(),
        Some(ShadowOptions { darkest, .. }) => {
            format!("brightness from {} %", number(100.0 * f64::from(darkest), 0))
        }
    };
    let switch = |is_on: bool| if is_on { "on" } else { "off" }.to_owned();
    let of = |options: &SegmentOptions| {
        [
            ("z-score", z(options.z_threshold)),
            ("shadow test", shadow(options)),
            ("hysteresis", options.hysteresis_z.map_or_else(|| "off".to_owned(), z)),
            ("chroma apart", switch(options.chroma.is_some())),
            ("opening", format!("{} px", options.opening_px)),
            ("closing", format!("{} px", options.closing_px)),
        ]
    };
    let both = of(before).into_iter().zip(of(after)).filter(|(before, after)| before.1 != after.1);
    both.map(|((what, before), (_, after))| format!("{what} {before} → {after}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_said_setting_by_setting() {
        let before = SegmentOptions::default();
        let after = SegmentOptions { z_threshold: 5.5, shadow: None, closing_px: 3, ..before.clone() };
        assert_eq!(
            changes(&before, &after),
            ["z-score 4.1 → 5.5", "shadow test brightness from 60 % → off", "closing 2 px → 3 px"]
        );
        assert!(changes(&before, &before).is_empty());
    }

    #[test]
    fn a_camera_keeps_what_is_not_changed() {
        let before = SegmentOptions::default();
        let after = SegmentOptions { z_threshold: 5.5, ..before.clone() };
        let own = SegmentOptions { z_threshold: 9.0, closing_px: 5, noise_floor: 2.0, ..before.clone() };
        assert_eq!(with_changes(&own, &before, &after), SegmentOptions { z_threshold: 5.5, ..own.clone() });
        assert_eq!(with_changes(&own, &before, &before), own);
    }

    #[test]
    fn candidates_differ_from_what_is_there_in_one_setting() {
        let now = SegmentOptions::default();
        let all = candidates(&now);
        assert_eq!(all.len(), 6);
        for options in all.iter().flatten() {
            options.check().unwrap();
            assert_eq!(changes(&now, options).len(), 1, "{options:?}");
        }
    }
}
