//! How urgent each kind of work is. On each thread the smallest level goes first.

use backlit_jobs::Priority;

/// The silhouettes of the pose on the screen.
pub(crate) const PREDICTION: Priority = Priority::screen(0);
/// The pictures of the laboratory's step.
pub(crate) const LABORATORY_LOOK: Priority = Priority::screen(1);
/// Opening a take.
pub(crate) const OPEN: Priority = Priority::screen(2);
/// Reading dropped files.
pub(crate) const TAKE_IN: Priority = Priority::screen(3);
/// Making the footage again for other cameras.
pub(crate) const CALIBRATION: Priority = Priority::screen(4);
/// Reading and segmenting the frame on the screen.
pub(crate) const FRAME: Priority = Priority::screen(5);
/// The fit of one frame.
pub(crate) const FIT: Priority = Priority::screen(6);
/// The laboratory's fits.
pub(crate) const LABORATORY: Priority = Priority::screen(7);
/// What the cameras see of the pose on the screen.
pub(crate) const OBSERVABILITY: Priority = Priority::screen(8);

/// The picture of the 3-D scene.
pub(crate) const SCENE: Priority = Priority::drawing(0);

/// Writing a project or the copy of unsaved work.
pub(crate) const SAVE: Priority = Priority::saving(0);
/// Writing the settings.
pub(crate) const SETTINGS: Priority = Priority::saving(1);
/// Writing a table, a plot or numbers.
pub(crate) const WRITE: Priority = Priority::saving(2);

/// A look at the take as a whole.
pub(crate) const SURVEY: Priority = Priority::long(0);
/// Painting and writing pictures. The user waits for them; trackers and basins go on after it.
pub(crate) const EXPORT: Priority = Priority::long(1);
/// The fit of frame after frame.
pub(crate) const TRACK: Priority = Priority::long(2);
/// The visual hull of the frame on the screen.
pub(crate) const HULL: Priority = Priority::long(3);
/// Names of the tracked motion.
pub(crate) const MOTIONS: Priority = Priority::long(4);
/// The check of the laboratory's gradients.
pub(crate) const LABORATORY_CHECK: Priority = Priority::long(5);
/// Fits of many starts of one frame.
pub(crate) const BASIN: Priority = Priority::long(6);
