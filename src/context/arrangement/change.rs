//! Opening, closing and showing a pane.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId};

use super::Arrangement;
use crate::context::pane::{Pane, PaneSide};

/// A pane that comes in takes this share of the window, where it has no place yet.
const NEW: f32 = 1.0 / 3.0;

pub(crate) fn is_open(tree: &Arrangement, pane: Pane) -> bool {
    tree.tiles.find_pane(&pane).is_some_and(|tile| tree.is_visible(tile))
}

/// Closes a pane; it keeps its place.
pub(crate) fn close(tree: &mut Arrangement, pane: Pane) {
    if let Some(tile) = tree.tiles.find_pane(&pane) {
        tree.set_visible(tile, false);
    }
}

/// Opens a pane in the place that it had, or at the side where it comes in, before what it shares tabs with.
pub(crate) fn open(tree: &mut Arrangement, pane: Pane) {
    match tree.tiles.find_pane(&pane) {
        Some(tile) => tree.set_visible(tile, true),
        None => insert(tree, pane),
    }
    show(tree, pane);
}

/// Brings a pane before what it shares tabs with.
pub(crate) fn show(tree: &mut Arrangement, pane: Pane) {
    tree.make_active(|_, tile| matches!(tile, Tile::Pane(other) if *other == pane));
}

/// The panes that share tabs with this one, itself among them; none if it has its tile for itself.
pub(crate) fn panes_with(tree: &Arrangement, pane: Pane) -> Vec<Pane> {
    let container = tree
        .tiles
        .find_pane(&pane)
        .and_then(|tile| tree.tiles.parent_of(tile))
        .and_then(|parent| tree.tiles.get_container(parent));
    let Some(Container::Tabs(tabs)) = container else { return Vec::new() };
    let open = tabs.children.iter().filter(|child| tree.is_visible(**child));
    let panes: Vec<Pane> = open.filter_map(|child| tree.tiles.get_pane(child).copied()).collect();
    if panes.len() > 1 { panes } else { Vec::new() }
}

fn insert(tree: &mut Arrangement, pane: Pane) {
    let tile = pane.tile_id();
    tree.tiles.insert(tile, Tile::Pane(pane));
    let is_beside = |other: &Pane| *other != pane && other.side() == pane.side() && is_open(tree, *other);
    if let Some(neighbour) = Pane::KINDS.iter().map(|kind| kind.0).find(is_beside) {
        return share_tabs(tree, neighbour, tile);
    }
    let Some(root) = tree.root else {
        tree.root = Some(tile);
        return;
    };
    let dir = match pane.side() {
        PaneSide::Right => LinearDir::Horizontal,
        PaneSide::Below => LinearDir::Vertical,
    };
    if let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get_mut(root)
        && linear.dir == dir
    {
        let total: f32 = linear.children.iter().map(|child| linear.shares[*child]).sum();
        linear.shares.set_share(tile, total * NEW / (1.0 - NEW));
        linear.add_child(tile);
        return;
    }
    let split = Linear::new_binary(dir, [root, tile], 1.0 - NEW);
    tree.root = Some(tree.tiles.insert_container(Container::Linear(split)));
}

/// Puts a tile where a pane stands that came in at the same side: no other tile gets smaller.
fn share_tabs(tree: &mut Arrangement, neighbour: Pane, tile: TileId) {
    let Some(beside) = tree.tiles.find_pane(&neighbour) else { return };
    let parent = tree.tiles.parent_of(beside);
    if let Some(Tile::Container(Container::Tabs(tabs))) = parent.and_then(|parent| tree.tiles.get_mut(parent))
    {
        tabs.add_child(tile);
        return;
    }
    let tabs = tree.tiles.insert_container(Tabs { children: vec![beside, tile], active: Some(tile) });
    match parent.and_then(|parent| tree.tiles.get_mut(parent)) {
        Some(Tile::Container(Container::Linear(linear))) => {
            linear.shares.replace_with(beside, tabs);
            linear.children.iter_mut().filter(|child| **child == beside).for_each(|child| *child = tabs);
        }
        _ => tree.root = Some(tabs),
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;
    use crate::context::arrangement::kept::fits;
    use crate::context::arrangement::{Centre, automatic};
    use crate::context::preferences::Layout;

    #[test]
    fn a_pane_that_was_closed_comes_back_to_its_place() {
        let size = vec2(1260.0, 850.0);
        let first = automatic(&Centre { layout: Layout::Debug, cameras: 4, pair: [0, 1], size, aspect: 0.6 });
        let mut tree = first.clone();
        close(&mut tree, Pane::Scene);
        assert!(!is_open(&tree, Pane::Scene) && is_open(&tree, Pane::Camera(0)));
        assert!(fits(&tree, 4));
        open(&mut tree, Pane::Scene);
        assert_eq!(tree, first);
        assert_eq!(panes_with(&tree, Pane::Camera(2)), [Pane::Camera(0), Pane::Camera(2)]);
        assert!(panes_with(&tree, Pane::Scene).is_empty());
    }

    #[test]
    fn a_pane_without_a_place_comes_in_at_its_side() {
        let size = vec2(1260.0, 850.0);
        let mut tree =
            automatic(&Centre { layout: Layout::Pose, cameras: 4, pair: [0, 1], size, aspect: 0.6 });
        for (pane, dir) in [(Pane::Scene, LinearDir::Horizontal), (Pane::Convergence, LinearDir::Vertical)] {
            assert!(!is_open(&tree, pane));
            open(&mut tree, pane);
            assert!(is_open(&tree, pane) && fits(&tree, 4));
            let root = tree.root().and_then(|root| tree.tiles.get_container(root));
            let Some(Container::Linear(linear)) = root else { panic!("{root:?}") };
            assert_eq!((linear.dir, linear.children.last()), (dir, Some(&pane.tile_id())));
        }
        let before = tree.clone();
        open(&mut tree, Pane::Basin);
        assert_eq!(panes_with(&tree, Pane::Basin), [Pane::Scene, Pane::Basin], "no other tile gets smaller");
        assert!(is_open(&tree, Pane::Basin) && fits(&tree, 4));
        let shares = |tree: &Arrangement| match tree.root().and_then(|root| tree.tiles.get_container(root)) {
            Some(Container::Linear(linear)) => linear.children.len(),
            _ => 0,
        };
        assert_eq!(shares(&tree), shares(&before));
        let mut empty = Arrangement::empty(egui::Id::unique("none"));
        open(&mut empty, Pane::Scene);
        assert!(is_open(&empty, Pane::Scene));
    }
}
