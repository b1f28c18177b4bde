//! What the features do by themselves in every frame.

use super::App;

impl App {
    /// Every feature takes in what its tasks have done, and asks for what it lacks.
    pub(crate) fn update_features(&mut self) {
        self.with(|features| &mut features.basin, |basin, context, requests| basin.update(context, requests));
    }
}
