//! Errors and times of the trees of a torus, a hand and a scan-like hare, at 8, 64 and 512 spheres.
//!
//! `cargo run --release -p backlit-sphere-tree --example shapes -- 0.025`: the number is the step of the grid that the meshes are
//! cut from. Distances are in hundredths of the radius of the box's ball.

#[path = "../tests/trees/shapes.rs"]
mod shapes;

use std::time::Instant;

use backlit_sphere_tree::{SphereTree, TreeOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let step = std::env::args().nth(1).map_or(Ok(0.025), |word| word.parse())?;
    println!(
        "| solid | triangles | spheres | outside: greatest | mean | inside: greatest | mean | covered | seconds |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, mesh) in shapes::all(step) {
        let [low, high] = mesh.bounds();
        let unit = 0.5 * (high - low).length() / 100.0;
        let start = Instant::now();
        let tree = SphereTree::build(&mesh, &TreeOptions::default())?;
        let seconds = start.elapsed().as_secs_f64();
        for level in &tree.levels {
            let e = level.error;
            let [a, b, c, d] =
                [e.outside_greatest, e.outside_mean, e.inside_greatest, e.inside_mean].map(|x| x / unit);
            println!(
                "| {name} | {} | {} | {a:.2} | {b:.2} | {c:.2} | {d:.2} | {:.6} | {seconds:.1} |",
                mesh.triangles().len(),
                level.spheres.len(),
                e.coverage
            );
        }
    }
    Ok(())
}
