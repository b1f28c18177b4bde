//! Predictions for the screen against the oracle's: all cameras of a scene, every pixel.

use std::hint::black_box;
use std::time::Duration;

use backlit_tracking::body::{Kinematics, Parameters};
use backlit_tracking::render::{
    BodyMotion, DrawOptions, Drawing, Ramp, RendererKind, View, draw, draw_plainly,
};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use super::scene::Scene;
use super::timing::Table;

/// The footage's cameras, and the largest that are looked at.
const SIZES: [(usize, u64, u64); 2] = [(4, 272, 480), (8, 1920, 1080)];
/// What is shown at the end of a robust fit.
const RAMP: Ramp = Ramp::Distance { inner_px: 1.5, outer_px: 1.5 };

/// What a drawing is made by.
type Draw = fn(&View, DrawOptions<'_>) -> Drawing;

/// Prints a table a size.
pub(crate) fn tables(budget: Duration) {
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let (one, two) = (pool(1), pool(2));
    for (count, width, height) in SIZES {
        let scene = Scene::new(width, height, count);
        let kinematics = Kinematics::new(&scene.model, &scene.pose);
        let views = |renderer, ramp| -> Vec<View> {
            let cameras = scene.cameras.iter();
            cameras.map(|(camera, _)| View::new(&scene.model, &kinematics, camera, renderer, ramp)).collect()
        };
        let capsules = views(RendererKind::Capsule, RAMP);
        let wide = views(RendererKind::Capsule, Ramp::Half);
        let cylinders = views(RendererKind::Cylinder, RAMP);
        let spheres = views(RendererKind::SphereTree { spheres: None }, RAMP);
        let mut direction = vec![0.0; Parameters::Tangent.columns(scene.model.rotation_count())];
        direction[5] = 1.0;
        let motion = BodyMotion::along(&kinematics, &scene.cameras[0].0, Parameters::Tangent, &direction);
        let (bare, gradient) =
            (DrawOptions::default(), DrawOptions { gradient: true, ..DrawOptions::default() });
        let change = DrawOptions { motion: Some(&motion), ..DrawOptions::default() };
        let all = |views: &[View], wanted: DrawOptions<'_>, draw: Draw| {
            views.par_iter().for_each(|view| drop(black_box(draw(view, wanted))));
        };
        Table::new(format!("Pictures of {count} × {width} × {height}"))
            .add("λ and owners, one thread", || one.install(|| all(&capsules, bare, draw)))
            .add("two threads", || two.install(|| all(&capsules, bare, draw)))
            .add("the ramp half, one thread", || one.install(|| all(&wide, bare, draw)))
            .add("cylinder, one thread", || one.install(|| all(&cylinders, bare, draw)))
            .add("sphere tree, one thread", || one.install(|| all(&spheres, bare, draw)))
            .add("with the pull, one thread", || one.install(|| all(&capsules, gradient, draw)))
            .add("with a column, one thread", || one.install(|| all(&capsules, change, draw)))
            .add("with a column, two threads", || two.install(|| all(&capsules, change, draw)))
            .add("oracle, one thread", || one.install(|| all(&capsules, bare, draw_plainly)))
            .add("oracle, two threads", || two.install(|| all(&capsules, bare, draw_plainly)))
            .add("oracle with a column, one thread", || one.install(|| all(&capsules, change, draw_plainly)))
            .run(budget);
    }
}
