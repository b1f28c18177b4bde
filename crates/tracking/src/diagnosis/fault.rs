//! Kinds of faults.

/// How a calibration is usually wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "`description` says what each is")]
pub enum FaultKind {
    PictureTurned,
    PictureScaled,
    InvertedExtrinsics,
    Unit,
    WorldAxes,
    CameraAxes,
    Swapped,
    LensOrder,
    Focal,
    PrincipalPoint,
    Turned,
    Shifted,
    Moved,
    Bumped,
    Offset,
    Drift,
    FrameRate,
}

impl FaultKind {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::PictureTurned,
        Self::PictureScaled,
        Self::InvertedExtrinsics,
        Self::Unit,
        Self::WorldAxes,
        Self::CameraAxes,
        Self::Swapped,
        Self::LensOrder,
        Self::Focal,
        Self::PrincipalPoint,
        Self::Turned,
        Self::Shifted,
        Self::Moved,
        Self::Bumped,
        Self::Offset,
        Self::Drift,
        Self::FrameRate,
    ];

    /// The word for it in files and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PictureTurned => "picture-turned",
            Self::PictureScaled => "picture-scaled",
            Self::InvertedExtrinsics => "inverted-extrinsics",
            Self::Unit => "unit",
            Self::WorldAxes => "world-axes",
            Self::CameraAxes => "camera-axes",
            Self::Swapped => "swapped",
            Self::LensOrder => "lens-order",
            Self::Focal => "focal-length",
            Self::PrincipalPoint => "principal-point",
            Self::Turned => "turned",
            Self::Shifted => "shifted",
            Self::Moved => "moved",
            Self::Bumped => "bumped",
            Self::Offset => "offset",
            Self::Drift => "drift",
            Self::FrameRate => "frame-rate",
        }
    }

    /// What is wrong, as a clause whose subject is the camera.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::PictureTurned => "has pictures that were turned after it was calibrated",
            Self::PictureScaled => "has pictures that were scaled after it was calibrated",
            Self::InvertedExtrinsics => {
                "has its place and its axes the other way round (world from camera for camera from world)"
            }
            Self::Unit => "stands in another unit of length",
            Self::WorldAxes => "has other world axes than the others",
            Self::CameraAxes => "has other axes of its own (OpenGL’s, for example)",
            Self::Swapped => "has the numbers of another camera",
            Self::LensOrder => "has the coefficients of its lens in another order",
            Self::Focal => "has a wrong focal length",
            Self::PrincipalPoint => "has a wrong principal point",
            Self::Turned => "is turned",
            Self::Shifted => "is shifted",
            Self::Moved => "is turned and shifted",
            Self::Bumped => "was moved while it filmed",
            Self::Offset => "has a clock that is ahead or behind",
            Self::Drift => "has a clock that is too fast or too slow",
            Self::FrameRate => "films at another frame rate",
        }
    }

    /// By how much rarer it is than others that silhouettes hardly tell from it, nats: a knock turns a camera more often than it shifts it
    /// alone, and calibrations seldom have a wrong principal point.
    pub(super) const fn rarity(self) -> f64 {
        match self {
            Self::Shifted | Self::Drift => 1.5,
            Self::PrincipalPoint => 3.0,
            _ => 0.0,
        }
    }

    /// Whether the camera's clock is wrong, not the camera.
    #[must_use]
    pub const fn is_clock(self) -> bool {
        matches!(self, Self::Offset | Self::Drift | Self::FrameRate)
    }
}

/// One number that says how large a fault is.
#[derive(Debug, Clone, PartialEq)]
pub struct Size {
    /// Of what: "turn", "offset".
    pub what: &'static str,
    /// In `unit`.
    pub value: f64,
    /// Its standard deviation; `None` where the fault is of a few possible sizes.
    pub deviation: Option<f64>,
    /// "°", "cm", "px", "s", "%", "×", or nothing.
    pub unit: &'static str,
}

/// What is to be done with a camera's clock: its time t becomes `rate`·t + `offset_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockChange {
    /// The camera's index.
    pub camera: usize,
    /// Seconds that are added.
    pub offset_s: f64,
    /// Factor of its times.
    pub rate: f64,
}
