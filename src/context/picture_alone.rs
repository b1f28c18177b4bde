//! One camera's picture and nothing else.

/// What an exported picture of a camera has besides the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PictureAlone {
    pub(crate) camera: usize,
    /// Joints, limbs and rays.
    pub(crate) marks: bool,
    /// The strip that explains the colours, under the picture.
    pub(crate) legend: bool,
}
