//! What stands around the features: toolbar, menus, palette, status bar, the dock of tiles, notices.

pub(crate) mod about;
pub(crate) mod dock;
pub(crate) mod docking;
pub(crate) mod drop_overlay;
pub(crate) mod empty;
pub(crate) mod matching;
pub(crate) mod menus;
pub(crate) mod messages;
pub(crate) mod notice_cards;
pub(crate) mod palette;
pub(crate) mod recent;
pub(crate) mod right_panel;
pub(crate) mod shortcuts;
pub(crate) mod status_bar;
pub(crate) mod toolbar;

use backlit_ui::style::theme::Theme;

/// The state of what stands around the features.
#[derive(Debug, Default)]
pub(crate) struct Shell {
    /// Tiles of the centre.
    pub(crate) docking: docking::Docking,
    pub(crate) overlay: Option<Overlay>,
    /// Files over the window.
    pub(crate) hovering: Option<drop_overlay::Hovering>,
    pub(crate) shown_theme: Option<Theme>,
}

/// What lies over the window.
#[derive(Debug)]
pub(crate) enum Overlay {
    Palette(palette::Palette),
    Shortcuts(String),
    Messages,
    About,
    Export,
    NewTake,
    Offsets,
    UnsavedWork,
}
