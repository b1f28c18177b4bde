//! Lamps, surfaces and how they look. Colours are linear RGB reflectances.

use glam::DVec3;

use super::figure::{Figure, Material, Part, Touch};
use super::room::RoomHit;
use super::solid::{lattice, noise};

/// A rectangle that gives light from one side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lamp {
    pub(super) centre: DVec3,
    pub(super) half_u: DVec3,
    pub(super) half_v: DVec3,
    pub(super) normal: DVec3,
    pub(super) radiance: DVec3,
}

/// Two panels on the ceiling, one much brighter, and the window.
pub(super) const LAMPS: [Lamp; 3] = [
    Lamp {
        centre: DVec3::new(1.1, 1.35, 2.7),
        half_u: DVec3::new(0.4, 0.0, 0.0),
        half_v: DVec3::new(0.0, 0.28, 0.0),
        normal: DVec3::NEG_Z,
        radiance: DVec3::new(24.0, 22.2, 19.5),
    },
    Lamp {
        centre: DVec3::new(-1.2, -1.5, 2.7),
        half_u: DVec3::new(0.5, 0.0, 0.0),
        half_v: DVec3::new(0.0, 0.35, 0.0),
        normal: DVec3::NEG_Z,
        radiance: DVec3::new(5.6, 5.4, 5.0),
    },
    Lamp {
        centre: DVec3::new(-3.5, -0.7, 1.55),
        half_u: DVec3::new(0.0, 0.8, 0.0),
        half_v: DVec3::new(0.0, 0.0, 0.62),
        normal: DVec3::X,
        radiance: DVec3::new(2.3, 2.7, 3.3),
    },
];

impl Lamp {
    pub(super) fn point(&self, u: f64, v: f64) -> DVec3 {
        self.centre + self.half_u * u + self.half_v * v
    }

    /// Light that a surface takes from a point of the lamp standing for all of it, over π.
    pub(super) fn light(&self, from: DVec3, position: DVec3, normal: DVec3) -> DVec3 {
        let way = from - position;
        let direction = way.normalize();
        let (out, inward) = ((-direction).dot(self.normal).max(0.0), direction.dot(normal).max(0.0));
        let area = 4.0 * self.half_u.length() * self.half_v.length();
        // A point stands for the whole lamp, so nearer than its breadth the light no longer grows.
        let distance_squared = way.length_squared().max(0.3 * area);
        self.radiance * (area * out * inward / (distance_squared * std::f64::consts::PI))
    }

    /// Half the lamp's breadth as seen from a metre.
    fn radius(&self) -> f64 {
        (self.half_u.length() * self.half_v.length()).sqrt()
    }
}

/// Light that reaches a surface from all sides: the ceiling above, the floor below.
pub(super) fn ambient(normal: DVec3) -> DVec3 {
    let up = 0.5 + 0.5 * normal.z;
    DVec3::new(0.2, 0.16, 0.125).lerp(DVec3::new(0.34, 0.355, 0.375), up)
}

/// How a piece of the room looks. Three numbers are a reflectance, one number tells copies apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Surface {
    Plain(f64, f64, f64),
    Wood(f64, f64, f64),
    Fabric(f64, f64, f64),
    Wall(f64, f64, f64),
    Book(i64),
    Poster(i64),
    Floor,
    Ceiling,
    Cardboard,
    Curtain,
    Radiator,
    Door,
    Whiteboard,
    Leaf,
    Sky,
    Glow,
}

/// Reflectance and the light that the surface gives by itself.
pub(super) fn room_colours(hit: &RoomHit) -> (DVec3, DVec3) {
    let p = hit.local;
    let colour = match hit.surface {
        Surface::Glow => return (DVec3::ZERO, DVec3::new(3.2, 3.1, 2.9)),
        Surface::Sky => return (DVec3::ZERO, sky(p, hit.half)),
        Surface::Plain(r, g, b) => DVec3::new(r, g, b),
        Surface::Wood(r, g, b) => DVec3::new(r, g, b) * (1.0 + 0.22 * grain(p)),
        Surface::Fabric(r, g, b) => {
            DVec3::new(r, g, b) * (1.0 + 0.2 * noise(p * 60.0) + 0.12 * noise(p * 9.0))
        }
        Surface::Wall(r, g, b) => {
            DVec3::new(r, g, b) * (1.0 + 0.03 * noise(p * 1.3) + 0.02 * noise(p * 30.0))
        }
        Surface::Book(which) => book(which, p, hit.half),
        Surface::Poster(which) => poster(which, p.x / hit.half.x, p.z / hit.half.z),
        Surface::Floor => floor(p),
        Surface::Ceiling => ceiling(p),
        Surface::Cardboard => {
            let tape = if p.x.abs() < 0.03 { 1.2 } else { 1.0 };
            DVec3::new(0.62, 0.5, 0.35) * (tape * (1.0 + 0.07 * noise(p * 25.0)))
        }
        Surface::Curtain => DVec3::new(0.5, 0.44, 0.32) * (0.8 + 0.25 * (p.x * 75.0).sin()),
        Surface::Radiator => DVec3::splat(0.66 + 0.12 * (p.x * 70.0).sin()),
        Surface::Door => {
            let (x, z) = (p.x.abs() / hit.half.x, p.z.abs() / hit.half.z);
            let panel = (x - 0.68).abs() < 0.03 && z < 0.85 || (z - 0.85).abs() < 0.015 && x < 0.7;
            DVec3::new(0.2, 0.34, 0.36) * if panel { 0.6 } else { 1.0 }
        }
        Surface::Whiteboard => whiteboard(p),
        Surface::Leaf => DVec3::new(0.1, 0.26, 0.08) * (1.0 + 0.75 * noise(p * 34.0)).max(0.25),
    };
    (colour, DVec3::ZERO)
}

fn grain(p: DVec3) -> f64 {
    noise(DVec3::new(p.x * 4.0, p.y * 45.0, p.z * 45.0)) + 0.5 * noise(p * DVec3::new(9.0, 120.0, 120.0))
}

fn floor(p: DVec3) -> DVec3 {
    const PLANK: f64 = 0.15;
    const LENGTH: f64 = 1.35;
    let row = (p.x / PLANK).floor();
    let shifted = p.y / LENGTH + 0.5 * (1.0 + lattice(row as i64, 7, 7));
    let plank = shifted.floor();
    let tint = lattice(row as i64, plank as i64, 3);
    let edge_x = (p.x / PLANK - row - 0.5).abs();
    let edge_y = (shifted - plank - 0.5).abs();
    let gap = if edge_x > 0.478 || edge_y > 0.4975 { 0.5 } else { 1.0 };
    let grain = noise(DVec3::new(p.x * 60.0, p.y * 5.0, row))
        + 0.5 * noise(DVec3::new(p.x * 150.0, p.y * 11.0, plank));
    DVec3::new(0.52 + 0.05 * tint, 0.425 + 0.045 * tint, 0.325 + 0.04 * tint) * (gap * (1.0 + 0.11 * grain))
}

fn ceiling(p: DVec3) -> DVec3 {
    let tile = |x: f64| (x / 0.6 - (x / 0.6).floor() - 0.5).abs() > 0.483;
    DVec3::splat(if tile(p.x) || tile(p.y) { 0.5 } else { 0.7 + 0.02 * noise(p * 40.0) })
}

fn book(which: i64, p: DVec3, half: DVec3) -> DVec3 {
    const COVERS: [[f64; 3]; 8] = [
        [0.45, 0.1, 0.08],
        [0.08, 0.18, 0.32],
        [0.55, 0.45, 0.25],
        [0.09, 0.26, 0.2],
        [0.6, 0.58, 0.54],
        [0.5, 0.28, 0.06],
        [0.2, 0.1, 0.22],
        [0.1, 0.1, 0.11],
    ];
    let pick = (lattice(which, 5, 5) * 0.5 + 0.5) * COVERS.len() as f64;
    let cover = DVec3::from(COVERS[(pick as usize).min(COVERS.len() - 1)]);
    let label = (p.z / half.z - 0.45 * lattice(which, 6, 6)).abs() < 0.14;
    if label { cover * 0.4 + DVec3::splat(0.35) } else { cover }
}

fn poster(which: i64, x: f64, z: f64) -> DVec3 {
    let paper = DVec3::new(0.72, 0.69, 0.6);
    let lines = |colour: DVec3| {
        let written = z < -0.62 && z > -0.9 && x.abs() < 0.75 && (z * 22.0).sin() > 0.0;
        if written { colour * 0.5 } else { paper }
    };
    match which {
        0 => {
            // Hills under a low sun.
            let (sun, ridge) =
                ((x - 0.25).hypot((z - 0.3) * 1.4), 0.22 * (x * 3.0).sin() + 0.1 * (x * 7.0).cos());
            if z < ridge - 0.55 {
                DVec3::new(0.04, 0.1, 0.13)
            } else if z < ridge * 0.7 - 0.2 {
                DVec3::new(0.08, 0.22, 0.26)
            } else if sun < 0.36 {
                DVec3::new(0.72, 0.2, 0.08)
            } else {
                DVec3::new(0.7, 0.52, 0.28).lerp(DVec3::new(0.62, 0.58, 0.46), z * 0.5 + 0.5)
            }
        }
        1 => {
            // Overlapping discs.
            let mut colour = paper;
            for (cx, cz, radius, tint) in [
                (-0.45, 0.1, 0.62, [0.2, 0.5, 0.62]),
                (0.4, 0.2, 0.52, [0.9, 0.45, 0.2]),
                (0.05, -0.35, 0.42, [0.85, 0.75, 0.3]),
            ] {
                if (x * 1.5 - cx).hypot(z - cz) < radius {
                    colour *= DVec3::from(tint);
                }
            }
            colour
        }
        2 => {
            let ring = (x.hypot(z * 1.4 - 0.2) * 9.0).sin();
            if x.hypot(z * 1.4 - 0.2) < 0.8 && ring > 0.0 {
                DVec3::new(0.1, 0.14, 0.3)
            } else {
                lines(DVec3::new(0.1, 0.14, 0.3))
            }
        }
        3 => {
            let bar = ((x + 1.0) * 3.5).floor();
            let tall = 0.55 * lattice(bar as i64, 8, 8) + 0.1;
            if z > -0.5 && z < tall && x.abs() < 0.82 {
                DVec3::new(0.5, 0.15 + 0.05 * bar, 0.1)
            } else {
                lines(DVec3::new(0.4, 0.1, 0.1))
            }
        }
        _ => {
            let step = ((x + z) * 4.0).floor() as i64;
            if step % 2 == 0 { DVec3::new(0.1, 0.32, 0.28) } else { paper }
        }
    }
}

fn whiteboard(p: DVec3) -> DVec3 {
    let curve = p.z - 0.16 * (p.x * 6.0).sin() * (-p.x.abs()).exp() - 0.1;
    let drawn = curve.abs() < 0.012 && p.x.abs() < 0.75;
    let axis = (p.z + 0.2).abs() < 0.008 && p.x.abs() < 0.8;
    let words = p.x < -0.2 && p.x > -0.8 && p.z > 0.3 && (p.z * 60.0).sin() > 0.6 && noise(p * 40.0) > -0.1;
    if drawn {
        DVec3::new(0.55, 0.08, 0.06)
    } else if axis || words {
        DVec3::new(0.08, 0.1, 0.25)
    } else {
        DVec3::new(0.8, 0.81, 0.82)
    }
}

fn sky(p: DVec3, half: DVec3) -> DVec3 {
    let (x, z) = (p.x / half.x, p.z / half.z);
    let cloud =
        (noise(DVec3::new(x * 2.5, 0.0, z * 4.0)) + 0.4 * noise(DVec3::new(x * 7.0, 1.0, z * 9.0))).max(0.0);
    let trees =
        -0.35 + 0.14 * noise(DVec3::new(x * 5.0, 3.0, 0.0)) + 0.06 * noise(DVec3::new(x * 18.0, 4.0, 0.0));
    if z < trees {
        DVec3::new(0.28, 0.42, 0.22) * (1.0 + 0.4 * noise(DVec3::new(x * 20.0, 5.0, z * 20.0)))
    } else {
        DVec3::new(0.85, 1.15, 1.55).lerp(DVec3::splat(1.7), (cloud + 0.35 * (1.0 - z)).min(1.0))
    }
}

/// Reflectance and gloss of a point of the figure, without the pattern of its build.
fn figure_colours(touch: &Touch) -> (DVec3, f64) {
    let p = touch.local;
    match touch.material {
        Material::Skin => (skin(touch), 0.1),
        Material::Hair => {
            (DVec3::new(0.055, 0.03, 0.018) * (1.0 + 0.7 * noise(p * DVec3::new(120.0, 60.0, 40.0))), 0.16)
        }
        Material::Shirt => {
            let trunk = touch.part == Part::Trunk;
            let weave = 1.0 + 0.05 * noise(p * 160.0) + 0.06 * noise(p * 22.0);
            // Two pale stripes round the chest, a trim at the sleeves.
            let stripe = trunk && ((p.z - 0.055).abs() < 0.019 || (p.z - 0.005).abs() < 0.009)
                || !trunk && (p.z + 0.198).abs() < 0.013;
            let striped = if stripe { DVec3::new(0.78, 0.72, 0.6) } else { DVec3::new(0.62, 0.085, 0.055) };
            (striped * weave, 0.0)
        }
        Material::Trousers => {
            let weave = 1.0 + 0.22 * noise(p * DVec3::new(170.0, 170.0, 50.0)) + 0.16 * noise(p * 9.0);
            let leg = touch.part != Part::Trunk;
            let seam = leg && p.y.abs() < 0.003;
            let worn = if leg { 1.0 + 0.35 * (p.y * 9.0).clamp(0.0, 1.0) } else { 1.0 };
            (DVec3::new(0.055, 0.095, 0.19) * (weave * worn * if seam { 0.6 } else { 1.0 }), 0.02)
        }
        Material::Shoe => shoe(p),
    }
}

fn shoe(p: DVec3) -> (DVec3, f64) {
    if p.z > -0.012 && p.y < 0.045 {
        (DVec3::splat(0.55), 0.0)
    } else if p.z < -0.074 {
        (DVec3::new(0.78, 0.77, 0.74), 0.05)
    } else if p.y > 0.03 && p.y < 0.1 && p.x.abs() < 0.02 {
        let lace = (p.y * 330.0).sin() > 0.0;
        (if lace { DVec3::splat(0.8) } else { DVec3::splat(0.14) }, 0.0)
    } else {
        (DVec3::new(0.09, 0.1, 0.115), 0.12)
    }
}

fn skin(touch: &Touch) -> DVec3 {
    let p = touch.local;
    let base = DVec3::new(0.5, 0.27, 0.18) * (1.0 + 0.04 * noise(p * 30.0));
    if touch.part != Part::Head || p.y < 0.03 {
        return base;
    }
    // The face, in the skull's axes: eyes, brows, mouth, a little colour on cheeks and nose.
    let x = p.x.abs();
    let eye = ((x - 0.031) / 0.0145).hypot((p.z - 0.09) / 0.0075);
    if eye < 1.0 {
        let iris = (x - 0.031).hypot(p.z - 0.09) < 0.0065;
        return if iris { DVec3::new(0.03, 0.02, 0.015) } else { DVec3::splat(0.6) };
    }
    let brow = ((x - 0.033) / 0.021).hypot((p.z - 0.111) / 0.005);
    let lips = (x / 0.024).hypot((p.z - 0.027) / 0.008);
    if brow < 1.0 {
        DVec3::new(0.07, 0.04, 0.025)
    } else if lips < 1.0 {
        DVec3::new(0.43, 0.16, 0.13)
    } else {
        let flush = (-((x - 0.042) / 0.022).powi(2) - ((p.z - 0.055) / 0.022).powi(2)).exp();
        base * (DVec3::ONE + flush * DVec3::new(0.1, -0.1, -0.08))
    }
}

/// How much of a lamp a point sees past the figure: 1 all, 0 nothing. A cone walk after I. Quilez.
pub(super) fn lamp_seen(figure: &Figure, position: DVec3, normal: DVec3, lamp: &Lamp) -> f64 {
    let start = position + normal * 0.004;
    let way = lamp.centre - start;
    let length = way.length();
    let direction = way / length;
    let breadth = lamp.radius() / length;
    let (centre, radius) = figure.bounding_ball();
    let middle = (centre - start).dot(direction).clamp(0.0, length);
    if (start + direction * middle).distance(centre) > radius + breadth * middle {
        return 1.0;
    }
    let mut seen = 1.0_f64;
    let mut t = 0.012;
    for _ in 0..64 {
        let distance = figure.distance(start + direction * t);
        seen = seen.min(distance / (breadth * t));
        t += (distance.abs() * 0.9).clamp(0.008, 0.2);
        if seen < -1.0 || t > length.min(middle + radius) {
            break;
        }
    }
    let seen = seen.max(-1.0);
    0.25 * (1.0 + seen) * (1.0 + seen) * (2.0 - seen)
}

/// How much of its surroundings a point sees past the figure.
pub(super) fn open_sky(figure: &Figure, position: DVec3, normal: DVec3, reach: f64) -> f64 {
    let mut hidden = 0.0;
    let mut weight = 0.45;
    for step in 1..=4 {
        let height = reach * f64::from(step) * 0.25;
        let distance = figure.distance(position + normal * height);
        hidden += weight * ((height - distance) / height).clamp(0.0, 1.0);
        weight *= 0.75;
    }
    (1.0 - hidden * 0.8).clamp(0.0, 1.0)
}

/// What of its surroundings and of each lamp a point of the figure sees past the figure itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shade {
    position: DVec3,
    open: f64,
    lamps: [f64; 3],
}

impl Shade {
    /// How far from its point a shade still serves, metres: shadows on a body have soft borders.
    const SERVES: f64 = 0.02;
    /// How far away the body's own parts still darken a place, metres.
    const REACH: f64 = 0.16;

    pub(super) fn new(figure: &Figure, position: DVec3) -> Self {
        let normal = figure.normal(position);
        let lamps = LAMPS.map(|lamp| {
            let faces = lamp.light(lamp.centre, position, normal).max_element() > 1e-4;
            if faces { lamp_seen(figure, position, normal, &lamp) } else { 0.0 }
        });
        Self { position, open: open_sky(figure, position, normal, Self::REACH), lamps }
    }

    /// Nothing is in the way of any light.
    pub(super) fn none(position: DVec3) -> Self {
        Self { position, open: 1.0, lamps: [1.0; 3] }
    }

    pub(super) fn serves(&self, position: DVec3) -> bool {
        self.position.distance_squared(position) < Self::SERVES * Self::SERVES
    }
}

/// Light from a point of the figure towards the eye (`direction` is the ray's, unit).
pub(super) fn figure_light(figure: &Figure, position: DVec3, direction: DVec3, shade: &Shade) -> DVec3 {
    let normal = figure.normal(position);
    let touch = figure.touch(position);
    let (mut colour, gloss) = figure_colours(&touch);
    if figure.build.pattern != 0.0 {
        let blotches = 0.7 * noise(touch.local * 26.0) + 0.5 * noise(touch.local * 55.0);
        colour *= (1.0 + figure.build.pattern * blotches).max(0.1);
    }
    let mut light = colour * ambient(normal) * shade.open;
    for (lamp, seen) in LAMPS.iter().zip(shade.lamps) {
        let half = ((lamp.centre - position).normalize() - direction).normalize();
        let shine = gloss * half.dot(normal).max(0.0).powi(24);
        light += lamp.light(lamp.centre, position, normal) * seen * (colour + DVec3::splat(shine));
    }
    light
}
