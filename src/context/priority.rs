//! How urgent each kind of work is. On each thread the smallest level goes first.

use backlit_jobs::Priority;

/// The silhouettes of the pose on the screen.
pub(crate) const PREDICTION: u8 = Priority::screen(0).code();
/// The pictures of the laboratory's step.
pub(crate) const LABORATORY_LOOK: u8 = Priority::screen(1).code();
/// Opening a take.
pub(crate) const OPEN: u8 = Priority::screen(2).code();
/// Reading dropped files.
pub(crate) const TAKE_IN: u8 = Priority::screen(3).code();
/// Making the footage again for other cameras.
pub(crate) const CALIBRATION: u8 = Priority::screen(4).code();
/// Reading and segmenting the frame on the screen.
pub(crate) const FRAME: u8 = Priority::screen(5).code();
/// The fit of one frame.
pub(crate) const FIT: u8 = Priority::screen(6).code();
/// The laboratory's fits.
pub(crate) const LABORATORY: u8 = Priority::screen(7).code();
/// What the cameras see of the pose on the screen.
pub(crate) const OBSERVABILITY: u8 = Priority::screen(8).code();

/// The picture of the 3-D scene.
pub(crate) const SCENE: u8 = Priority::drawing(0).code();

/// Writing a project or the copy of unsaved work.
pub(crate) const SAVE: u8 = Priority::saving(0).code();
/// Writing the settings.
pub(crate) const SETTINGS: u8 = Priority::saving(1).code();
/// Writing a table, a plot or numbers.
pub(crate) const WRITE: u8 = Priority::saving(2).code();

/// A look at the take as a whole.
pub(crate) const SURVEY: u8 = Priority::long(0).code();
/// Painting and writing pictures. The user waits for them; trackers and basins go on after it.
pub(crate) const EXPORT: u8 = Priority::long(1).code();
/// The fit of frame after frame.
pub(crate) const TRACK: u8 = Priority::long(2).code();
/// The visual hull of the frame on the screen.
pub(crate) const HULL: u8 = Priority::long(3).code();
/// Names of the tracked motion.
pub(crate) const MOTIONS: u8 = Priority::long(4).code();
/// The check of the laboratory's gradients.
pub(crate) const LABORATORY_CHECK: u8 = Priority::long(5).code();
/// Fits of many starts of one frame.
pub(crate) const BASIN: u8 = Priority::long(6).code();
