//! How far the limbs of a frame are believed, as files have it.

use std::collections::BTreeMap;

use backlit_tracking::belief::{LimbTrust, Reason};
use backlit_tracking::body::Model;
use serde::{Deserialize, Serialize};

use crate::FileProblem;
use crate::json_text::unique_keys;

/// By the limb's name.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TrustRecord(#[serde(deserialize_with = "unique_keys")] BTreeMap<String, LimbRecord>);

#[derive(Debug, Serialize, Deserialize)]
struct LimbRecord {
    /// For those who read the file: it follows from the probability.
    #[serde(skip_deserializing)]
    verdict: &'static str,
    wrong: f64,
    error: f64,
    /// Files of older versions do not say it.
    #[serde(default = "farthest_m")]
    error_95: f64,
    because: Option<Reason>,
}

/// An error of which nothing is known, metres.
fn farthest_m() -> f64 {
    2.0
}

impl TrustRecord {
    /// How far these limbs of a body are believed.
    #[must_use]
    pub fn of(model: &Model, trust: &[LimbTrust]) -> Self {
        let record = |limb: &LimbTrust| LimbRecord {
            verdict: limb.verdict.name(),
            wrong: limb.wrong,
            error: limb.error_m,
            error_95: limb.error_95_m,
            because: limb.reason,
        };
        Self(trust.iter().map(|limb| (model.limbs()[limb.limb].name.clone(), record(limb))).collect())
    }

    /// Whether nobody judged the limbs.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The same in the order of the limbs.
    ///
    /// # Errors
    /// A limb that the body does not have, or numbers that are no probability and no metres. The error names the `field`.
    pub fn read(self, model: &Model, field: &str) -> Result<Vec<LimbTrust>, FileProblem> {
        let mut trust = Vec::with_capacity(self.0.len());
        for (name, LimbRecord { wrong, error, error_95, because, .. }) in self.0 {
            let limb = model.limb_index(&name).ok_or_else(|| {
                let (field, limb) = (field.to_owned(), name.clone());
                FileProblem::UnknownLimb { field, limb }
            })?;
            let is_error = |metres: f64| metres.is_finite() && metres >= 0.0;
            if !((0.0..=1.0).contains(&wrong) && is_error(error) && is_error(error_95)) {
                let (field, found) = (format!("{field}.{name}"), format!("{wrong}, {error}, {error_95}"));
                return Err(FileProblem::field(&field, found, "a probability and metres"));
            }
            trust.push(LimbTrust::new(limb, wrong, [error, error_95], because.unwrap_or(Reason::Loose)));
        }
        trust.sort_by_key(|limb| limb.limb);
        Ok(trust)
    }
}
