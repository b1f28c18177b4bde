//! Icons as painted strokes in a box of 14 points: sharp at every scale, and no icon font.

use egui::epaint::PathShape;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, pos2};

use crate::style::theme::size;

/// One mark of an icon; coordinates are in the box of 14, y down.
enum Mark {
    /// An open stroke.
    Line(&'static [(f32, f32)]),
    /// A closed stroke.
    Loop(&'static [(f32, f32)]),
    /// A filled convex polygon.
    Fill(&'static [(f32, f32)]),
    /// A stroked circle: centre and radius.
    Ring(f32, f32, f32),
    /// A filled circle: centre and radius.
    Dot(f32, f32, f32),
    /// A stroked arc: centre, radius, and from where to where in degrees, clockwise from the right.
    Arc(f32, f32, f32, f32, f32),
}

use Mark::{Arc, Dot, Fill, Line, Loop, Ring};

/// Declares [`Icon`], each with its marks.
macro_rules! icons {
    ($($name:ident: $marks:expr;)*) => {
        /// What an icon shows.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[expect(missing_docs, reason = "an icon's name is what it shows")]
        pub enum Icon {
            $($name,)*
        }

        impl Icon {
            /// All icons.
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];

            fn marks(self) -> &'static [Mark] {
                match self {
                    $(Self::$name => $marks,)*
                }
            }
        }
    };
}

icons! {
    Undo: &[
        Line(&[(5.2, 1.8), (2.2, 4.8), (5.2, 7.8)]),
        Line(&[(2.4, 4.8), (8.4, 4.8)]),
        Arc(8.4, 8.1, 3.3, -90.0, 90.0),
        Line(&[(8.4, 11.4), (5.4, 11.4)]),
    ];
    Redo: &[
        Line(&[(8.8, 1.8), (11.8, 4.8), (8.8, 7.8)]),
        Line(&[(11.6, 4.8), (5.6, 4.8)]),
        Arc(5.6, 8.1, 3.3, -90.0, -270.0),
        Line(&[(5.6, 11.4), (8.6, 11.4)]),
    ];
    StepBack: &[
        Fill(&[(2.0, 2.0), (3.8, 2.0), (3.8, 12.0), (2.0, 12.0)]),
        Fill(&[(12.0, 2.0), (12.0, 12.0), (4.6, 7.0)]),
    ];
    Step: &[
        Fill(&[(2.0, 2.0), (9.4, 7.0), (2.0, 12.0)]),
        Fill(&[(10.2, 2.0), (12.0, 2.0), (12.0, 12.0), (10.2, 12.0)]),
    ];
    Run: &[Fill(&[(1.0, 2.4), (7.0, 7.0), (1.0, 11.6)]), Fill(&[(7.2, 2.4), (13.2, 7.0), (7.2, 11.6)])];
    Stop: &[Fill(&[(3.0, 3.0), (11.0, 3.0), (11.0, 11.0), (3.0, 11.0)])];
    Play: &[Fill(&[(3.2, 1.8), (12.0, 7.0), (3.2, 12.2)])];
    Pause: &[
        Fill(&[(3.0, 2.2), (5.8, 2.2), (5.8, 11.8), (3.0, 11.8)]),
        Fill(&[(8.2, 2.2), (11.0, 2.2), (11.0, 11.8), (8.2, 11.8)]),
    ];
    First: &[Line(&[(3.0, 2.6), (3.0, 11.4)]), Line(&[(10.6, 2.6), (6.2, 7.0), (10.6, 11.4)])];
    Last: &[Line(&[(11.0, 2.6), (11.0, 11.4)]), Line(&[(3.4, 2.6), (7.8, 7.0), (3.4, 11.4)])];
    Previous: &[Line(&[(9.2, 2.6), (4.8, 7.0), (9.2, 11.4)])];
    Next: &[Line(&[(4.8, 2.6), (9.2, 7.0), (4.8, 11.4)])];
    Link: LINK;
    Unlink: UNLINK;
    Expand: &[
        Line(&[(8.4, 2.0), (12.0, 2.0), (12.0, 5.6)]),
        Line(&[(11.8, 2.2), (8.2, 5.8)]),
        Line(&[(5.6, 12.0), (2.0, 12.0), (2.0, 8.4)]),
        Line(&[(2.2, 11.8), (5.8, 8.2)]),
    ];
    More: &[Dot(2.6, 7.0, 1.3), Dot(7.0, 7.0, 1.3), Dot(11.4, 7.0, 1.3)];
    Search: &[Ring(5.8, 5.8, 3.9), Line(&[(8.7, 8.7), (12.4, 12.4)])];
    Eye: &[Loop(EYE), Dot(7.0, 7.0, 1.8)];
    EyeOff: &[Loop(EYE), Dot(7.0, 7.0, 1.8), Line(&[(2.6, 12.2), (11.4, 1.8)])];
    ChevronDown: &[Line(&[(3.4, 5.2), (7.0, 8.8), (10.6, 5.2)])];
    ChevronRight: &[Line(&[(5.2, 3.4), (8.8, 7.0), (5.2, 10.6)])];
    Pin: &[
        Line(&[(4.2, 1.8), (9.8, 1.8)]),
        Line(&[(5.4, 2.0), (5.0, 6.4), (3.2, 8.6), (10.8, 8.6), (9.0, 6.4), (8.6, 2.0)]),
        Line(&[(7.0, 8.8), (7.0, 12.8)]),
    ];
    Warning: &[
        Loop(&[(7.0, 1.6), (13.0, 12.2), (1.0, 12.2)]),
        Line(&[(7.0, 5.4), (7.0, 8.6)]),
        Dot(7.0, 10.4, 0.9),
    ];
    Info: &[Ring(7.0, 7.0, 5.6), Line(&[(7.0, 6.4), (7.0, 10.2)]), Dot(7.0, 4.2, 0.9)];
    Pencil: &[
        Loop(&[(9.8, 1.8), (12.2, 4.2), (4.8, 11.6), (1.8, 12.2), (2.4, 9.2)]),
        Line(&[(8.2, 3.4), (10.6, 5.8)]),
    ];
    Close: &[Line(&[(3.2, 3.2), (10.8, 10.8)]), Line(&[(10.8, 3.2), (3.2, 10.8)])];
    Check: &[Line(&[(2.6, 7.4), (5.6, 10.4), (11.4, 3.8)])];
    PreviousKey: &[
        Line(&[(5.0, 3.4), (1.6, 7.0), (5.0, 10.6)]),
        Loop(&[(9.6, 3.8), (12.8, 7.0), (9.6, 10.2), (6.4, 7.0)]),
    ];
    NextKey: &[
        Line(&[(9.0, 3.4), (12.4, 7.0), (9.0, 10.6)]),
        Loop(&[(4.4, 3.8), (7.6, 7.0), (4.4, 10.2), (1.2, 7.0)]),
    ];
}

impl Icon {
    /// Paints the icon in the middle of `rect`, in its box of [`size::ICON`] points.
    pub fn paint(self, painter: &Painter, rect: Rect, colour: Color32) {
        self.paint_scaled(painter, rect, colour, 1.0);
    }

    /// Paints the icon in the middle of `rect`, its box scaled by `scale`. The strokes keep their width.
    pub fn paint_scaled(self, painter: &Painter, rect: Rect, colour: Color32, scale: f32) {
        let corner = rect.center() - egui::Vec2::splat(size::ICON * 0.5 * scale);
        let at = |x: f32, y: f32| pos2(corner.x + x * scale, corner.y + y * scale);
        let path = |points: &[(f32, f32)]| points.iter().map(|(x, y)| at(*x, *y)).collect::<Vec<Pos2>>();
        let stroke = Stroke::new(size::ICON_STROKE, colour);
        for mark in self.marks() {
            painter.add(match *mark {
                Line(points) => Shape::line(path(points), stroke),
                Loop(points) => Shape::Path(PathShape::closed_line(path(points), stroke)),
                Fill(points) => Shape::convex_polygon(path(points), colour, Stroke::NONE),
                Ring(x, y, radius) => Shape::circle_stroke(at(x, y), radius * scale, stroke),
                Dot(x, y, radius) => Shape::circle_filled(at(x, y), radius * scale, colour),
                Arc(x, y, radius, from, to) => Shape::line(arc(at(x, y), radius * scale, from, to), stroke),
            });
        }
    }
}

/// Two hooks of a chain, and the bar between them.
const LINK: &[Mark] = &[
    Line(&[(6.0, 4.2), (4.2, 4.2)]),
    Arc(4.2, 7.0, 2.8, -90.0, -270.0),
    Line(&[(4.2, 9.8), (6.0, 9.8)]),
    Line(&[(8.0, 4.2), (9.8, 4.2)]),
    Arc(9.8, 7.0, 2.8, -90.0, 90.0),
    Line(&[(9.8, 9.8), (8.0, 9.8)]),
    Line(&[(4.8, 7.0), (9.2, 7.0)]),
];

/// The hooks without the bar, crossed out.
const UNLINK: &[Mark] = &[
    Line(&[(6.0, 4.2), (4.2, 4.2)]),
    Arc(4.2, 7.0, 2.8, -90.0, -270.0),
    Line(&[(4.2, 9.8), (6.0, 9.8)]),
    Line(&[(8.0, 4.2), (9.8, 4.2)]),
    Arc(9.8, 7.0, 2.8, -90.0, 90.0),
    Line(&[(9.8, 9.8), (8.0, 9.8)]),
    Line(&[(4.6, 12.2), (9.4, 1.8)]),
];

const EYE: &[(f32, f32)] = &[
    (0.8, 7.0),
    (2.5, 4.9),
    (4.6, 3.6),
    (7.0, 3.1),
    (9.4, 3.6),
    (11.5, 4.9),
    (13.2, 7.0),
    (11.5, 9.1),
    (9.4, 10.4),
    (7.0, 10.9),
    (4.6, 10.4),
    (2.5, 9.1),
];

fn arc(centre: Pos2, radius: f32, from_degrees: f32, to_degrees: f32) -> Vec<Pos2> {
    const SEGMENTS: u8 = 12;
    let at = |step: u8| {
        let share = f32::from(step) / f32::from(SEGMENTS);
        let angle = (from_degrees + (to_degrees - from_degrees) * share).to_radians();
        centre + radius * egui::vec2(angle.cos(), angle.sin())
    };
    (0..=SEGMENTS).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_icon_stays_in_its_box() {
        for icon in Icon::ALL {
            for mark in icon.marks() {
                let points = match *mark {
                    Line(points) | Loop(points) | Fill(points) => points.to_vec(),
                    Ring(x, y, r) | Dot(x, y, r) => vec![(x - r, y - r), (x + r, y + r)],
                    Arc(x, y, r, from, to) => {
                        arc(pos2(x, y), r, from, to).iter().map(|p| (p.x, p.y)).collect()
                    }
                };
                for (x, y) in points {
                    assert!((0.7..=13.3).contains(&x) && (0.7..=13.3).contains(&y), "{icon:?}: {x}, {y}");
                }
            }
        }
    }
}
