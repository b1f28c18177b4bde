//! What stands in the room.

use glam::DVec3;

use super::room::{HALF, HEIGHT, Piece, Room, Shape, turned};
use super::shading::{LAMPS, Surface};
use super::solid::lattice;

/// Collects furniture, turned about a place on the floor.
#[derive(Debug, Default)]
struct Furnisher {
    pieces: Vec<Piece>,
    place: DVec3,
    turn: [f64; 2],
}

impl Furnisher {
    /// Later pieces stand about this place, turned by `degrees` to the left.
    fn at(&mut self, x: f64, y: f64, degrees: f64) -> &mut Self {
        self.place = DVec3::new(x, y, 0.0);
        self.turn = degrees.to_radians().sin_cos().into();
        self
    }

    fn add(&mut self, shape: Shape, centre: DVec3, surface: Surface) -> &mut Self {
        let centre = self.place + turned(self.turn, centre);
        self.pieces.push(Piece { shape, centre, turn: self.turn, surface });
        self
    }

    /// A block from its middle and its whole sizes.
    fn block(&mut self, centre: [f64; 3], size: [f64; 3], surface: Surface) -> &mut Self {
        self.add(Shape::Block(DVec3::from(size) * 0.5), DVec3::from(centre), surface)
    }

    fn cylinder(&mut self, centre: [f64; 3], radius: f64, height: f64, surface: Surface) -> &mut Self {
        self.add(Shape::Cylinder(radius, height * 0.5), DVec3::from(centre), surface)
    }

    fn ellipsoid(&mut self, centre: [f64; 3], radii: [f64; 3], surface: Surface) -> &mut Self {
        self.add(Shape::Ellipsoid(DVec3::from(radii)), DVec3::from(centre), surface)
    }

    fn legs(&mut self, half: [f64; 2], height: f64, thick: f64, surface: Surface) -> &mut Self {
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            self.block([x * half[0], y * half[1], height * 0.5], [thick, thick, height], surface);
        }
        self
    }
}

impl Default for Room {
    /// A practice room: shelf, window, door, desk, chairs, boxes, plants, posters, a whiteboard.
    fn default() -> Self {
        let mut f = Furnisher::default();
        south_wall(&mut f);
        west_wall(&mut f);
        north_wall(&mut f);
        east_wall(&mut f);
        ceiling_and_floor(&mut f);
        Self { pieces: f.pieces }
    }
}

const WOOD: Surface = Surface::Wood(0.34, 0.2, 0.1);
const PALE_WOOD: Surface = Surface::Wood(0.62, 0.46, 0.29);
const WHITE: Surface = Surface::Plain(0.78, 0.78, 0.76);
const METAL: Surface = Surface::Plain(0.2, 0.21, 0.22);
const BLACK: Surface = Surface::Plain(0.03, 0.03, 0.035);
const CARD: Surface = Surface::Cardboard;

fn south_wall(f: &mut Furnisher) {
    // A shelf with books, boxes and a lamp.
    f.at(0.75, -HALF + 0.17, 0.0);
    for x in [-0.62, 0.0, 0.62] {
        f.block([x, 0.0, 0.95], [0.03, 0.32, 1.9], PALE_WOOD);
    }
    f.block([0.0, -0.155, 0.95], [1.24, 0.01, 1.9], Surface::Plain(0.5, 0.42, 0.33));
    for level in 0..6_i64 {
        let z = 0.05 + 0.365 * level as f64;
        f.block([0.0, 0.0, z], [1.27, 0.32, 0.03], PALE_WOOD);
        if level == 5 {
            continue;
        }
        for bay in 0..2_i64 {
            let mut x = -0.6 + 0.62 * bay as f64;
            let end = x + 0.58 - 0.18 * (1.0 + lattice(level, bay, 9));
            let mut book = 0;
            while x < end && (level + bay) % 3 != 2 {
                let width = 0.035 + 0.012 * lattice(level, bay * 40 + book, 1);
                let tall = 0.25 + 0.05 * lattice(level, bay * 40 + book, 2);
                let tint = level * 64 + bay * 32 + book;
                f.block(
                    [x + width * 0.5, 0.0, z + 0.015 + tall * 0.5],
                    [width * 0.92, 0.2, tall],
                    Surface::Book(tint),
                );
                x += width;
                book += 1;
            }
            if (level + bay) % 3 == 2 {
                f.block([x + 0.27, 0.02, z + 0.13], [0.4, 0.26, 0.22], Surface::Fabric(0.35, 0.4, 0.38));
            }
        }
    }
    f.cylinder([-0.35, 0.0, 2.03], 0.08, 0.2, Surface::Plain(0.2, 0.33, 0.35));
    f.ellipsoid([-0.35, 0.0, 2.25], [0.2, 0.15, 0.17], Surface::Leaf);
    // A poster, a low cabinet with a radio, cardboard boxes.
    f.at(-0.75, -HALF, 0.0);
    f.block([0.0, 0.015, 1.62], [0.74, 0.03, 1.02], BLACK);
    f.block([0.0, 0.02, 1.62], [0.68, 0.03, 0.96], Surface::Poster(0));
    f.block([-0.1, 0.24, 0.36], [1.1, 0.44, 0.72], WHITE);
    f.block([-0.1, 0.465, 0.36], [0.012, 0.01, 0.66], METAL);
    f.block([-0.35, 0.24, 0.82], [0.36, 0.18, 0.2], Surface::Plain(0.42, 0.13, 0.1));
    f.cylinder([0.2, 0.24, 0.79], 0.05, 0.14, Surface::Plain(0.75, 0.6, 0.2));
    f.at(-2.2, -HALF + 0.4, 12.0);
    f.block([0.0, 0.0, 0.24], [0.62, 0.5, 0.48], CARD).block([0.03, -0.02, 0.66], [0.46, 0.4, 0.36], CARD);
    f.at(2.25, -HALF + 0.42, -8.0);
    f.block([0.0, 0.0, 0.2], [0.5, 0.46, 0.4], Surface::Plain(0.16, 0.3, 0.42));
    f.cylinder([0.55, 0.05, 0.55], 0.09, 1.1, Surface::Fabric(0.3, 0.42, 0.3));
}

fn west_wall(f: &mut Furnisher) {
    // A window with daylight, curtains, a radiator and a desk.
    f.at(-HALF, -0.7, -90.0);
    f.block([0.0, 0.01, 1.55], [1.7, 0.02, 1.3], Surface::Sky);
    for x in [-0.85, -0.28, 0.28, 0.85] {
        f.block([x, 0.03, 1.55], [0.06, 0.06, 1.36], WHITE);
    }
    for z in [0.9, 1.9, 2.2] {
        f.block([0.0, 0.03, z], [1.76, 0.06, 0.05], WHITE);
    }
    f.block([0.0, 0.1, 0.87], [1.9, 0.2, 0.04], WHITE);
    for x in [-1.1, 1.1] {
        f.block([x, 0.09, 1.4], [0.4, 0.1, 2.3], Surface::Curtain);
    }
    f.block([0.0, 0.09, 0.45], [1.3, 0.1, 0.56], Surface::Radiator);
    f.at(-HALF + 0.42, 1.45, -90.0);
    f.block([0.0, 0.0, 0.73], [1.5, 0.72, 0.04], WOOD).legs([0.68, 0.3], 0.71, 0.05, METAL);
    f.block([0.1, 0.02, 0.76], [0.36, 0.25, 0.02], METAL);
    f.block([0.1, -0.12, 0.88], [0.36, 0.02, 0.24], BLACK);
    f.cylinder([-0.4, 0.1, 0.8], 0.04, 0.1, Surface::Plain(0.7, 0.2, 0.12));
    f.cylinder([0.55, -0.15, 0.92], 0.018, 0.34, METAL);
    f.ellipsoid([0.5, -0.1, 1.1], [0.12, 0.12, 0.07], Surface::Plain(0.75, 0.62, 0.15));
    f.at(-HALF, 1.5, -90.0);
    f.block([0.0, 0.012, 1.75], [0.9, 0.024, 0.6], Surface::Poster(1));
    chair(f, [-2.45, 1.35], 70.0, Surface::Fabric(0.13, 0.25, 0.3));
    f.at(-HALF + 0.35, -2.45, 0.0);
    f.cylinder([0.0, 0.0, 0.2], 0.2, 0.4, Surface::Plain(0.55, 0.3, 0.2));
    f.cylinder([0.0, 0.0, 0.8], 0.02, 0.9, WOOD);
    plant(f, 1.25);
}

fn north_wall(f: &mut Furnisher) {
    // A door, coats, a bench and a poster.
    f.at(-0.95, HALF, 180.0);
    f.block([0.0, 0.02, 1.05], [1.02, 0.04, 2.14], WHITE);
    f.block([0.0, 0.03, 1.03], [0.88, 0.05, 2.06], Surface::Door);
    f.block([0.36, 0.09, 1.02], [0.1, 0.03, 0.025], METAL);
    f.at(0.75, HALF, 180.0);
    f.block([0.0, 0.012, 1.72], [0.6, 0.024, 0.84], Surface::Poster(2));
    f.block([-0.85, 0.012, 1.72], [0.6, 0.024, 0.84], Surface::Poster(3));
    f.at(0.75, HALF - 0.3, 180.0);
    f.block([0.0, 0.0, 0.44], [1.5, 0.36, 0.05], PALE_WOOD).legs([0.65, 0.13], 0.42, 0.05, PALE_WOOD);
    f.block([0.45, 0.0, 0.59], [0.34, 0.22, 0.24], Surface::Fabric(0.25, 0.12, 0.18));
    f.block([-0.3, 0.02, 0.12], [0.3, 0.24, 0.2], Surface::Plain(0.6, 0.55, 0.4));
    f.at(-2.2, HALF - 0.4, 160.0);
    f.cylinder([0.0, 0.0, 0.9], 0.025, 1.8, METAL).cylinder([0.0, 0.0, 0.02], 0.22, 0.04, METAL);
    f.ellipsoid([0.05, 0.05, 1.4], [0.2, 0.13, 0.36], Surface::Fabric(0.42, 0.32, 0.12));
    f.at(2.5, HALF - 0.45, 20.0);
    f.block([0.0, 0.0, 0.3], [0.7, 0.5, 0.6], CARD);
}

fn east_wall(f: &mut Furnisher) {
    // A whiteboard, a table with a screen, stools and mats.
    f.at(HALF, 0.55, 90.0);
    f.block([0.0, 0.015, 1.55], [1.9, 0.03, 1.15], METAL);
    f.block([0.0, 0.02, 1.55], [1.84, 0.03, 1.09], Surface::Whiteboard);
    f.block([0.0, 0.06, 0.97], [1.4, 0.08, 0.02], METAL);
    f.at(HALF - 0.4, -1.15, 90.0);
    f.block([0.0, 0.0, 0.74], [1.3, 0.7, 0.04], PALE_WOOD).legs([0.58, 0.28], 0.72, 0.05, WHITE);
    f.block([-0.1, -0.15, 1.06], [0.66, 0.04, 0.4], BLACK);
    f.block([-0.1, -0.15, 0.81], [0.06, 0.04, 0.14], METAL);
    f.block([-0.1, 0.12, 0.77], [0.42, 0.14, 0.02], Surface::Plain(0.12, 0.12, 0.13));
    f.block([0.48, 0.05, 0.87], [0.2, 0.26, 0.22], Surface::Plain(0.16, 0.36, 0.32));
    f.block([0.15, -0.05, 0.2], [0.2, 0.45, 0.42], METAL);
    chair(f, [2.5, -1.0], -80.0, Surface::Fabric(0.42, 0.16, 0.1));
    f.at(HALF - 0.32, 1.75, 90.0);
    for (layer, tint) in [(0, 0.36), (1, 0.28), (2, 0.4)] {
        let z = 0.06 + 0.12 * f64::from(layer);
        f.block([0.02 * f64::from(layer), 0.0, z], [1.0, 0.5, 0.115], Surface::Fabric(0.1, 0.2, tint));
    }
    f.ellipsoid([0.1, 0.02, 0.53], [0.17, 0.17, 0.17], Surface::Plain(0.62, 0.24, 0.08));
    f.at(HALF - 0.35, -2.5, 0.0);
    f.cylinder([0.0, 0.0, 0.16], 0.17, 0.32, WHITE);
    plant(f, 0.72);
    f.at(HALF, -2.3, 90.0);
    f.block([0.0, 0.012, 1.8], [0.5, 0.024, 0.7], Surface::Poster(4));
}

fn ceiling_and_floor(f: &mut Furnisher) {
    f.at(0.0, 0.0, 0.0);
    // The corners of the capture volume, in tape.
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        f.block([x * 1.25, y * 1.3, 0.001], [0.3, 0.045, 0.002], Surface::Plain(0.75, 0.62, 0.12));
        f.block([x * 1.38, y * 1.18, 0.001], [0.045, 0.28, 0.002], Surface::Plain(0.75, 0.62, 0.12));
    }
    for x in [-1.0, 1.0] {
        f.block([0.0, x * (HALF - 0.01), 0.05], [HALF * 2.0, 0.02, 0.1], WHITE);
        f.block([x * (HALF - 0.01), 0.0, 0.05], [0.02, HALF * 2.0, 0.1], WHITE);
    }
    for lamp in &LAMPS[..2] {
        let size = [2.0 * lamp.half_u.x + 0.06, 2.0 * lamp.half_v.y + 0.06, 0.06];
        f.block([lamp.centre.x, lamp.centre.y, HEIGHT - 0.01], size, WHITE);
        let glow = [2.0 * lamp.half_u.x, 2.0 * lamp.half_v.y, 0.02];
        f.block([lamp.centre.x, lamp.centre.y, HEIGHT - 0.035], glow, Surface::Glow);
    }
    f.block([2.4, 0.6, HEIGHT - 0.06], [0.16, 5.4, 0.12], WHITE);
}

fn chair(f: &mut Furnisher, place: [f64; 2], degrees: f64, seat: Surface) {
    f.at(place[0], place[1], degrees);
    f.block([0.0, 0.0, 0.46], [0.44, 0.44, 0.06], seat).legs([0.19, 0.19], 0.44, 0.035, METAL);
    f.block([0.0, -0.2, 0.76], [0.42, 0.04, 0.36], seat);
    for x in [-0.17, 0.17] {
        f.block([x, -0.2, 0.55], [0.03, 0.03, 0.3], METAL);
    }
}

fn plant(f: &mut Furnisher, height: f64) {
    for leaf in 0..9_i64 {
        let angle = leaf as f64 * 2.4;
        let (sin, cos) = angle.sin_cos();
        let reach = 0.15 + 0.06 * lattice(leaf, 3, 5);
        let z = height + 0.22 * lattice(leaf, 4, 6);
        f.ellipsoid([cos * reach, sin * reach, z], [0.13, 0.13, 0.1], Surface::Leaf);
    }
}
