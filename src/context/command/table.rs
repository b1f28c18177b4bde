//! The table of all commands, in the order of the menus: text, tooltip and keys stand here and nowhere else.

use backlit_take::demonstration::Demonstration;
use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;
use backlit_tracking::silhouette::Label;
use backlit_ui::drawing::{ModeComparison, ViewMode};
use egui::{Key, KeyboardShortcut};

use super::Command::{
    Basin, Beginning, Bookmarks, CameraCheck, CameraPlan, CameraRefinement, Compare, Convergence,
    Demonstration as Show, Export, File, Fit, History, Laboratory, Observability, Offsets, Pose, Recovery,
    Scene, Silhouettes, Timeline, Tour, Tracking, View, Window,
};
use super::keys::{ctrl, ctrl_shift, key, shift};
use super::{
    BasinCommand, BasinView, BeginningCommand, BodyPart, Command, CompareCommand, ConvergenceCommand,
    ExportCommand, FileCommand, FitCommand, HistoryCommand, LaboratoryCommand, Menu, Nudge,
    ObservabilityCommand, PoseCommand, RecoveryCommand, SceneCommand, SilhouetteCommand, TimelineCommand,
    TrackingCommand, Variants, ViewCommand, WindowCommand,
};
use crate::context::marks::SilhouetteTool;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

pub(super) struct CommandRow {
    pub(super) command: Command,
    pub(super) menu: Menu,
    pub(super) text: &'static str,
    pub(super) tooltip: &'static str,
    pub(super) keys: &'static [KeyboardShortcut],
}

const fn row(
    menu: Menu,
    command: Command,
    text: &'static str,
    tooltip: &'static str,
    keys: &'static [KeyboardShortcut],
) -> CommandRow {
    CommandRow { command, menu, text, tooltip, keys }
}

const fn solid(kind: RendererKind, tooltip: &'static str, keys: &'static [KeyboardShortcut]) -> CommandRow {
    row(Menu::Fit, Fit(FitCommand::Renderer(kind)), kind.label(), tooltip, keys)
}

#[rustfmt::skip]
pub(super) const TABLE: &[CommandRow] = &[
    row(Menu::File, File(FileCommand::NewTake), "New take…", "Make a take from footage and a calibration, or from another tool’s project", &[ctrl(Key::N)]),
    row(Menu::File, File(FileCommand::OpenTake), "Open take…", "Open a folder with a take.toml", &[ctrl(Key::O)]),
    row(Menu::File, File(FileCommand::OpenBuiltIn), "Open built-in take", "A synthetic figure before four cameras, with known truth", &[]),
    row(Menu::File, File(FileCommand::OpenMotion), "Play a motion…", "Move the body by a BVH, TRC, C3D, CSV or NumPy file, without footage", &[]),
    row(Menu::File, File(FileCommand::OpenProject), "Open project…", "Open saved work, a .backlit file", &[ctrl_shift(Key::O)]),
    row(Menu::File, File(FileCommand::FindTake), "Find take…", "Open the project whose take was missing: say where the take is now", &[]),
    row(Menu::File, File(FileCommand::Save), "Save", "Save poses, sizes and settings to the project file", &[ctrl(Key::S)]),
    row(Menu::File, File(FileCommand::SaveAs), "Save as…", "Save to another project file", &[ctrl_shift(Key::S)]),
    row(Menu::File, Export(ExportCommand::View), "Export view…", "The active camera’s picture with its marks and legend, as a PNG of any size", &[ctrl(Key::E)]),
    row(Menu::File, Export(ExportCommand::Window), "Export window…", "The window as it is, as a PNG of any size", &[ctrl_shift(Key::E)]),
    row(Menu::File, Export(ExportCommand::Steps), "Export steps…", "All steps of the run on the screen, as PNGs or as an animation", &[]),
    row(Menu::File, Export(ExportCommand::Frames), "Export frames…", "A range of frames with their poses, as PNGs or as an animation", &[]),
    row(Menu::File, Export(ExportCommand::Motion), "Export motion…", "All poses, those set by hand too, as BVH, glTF, C3D, TRC, MOT, NumPy or CSV", &[]),
    row(Menu::File, Export(ExportCommand::Report), "Report…", "All poses as one HTML page to send: views, scene, curves, errors, steps of a fit", &[]),
    row(Menu::File, Export(ExportCommand::Stop), "Stop export", "End the export that is under way", &[]),
    row(Menu::File, Export(ExportCommand::ShowExported), "Show exported files", "Open the folder of the last export", &[]),
    row(Menu::File, Recovery(RecoveryCommand::Show), "Unsaved work…", "What this window or an earlier one has left unsaved: go on with it, or discard it", &[]),
    row(Menu::File, Recovery(RecoveryCommand::UndoDiscard), "Undo discard", "Bring back the unsaved work that was discarded last", &[]),
    row(Menu::File, File(FileCommand::Quit), "Quit", "Close the window; unsaved work is kept for the next start", &[ctrl(Key::Q)]),
    row(Menu::Edit, History(HistoryCommand::Undo), "Undo", "Take back the last change", &[ctrl(Key::Z)]),
    row(Menu::Edit, History(HistoryCommand::Redo), "Redo", "Make the last undone change again", &[ctrl_shift(Key::Z), ctrl(Key::Y)]),
    row(Menu::Edit, Pose(PoseCommand::Copy), "Copy pose", "Copy the whole pose of this frame", &[ctrl(Key::C)]),
    row(Menu::Edit, Pose(PoseCommand::Paste), "Paste pose", "Give this frame the copied pose", &[ctrl(Key::V)]),
    row(Menu::Edit, Pose(PoseCommand::Mirror), "Mirror", "Copy the selected limb and all that hangs from it, mirrored, to the other side of the body", &[key(Key::X)]),
    row(Menu::Edit, Pose(PoseCommand::MirrorAll), "Mirror pose", "Swap left and right in the whole pose", &[shift(Key::X)]),
    row(Menu::Edit, Pose(PoseCommand::TurnRound), "Turn round", "Turn the body to face the other way where it stands: silhouettes hardly tell front from back", &[ctrl_shift(Key::X)]),
    row(Menu::Edit, Pose(PoseCommand::PinJoint), "Pin or free joint", "A pinned joint stays where it is while others are dragged", &[key(Key::I)]),
    row(Menu::Edit, Pose(PoseCommand::HoldTrunk), "Hold the trunk", "A dragged joint moves its own arm, leg or neck alone, and stops where that ends", &[shift(Key::I)]),
    row(Menu::Edit, Pose(PoseCommand::ResetLimb), "Reset limb", "Turn the selected limb back to its rest position", &[key(Key::Backspace)]),
    row(Menu::Edit, Pose(PoseCommand::ResetBody), "Reset body", "Go back to the start pose of the take", &[shift(Key::Backspace)]),
    row(Menu::Edit, Pose(PoseCommand::NextJoint), "Next joint", "Select the next joint of the body", &[key(Key::Tab)]),
    row(Menu::Edit, Pose(PoseCommand::PreviousJoint), "Previous joint", "Select the previous joint of the body", &[shift(Key::Tab)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::Left)), "Nudge left", "Move the selected joint one pixel to the left in the active view", &[ctrl(Key::ArrowLeft)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::Right)), "Nudge right", "Move the selected joint one pixel to the right in the active view", &[ctrl(Key::ArrowRight)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::Up)), "Nudge up", "Move the selected joint one pixel up in the active view", &[ctrl(Key::ArrowUp)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::Down)), "Nudge down", "Move the selected joint one pixel down in the active view", &[ctrl(Key::ArrowDown)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::FarLeft)), "Nudge left by five", "Move the selected joint five pixels to the left in the active view", &[ctrl_shift(Key::ArrowLeft)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::FarRight)), "Nudge right by five", "Move the selected joint five pixels to the right in the active view", &[ctrl_shift(Key::ArrowRight)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::FarUp)), "Nudge up by five", "Move the selected joint five pixels up in the active view", &[ctrl_shift(Key::ArrowUp)]),
    row(Menu::Edit, Pose(PoseCommand::Nudge(Nudge::FarDown)), "Nudge down by five", "Move the selected joint five pixels down in the active view", &[ctrl_shift(Key::ArrowDown)]),
    row(Menu::View, Window(WindowCommand::Layout(Layout::Pose)), "Pose layout", "Large camera views, for setting a pose by hand", &[key(Key::F1)]),
    row(Menu::View, Window(WindowCommand::Layout(Layout::Debug)), "Debug layout", "Camera views with the convergence plot and its steps", &[key(Key::F2)]),
    row(Menu::View, Window(WindowCommand::Layout(Layout::Demonstrate)), "Demonstrate layout", "The laboratory: several ways to fit from one start, side by side", &[key(Key::F3)]),
    row(Menu::View, Window(WindowCommand::ToggleTheme), "Dark or light", "Switch between the dark and the light theme", &[]),
    row(Menu::View, Window(WindowCommand::TogglePanel), "Show or hide panel", "The column on the right", &[ctrl(Key::B)]),
    row(Menu::View, Window(WindowCommand::ToggleTimeline), "Show or hide lanes", "The lanes of the timeline", &[ctrl(Key::T)]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Scene)), "Show or hide scene", "Body, cameras and their pictures in three dimensions", &[]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Convergence)), "Show or hide convergence", "The plot of the runs, and their steps", &[]),
    row(Menu::View, Scene(SceneCommand::Front), "Scene from the front", "Look at the body’s front in the scene", &[]),
    row(Menu::View, Scene(SceneCommand::Side), "Scene from the side", "Look at the body’s right side in the scene", &[]),
    row(Menu::View, Scene(SceneCommand::Top), "Scene from above", "Look down on the body in the scene", &[]),
    row(Menu::View, Scene(SceneCommand::FromCamera), "Scene from the active camera", "Look from the place of the camera whose tile is active", &[]),
    row(Menu::View, Scene(SceneCommand::Reset), "Whole scene", "See all cameras in the scene", &[]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Basin)), "Show or hide basin", "How far off a start may be: success over angle, and a map", &[]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Motions)), "Show or hide motions", "What the tracked motion is called: walking, boxing and others, as a curve among kinds of motion", &[]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Compare)), "Show or hide comparison", "Joints and angles beside recordings of other tools or other tracks, and runs of the fit as a table", &[]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Silhouettes)), "Show or hide silhouettes", "How a silhouette comes about step by step, which are worst, and brushes to mend them", &[]),
    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Beginnings)), "Show or hide ways to begin", "Particle filter, softened ramp, templates and search, step by step", &[]),
    row(Menu::View, Window(WindowCommand::ArrangeTiles), "Arrange tiles", "Place the tiles of this layout so that their pictures are largest", &[]),
    row(Menu::View, Window(WindowCommand::ResetLayout), "Reset layout", "Put tiles, sizes and sections back as they were at first", &[]),
    row(Menu::View, Window(WindowCommand::RestoreLayout), "Undo layout", "Take back the last Reset layout or Arrange tiles", &[]),
    row(Menu::View, Window(WindowCommand::Enlarge), "Larger letters and buttons", "Enlarge all of the window by a tenth", &[ctrl(Key::Plus), ctrl(Key::Equals)]),
    row(Menu::View, Window(WindowCommand::Shrink), "Smaller letters and buttons", "Shrink all of the window by a tenth", &[ctrl(Key::Minus)]),
    row(Menu::View, Window(WindowCommand::NormalSize), "Usual letters and buttons", "Show all of the window at the size that the desktop asks for", &[ctrl(Key::Num0)]),
    row(Menu::View, View(ViewCommand::FitSubject), "Fit subject", "Zoom every view to the subject", &[key(Key::F)]),
    row(Menu::View, View(ViewCommand::WholePicture), "Whole picture", "Zoom every view to the whole frame", &[key(Key::A)]),
    row(Menu::View, View(ViewCommand::ZoomIn), "Zoom in", "Magnify the active view about its middle; the wheel does it at the pointer", &[key(Key::Plus), key(Key::Equals)]),
    row(Menu::View, View(ViewCommand::ZoomOut), "Zoom out", "Show more of the active view; the wheel does it at the pointer", &[key(Key::Minus)]),
    row(Menu::View, View(ViewCommand::LinkZoom), "Link zoom", "Let all views zoom and pan together, about the same point of the body", &[key(Key::Z)]),
    row(Menu::View, View(ViewCommand::CalibrationMarks), "Calibration marks", "Show principal points, the axes of the world, a grid through its origin, and lens edges", &[key(Key::Q)]),
    row(Menu::View, View(ViewCommand::SideMarks), "Left, right and face", "Mark hands and feet with L and R, and the head with a nose; its tip is filled when the body faces the camera", &[]),
    row(Menu::View, View(ViewCommand::Rivals), "Rival poses", "Show poses that the tracker carried beside the one on the screen, each with how likely it is", &[]),
    row(Menu::View, View(ViewCommand::PixelGrid), "Pixel grid", "Show lines between pixels where they are shown large", &[]),
    row(Menu::View, View(ViewCommand::SizeHandles), "Size handles", "Show handles for the length and the radius of the selected limb in the views", &[key(Key::E)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::Footage)), "Footage", "Show the footage alone", &[key(Key::O)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::Data)), "Data D", "Show the measured silhouette", &[key(Key::D)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::Prediction)), "Prediction Λ", "Show the silhouette that the pose predicts", &[key(Key::M)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::Residual)), "Residual D − Λ", "Show where data and model differ: orange is missing, blue is spurious", &[key(Key::R)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::Tinted)), "Tinted overlay", "Show agreement, missing and spurious over the footage", &[key(Key::T)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::ReportOverlay)), "Report overlay", "Show the data black and the model white, as the report does", &[key(Key::V)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::OwnerLimb)), "Owner limb", "Show which limb each pixel belongs to", &[key(Key::L)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::Gradient)), "Gradient", "Show how strongly each pixel pulls at its limb", &[key(Key::G)]),
    row(Menu::View, View(ViewCommand::Mode(ViewMode::JacobianColumn)), "Jacobian column", "Show how each pixel changes as the selected joint turns; the same key again shows the next axis", &[key(Key::J)]),
    row(Menu::View, View(ViewCommand::Compare(ModeComparison::Wipe)), "Wipe", "Compare two view modes side by side in the active view", &[key(Key::W)]),
    row(Menu::View, View(ViewCommand::Compare(ModeComparison::Blink)), "Blink", "Compare two view modes one after the other in the active view", &[key(Key::B)]),
    row(Menu::View, View(ViewCommand::CameraAlone(0)), "Camera 1 alone", "Show camera 1 alone in the window, or go back to all views", &[key(Key::Num1)]),
    row(Menu::View, View(ViewCommand::CameraAlone(1)), "Camera 2 alone", "Show camera 2 alone in the window, or go back to all views", &[key(Key::Num2)]),
    row(Menu::View, View(ViewCommand::CameraAlone(2)), "Camera 3 alone", "Show camera 3 alone in the window, or go back to all views", &[key(Key::Num3)]),
    row(Menu::View, View(ViewCommand::CameraAlone(3)), "Camera 4 alone", "Show camera 4 alone in the window, or go back to all views", &[key(Key::Num4)]),
    row(Menu::View, View(ViewCommand::CameraAlone(4)), "Camera 5 alone", "Show camera 5 alone in the window, or go back to all views", &[key(Key::Num5)]),
    row(Menu::View, View(ViewCommand::CameraAlone(5)), "Camera 6 alone", "Show camera 6 alone in the window, or go back to all views", &[key(Key::Num6)]),
    row(Menu::View, View(ViewCommand::CameraAlone(6)), "Camera 7 alone", "Show camera 7 alone in the window, or go back to all views", &[key(Key::Num7)]),
    row(Menu::View, View(ViewCommand::CameraAlone(7)), "Camera 8 alone", "Show camera 8 alone in the window, or go back to all views", &[key(Key::Num8)]),
    row(Menu::Fit, Fit(FitCommand::Step), "Step", "One step of the fit on this frame", &[key(Key::Space)]),
    row(Menu::Fit, Fit(FitCommand::StepBack), "Step back", "Look at the previous step", &[shift(Key::Space)]),
    row(Menu::Fit, Fit(FitCommand::Run), "Run", "Step until the fit ends by itself", &[key(Key::Enter)]),
    row(Menu::Fit, Fit(FitCommand::Stop), "Stop", "Stop the fit or the tracker; what is done stays", &[key(Key::Escape)]),
    row(Menu::Fit, Fit(FitCommand::EarlierStep), "Earlier step", "Look at the previous step of the run", &[key(Key::Comma)]),
    row(Menu::Fit, Fit(FitCommand::LaterStep), "Later step", "Look at the next step of the run", &[key(Key::Period)]),
    row(Menu::Fit, Fit(FitCommand::Branch), "Branch", "Start a new run from the step on the screen; the old run stays", &[]),
    row(Menu::Fit, Fit(FitCommand::Refit(BodyPart::Limb)), "Refit limb", "Fit the selected limb alone; the rest stays", &[]),
    row(Menu::Fit, Fit(FitCommand::Refit(BodyPart::Chain)), "Refit chain", "Fit the selected limb and its neighbours up to the trunk", &[]),
    row(Menu::Fit, Fit(FitCommand::Refit(BodyPart::Body)), "Refit body", "Fit the whole body", &[]),
    row(Menu::Fit, Fit(FitCommand::RunAgain(Variants::Renderers)), "Run again with each renderer", "From the start of the run on the screen, once with capsules, cylinders and sphere trees; the body stays as it is", &[]),
    row(Menu::Fit, Fit(FitCommand::RunAgain(Variants::Presets)), "Run again with each preset", "From the start of the run on the screen, once with Report 2004 and once with Robust; the body stays as it is", &[]),
    row(Menu::Fit, Fit(FitCommand::RunAgain(Variants::Ramps)), "Run again with each ramp", "From the start of the run on the screen, once with each kind of ramp; the body stays as it is", &[]),
    row(Menu::Fit, Fit(FitCommand::RunAgainWithCameras), "Run again with each camera left out", "From the start of the run on the screen, once with all cameras in use and once without each of them; the body stays as it is", &[]),
    row(Menu::Fit, Fit(FitCommand::SearchPoses), "Search poses", "Look for other poses that the silhouettes of this frame allow; they are listed under Refit", &[ctrl(Key::F)]),
    row(Menu::Fit, Fit(FitCommand::MakeSpheres), "Make body of spheres", "Carve each limb from the silhouettes of up to twelve frames, fill it with nested spheres, and move them until they fit", &[]),
    row(Menu::Fit, Fit(FitCommand::FitBody), "Fit body to frames", "Find the person’s lengths and radii from up to eight frames that have poses of their own", &[]),
    solid(RendererKind::Capsule, "Limbs with round ends", &[key(Key::C)]),
    solid(RendererKind::Cylinder, "Limbs with flat ends", &[key(Key::Y)]),
    solid(RendererKind::SphereTree { spheres: None }, "Limbs as rows of spheres", &[key(Key::S)]),
    row(Menu::Fit, Fit(FitCommand::Preset(Preset::Report)), "Report 2004", "Raw quaternions, thesis ramp on smoothed silhouettes, fixed damping, each frame from the last pose, as in the report", &[]),
    row(Menu::Fit, Fit(FitCommand::Preset(Preset::Robust)), "Robust", "Tangent updates, Levenberg-Marquardt, annealed distance data, priors and limits", &[]),
    row(Menu::Fit, Convergence(ConvergenceCommand::ClearRuns), "Clear runs", "Remove all runs from the convergence plot", &[]),
    row(Menu::Fit, Convergence(ConvergenceCommand::RestoreRuns), "Undo remove runs", "Bring back the runs that were removed last", &[]),
    row(Menu::Fit, Convergence(ConvergenceCommand::ExportCurves), "Export curves…", "Write every step of all runs to a CSV file", &[]),
    row(Menu::Fit, Convergence(ConvergenceCommand::ExportPlot), "Export plot…", "Write the convergence plot to a PNG file", &[]),
    row(Menu::Fit, Observability(ObservabilityCommand::Ellipses), "Uncertainty in the views", "Show two standard deviations of every joint as ellipses", &[key(Key::U)]),
    row(Menu::Fit, Observability(ObservabilityCommand::Sway), "Sway", "Sway the body along the selected direction, or hold it still", &[shift(Key::U)]),
    row(Menu::Fit, Observability(ObservabilityCommand::WeakerDirection), "Worse seen direction", "Select the next direction that the cameras see less well", &[key(Key::PageDown)]),
    row(Menu::Fit, Observability(ObservabilityCommand::StrongerDirection), "Better seen direction", "Select the next direction that the cameras see better", &[key(Key::PageUp)]),
    row(Menu::Fit, CameraPlan, "Where to put cameras…", "Find how well the cameras would know a person anywhere on the floor, which of them is missed least, and where one more would bring most", &[]),
    row(Menu::Fit, Basin(BasinCommand::Run(BasinView::Angles)), "Run basin", "Fit this frame from many starts farther and farther off, in the background", &[]),
    row(Menu::Fit, Basin(BasinCommand::Run(BasinView::Map)), "Run basin map", "Fit this frame from a grid of starts with two angles set off, in the background", &[]),
    row(Menu::Fit, Basin(BasinCommand::Cancel), "Cancel basin", "Stop the basin’s fits; what is done stays", &[]),
    row(Menu::Fit, Beginning(BeginningCommand::RunAll), "Try ways to begin", "Particle filter, softened ramp, templates and search on this frame, in the background; every step is kept and can be played", &[]),
    row(Menu::Fit, Beginning(BeginningCommand::AcquireBody), "Acquire a body", "Find pose and sizes of a person of whom nothing is known, by growing limbs; every step is kept and can be played", &[]),
    row(Menu::Fit, Beginning(BeginningCommand::Stop), "Stop ways to begin", "End what is being tried; what is done stays", &[]),
    row(Menu::Track, Tracking(TrackingCommand::ChoosePerson), "Follow one person…", "Find everybody in view of three cameras or more, and click the one to follow; pixels of the others are unknown from then on", &[]),
    row(Menu::Track, Tracking(TrackingCommand::FollowEverybody), "Follow everybody in view", "Choose nobody: all that is not background is the subject", &[]),
    row(Menu::Track, Tracking(TrackingCommand::FindStart), "Find start", "Find where the person stands in this frame from the silhouettes alone", &[]),
    row(Menu::Track, Tracking(TrackingCommand::Forward), "Track forward", "Fit frame after frame from here to the end. Where the take has no start, or asks for the person’s own sizes, they are found first", &[ctrl(Key::Enter)]),
    row(Menu::Track, Tracking(TrackingCommand::Back), "Track back", "Fit frame after frame from here to the beginning", &[ctrl_shift(Key::Enter)]),
    row(Menu::Track, Tracking(TrackingCommand::Between), "Track between keys", "Fit forward from the key pose before this frame and back from the one after it. The two tracks are joined where their joints are nearest; frames around the join are blended and fitted again", &[ctrl_shift(Key::K)]),
    row(Menu::Track, Bookmarks, "Bookmarks…", "Mark a frame, with a camera and a joint if wanted; go to marked places", &[ctrl_shift(Key::B)]),
    row(Menu::Track, Offsets, "Camera offsets…", "For cameras that were not started together: compare two side by side and shift one, or find the shifts from the silhouettes", &[]),
    row(Menu::Track, CameraCheck, "Check cameras…", "Find which camera’s calibration or clock is wrong, and how, from what all cameras see of the person", &[]),
    row(Menu::Track, CameraRefinement, "Refine cameras…", "Fit cameras, poses and body sizes together to the silhouettes of the person, and judge the cameras found in frames held out", &[]),
    row(Menu::Track, Compare(CompareCommand::AddReference), "Add reference…", "Compare the poses with a recording (TRC, C3D, BVH, MOT, CSV, NumPy), a track or a project", &[]),
    row(Menu::Track, Compare(CompareCommand::RemoveReferences), "Remove references", "Compare with nothing but the take’s own reference", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::Draw(SilhouetteTool::Region)), "Draw region of interest", "Draw a rectangle in a camera’s view: outside it is background in every frame", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::RemoveRegion), "Remove region of interest", "The subject may be anywhere in the active camera’s picture", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::Draw(SilhouetteTool::Brush(Label::Subject))), "Paint subject", "Paint pixels of a silhouette that are subject", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::Draw(SilhouetteTool::Brush(Label::Background))), "Paint background", "Paint pixels of a silhouette that are background", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::Draw(SilhouetteTool::Brush(Label::Unknown))), "Paint unknown", "Paint pixels of a silhouette that weigh nothing", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::PutAway), "Put brush away", "The pointer poses the body again", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::Erase), "Remove brush strokes", "Remove what is painted in the active camera’s frame, or in its marked frames", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::FindWorst), "Find worst silhouettes", "Look through the take for silhouettes that other cameras, neighbours in time or the body contradict", &[]),
    row(Menu::Track, Silhouettes(SilhouetteCommand::Tune), "Tune silhouettes", "Choose z-score, shadow test, hysteresis, chroma, opening and closing by how well cameras and the tracked body agree", &[]),
    row(Menu::Track, Timeline(TimelineCommand::SetKeyPose), "Set or clear key pose", "Keep the pose of this frame as one that was set by hand, a diamond in the timeline: the tracker starts again from it. Dragging a joint sets one too. On a frame that has one, clear it", &[key(Key::K)]),
    row(Menu::Track, Timeline(TimelineCommand::PreviousKey), "Previous key pose", "Go to the previous key pose", &[key(Key::OpenBracket)]),
    row(Menu::Track, Timeline(TimelineCommand::NextKey), "Next key pose", "Go to the next key pose", &[key(Key::CloseBracket)]),
    row(Menu::Track, Tracking(TrackingCommand::TurnRound), "Turn track round", "Turn the body to face the other way in every frame that has a pose, and fit each again from there; key poses are turned too", &[]),
    row(Menu::Track, Tracking(TrackingCommand::LearnBackground), "Learn background again", "Learn every camera’s plate from the footage once more, without the pixels of the tracked body, and make the silhouettes again with it", &[]),
    row(Menu::Track, Tracking(TrackingCommand::Clear), "Clear track", "Remove all tracked poses; key poses stay", &[]),
    row(Menu::Track, Timeline(TimelineCommand::ClearRange), "Clear marked frames", "Remove the tracked poses of the frames marked in the timeline; key poses stay", &[]),
    row(Menu::Track, Timeline(TimelineCommand::PreviousFrame), "Previous frame", "Go to the previous frame", &[key(Key::ArrowLeft)]),
    row(Menu::Track, Timeline(TimelineCommand::NextFrame), "Next frame", "Go to the frame after", &[key(Key::ArrowRight)]),
    row(Menu::Track, Timeline(TimelineCommand::TenFramesBack), "Ten frames back", "Go back ten frames", &[shift(Key::ArrowLeft)]),
    row(Menu::Track, Timeline(TimelineCommand::TenFramesOn), "Ten frames on", "Go forward ten frames", &[shift(Key::ArrowRight)]),
    row(Menu::Track, Timeline(TimelineCommand::FirstFrame), "First frame", "Go to the first frame", &[key(Key::Home)]),
    row(Menu::Track, Timeline(TimelineCommand::LastFrame), "Last frame", "Go to the last frame", &[key(Key::End)]),
    row(Menu::Track, Timeline(TimelineCommand::Play), "Play or pause", "Play the frames with their poses", &[key(Key::P)]),
    row(Menu::Track, Timeline(TimelineCommand::ToggleLoop), "Loop", "At the end of the marked frames, or of the take if none are marked, start over", &[shift(Key::P)]),
    row(Menu::Track, Timeline(TimelineCommand::Slower), "Play slower", "The next lower speed, down to a tenth", &[shift(Key::Comma)]),
    row(Menu::Track, Timeline(TimelineCommand::Faster), "Play faster", "The next higher speed, up to four times", &[shift(Key::Period)]),
    row(Menu::Track, Timeline(TimelineCommand::WholeTake), "Show whole take", "Show all frames in the timeline", &[]),
    row(Menu::Track, Timeline(TimelineCommand::WorstFrame), "Worst frame", "Go to the worst frame: lost frames first, then those whose limbs are most likely to be wrong, then the least overlap. Again goes to the next worst", &[key(Key::N)]),
    row(Menu::Track, Timeline(TimelineCommand::NextPoor), "Next poor frame", "Go to the next poor frame: one of the tenth of the frames that fit worst", &[shift(Key::N)]),
    row(Menu::Track, Timeline(TimelineCommand::PreviousPoor), "Previous poor frame", "Go to the previous poor frame: one of the tenth of the frames that fit worst", &[]),
    row(Menu::Demonstrate, Show(Demonstration::SingleLimb), "Fig. 5.1: one limb, three renderers", "One limb seen from the side: capsule and sphere tree find it, the cylinder stays off", &[]),
    row(Menu::Demonstrate, Show(Demonstration::OneCamera), "Fig. 5.2: upper body, one camera", "The cost falls, yet the arms are off where the camera cannot see it", &[]),
    row(Menu::Demonstrate, Show(Demonstration::TwoCameras), "Fig. 5.3: upper body, two cameras", "The same start with a second camera, the report’s steps beside tangent ones", &[]),
    row(Menu::Demonstrate, Show(Demonstration::Sequence), "Fig. 5.5: simulated sequence", "50 frames of silhouettes in two cameras, to be tracked", &[]),
    row(Menu::Demonstrate, Show(Demonstration::TinySequence), "Fig. 5.6: tiny pictures", "The same frames with 48 × 36 pixels", &[]),
    row(Menu::Demonstrate, Show(Demonstration::RealFootage), "Figs. 5.4 and 5.5: real footage", "The report’s small pictures of a real person, 50 frames in two cameras", &[]),
    row(Menu::Demonstrate, Show(Demonstration::Bias), "Bias of a ramp", "Fits that begin at the true pose, and leave it", &[]),
    row(Menu::Demonstrate, Show(Demonstration::Cues), "Section 6.3: cues under occlusion", "Squats before two phones: silhouettes alone lose an arm, keypoints or pictures hold it", &[]),
    row(Menu::Demonstrate, Show(Demonstration::Begin), "Section 6.4: three ways to begin", "From a start that is far off: particle filter, softened ramp, templates and search, step by step", &[]),
    row(Menu::Demonstrate, Show(Demonstration::Spheres), "Section 6.5: a body of spheres", "A clothed person carved from silhouettes and filled with nested spheres", &[]),
    row(Menu::Demonstrate, Show(Demonstration::Motions), "Section 6.6: motions recognised", "A walk, squats, signals and boxing, tracked and called by name", &[]),
    row(Menu::Demonstrate, Laboratory(LaboratoryCommand::Restart), "Restart laboratory", "Forget the laboratory’s steps and begin again from its start", &[ctrl(Key::R)]),
    row(Menu::Help, Window(WindowCommand::Palette), "Find a command…", "Type a few letters of any command", &[ctrl(Key::K)]),
    row(Menu::Help, Window(WindowCommand::Shortcuts), "Keys", "All keys, searchable", &[key(Key::Questionmark)]),
    row(Menu::Help, Tour, "Tour", "Seven steps on the built-in take; you do them yourself", &[]),
    row(Menu::Help, Window(WindowCommand::Messages), "Messages", "What the program has said since it was started", &[]),
    row(Menu::Help, Window(WindowCommand::About), "About Backlit", "Version, licence, and the method’s source", &[]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::command::keys_text;

    #[test]
    fn every_command_has_one_row() {
        let all = Command::every();
        for command in &all {
            assert_eq!(TABLE.iter().filter(|row| row.command == *command).count(), 1, "{command:?}");
        }
        assert_eq!(TABLE.len(), all.len());
    }

    #[test]
    fn every_key_has_one_command_and_no_text_ends_with_a_full_stop() {
        let mut keys: Vec<String> = Vec::new();
        for row in TABLE {
            assert!(!row.text.ends_with('.') && !row.tooltip.ends_with('.'), "{}", row.text);
            for shortcut in row.keys {
                let text = keys_text(shortcut);
                assert!(!keys.contains(&text), "{text} is used twice");
                keys.push(text);
            }
        }
    }
}
