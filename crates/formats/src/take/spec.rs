//! What `take.toml` says, before anything is looked up.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

/// Name and version of the take file's format.
pub const FORMAT: &str = "backlit-take 1";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TakeSpec {
    #[serde(rename = "format")]
    pub(super) _format: String,
    pub(super) name: Spanned<String>,
    pub(super) frame_rate: Spanned<f64>,
    #[serde(default)]
    pub(super) units: Units,
    pub(super) footage: Option<Spanned<String>>,
    pub(super) model: Spanned<String>,
    pub(super) start: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) sizes: BodySizes,
    pub(super) reduction: Option<Spanned<u64>>,
    pub(super) cameras: CalibrationSpec,
    #[serde(rename = "camera", default)]
    pub(super) views: Vec<ViewSpec>,
    pub(super) reference: Option<ReferenceSpec>,
    #[serde(default)]
    pub(super) measurement: toml::Table,
}

/// What is known of the body's sizes.
#[derive(Debug, Deserialize, Clone, Copy, Default, PartialEq, Eq)]
pub enum BodySizes {
    /// The model has the person's own sizes, or better ones are not needed.
    #[default]
    #[serde(rename = "known")]
    Known,
    /// The model is an average body: the person's own sizes are to be fitted before a take is tracked.
    #[serde(rename = "fit")]
    Fit,
}

/// Unit of lengths in files that do not say their own.
#[derive(Debug, Deserialize, Clone, Copy, Default)]
pub(super) enum Units {
    #[default]
    #[serde(rename = "m")]
    Metres,
    #[serde(rename = "mm")]
    Millimetres,
}

impl Units {
    pub(super) fn metres(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Millimetres => 1e-3,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CalibrationSpec {
    pub(super) calibration: Spanned<String>,
    pub(super) size: Option<[u64; 2]>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ViewSpec {
    pub(super) name: Spanned<String>,
    pub(super) frames: Option<Spanned<String>>,
    pub(super) masks: Option<Spanned<String>>,
    pub(super) masks_first: Option<Spanned<u64>>,
    pub(super) mask_values: Option<Spanned<toml::Value>>,
    #[serde(default)]
    pub(super) first: u64,
    pub(super) count: Option<Spanned<u64>>,
    pub(super) last: Option<Spanned<u64>>,
    pub(super) offset: Option<Spanned<i64>>,
    pub(super) offset_seconds: Option<Spanned<f64>>,
    pub(super) background: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) background_first: u64,
    pub(super) background_count: Option<Spanned<u64>>,
    pub(super) keypoints: Option<Spanned<String>>,
    pub(super) keypoints_first: Option<u64>,
    #[serde(default)]
    pub(super) measurement: toml::Table,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReferenceSpec {
    pub(super) keypoints: Spanned<String>,
    #[serde(default)]
    pub(super) first_frame: u64,
    pub(super) axes: Option<Spanned<String>>,
    pub(super) markers: Option<BTreeMap<String, Spanned<String>>>,
    pub(super) placement: Option<Spanned<String>>,
}
