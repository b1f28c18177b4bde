//! What a template holds in every camera: the subject's pixels, what other templates hold already, and background.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::camera::Camera;
use crate::fit::FitView;
use crate::geometry::NearestToLines;
use crate::search::mask_of;
use crate::silhouette::{Label, Mask};

/// ε: how much the middle of a template counts beside the rays of its centroids.
const HOLD: f64 = 0.02;
/// Nothing nearer to a camera's plane is looked at, metres.
const NEAREST_M: f64 = 0.05;

/// A template: a segment with a radius. World metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Template {
    pub(crate) from: DVec3,
    pub(crate) to: DVec3,
    pub(crate) radius: f64,
}

/// What a template holds, as shares of its pixels, cameras summed and divided by their number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct TemplateContent {
    /// Of the subject, in no other template.
    pub(crate) subject: f64,
    /// In other templates.
    pub(crate) claimed: f64,
    pub(crate) background: f64,
    /// The same in the camera that sees most of it, of that camera's pixels.
    pub(crate) most_background: f64,
    /// The point nearest to the rays of the centroids; `None` where nothing of the subject is in it.
    pub(crate) towards: Option<DVec3>,
}

/// One camera's silhouette.
#[derive(Debug, Clone)]
pub(crate) struct SilhouetteView {
    pub(crate) camera: Arc<Camera>,
    mask: Arc<Mask>,
    /// Subject pixels with background beside them.
    pub(crate) border: Vec<DVec2>,
    /// Pixels that templates hold.
    claimed: Vec<bool>,
}

/// All of them.
#[derive(Debug, Clone)]
pub(crate) struct Silhouettes(pub(crate) Vec<SilhouetteView>);

impl Silhouettes {
    pub(crate) fn new(views: &[FitView]) -> Self {
        let picture = |view: &FitView| {
            let mask = mask_of(view)?;
            let claimed = vec![false; mask.labels().len()];
            Some(SilhouetteView { camera: Arc::clone(&view.camera), border: border(&mask), claimed, mask })
        };
        Self(views.iter().filter_map(picture).collect())
    }

    /// Whether no camera sees background at a point. Beyond a picture's border all is possible.
    pub(crate) fn may_be_subject(&self, point: DVec3) -> bool {
        self.0.iter().all(|picture| {
            let Some(pixel) = picture.camera.project(point) else { return true };
            let (x, y) = (pixel.x.round(), pixel.y.round());
            if x < 0.0 || y < 0.0 {
                return true;
            }
            picture.mask.get(x as usize, y as usize) != Some(Label::Background)
        })
    }

    /// What a template holds.
    pub(crate) fn held(&self, template: &Template) -> TemplateContent {
        let mut held = TemplateContent::default();
        let middle = 0.5 * (template.from + template.to);
        let (mut nearest, mut mass) = (NearestToLines::default(), 0.0);
        for picture in &self.0 {
            let mut centroid = DVec2::ZERO;
            let [mut subject, mut claimed, mut background] = [0.0; 3];
            picture.each_pixel(template, |x, y, index| match picture.mask.labels()[index] {
                Label::Subject if picture.claimed[index] => claimed += 1.0,
                Label::Subject => {
                    subject += 1.0;
                    centroid += DVec2::new(x as f64, y as f64);
                }
                Label::Background => background += 1.0,
                Label::Unknown => {}
            });
            let all: f64 = subject + claimed + background;
            if all == 0.0 {
                continue;
            }
            let share = 1.0 / (all * self.0.len() as f64);
            held.subject += subject * share;
            held.claimed += claimed * share;
            held.background += background * share;
            held.most_background = held.most_background.max(background / all);
            let Some(ray) = picture.camera.ray_in_world(centroid / subject).filter(|_| subject > 0.0) else {
                continue;
            };
            // Shares, so that a near camera counts no more than a far one.
            let weight = subject / all;
            nearest.add(picture.camera.centre(), ray, weight);
            mass += weight;
        }
        if mass > 0.0 {
            nearest.pull(middle, HOLD * mass);
            held.towards = nearest.solve();
        }
        held
    }

    /// Takes what a template holds from those after it.
    pub(crate) fn claim(&mut self, template: &Template) {
        for picture in &mut self.0 {
            let mut held = Vec::new();
            picture.each_pixel(template, |_, _, index| held.push(index));
            for index in held {
                picture.claimed[index] = true;
            }
        }
    }
}

impl SilhouetteView {
    /// Every pixel whose centre lies in a template's outline, about: a segment whose radius goes from one end's to the
    /// other's.
    fn each_pixel(&self, template: &Template, mut see: impl FnMut(usize, usize, usize)) {
        let camera = &self.camera;
        let ends = [template.from, template.to];
        let [depth_a, depth_b] = ends.map(|end| camera.depth(end));
        let [Some(a), Some(b)] = ends.map(|end| camera.project(end)) else { return };
        if depth_a.min(depth_b) < NEAREST_M {
            return;
        }
        let focal = camera.intrinsics().mean_focal_px();
        let (radius_a, radius_b) = (template.radius * focal / depth_a, template.radius * focal / depth_b);
        let reach = radius_a.max(radius_b);
        let (low, high) = (a.min(b) - reach, a.max(b) + reach);
        // Casts of floats saturate: what is left of or above the picture is 0.
        let columns = low.x.ceil() as usize..((high.x + 1.0) as usize).min(camera.width());
        let rows = low.y.ceil() as usize..((high.y + 1.0) as usize).min(camera.height());
        let along = b - a;
        let inverse = 1.0 / along.length_squared().max(1e-9);
        for y in rows {
            for x in columns.clone() {
                let from = DVec2::new(x as f64, y as f64) - a;
                let t = (from.dot(along) * inverse).clamp(0.0, 1.0);
                let radius = radius_a + t * (radius_b - radius_a);
                if (from - along * t).length_squared() <= radius * radius {
                    see(x, y, y * camera.width() + x);
                }
            }
        }
    }
}

/// Subject pixels that have background above, below or beside them.
fn border(mask: &Mask) -> Vec<DVec2> {
    let (width, height) = (mask.width(), mask.height());
    let is_background = |x: usize, y: usize| mask.labels()[y * width + x] == Label::Background;
    let mut border = Vec::new();
    for (index, _) in mask.labels().iter().enumerate().filter(|(_, label)| **label == Label::Subject) {
        let (x, y) = (index % width, index / width);
        let is_border = (x > 0 && is_background(x - 1, y))
            || (x + 1 < width && is_background(x + 1, y))
            || (y > 0 && is_background(x, y - 1))
            || (y + 1 < height && is_background(x, y + 1));
        if is_border {
            border.push(DVec2::new(x as f64, y as f64));
        }
    }
    border
}
