//! What all camera views share, kept from start to start.

use crate::context::view_settings::ViewSettings;

/// What is chosen for all views.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct CameraViewPreferences {
    /// Whether zoom and pan go together in all views.
    pub(crate) linked_zoom: bool,
    /// What is drawn in them, and what is dragged.
    pub(crate) settings: ViewSettings,
}
