//! Every reader, with what it begins from and what must hold of what it read.

mod meshes;
mod takes;
mod texts;
mod videos;

use crate::engine::Target;

/// All targets.
pub(crate) fn all() -> Vec<Target> {
    let mut all = texts::targets();
    all.extend(takes::targets());
    all.extend(meshes::targets());
    all.extend(videos::targets());
    all
}
