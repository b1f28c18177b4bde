//! The features, one folder each: all of a feature is in its folder, and it is known elsewhere only to the shell and the app.
//!
//! A feature is registered here, once: its module, and its row in the list.

pub mod basin;
pub(crate) mod beginnings;
pub(crate) mod bookmarks;
pub(crate) mod camera_check;
pub(crate) mod camera_plan;
pub(crate) mod camera_refinement;
pub mod camera_views;
pub(crate) mod compare;
pub mod convergence;
pub(crate) mod demonstrations;
pub mod export;
pub(crate) mod fit;
pub mod laboratory;
pub(crate) mod motions;
pub(crate) mod new_take;
pub mod observability;
pub(crate) mod offsets;
pub(crate) mod pose;
pub mod recovery;
pub mod scene;
pub(crate) mod silhouettes;
pub(crate) mod timeline;
pub(crate) mod tour;
pub(crate) mod tracking;

use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, window};
use crate::context::{Context, FeatureCard};

macro_rules! features {
    ($($visible:vis $name:ident: $feature:ty),* $(,)?) => {
        /// All features, by name and in the order in which they work.
        #[derive(Debug, Default)]
        #[expect(missing_docs, reason = "each is described in its own file")]
        pub struct Features {
            $($visible $name: $feature),*
        }

        impl Features {
            pub(crate) fn all(&self) -> impl Iterator<Item = &dyn Feature> {
                [$(&self.$name as &dyn Feature),*].into_iter()
            }

            pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut dyn Feature> {
                [$(&mut self.$name as &mut dyn Feature),*].into_iter()
            }

            /// The same without any work that is going on, for a picture of it.
            pub(crate) fn at_rest(&self) -> Self {
                Self { $($name: self.$name.at_rest()),* }
            }
        }
    };
}

features! {
    pub(crate) fit: fit::Fit,
    pub(crate) new_take: new_take::NewTake,
    pub(crate) offsets: offsets::Offsets,
    pub(crate) camera_check: camera_check::CameraCheck,
    pub(crate) camera_plan: camera_plan::CameraPlan,
    pub(crate) camera_refinement: camera_refinement::CameraRefinement,
    pub(crate) export: export::Export,
    pub convergence: convergence::Convergence,
    pub(crate) tracking: tracking::Tracking,
    pub(crate) camera_views: camera_views::CameraViews,
    pub(crate) timeline: timeline::Timeline,
    pub observability: observability::Observability,
    pub basin: basin::Basin,
    pub(crate) motions: motions::Motions,
    pub(crate) silhouettes: silhouettes::SilhouetteSteering,
    pub(crate) compare: compare::Compare,
    pub(crate) beginnings: beginnings::Beginnings,
    pub laboratory: laboratory::Laboratory,
    pub scene: scene::Scene,
    pub(crate) bookmarks: bookmarks::Bookmarks,
    pub(crate) tour: tour::Tour,
    pub(crate) demonstrations: demonstrations::Demonstrations,
    pub(crate) pose: pose::Posing,
    pub(crate) recovery: recovery::Recovery,
}

impl Features {
    /// Why a command cannot be used now, in a sentence without its full stop; `None` if it can.
    pub(crate) fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        // In its layout some commands of others are the laboratory's.
        if let Some(answer) = self.laboratory.overrides(command, context) {
            return answer;
        }
        self.all()
            .find_map(|feature| feature.unavailable(command, context))
            .or_else(|| window(command, context))
    }

    /// The feature that fills a pane.
    pub(crate) fn of_pane(&mut self, pane: Pane) -> Option<&mut dyn Feature> {
        self.all_mut().find(|feature| feature.fills() == Some(pane))
    }

    /// The feature whose card it is.
    pub(crate) fn of_card(&mut self, card: FeatureCard) -> &mut dyn Feature {
        match card {
            FeatureCard::Bookmarks => &mut self.bookmarks,
            FeatureCard::CameraCheck => &mut self.camera_check,
            FeatureCard::CameraPlan => &mut self.camera_plan,
            FeatureCard::CameraRefinement => &mut self.camera_refinement,
            FeatureCard::Export => &mut self.export,
            FeatureCard::NewTake => &mut self.new_take,
            FeatureCard::Offsets => &mut self.offsets,
            FeatureCard::UnsavedWork => &mut self.recovery,
        }
    }
}
