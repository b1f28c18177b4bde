//! Bodies in the place of the posed one, as things to draw: one of solid limbs, the others of faint lines.

use backlit_ui::drawing::Ghosts;
use backlit_ui::style::theme::data_colours::{GHOST, JOINT, SCENE_BODY, SELECTED};

use super::raster::{Ends, Limb, Line};

/// Width of a faint limb, in points.
const WIDTH: f64 = 1.5;

/// The limbs of the one that is drawn whole, as far as they have a place, and the template if it is a ball.
pub(super) fn limbs(ghosts: &Ghosts) -> Vec<Limb> {
    let mut limbs = Vec::new();
    if let Some(ghost) = ghosts.bodies.first() {
        let (starts, ends) = (ghost.kinematics.starts(), ghost.kinematics.ends());
        limbs.extend(ghosts.limbs().map(|limb| Limb {
            ends: [starts[limb], ends[limb]],
            radius: ghosts.model.limbs()[limb].radius,
            shape: Ends::Round,
            colour: if ghosts.marked[limb] { SELECTED } else { SCENE_BODY },
        }));
    }
    let ball = ghosts.template.filter(|template| template.ends[0] == template.ends[1]);
    let ball =
        ball.map(|ball| Limb { ends: ball.ends, radius: ball.radius, shape: Ends::Round, colour: JOINT });
    limbs.extend(ball);
    limbs
}

/// The limbs of the faint ones.
pub(super) fn lines(ghosts: &Ghosts, scale: f64) -> impl Iterator<Item = Line> {
    ghosts.sticks().flat_map(move |(ghost, opacity)| {
        let (starts, ends) = (ghost.kinematics.starts(), ghost.kinematics.ends());
        let line = move |limb: usize| Line {
            ends: [starts[limb], ends[limb]],
            width_px: WIDTH * scale,
            colour: GHOST.gamma_multiply(opacity),
        };
        ghosts.limbs().map(line)
    })
}
