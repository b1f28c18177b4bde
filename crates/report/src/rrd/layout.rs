//! How the viewer's window is divided at first.

use re_sdk::blueprint::{
    Blueprint, ContainerLike, Grid, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView, Tabs,
    TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use re_sdk_types::blueprint::components::PanelState;

use super::{camera_path, part};
use crate::Page;

/// Scene and curves at the left, cameras and texts at the right.
pub(super) fn of(page: &Page) -> Blueprint {
    let scene = Spatial3DView::new("Scene").with_origin("world");
    let mut groups: Vec<&str> = Vec::new();
    for curve in &page.curves {
        if !groups.contains(&curve.group.as_str()) {
            groups.push(&curve.group);
        }
    }
    let mut plots: Vec<ContainerLike> = Vec::new();
    for group in groups {
        let origin = re_sdk::EntityPath::from("curves").join(&part(group));
        plots.push(TimeSeriesView::new(group).with_origin(origin).into());
    }
    if !page.fits.is_empty() {
        plots.push(TimeSeriesView::new("Cost of the steps").with_origin("costs").into());
    }
    let cameras = page.cameras.iter().map(|camera| {
        let view = Spatial2DView::new(camera.name.clone()).with_origin(camera_path(camera));
        view.with_contents(["$origin/**", "/world/body/**", "/world/fits/**"]).into()
    });
    let texts: [ContainerLike; 3] = [
        TextLogView::new("Doubtful limbs").with_origin("trust").into(),
        TextLogView::new("Bookmarks").with_origin("bookmarks").into(),
        TextDocumentView::new("About").with_origin("about").into(),
    ];
    let mut left: Vec<ContainerLike> = vec![scene.into()];
    if !plots.is_empty() {
        left.push(Tabs::new(plots).into());
    }
    let mut right: Vec<ContainerLike> = vec![Tabs::new(texts).into()];
    if !page.cameras.is_empty() {
        right.insert(0, Grid::new(cameras).into());
    }
    let root = Horizontal::new([Vertical::new(left).into(), Vertical::new(right).into()]);
    Blueprint::new(root)
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
        .with_time_panel(TimePanel::new().with_timeline("frame"))
}
