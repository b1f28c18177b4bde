//! The commands of each feature, and what some of them carry.

use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;
use backlit_ui::drawing::{ModeComparison, ViewMode};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::context::marks::SilhouetteTool;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

groups! {
    /// Takes and projects.
    FileCommand { NewTake, OpenTake, OpenBuiltIn, OpenMotion, OpenProject, FindTake, Save, SaveAs, Quit }

    /// The document's past.
    HistoryCommand { Undo, Redo }

    /// Work that was left unsaved.
    RecoveryCommand { Show, UndoDiscard }

    /// Pictures for other people.
    ExportCommand { View, Window, Steps, Frames, Motion, Report, Stop, ShowExported }

    /// Posing by hand.
    PoseCommand {
        Copy,
        Paste,
        Mirror,
        MirrorAll,
        TurnRound,
        HoldTrunk,
        PinJoint,
        ResetLimb,
        ResetBody,
        NextJoint,
        PreviousJoint,
        Nudge(Nudge) of Nudge::every(),
    }

    /// A small move of the selected joint in the active view.
    Nudge { Left, Right, Up, Down, FarLeft, FarRight, FarUp, FarDown }

    /// The window: how it is arranged, and what lies over it.
    WindowCommand {
        Layout(Layout) of Layout::ALL.map(|(layout, _)| layout),
        ToggleTheme,
        TogglePanel,
        ToggleTimeline,
        TogglePane(Pane) of Pane::KINDS.map(|kind| kind.0),
        ArrangeTiles,
        ResetLayout,
        RestoreLayout,
        Enlarge,
        Shrink,
        NormalSize,
        Palette,
        Shortcuts,
        Messages,
        About,
    }

    /// What all camera views show, and how; keys stop at the eighth camera.
    ViewCommand {
        FitSubject,
        WholePicture,
        ZoomIn,
        ZoomOut,
        LinkZoom,
        CalibrationMarks,
        SideMarks,
        Rivals,
        PixelGrid,
        SizeHandles,
        Mode(ViewMode) of ViewMode::ALL,
        Compare(ModeComparison) of [ModeComparison::Wipe, ModeComparison::Blink],
        CameraAlone(usize) of 0..8,
    }

    /// How silhouettes are made, and mended by hand.
    SilhouetteCommand {
        Draw(SilhouetteTool) of SilhouetteTool::ALL,
        PutAway,
        Erase,
        RemoveRegion,
        FindWorst,
        Tune,
    }

    /// What the poses are compared with.
    CompareCommand { AddReference, RemoveReferences }

    /// Where the scene is seen from.
    SceneCommand { Front, Side, Top, FromCamera, Reset }

    /// The fit of the frame on the screen.
    FitCommand {
        Step,
        StepBack,
        Run,
        Stop,
        EarlierStep,
        LaterStep,
        Branch,
        Refit(BodyPart) of BodyPart::every(),
        RunAgain(Variants) of Variants::every(),
        RunAgainWithCameras,
        SearchPoses,
        FitBody,
        MakeSpheres,
        Renderer(RendererKind) of RendererKind::ALL,
        Preset(Preset) of Preset::ALL,
    }

    /// What differs between runs from one start.
    Variants { Renderers, Presets, Ramps }

    /// Which part of the body is fitted.
    BodyPart { Limb, Chain, Body }

    /// The runs and their plot.
    ConvergenceCommand { ClearRuns, RestoreRuns, ExportCurves, ExportPlot }

    /// The basin of the frame.
    BasinCommand { Run(BasinView) of [BasinView::Angles, BasinView::Map], Cancel }

    /// Ways to begin.
    BeginningCommand { RunAll, AcquireBody, Stop }

    /// What the cameras see.
    ObservabilityCommand { Ellipses, Sway, WeakerDirection, StrongerDirection }

    /// The tracker.
    TrackingCommand { FindStart, Forward, Back, Between, TurnRound, LearnBackground, ChoosePerson, FollowEverybody, Clear }

    /// Frames: going to them, playing them, key poses.
    TimelineCommand {
        SetKeyPose,
        PreviousKey,
        NextKey,
        ClearRange,
        PreviousFrame,
        NextFrame,
        TenFramesBack,
        TenFramesOn,
        FirstFrame,
        LastFrame,
        Play,
        ToggleLoop,
        Slower,
        Faster,
        WholeTake,
        WorstFrame,
        NextPoor,
        PreviousPoor,
    }

    /// The laboratory.
    LaboratoryCommand { Restart }
}

impl Nudge {
    /// How far it goes in the view.
    pub(crate) const fn by_px(self) -> DVec2 {
        match self {
            Self::Left => DVec2::new(-1.0, 0.0),
            Self::Right => DVec2::new(1.0, 0.0),
            Self::Up => DVec2::new(0.0, -1.0),
            Self::Down => DVec2::new(0.0, 1.0),
            Self::FarLeft => DVec2::new(-5.0, 0.0),
            Self::FarRight => DVec2::new(5.0, 0.0),
            Self::FarUp => DVec2::new(0.0, -5.0),
            Self::FarDown => DVec2::new(0.0, 5.0),
        }
    }
}

/// The two ways in which a basin is tried and shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BasinView {
    /// Success over angle.
    #[default]
    Angles,
    /// A map of two directions.
    Map,
}
