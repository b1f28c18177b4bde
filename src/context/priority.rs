//! How urgent each kind of work is. On each thread the smallest level goes first.

use backlit_jobs::{Crew, priority};

/// The silhouettes of the pose on the screen.
pub(crate) const PREDICTION: u8 = priority(Crew::Screen, 0);
/// The pictures of the laboratory's step.
pub(crate) const LABORATORY_LOOK: u8 = priority(Crew::Screen, 1);
pub(crate) const OPEN: u8 = priority(Crew::Screen, 2);
/// Reading dropped files.
pub(crate) const TAKE_IN: u8 = priority(Crew::Screen, 3);
/// Making the footage again for other cameras.
pub(crate) const CALIBRATION: u8 = priority(Crew::Screen, 4);
/// Reading and segmenting the frame on the screen.
pub(crate) const FRAME: u8 = priority(Crew::Screen, 5);
/// The fit of one frame.
pub(crate) const FIT: u8 = priority(Crew::Screen, 6);
pub(crate) const LABORATORY: u8 = priority(Crew::Screen, 7);
/// What the cameras see of the pose on the screen.
pub(crate) const OBSERVABILITY: u8 = priority(Crew::Screen, 8);

/// The picture of the 3-D scene.
pub(crate) const SCENE: u8 = priority(Crew::Drawing, 0);

/// Writing a project or the copy of unsaved work.
pub(crate) const SAVE: u8 = priority(Crew::Saving, 0);
pub(crate) const SETTINGS: u8 = priority(Crew::Saving, 1);
/// Writing a table, a plot or numbers.
pub(crate) const WRITE: u8 = priority(Crew::Saving, 2);

/// A look at the take as a whole.
pub(crate) const SURVEY: u8 = priority(Crew::Long, 0);
/// Painting and writing pictures. The user waits for them; trackers and basins go on after it.
pub(crate) const EXPORT: u8 = priority(Crew::Long, 1);
/// The fit of frame after frame.
pub(crate) const TRACK: u8 = priority(Crew::Long, 2);
/// The visual hull of the frame on the screen.
pub(crate) const HULL: u8 = priority(Crew::Long, 3);
/// Names of the tracked motion.
pub(crate) const MOTIONS: u8 = priority(Crew::Long, 4);
/// How the silhouette on the screen came about.
pub(crate) const SILHOUETTE_STEPS: u8 = priority(Crew::Drawing, 1);
/// The worst silhouettes, and settings that suit the take better.
pub(crate) const SILHOUETTES: u8 = priority(Crew::Long, 7);
/// Reading references, and comparing the poses with them.
pub(crate) const COMPARE: u8 = priority(Crew::Long, 8);
/// The check of the laboratory's gradients.
pub(crate) const LABORATORY_CHECK: u8 = priority(Crew::Long, 5);
/// Fits of many starts of one frame.
pub(crate) const BASIN: u8 = priority(Crew::Long, 6);
