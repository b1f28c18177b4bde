//! Arrangements of the user's own.

use std::collections::BTreeSet;

use egui_tiles::{Container, Tile, TileId};
use serde::{Deserialize, Serialize};

use super::Arrangement;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

/// The user's own arrangements: one for each layout and number of cameras, so that a take with other cameras
/// begins with the automatic one and takes nothing away from the rest.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Kept {
    entries: Vec<KeptArrangement>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct KeptArrangement {
    layout: Layout,
    cameras: usize,
    tree: Arrangement,
}

impl Kept {
    /// The user's arrangement, if there is one and it holds exactly these cameras.
    pub fn get(&self, layout: Layout, cameras: usize) -> Option<&Arrangement> {
        let entry = self.entries.iter().find(|entry| (entry.layout, entry.cameras) == (layout, cameras));
        entry.map(|entry| &entry.tree).filter(|tree| fits(tree, cameras))
    }

    /// Keeps an arrangement in the place of the one before.
    pub(crate) fn set(&mut self, layout: Layout, cameras: usize, tree: Arrangement) {
        self.forget(layout, cameras);
        self.entries.push(KeptArrangement { layout, cameras, tree });
    }

    /// The automatic arrangement comes back.
    pub(crate) fn forget(&mut self, layout: Layout, cameras: usize) {
        self.entries.retain(|entry| (entry.layout, entry.cameras) != (layout, cameras));
    }
}

/// Whether an arrangement that was read from a file is whole: every camera once, no pane twice, no way round in
/// circles, and shares that can be laid out.
pub(crate) fn fits(tree: &Arrangement, cameras: usize) -> bool {
    let Some(root) = tree.root() else { return false };
    let mut seen = BTreeSet::new();
    let mut panes = BTreeSet::new();
    let mut left = vec![root];
    while let Some(id) = left.pop() {
        if !seen.insert(id.0) {
            return false;
        }
        match tree.tiles.get(id) {
            None => return false,
            Some(Tile::Pane(pane)) => {
                if !panes.insert(*pane) {
                    return false;
                }
            }
            Some(Tile::Container(container)) => {
                if !has_sound_shares(container) {
                    return false;
                }
                left.extend(container.children().copied().collect::<Vec<TileId>>());
            }
        }
    }
    let found = panes.iter().filter_map(|pane| match pane {
        Pane::Camera(index) => Some(*index),
        _ => None,
    });
    found.eq(0..cameras)
}

fn has_sound_shares(container: &Container) -> bool {
    match container {
        Container::Linear(linear) => linear.children.iter().all(|child| {
            let share = linear.shares[*child];
            share.is_finite() && share > 0.0
        }),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;
    use crate::context::arrangement::{Centre, automatic, close, open};

    fn debug(cameras: usize) -> Arrangement {
        let size = vec2(1260.0, 850.0);
        automatic(&Centre { layout: Layout::Debug, cameras, pair: [0, 1], size, aspect: 0.6 })
    }

    #[test]
    fn an_arrangement_is_written_and_read() {
        let mut tree = debug(4);
        close(&mut tree, Pane::Scene);
        open(&mut tree, Pane::Camera(2));
        let mut kept = Kept::default();
        kept.set(Layout::Debug, 4, tree.clone());
        let text = serde_json::to_string(&kept).unwrap();
        let read: Kept = serde_json::from_str(&text).unwrap();
        assert_eq!(read, kept);
        assert_eq!(read.get(Layout::Debug, 4), Some(&tree));
    }

    #[test]
    fn other_cameras_get_the_automatic_one_and_lose_nothing() {
        let mut kept = Kept::default();
        kept.set(Layout::Debug, 4, debug(4));
        assert_eq!((kept.get(Layout::Debug, 2), kept.get(Layout::Pose, 4)), (None, None));
        kept.set(Layout::Debug, 2, debug(2));
        assert!(kept.get(Layout::Debug, 4).is_some() && kept.get(Layout::Debug, 2).is_some());
        kept.forget(Layout::Debug, 2);
        assert!(kept.get(Layout::Debug, 4).is_some() && kept.get(Layout::Debug, 2).is_none());
    }

    #[test]
    fn a_damaged_arrangement_is_not_used() {
        let mut kept = Kept::default();
        kept.set(Layout::Debug, 4, debug(3));
        assert_eq!(kept.get(Layout::Debug, 4), None, "a camera is missing");

        let mut twice = debug(2);
        let other = twice.tiles.insert_pane(Pane::Camera(1));
        let root = twice.root().unwrap();
        twice.root = Some(twice.tiles.insert_vertical_tile(vec![root, other]));
        assert!(!fits(&twice, 2), "a camera is there twice");

        let mut round = debug(2);
        let root = round.root().unwrap();
        if let Some(Tile::Container(container)) = round.tiles.get_mut(root) {
            container.add_child(root);
        }
        assert!(!fits(&round, 2), "it goes round in circles");

        let mut thin = debug(2);
        if let Some(Tile::Container(Container::Linear(linear))) = thin.tiles.get_mut(root) {
            let first = linear.children[0];
            linear.shares.set_share(first, f32::NAN);
        }
        assert!(!fits(&thin, 2), "a share is no number");
        assert!(!fits(&Arrangement::empty(egui::Id::unique("none")), 0));
    }
}
