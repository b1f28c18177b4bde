//! The arrangement that follows the window.
//!
//! The pose layout shows all cameras, in the number of columns that makes their pictures largest; where there is room
//! for two, the other cameras stand behind those. The debug layout has two cameras, the scene, and the
//! convergence plot beneath.

use backlit_ui::style::theme::{size, space};
use egui::{Id, Vec2};
use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles};

use super::Arrangement;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

/// No tile is narrower: its header has buttons.
const NARROWEST: f32 = 260.0;
/// Where the centre is narrower, two cameras are shown and the others stand behind them.
const TWO_TILES_BELOW: f32 = 900.0;
/// A lower centre begins with a low convergence plot.
const LOW: f32 = 640.0;
/// Height of the convergence plot there.
const LOW_PLOT: f32 = 220.0;
/// Shares of a camera and of the scene in the debug layout's row.
const CAMERA: f32 = 0.307;
const SCENE: f32 = 0.386;

/// What the automatic arrangement depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Centre {
    pub(crate) layout: Layout,
    pub(crate) cameras: usize,
    /// The two cameras that are shown where there is room for two.
    pub(crate) pair: [usize; 2],
    /// Size of the centre in points.
    pub(crate) size: Vec2,
    /// Width of the cameras' pictures over their height.
    pub(crate) aspect: f32,
}

/// Whether two cameras are shown, and a strip beneath names the others.
pub(crate) fn has_strip(centre: &Centre) -> bool {
    centre.layout != Layout::Debug && centre.cameras > 2 && centre.size.x < TWO_TILES_BELOW
}

pub(crate) fn automatic(centre: &Centre) -> Arrangement {
    let mut plan = Plan { tiles: Tiles::default() };
    let root = if centre.layout == Layout::Debug {
        plan.debug(centre)
    } else if has_strip(centre) {
        let groups = groups(centre);
        let tiles: Vec<TileId> = groups.into_iter().map(|group| plan.group(&group)).collect();
        plan.grid(centre, &tiles)
    } else {
        let tiles: Vec<TileId> = (0..centre.cameras).map(|camera| plan.pane(Pane::Camera(camera))).collect();
        plan.grid(centre, &tiles)
    };
    Arrangement::new(Id::unique("centre"), root, plan.tiles)
}

/// Two groups of cameras; the first of each is the one that is shown.
fn groups(centre: &Centre) -> Vec<Vec<usize>> {
    let last = centre.cameras.saturating_sub(1);
    let mut groups = vec![vec![centre.pair[0].min(last)]];
    if centre.cameras > 1 {
        groups.push(vec![centre.pair[1].min(last)]);
    }
    for camera in 0..centre.cameras {
        if groups.iter().all(|group| group[0] != camera) {
            let count = groups.len();
            groups[camera % count].push(camera);
        }
    }
    groups
}

struct Plan {
    tiles: Tiles<Pane>,
}

impl Plan {
    fn pane(&mut self, pane: Pane) -> TileId {
        let id = pane.tile_id();
        self.tiles.insert(id, Tile::Pane(pane));
        id
    }

    /// Cameras of which the first is shown; the others stand behind it, in order.
    fn group(&mut self, cameras: &[usize]) -> TileId {
        let mut children: Vec<TileId> =
            cameras.iter().map(|&camera| self.pane(Pane::Camera(camera))).collect();
        if children.len() == 1 {
            return children[0];
        }
        let active = children.first().copied();
        children.sort_by_key(|tile| tile.0);
        self.tiles.insert_container(Tabs { children, active })
    }

    fn split(&mut self, dir: LinearDir, parts: &[(TileId, f32)]) -> TileId {
        if let [(only, _)] = parts {
            return *only;
        }
        let mut linear = Linear::new(dir, parts.iter().map(|part| part.0).collect());
        let total: f32 = parts.iter().map(|part| part.1).sum();
        for &(tile, share) in parts {
            linear.shares.set_share(tile, share * parts.len() as f32 / total.max(f32::MIN_POSITIVE));
        }
        self.tiles.insert_container(Container::Linear(linear))
    }

    /// Rows of equal tiles; a last row with fewer has wider ones.
    fn grid(&mut self, centre: &Centre, tiles: &[TileId]) -> TileId {
        let columns = columns(centre.size, tiles.len(), centre.aspect);
        let rows: Vec<(TileId, f32)> = tiles
            .chunks(columns)
            .map(|row| {
                let parts: Vec<(TileId, f32)> = row.iter().map(|&tile| (tile, 1.0)).collect();
                (self.split(LinearDir::Horizontal, &parts), 1.0)
            })
            .collect();
        self.split(LinearDir::Vertical, &rows)
    }

    fn debug(&mut self, centre: &Centre) -> TileId {
        let groups = groups(centre);
        let mut row: Vec<(TileId, f32)> = groups.iter().map(|group| (self.group(group), CAMERA)).collect();
        row.push((self.pane(Pane::Scene), SCENE));
        let row = self.split(LinearDir::Horizontal, &row);
        let plot = if centre.size.y < LOW { LOW_PLOT } else { size::CONVERGENCE };
        let above = (centre.size.y - plot - space::TILE_GAP).max(plot);
        let plot = (self.pane(Pane::Convergence), plot);
        self.split(LinearDir::Vertical, &[(row, above), plot])
    }
}

/// The number of columns that makes the pictures largest; of several the fewest.
fn columns(size: Vec2, count: usize, aspect: f32) -> usize {
    let area = |columns: usize| {
        let rows = count.div_ceil(columns);
        let width = size.x / columns as f32;
        let height = (size.y / rows as f32 - size::TILE_HEADER).max(1.0);
        let shown = width.min(height * aspect);
        shown * shown
    };
    let fits = |columns: &usize| *columns == 1 || size.x / *columns as f32 >= NARROWEST;
    let most = (1..=count).filter(fits).map(|columns| (columns, area(columns)));
    most.fold((1, 0.0), |best, next| if next.1 > 1.001 * best.1 { next } else { best }).0
}

#[cfg(test)]
mod tests {
    use egui::{Pos2, RawInput, Rect, Ui, UiBuilder, WidgetText, vec2};
    use egui_tiles::{Behavior, UiResponse};

    use super::*;
    use crate::context::arrangement::kept::fits;
    use crate::context::arrangement::{close, open};

    /// Lays tiles out and shows nothing in them.
    struct Blank;

    impl Behavior<Pane> for Blank {
        fn pane_ui(&mut self, _: &mut Ui, _: TileId, _: &mut Pane) -> UiResponse {
            UiResponse::None
        }

        fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
            pane.title().into()
        }

        fn gap_width(&self, _: &egui::Style) -> f32 {
            space::TILE_GAP
        }

        fn is_tab_bar_visible(&self, _: TileId, _: &Tabs) -> bool {
            false
        }
    }

    fn places(tree: &mut Arrangement, size: Vec2) -> Vec<Rect> {
        let rect = Rect::from_min_size(Pos2::ZERO, size);
        let input = RawInput { screen_rect: Some(rect), ..RawInput::default() };
        let mut output = egui::Context::default().run_ui(input, |ui| {
            ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| tree.ui(&mut Blank, ui));
        });
        output.textures_delta.clear();
        let is_pane = |tile: &TileId| tree.tiles.get_pane(tile).is_some();
        tree.active_tiles()
            .iter()
            .filter(|tile| is_pane(tile))
            .filter_map(|tile| tree.tiles.rect(*tile))
            .collect()
    }

    /// Tiles lie beside each other, and no point of the centre is farther than a gap from one.
    fn assert_fills(tree: &mut Arrangement, size: Vec2) {
        let places = places(tree, size);
        let centre = Rect::from_min_size(Pos2::ZERO, size).expand(0.01);
        for (index, place) in places.iter().enumerate() {
            assert!(centre.contains_rect(*place) && place.is_positive(), "{place} in {size}");
            for other in &places[..index] {
                assert!(!place.shrink(0.01).intersects(*other), "{place} and {other} in {size}");
            }
        }
        for step in 0..900 {
            let share = vec2((step % 30) as f32 / 29.0, (step / 30) as f32 / 29.0);
            let at = (size * share).to_pos2();
            let is_near = |place: &Rect| place.expand(space::TILE_GAP).contains(at);
            assert!(places.iter().any(is_near), "nothing at {at} of {size}: {places:?}");
        }
    }

    #[test]
    fn tiles_fill_the_centre_without_overlap_whatever_is_opened_and_closed() {
        for layout in [Layout::Pose, Layout::Debug] {
            for cameras in [1, 2, 3, 4, 7] {
                for size in [vec2(1276.0, 800.0), vec2(820.0, 552.0), vec2(500.0, 900.0)] {
                    let pair = [0, 1.min(cameras - 1)];
                    let mut tree = automatic(&Centre { layout, cameras, pair, size, aspect: 1.3 });
                    assert_fills(&mut tree, size);
                    for pane in [Pane::Scene, Pane::Camera(0), Pane::Convergence] {
                        open(&mut tree, pane);
                        assert_fills(&mut tree, size);
                    }
                    for pane in [Pane::Convergence, Pane::Camera(cameras - 1)] {
                        close(&mut tree, pane);
                        assert_fills(&mut tree, size);
                    }
                    assert!(fits(&tree, cameras), "{tree:?}");
                }
            }
        }
    }

    #[test]
    fn columns_follow_the_shape_of_the_centre() {
        assert_eq!(columns(vec2(1276.0, 800.0), 4, 4.0 / 3.0), 2);
        assert_eq!(columns(vec2(1276.0, 800.0), 4, 0.6), 4, "portrait pictures in a row");
        assert_eq!(columns(vec2(900.0, 800.0), 4, 0.6), 2, "a tile is not too narrow");
        assert_eq!(columns(vec2(1260.0, 520.0), 4, 0.6), 4);
        assert_eq!(columns(vec2(500.0, 900.0), 3, 1.8), 1);
    }

    #[test]
    fn every_arrangement_has_all_cameras_once() {
        for layout in [Layout::Pose, Layout::Debug] {
            for cameras in 1..=9 {
                for width in [300.0, 800.0, 1276.0, 2400.0] {
                    for pair in [[0, 1], [3, 1], [1, 0], [8, 7]] {
                        let pair = pair.map(|camera: usize| camera.min(cameras - 1));
                        let centre = Centre { layout, cameras, pair, size: vec2(width, 700.0), aspect: 0.6 };
                        let tree = automatic(&centre);
                        assert!(fits(&tree, cameras) || pair[0] == pair[1], "{centre:?}: {tree:?}");
                        for pane in Pane::all(cameras) {
                            let is_there = tree.tiles.find_pane(&pane).is_some();
                            assert_eq!(is_there, pane.is_open_at_first(layout), "{centre:?} {pane:?}");
                        }
                    }
                }
            }
        }
    }
}
