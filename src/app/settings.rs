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

/// All that is kept. It is in the settings file as it is here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Dark or light.
    pub theme: Theme,
    /// What it is arranged for.
    pub layout: Layout,
    /// Whether the right panel is there.
    pub panel: bool,
    /// Whether the timeline has its lanes.
    pub lanes: bool,
    /// Whether zoom and pan go together in all views.
    pub linked_zoom: bool,
    /// How all camera views look.
    pub views: ViewSettings,
    /// Megabytes that frames which were read may take.
    pub frames_mb: usize,
    /// Takes that were opened last, the newest first.
    pub recent: Vec<PathBuf>,
    /// What the 3-D scene shows.
    pub scene: ScenePreferences,
    /// How the user has arranged the tiles.
    pub kept: Kept,
    /// What was chosen for the last export.
    pub export: ExportChoices,
    /// What the convergence plot shows.
    pub curves: ConvergencePreferences,
    /// What is chosen for the basin, and how it is shown.
    pub basin: BasinPreferences,
    /// How motions are named, and how that is shown.
    pub motions: MotionsPreferences,
    /// Names of the commands that were chosen last in the palette, the newest first.
    pub used_commands: Vec<String>,
    /// Whether the tour was offered.
    pub tour_offered: bool,
    /// Changes with *Reset layout*, so that egui forgets sizes and open sections.
    pub generation: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: Theme::Dark,
            layout: Layout::Pose,
            panel: true,
            lanes: true,
            linked_zoom: false,
            views: ViewSettings::default(),
            frames_mb: FRAMES_MB,
            recent: Vec::new(),
            scene: ScenePreferences::default(),
            kept: Kept::default(),
            export: ExportChoices::default(),
            curves: ConvergencePreferences::default(),
            basin: BasinPreferences::default(),
            motions: MotionsPreferences::default(),
            used_commands: Vec::new(),
            tour_offered: false,
            generation: 0,
        }
    }
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

/// Where each field of the settings lives in the inspector.
macro_rules! kept {
    ($($field:ident: $($place:ident).+),* $(,)?) => {
        impl Inspector {
            /// What is kept for the next start.
            pub fn settings(&self) -> Settings {
                Settings { $($field: self.$($place).+.clone()),* }
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

kept! {
    theme: state.preferences.theme,
    layout: state.preferences.layout,
    panel: state.preferences.panel,
    lanes: features.timeline.shows_lanes,
    linked_zoom: features.camera_views.preferences.linked_zoom,
    views: features.camera_views.preferences.settings,
    frames_mb: state.preferences.frames_mb,
    recent: state.preferences.recent,
    scene: features.scene.preferences,
    kept: state.preferences.kept,
    export: features.export.preferences,
    curves: features.convergence.preferences,
    basin: features.basin.preferences,
    motions: features.motions.preferences,
    used_commands: state.preferences.used_commands,
    tour_offered: features.tour.was_offered,
    generation: state.preferences.generation,
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
        look.export.motion.names = backlit_formats::motion::Names::Mixamo;
        let kept: Settings = serde_json::from_str(&serde_json::to_string(&look).unwrap()).unwrap();
        assert_eq!(kept, look);
        let mut after = kept.clone();
        after.reset();
        assert_eq!((after.curves, &after.basin), (look.curves, &look.basin));
        // An arrangement of before there were such choices.
        assert_eq!(serde_json::from_str::<Settings>("{}").unwrap(), Settings::default());
    }
}
