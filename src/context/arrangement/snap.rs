//! Splits that snap at thirds and halves of what they divide.

use egui::Pos2;
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId};

use super::Arrangement;

/// A split closer to a mark than this snaps to it, in points.
const REACH: f32 = 8.0;
const MARKS: [f32; 3] = [1.0 / 3.0, 0.5, 2.0 / 3.0];
/// A tile does not get smaller than this by snapping, in points.
const LEAST: f32 = 32.0;

/// After a split was dragged: the one that has moved since `before` and is nearest to the pointer snaps to a
/// third or the half of its container, if it is close to it.
pub(crate) fn snap(before: &Arrangement, after: &mut Arrangement, pointer: Pos2) {
    let containers: Vec<TileId> = after.tiles.tile_ids().collect();
    for id in containers {
        let (Some(old), Some(new)) = (linear(before, id), linear(after, id)) else { continue };
        let Some((pair, by)) = correction(after, id, old, new, pointer) else { continue };
        if let Some(Tile::Container(Container::Linear(linear))) = after.tiles.get_mut(id) {
            let shares = pair.map(|tile| linear.shares[tile]);
            linear.shares.set_share(pair[0], shares[0] + by);
            linear.shares.set_share(pair[1], shares[1] - by);
        }
    }
}

fn linear(tree: &Arrangement, id: TileId) -> Option<&Linear> {
    match tree.tiles.get_container(id)? {
        Container::Linear(linear) => Some(linear),
        _ => None,
    }
}

/// The two tiles beside the split that snaps, and what the first gets of the second's share.
fn correction(
    tree: &Arrangement,
    id: TileId,
    old: &Linear,
    new: &Linear,
    pointer: Pos2,
) -> Option<([TileId; 2], f32)> {
    let rect = tree.tiles.rect(id)?;
    let children: Vec<TileId> =
        new.children.iter().copied().filter(|child| tree.tiles.is_visible_in_layout(*child)).collect();
    let (extent, at) = match new.dir {
        LinearDir::Horizontal => (rect.width(), pointer.x - rect.left()),
        LinearDir::Vertical => (rect.height(), pointer.y - rect.top()),
    };
    let total = |linear: &Linear| children.iter().map(|child| linear.shares[*child]).sum::<f32>();
    let (old_total, new_total) = (total(old), total(new));
    let (mut old_sum, mut new_sum) = (0.0, 0.0);
    let mut moved: Option<(usize, f32)> = None;
    for (index, child) in children.iter().enumerate().take(children.len().saturating_sub(1)) {
        old_sum += old.shares[*child];
        new_sum += new.shares[*child];
        let (was, is) = (old_sum / old_total, new_sum / new_total);
        let is_nearer = moved.is_none_or(|(_, other)| (is * extent - at).abs() < (other * extent - at).abs());
        if (was - is).abs() > 1e-6 && is_nearer {
            moved = Some((index, is));
        }
    }
    let (index, place) = moved?;
    let mark = MARKS.into_iter().find(|mark| (mark - place).abs() * extent < REACH)?;
    let pair = [children[index], children[index + 1]];
    let by = (mark - place) * new_total;
    let least = LEAST / extent * new_total;
    let is_roomy = new.shares[pair[0]] + by >= least && new.shares[pair[1]] - by >= least;
    is_roomy.then_some((pair, by))
}
