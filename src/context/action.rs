//! The commands of menus, toolbar, palette and keyboard: text, tooltip and keys stand here and nowhere else.

use egui::{Key, KeyboardShortcut, ModifierNames, Modifiers};

/// A command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the table below says what each command does")]
pub enum Action {
    OpenTake,
    OpenBuiltIn,
    OpenProject,
    FindTake,
    Save,
    SaveAs,
    ExportView,
    ExportWindow,
    ExportSteps,
    ExportFrames,
    StopExport,
    ShowExported,
    UndoDiscard,
    Quit,
    Undo,
    Redo,
    CopyPose,
    PastePose,
    Mirror,
    MirrorPose,
    PinJoint,
    ResetLimb,
    ResetBody,
    NextJoint,
    PreviousJoint,
    NudgeLeft,
    NudgeRight,
    NudgeUp,
    NudgeDown,
    NudgeFarLeft,
    NudgeFarRight,
    NudgeFarUp,
    NudgeFarDown,
    LayoutPose,
    LayoutDebug,
    LayoutDemonstrate,
    ToggleTheme,
    TogglePanel,
    ToggleTimeline,
    ShowScene,
    ShowConvergence,
    SceneFront,
    SceneSide,
    SceneTop,
    SceneFromCamera,
    SceneReset,
    ShowBasin,
    ArrangeTiles,
    ResetLayout,
    RestoreLayout,
    FitSubject,
    WholePicture,
    ZoomIn,
    ZoomOut,
    LinkZoom,
    CalibrationMarks,
    PixelGrid,
    SizeHandles,
    ViewFootage,
    ViewData,
    ViewPrediction,
    ViewResidual,
    ViewTinted,
    ViewReport,
    ViewOwner,
    ViewGradient,
    ViewJacobian,
    Wipe,
    Blink,
    Camera1,
    Camera2,
    Camera3,
    Camera4,
    Camera5,
    Camera6,
    Camera7,
    Camera8,
    Step,
    StepBack,
    Run,
    Stop,
    EarlierStep,
    LaterStep,
    Branch,
    RefitLimb,
    RefitChain,
    RefitBody,
    SearchPoses,
    FitBody,
    RendererCapsule,
    RendererCylinder,
    RendererSphereTree,
    PresetReport,
    PresetRobust,
    ClearRuns,
    RestoreRuns,
    RunBasin,
    RunBasinMap,
    CancelBasin,
    ExportCurves,
    ExportPlot,
    Uncertainty,
    Sway,
    WeakerDirection,
    StrongerDirection,
    TrackForward,
    TrackBack,
    TrackBetween,
    SetKeyPose,
    PreviousKey,
    NextKey,
    ClearTrack,
    ClearRange,
    PreviousFrame,
    NextFrame,
    TenFramesBack,
    TenFramesOn,
    FirstFrame,
    LastFrame,
    Play,
    ToggleLoop,
    PlaySlower,
    PlayFaster,
    WholeTake,
    NextWorst,
    PreviousWorst,
    ShowSingleLimb,
    ShowOneCamera,
    ShowTwoCameras,
    ShowSequence,
    ShowTinySequence,
    ShowBias,
    RestartLaboratory,
    Palette,
    Shortcuts,
    Tour,
    Messages,
    About,
}

/// The menus, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "a menu's name says what is in it")]
pub enum Menu {
    File,
    Edit,
    View,
    Fit,
    Track,
    Demonstrate,
    Help,
}

impl Menu {
    /// All menus.
    pub const ALL: [Self; 7] =
        [Self::File, Self::Edit, Self::View, Self::Fit, Self::Track, Self::Demonstrate, Self::Help];

    /// The menu's label.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Fit => "Fit",
            Self::Track => "Track",
            Self::Demonstrate => "Demonstrate",
            Self::Help => "Help",
        }
    }
}

struct Command {
    action: Action,
    menu: Menu,
    text: &'static str,
    tooltip: &'static str,
    keys: &'static [KeyboardShortcut],
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

const fn row(
    menu: Menu,
    action: Action,
    text: &'static str,
    tooltip: &'static str,
    keys: &'static [KeyboardShortcut],
) -> Command {
    Command { action, menu, text, tooltip, keys }
}

#[rustfmt::skip]
const TABLE: &[Command] = &{
    use Action as A;
    use Menu as M;
    [
    row(M::File, A::OpenTake, "Open take…", "Open a folder with a take.toml", &[ctrl(Key::O)]),
    row(M::File, A::OpenBuiltIn, "Open built-in take", "A synthetic figure before four cameras, with known truth", &[]),
    row(M::File, A::OpenProject, "Open project…", "Open saved work, a .backlit file", &[ctrl_shift(Key::O)]),
    row(M::File, A::FindTake, "Find take…", "Say where the take is now of the project that was not opened for lack of it", &[]),
    row(M::File, A::Save, "Save", "Save poses, sizes and settings to the project file", &[ctrl(Key::S)]),
    row(M::File, A::SaveAs, "Save as…", "Save to another project file", &[ctrl_shift(Key::S)]),
    row(M::File, A::ExportView, "Export view…", "The active camera's picture with its marks and legend, as a PNG of any size", &[ctrl(Key::E)]),
    row(M::File, A::ExportWindow, "Export window…", "The window as it is, as a PNG of any size", &[ctrl_shift(Key::E)]),
    row(M::File, A::ExportSteps, "Export iterations…", "All steps of the shown run, as PNGs or as a picture that moves", &[]),
    row(M::File, A::ExportFrames, "Export frames…", "A range of frames with their poses, as PNGs or as a picture that moves", &[]),
    row(M::File, A::StopExport, "Stop export", "End the export that is under way", &[]),
    row(M::File, A::ShowExported, "Show exported files", "Open the folder of the last export", &[]),
    row(M::File, A::UndoDiscard, "Undo discard", "Offer again the unsaved work that was discarded last", &[]),
    row(M::File, A::Quit, "Quit", "Close the window; unsaved work is kept for the next start", &[ctrl(Key::Q)]),
    row(M::Edit, A::Undo, "Undo", "Take back the last change", &[ctrl(Key::Z)]),
    row(M::Edit, A::Redo, "Redo", "Make the change again that was taken back", &[ctrl_shift(Key::Z), ctrl(Key::Y)]),
    row(M::Edit, A::CopyPose, "Copy pose", "Copy the whole pose of this frame", &[ctrl(Key::C)]),
    row(M::Edit, A::PastePose, "Paste pose", "Give this frame the copied pose", &[ctrl(Key::V)]),
    row(M::Edit, A::Mirror, "Mirror", "Give the other side of the body the turn of the selected limb and all that hangs from it", &[key(Key::X)]),
    row(M::Edit, A::MirrorPose, "Mirror pose", "Let right and left trade places in the whole pose", &[shift(Key::X)]),
    row(M::Edit, A::PinJoint, "Pin or free joint", "A pinned joint stays where it is while others are dragged", &[key(Key::I)]),
    row(M::Edit, A::ResetLimb, "Reset limb", "Turn the selected limb as it is at rest", &[key(Key::Backspace)]),
    row(M::Edit, A::ResetBody, "Reset body", "Go back to the start pose of the take", &[shift(Key::Backspace)]),
    row(M::Edit, A::NextJoint, "Next joint", "Select the next joint of the body", &[key(Key::Tab)]),
    row(M::Edit, A::PreviousJoint, "Previous joint", "Select the joint before", &[shift(Key::Tab)]),
    row(M::Edit, A::NudgeLeft, "Nudge left", "Move the selected joint one pixel to the left in the active view", &[ctrl(Key::ArrowLeft)]),
    row(M::Edit, A::NudgeRight, "Nudge right", "Move the selected joint one pixel to the right in the active view", &[ctrl(Key::ArrowRight)]),
    row(M::Edit, A::NudgeUp, "Nudge up", "Move the selected joint one pixel up in the active view", &[ctrl(Key::ArrowUp)]),
    row(M::Edit, A::NudgeDown, "Nudge down", "Move the selected joint one pixel down in the active view", &[ctrl(Key::ArrowDown)]),
    row(M::Edit, A::NudgeFarLeft, "Nudge left by five", "Move the selected joint five pixels to the left in the active view", &[ctrl_shift(Key::ArrowLeft)]),
    row(M::Edit, A::NudgeFarRight, "Nudge right by five", "Move the selected joint five pixels to the right in the active view", &[ctrl_shift(Key::ArrowRight)]),
    row(M::Edit, A::NudgeFarUp, "Nudge up by five", "Move the selected joint five pixels up in the active view", &[ctrl_shift(Key::ArrowUp)]),
    row(M::Edit, A::NudgeFarDown, "Nudge down by five", "Move the selected joint five pixels down in the active view", &[ctrl_shift(Key::ArrowDown)]),
    row(M::View, A::LayoutPose, "Pose layout", "Large camera views, for setting a pose by hand", &[key(Key::F1)]),
    row(M::View, A::LayoutDebug, "Debug layout", "Camera views with the convergence plot and its steps", &[key(Key::F2)]),
    row(M::View, A::LayoutDemonstrate, "Demonstrate layout", "The laboratory: several ways to fit from one start, side by side", &[key(Key::F3)]),
    row(M::View, A::ToggleTheme, "Dark or light", "Switch between the dark and the light theme", &[]),
    row(M::View, A::TogglePanel, "Show or hide panel", "The column on the right", &[ctrl(Key::B)]),
    row(M::View, A::ToggleTimeline, "Show or hide lanes", "The lanes of the timeline", &[ctrl(Key::T)]),
    row(M::View, A::ShowScene, "Show or hide scene", "Body, cameras and their pictures in three dimensions", &[]),
    row(M::View, A::ShowConvergence, "Show or hide convergence", "The plot of the runs, and their steps", &[]),
    row(M::View, A::SceneFront, "Scene from the front", "Look at the body's front in the scene", &[]),
    row(M::View, A::SceneSide, "Scene from the side", "Look at the body's right side in the scene", &[]),
    row(M::View, A::SceneTop, "Scene from above", "Look down on the body in the scene", &[]),
    row(M::View, A::SceneFromCamera, "Scene from the active camera", "Look from the place of the camera whose tile is active", &[]),
    row(M::View, A::SceneReset, "Whole scene", "See all cameras in the scene", &[]),
    row(M::View, A::ShowBasin, "Show or hide basin", "How far off a start may be: success over angle, and a map", &[]),
    row(M::View, A::ArrangeTiles, "Arrange tiles", "Tiles where they give the largest pictures, in this layout", &[]),
    row(M::View, A::ResetLayout, "Reset layout", "Tiles, sizes and sections as they were at first", &[]),
    row(M::View, A::RestoreLayout, "Undo layout", "Take back the last Reset layout or Arrange tiles", &[]),
    row(M::View, A::FitSubject, "Fit subject", "Zoom every view to the subject", &[key(Key::F)]),
    row(M::View, A::WholePicture, "Whole picture", "Zoom every view to the whole frame", &[key(Key::A)]),
    row(M::View, A::ZoomIn, "Zoom in", "Magnify the active view about its middle; the wheel does it at the pointer", &[key(Key::Plus), key(Key::Equals)]),
    row(M::View, A::ZoomOut, "Zoom out", "Show more of the active view; the wheel does it at the pointer", &[key(Key::Minus)]),
    row(M::View, A::LinkZoom, "Link zoom", "Let all views zoom and pan together, about the same point of the body", &[key(Key::Z)]),
    row(M::View, A::CalibrationMarks, "Calibration marks", "Show principal points, the axes of the world, a grid through its origin, and lens edges", &[key(Key::Q)]),
    row(M::View, A::PixelGrid, "Pixel grid", "Show lines between pixels where they are shown large", &[]),
    row(M::View, A::SizeHandles, "Size handles", "Show handles for the length and the radius of the selected limb in the views", &[key(Key::E)]),
    row(M::View, A::ViewFootage, "Footage", "Show the footage alone", &[key(Key::O)]),
    row(M::View, A::ViewData, "Data D", "Show the measured silhouette", &[key(Key::D)]),
    row(M::View, A::ViewPrediction, "Prediction Λ", "Show the silhouette that the pose predicts", &[key(Key::M)]),
    row(M::View, A::ViewResidual, "Residual D − Λ", "Show where data and model differ: orange is missing, blue is spurious", &[key(Key::R)]),
    row(M::View, A::ViewTinted, "Tinted overlay", "Show agreement, missing and spurious over the footage", &[key(Key::T)]),
    row(M::View, A::ViewReport, "Report overlay", "Show the data black and the model white, as the report does", &[key(Key::V)]),
    row(M::View, A::ViewOwner, "Owner limb", "Show which limb each pixel belongs to", &[key(Key::L)]),
    row(M::View, A::ViewGradient, "Gradient", "Show how strongly each pixel pulls at its limb", &[key(Key::G)]),
    row(M::View, A::ViewJacobian, "Jacobian column", "Show how each pixel changes with the selected joint; again: the next axis", &[key(Key::J)]),
    row(M::View, A::Wipe, "Wipe", "Compare two view modes side by side in the active view", &[key(Key::W)]),
    row(M::View, A::Blink, "Blink", "Compare two view modes one after the other in the active view", &[key(Key::B)]),
    row(M::View, A::Camera1, "Camera 1 alone", "Camera 1 to the full window, and back", &[key(Key::Num1)]),
    row(M::View, A::Camera2, "Camera 2 alone", "Camera 2 to the full window, and back", &[key(Key::Num2)]),
    row(M::View, A::Camera3, "Camera 3 alone", "Camera 3 to the full window, and back", &[key(Key::Num3)]),
    row(M::View, A::Camera4, "Camera 4 alone", "Camera 4 to the full window, and back", &[key(Key::Num4)]),
    row(M::View, A::Camera5, "Camera 5 alone", "Camera 5 to the full window, and back", &[key(Key::Num5)]),
    row(M::View, A::Camera6, "Camera 6 alone", "Camera 6 to the full window, and back", &[key(Key::Num6)]),
    row(M::View, A::Camera7, "Camera 7 alone", "Camera 7 to the full window, and back", &[key(Key::Num7)]),
    row(M::View, A::Camera8, "Camera 8 alone", "Camera 8 to the full window, and back", &[key(Key::Num8)]),
    row(M::Fit, A::Step, "Step", "One step of the fit on this frame", &[key(Key::Space)]),
    row(M::Fit, A::StepBack, "Step back", "Look at the step before", &[shift(Key::Space)]),
    row(M::Fit, A::Run, "Run", "Step until the fit ends by itself", &[key(Key::Enter)]),
    row(M::Fit, A::Stop, "Stop", "Stop the fit or the tracker; what is done stays", &[key(Key::Escape)]),
    row(M::Fit, A::EarlierStep, "Earlier step", "Look at the step before in the run", &[key(Key::Comma)]),
    row(M::Fit, A::LaterStep, "Later step", "Look at the step after in the run", &[key(Key::Period)]),
    row(M::Fit, A::Branch, "Branch", "Go on from the step on the screen; the old run stays", &[]),
    row(M::Fit, A::RefitLimb, "Refit limb", "Fit the selected limb alone, the rest stays", &[]),
    row(M::Fit, A::RefitChain, "Refit chain", "Fit the selected limb and its neighbours up to the trunk", &[]),
    row(M::Fit, A::RefitBody, "Refit body", "Fit the whole body", &[]),
    row(M::Fit, A::SearchPoses, "Search poses", "Look for other poses that the silhouettes of this frame allow; they are listed under Refit", &[ctrl(Key::F)]),
    row(M::Fit, A::FitBody, "Fit body to frames", "Find the person's lengths and radii from up to eight frames that have poses of their own", &[]),
    row(M::Fit, A::RendererCapsule, "Capsule", "Limbs with round ends", &[key(Key::C)]),
    row(M::Fit, A::RendererCylinder, "Cylinder", "Limbs with flat ends", &[key(Key::Y)]),
    row(M::Fit, A::RendererSphereTree, "Sphere tree", "Limbs as rows of spheres", &[key(Key::S)]),
    row(M::Fit, A::PresetReport, "Report 2004", "Raw quaternions, thesis ramp, fixed damping, as in the report", &[]),
    row(M::Fit, A::PresetRobust, "Robust", "Tangent updates, Levenberg-Marquardt, annealed distance data, priors and limits", &[]),
    row(M::Fit, A::ClearRuns, "Clear runs", "Forget the runs in the convergence plot", &[]),
    row(M::Fit, A::RestoreRuns, "Undo remove runs", "Bring back the runs that were removed last", &[]),
    row(M::Fit, A::ExportCurves, "Export curves…", "Write every step of all runs to a CSV file", &[]),
    row(M::Fit, A::ExportPlot, "Export plot…", "Write the convergence plot to a PNG file", &[]),
    row(M::Fit, A::Uncertainty, "Uncertainty in the views", "Show two standard deviations of every joint as ellipses", &[key(Key::U)]),
    row(M::Fit, A::Sway, "Sway", "Sway the body along the direction that is looked at, or hold it still", &[shift(Key::U)]),
    row(M::Fit, A::WeakerDirection, "Weaker direction", "Look at the next direction that the cameras see less", &[key(Key::PageDown)]),
    row(M::Fit, A::StrongerDirection, "Better seen direction", "Look at the next direction that the cameras see better", &[key(Key::PageUp)]),
    row(M::Fit, A::RunBasin, "Run basin", "Fit this frame from many starts farther and farther off, in the background", &[]),
    row(M::Fit, A::RunBasinMap, "Run basin map", "Fit this frame from a grid of starts with two angles set off, in the background", &[]),
    row(M::Fit, A::CancelBasin, "Cancel basin", "Stop the basin's fits; what is done stays", &[]),
    row(M::Track, A::TrackForward, "Track forward", "Fit frame after frame from here to the end", &[ctrl(Key::Enter)]),
    row(M::Track, A::TrackBack, "Track back", "Fit frame after frame from here to the beginning", &[ctrl_shift(Key::Enter)]),
    row(M::Track, A::TrackBetween, "Track between keys", "Fit from the key pose before on and from the one after back; both tracks are joined where their joints lie nearest, and the frames about the join are blended and fitted again", &[ctrl_shift(Key::K)]),
    row(M::Track, A::SetKeyPose, "Set or clear key pose", "Keep the pose of this frame as one that was set by hand, a diamond in the timeline: the tracker begins anew from it. Dragging a joint sets one too; again clears it", &[key(Key::K)]),
    row(M::Track, A::PreviousKey, "Previous key pose", "Go to the key pose before", &[key(Key::OpenBracket)]),
    row(M::Track, A::NextKey, "Next key pose", "Go to the next key pose", &[key(Key::CloseBracket)]),
    row(M::Track, A::ClearTrack, "Clear track", "Forget all tracked poses; key poses stay", &[]),
    row(M::Track, A::ClearRange, "Clear marked frames", "Forget what was found for the frames marked in the timeline; key poses stay", &[]),
    row(M::Track, A::PreviousFrame, "Previous frame", "Go to the frame before", &[key(Key::ArrowLeft)]),
    row(M::Track, A::NextFrame, "Next frame", "Go to the frame after", &[key(Key::ArrowRight)]),
    row(M::Track, A::TenFramesBack, "Ten frames back", "Go back by ten frames", &[shift(Key::ArrowLeft)]),
    row(M::Track, A::TenFramesOn, "Ten frames on", "Go on by ten frames", &[shift(Key::ArrowRight)]),
    row(M::Track, A::FirstFrame, "First frame", "Go to the first frame", &[key(Key::Home)]),
    row(M::Track, A::LastFrame, "Last frame", "Go to the last frame", &[key(Key::End)]),
    row(M::Track, A::Play, "Play or pause", "Play the frames with their poses", &[key(Key::P)]),
    row(M::Track, A::ToggleLoop, "Loop", "Begin again at the end: of the marked frames, else of the take", &[shift(Key::P)]),
    row(M::Track, A::PlaySlower, "Play slower", "The next lower speed, down to a tenth", &[shift(Key::Comma)]),
    row(M::Track, A::PlayFaster, "Play faster", "The next higher speed, up to four times", &[shift(Key::Period)]),
    row(M::Track, A::WholeTake, "Show whole take", "All frames in the timeline", &[]),
    row(M::Track, A::NextWorst, "Next worst", "Go to the next frame with a poor fit", &[key(Key::N)]),
    row(M::Track, A::PreviousWorst, "Previous worst", "Go to the poor fit before", &[shift(Key::N)]),
    row(M::Demonstrate, A::ShowSingleLimb, "Fig. 5.1: one limb, three renderers", "One limb seen from the side: capsule and sphere tree come home, the cylinder stays", &[]),
    row(M::Demonstrate, A::ShowOneCamera, "Fig. 5.2: upper body, one camera", "The cost falls, yet the arms are off where the camera cannot see it", &[]),
    row(M::Demonstrate, A::ShowTwoCameras, "Fig. 5.3: upper body, two cameras", "The same start with a second camera, the report's steps beside tangent ones", &[]),
    row(M::Demonstrate, A::ShowSequence, "Fig. 5.5: simulated sequence", "50 frames of silhouettes in two cameras, to be tracked", &[]),
    row(M::Demonstrate, A::ShowTinySequence, "Fig. 5.6: tiny pictures", "The same frames with 48 × 36 pixels", &[]),
    row(M::Demonstrate, A::ShowBias, "Bias of a ramp", "Fits that begin at the true pose, and leave it", &[]),
    row(M::Demonstrate, A::RestartLaboratory, "Restart laboratory", "Forget the laboratory's steps and begin again from its start", &[ctrl(Key::R)]),
    row(M::Help, A::Palette, "Find a command…", "Type a few letters of any command", &[ctrl(Key::K)]),
    row(M::Help, A::Shortcuts, "Keys", "All keys, searchable", &[key(Key::Questionmark)]),
    row(M::Help, A::Tour, "Tour", "Seven steps on the built-in take, that you do yourself", &[]),
    row(M::Help, A::Messages, "Messages", "What the program has said since it was started", &[]),
    row(M::Help, A::About, "About Backlit", "Version, licence, and the method's source", &[]),
    ]
};

impl Action {
    /// All commands, in the order of the menus.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|command| command.action)
    }

    /// The commands of a menu.
    pub fn in_menu(menu: Menu) -> impl Iterator<Item = Self> {
        TABLE.iter().filter(move |command| command.menu == menu).map(|command| command.action)
    }

    /// The command's name on buttons and in menus.
    #[must_use]
    pub fn text(self) -> &'static str {
        self.command().text
    }

    /// One sentence about what it does, without its full stop.
    #[must_use]
    pub fn explanation(self) -> &'static str {
        self.command().tooltip
    }

    /// The explanation and the keys, for a tooltip.
    #[must_use]
    pub fn tooltip(self) -> String {
        match self.keys_text() {
            Some(keys) => format!("{}   {keys}", self.explanation()),
            None => self.explanation().to_owned(),
        }
    }

    /// The menu it stands in.
    #[must_use]
    pub fn menu(self) -> Menu {
        self.command().menu
    }

    /// Its keys.
    #[must_use]
    pub fn shortcuts(self) -> &'static [KeyboardShortcut] {
        self.command().keys
    }

    /// Its first keys as they are written: "Ctrl+K".
    #[must_use]
    pub fn keys_text(self) -> Option<String> {
        self.shortcuts().first().map(keys_text)
    }

    /// The command that shows this camera alone, counted from zero.
    #[must_use]
    pub fn camera_alone(index: usize) -> Option<Self> {
        const CAMERAS: [Action; 8] = [
            Action::Camera1,
            Action::Camera2,
            Action::Camera3,
            Action::Camera4,
            Action::Camera5,
            Action::Camera6,
            Action::Camera7,
            Action::Camera8,
        ];
        CAMERAS.get(index).copied()
    }

    /// The commands whose keys were pressed since the last frame; the key events are used up. While text is
    /// typed only commands with Ctrl and function keys act; while a button has the focus, its keys are its own.
    pub fn pressed(ctx: &egui::Context) -> Vec<Self> {
        let typing = ctx.text_edit_focused();
        let focused = ctx.egui_wants_keyboard_input();
        let actions: Vec<Self> = ctx.input_mut(|input| {
            // Longer combinations first, or Ctrl+Shift+Z would be taken for Ctrl+Z.
            let mut rows: Vec<(&KeyboardShortcut, Self)> =
                TABLE.iter().flat_map(|c| c.keys.iter().map(move |k| (k, c.action))).collect();
            rows.sort_by_key(|(keys, _)| std::cmp::Reverse(modifier_count(keys.modifiers)));
            rows.retain(|(keys, _)| !typing || acts_while_typing(keys));
            rows.retain(|(keys, _)| !focused || !belongs_to_focus(keys));
            rows.retain(|(keys, _)| input.consume_shortcut(keys));
            rows.into_iter().map(|(_, action)| action).collect()
        });
        if actions.iter().any(|action| matches!(action, Self::NextJoint | Self::PreviousJoint)) {
            // The same Tab would move the focus.
            ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
        }
        actions
    }

    fn command(self) -> &'static Command {
        // A test holds that every command has its row.
        TABLE.iter().find(|command| command.action == self).unwrap_or(&TABLE[0])
    }
}

/// Keys as they are written.
#[must_use]
pub fn keys_text(keys: &KeyboardShortcut) -> String {
    match keys.logical_key {
        Key::Questionmark => "?".to_owned(),
        Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown => {
            keys.format(&ModifierNames::NAMES, false).replace("Arrow", "")
        }
        _ => keys.format(&ModifierNames::NAMES, false),
    }
}

fn modifier_count(modifiers: Modifiers) -> usize {
    usize::from(modifiers.shift)
        + usize::from(modifiers.command || modifiers.ctrl)
        + usize::from(modifiers.alt)
}

fn acts_while_typing(keys: &KeyboardShortcut) -> bool {
    let is_text_command =
        keys.modifiers.command && matches!(keys.logical_key, Key::C | Key::V | Key::Z | Key::Y | Key::A);
    (keys.modifiers.command && !is_text_command) || matches!(keys.logical_key, Key::F1 | Key::F2 | Key::F3)
}

fn belongs_to_focus(keys: &KeyboardShortcut) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter, Space, Tab};
    let own = [ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter, Space, Tab];
    !keys.modifiers.command && own.contains(&keys.logical_key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_one_row_and_every_key_one_command() {
        let mut keys: Vec<String> = Vec::new();
        for command in TABLE {
            assert_eq!(TABLE.iter().filter(|other| other.action == command.action).count(), 1);
            assert!(!command.text.ends_with('.') && !command.tooltip.ends_with('.'), "{}", command.text);
            for shortcut in command.keys {
                let text = keys_text(shortcut);
                assert!(!keys.contains(&text), "{text} is used twice");
                keys.push(text);
            }
        }
        // The last of the enumeration: together with the count, no command is without a row.
        assert_eq!(TABLE.len(), Action::About as usize + 1);
    }

    #[test]
    fn keys_are_written_plainly() {
        assert_eq!(Action::Redo.keys_text().as_deref(), Some("Ctrl+Shift+Z"));
        assert_eq!(Action::EarlierStep.keys_text().as_deref(), Some("Comma"));
        assert_eq!(Action::NextFrame.keys_text().as_deref(), Some("Right"));
        assert!(Action::Palette.tooltip().ends_with("Ctrl+K"));
    }
}
