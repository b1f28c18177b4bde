//! The menus in which commands stand.

/// The menus, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Menu {
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
    pub(crate) const ALL: [Self; 7] =
        [Self::File, Self::Edit, Self::View, Self::Fit, Self::Track, Self::Demonstrate, Self::Help];

    /// The menu's label.
    pub(crate) const fn text(self) -> &'static str {
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
