//! What is kept from start to start: the preferences of the window and of every feature, in one record.

use std::path::PathBuf;

use backlit_ui::style::theme::Theme;
use serde::{Deserialize, Serialize};

use super::Inspector;
use crate::context::arrangement::Kept;
use crate::context::preferences::{FRAMES_MB, FRAMES_MB_CHOICES, Layout};
use crate::context::view_settings::ViewSettings;
use crate::features::basin::BasinPreferences;
use crate::features::convergence::ConvergencePreferences;
use crate::features::export::ExportChoices;
use crate::features::motions::MotionsPreferences;
use crate::features::scene::ScenePreferences;

macro_rules! settings {
    ($($(#[$doc:meta])* $field:ident: $kind:ty = $first:expr, $($place:ident).+;)*) => {
        /// All that is kept. It is in the settings file as it is here.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(default)]
        pub struct Settings {
            $($(#[$doc])* pub $field: $kind),*
        }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($field: $first),* }
            }
        }

        impl Inspector {
            /// What is chosen now.
            pub fn settings(&self) -> Settings {
                Settings { $($field: self.$($place).+.clone()),* }
            }

            /// What is kept for the next start: layout and tiles are not those of a demonstration.
            pub fn kept_settings(&self) -> Settings {
                let settings = self.settings();
                match &self.state.own_tiles {
                    Some((layout, kept)) => Settings { layout: *layout, kept: kept.clone(), ..settings },
                    None => settings,
                }
            }

            /// Hands what was kept to those who use it.
            pub(crate) fn apply_settings(&mut self, settings: Settings) {
                $(self.$($place).+ = settings.$field;)*
                let frames_mb = &mut self.state.preferences.frames_mb;
                *frames_mb = (*frames_mb).clamp(*FRAMES_MB_CHOICES.start(), *FRAMES_MB_CHOICES.end());
            }
        }
    };
}

// What each setting is, its type, what it is at first, and where it lives in the inspector.
settings! {
    /// Dark or light.
    theme: Theme = Theme::Dark, state.preferences.theme;
    /// What it is arranged for.
    layout: Layout = Layout::Pose, state.preferences.layout;
    /// Whether the right panel is there.
    panel: bool = true, state.preferences.panel;
    /// Whether the timeline has its lanes.
    lanes: bool = true, features.timeline.shows_lanes;
    /// Whether zoom and pan go together in all views.
    linked_zoom: bool = false, features.camera_views.preferences.linked_zoom;
    /// How all camera views look.
    views: ViewSettings = ViewSettings::default(), features.camera_views.preferences.settings;
    /// Megabytes that frames which were read may take.
    frames_mb: usize = FRAMES_MB, state.preferences.frames_mb;
    /// Takes that were opened last, the newest first.
    recent: Vec<PathBuf> = Vec::new(), state.preferences.recent;
    /// What the 3-D scene shows.
    scene: ScenePreferences = ScenePreferences::default(), features.scene.preferences;
    /// How the user has arranged the tiles.
    kept: Kept = Kept::default(), state.preferences.kept;
    /// What was chosen for the last export.
    export: ExportChoices = ExportChoices::default(), features.export.preferences;
    /// What the convergence plot shows.
    curves: ConvergencePreferences = ConvergencePreferences::default(), features.convergence.preferences;
    /// What is chosen for the basin, and how it is shown.
    basin: BasinPreferences = BasinPreferences::default(), features.basin.preferences;
    /// How motions are named, and how that is shown.
    motions: MotionsPreferences = MotionsPreferences::default(), features.motions.preferences;
    /// Names of the commands that were chosen last in the palette, the newest first.
    used_commands: Vec<String> = Vec::new(), state.preferences.used_commands;
    /// Whether the tour was offered.
    tour_offered: bool = false, features.tour.was_offered;
    /// Changes with *Reset layout*, so that egui forgets sizes and open sections.
    generation: u32 = 0, state.preferences.generation;
}

impl Settings {
    /// The arrangement as it was at first; theme and recent takes stay.
    pub(crate) fn reset(&mut self) {
        let generation = self.generation.wrapping_add(1);
        let before = std::mem::take(self);
        *self = Self { layout: before.layout, generation, ..Self::default() }.with_memory_of(before);
    }

    /// The same arrangement with what another one remembers that *Reset layout* does not touch.
    pub(crate) fn with_memory_of(self, other: Self) -> Self {
        Self {
            theme: other.theme,
            frames_mb: other.frames_mb,
            recent: other.recent,
            export: other.export,
            curves: other.curves,
            basin: other.basin,
            motions: other.motions,
            used_commands: other.used_commands,
            tour_offered: other.tour_offered,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::convergence::Quantity;

    #[test]
    fn what_is_chosen_for_plots_and_basin_is_kept_and_outlives_a_reset() {
        let curves = ConvergencePreferences {
            quantity: Quantity::StepNorm,
            is_log: false,
            rejected: false,
            exports_light: false,
        };
        let mut look = Settings { curves, ..Settings::default() };
        look.basin.settings.seed = 12;
        look.basin.view = crate::context::command::BasinView::Map;
        look.export.motion.axes = Some(backlit_formats::motion::Axes::ZUp);
        look.export.motion.names = Some(backlit_formats::motion::Names::Mixamo);
        let kept: Settings = serde_json::from_str(&serde_json::to_string(&look).unwrap()).unwrap();
        assert_eq!(kept, look);
        let mut after = kept.clone();
        after.reset();
        assert_eq!((after.curves, &after.basin), (look.curves, &look.basin));
        // An arrangement of before there were such choices.
        assert_eq!(serde_json::from_str::<Settings>("{}").unwrap(), Settings::default());
    }
}
