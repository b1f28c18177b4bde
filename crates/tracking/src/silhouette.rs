//! Silhouettes: what the footage says about where the subject is.
//!
//! A [`Mask`] is the evidence: every pixel is background, subject or unknown; background and unknown may be so because of a
//! shadow, which is a [class](PixelClass) of its own. Everything else here is a view of it:
//!
//! - [`Measurement`] is D of the cost ‖D − Λ‖²: a grey level and a weight for each pixel, made from the mask as it is,
//!   from its area averages, or from its [`SignedDistance`];
//! - [`Overlap`] counts where a prediction Λ and a mask agree;
//! - [`contours`] are outlines to draw.
//!
//! Throughout, pixel centres lie at integer coordinates, x to the right and y down; images are stored row by row. Grey
//! levels run from 0 (subject) to 255 (background). Image *files* of masks are the other way round: white is the subject.

mod box_average;
mod contour;
mod distance;
pub(crate) mod distance_ramp;
mod mask;
pub(crate) mod measurement;
mod near_distance;
mod overlap;
mod row_search;
mod stroke;

pub use contour::contours;
pub use distance::SignedDistance;
pub use mask::{Label, MAX_PIXELS, Mask, MaskError, PixelBox, PixelClass};
pub use measurement::{Measurement, MeasurementError, Region};
pub use overlap::{Overlap, OverlapError};
pub use stroke::{Stroke, StrokeError};
