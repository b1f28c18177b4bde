//! The plane of motions: the take is a curve in the colours of its names, over the regions where the model's motions lie.

use backlit_recognition::recognizer::PlaneCloud;
use backlit_ui::style::theme::{data_colours, motion_colours, size, tick};
use backlit_ui::style::{format, theme};
use egui::{
    Align2, Id, PopupAnchor, Pos2, Rect, Role, Sense, Shape, Stroke, TextStyle, Tooltip, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use crate::context::Context;
use crate::context::marks::whole_percent;
use crate::features::motions::job::RecognisedMotions;
use crate::features::motions::{Motions, Plane, words};

/// Most places of a curve that are drawn.
const MOST_PLACES: usize = 4000;
/// Most dots that mark time.
const MOST_DOTS: usize = 40;
/// The pointer is at a place of the curve within this many points.
const REACH: f32 = 16.0;
/// Opacity of the curve away from the frame on the screen, of a region and of its edge.
const FAR: f32 = 0.5;
const REGION: f32 = 0.1;
const REGION_EDGE: f32 = 0.55;
/// Corners of a region's edge.
const CORNERS: usize = 48;
/// Seconds before and after the frame on the screen in which the curve is strong.
const NEAR_S: f64 = 1.0;
/// Room about what is shown, as a part of it; room for the names of the axes.
const MARGIN: f64 = 0.06;
const AXIS: f32 = 18.0;
/// Side of the square about the frame on the screen in which no name stands, points.
const NOW: f32 = 18.0;
/// Side of the square about a dot in which no time stands, points.
const DOT: f32 = 7.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Place {
    pub(in super::super) frame: usize,
    class: Option<usize>,
    pub(in super::super) at: [f64; 2],
    run: usize,
}

/// The frames' places on a plane, thinned where they are many.
pub(in super::super) fn places(found: &RecognisedMotions, plane: Plane) -> Vec<Place> {
    let total: usize = found.runs.iter().map(|run| run.frames.len()).sum();
    let every = total.div_ceil(MOST_PLACES).max(1);
    let of_run = |(run, names): (usize, &backlit_recognition::Recognition)| -> Vec<Place> {
        let place = |named: &backlit_recognition::FrameName| {
            let at = if plane == Plane::Apart { named.apart } else { named.place };
            Place { frame: named.frame, class: named.class, at, run }
        };
        names.frames.iter().step_by(every).map(place).collect()
    };
    found.runs.iter().enumerate().flat_map(of_run).collect()
}

/// Where the plane lies on the screen.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Sheet {
    area: Rect,
    low: [f64; 2],
    high: [f64; 2],
}

impl Sheet {
    /// All places and regions within an area.
    pub(in super::super) fn new(area: Rect, places: &[Place], clouds: &[PlaneCloud]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut reach = |at: [f64; 2]| {
            for axis in 0..2 {
                (low[axis], high[axis]) = (low[axis].min(at[axis]), high[axis].max(at[axis]));
            }
        };
        places.iter().for_each(|place| reach(place.at));
        clouds.iter().flat_map(edge).for_each(&mut reach);
        for axis in 0..2 {
            let room = MARGIN * (high[axis] - low[axis]).max(1e-6);
            (low[axis], high[axis]) = (low[axis] - room, high[axis] + room);
        }
        Self { area, low, high }
    }

    pub(in super::super) fn place(&self, at: [f64; 2]) -> Pos2 {
        let share =
            [0, 1].map(|axis| ((at[axis] - self.low[axis]) / (self.high[axis] - self.low[axis])) as f32);
        pos2(
            self.area.left() + share[0] * self.area.width(),
            self.area.bottom() - share[1] * self.area.height(),
        )
    }

    /// The frame whose place is nearest to the pointer, if it is near.
    pub(in super::super) fn frame_at(&self, places: &[Place], pointer: Pos2) -> Option<usize> {
        let distance = |place: &Place| self.place(place.at).distance(pointer);
        let nearest = places.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(nearest) <= REACH).then_some(nearest.frame)
    }
}

/// The edge of one standard deviation about a region's middle.
fn edge(cloud: &PlaneCloud) -> Vec<[f64; 2]> {
    let [xx, yy, xy] = cloud.covariance;
    // Cholesky: the unit circle becomes the ellipse.
    let a = xx.max(0.0).sqrt();
    let b = if a > 0.0 { xy / a } else { 0.0 };
    let c = (yy - b * b).max(0.0).sqrt();
    let corner = |index: usize| {
        let (sin, cos) = (std::f64::consts::TAU * index as f64 / CORNERS as f64).sin_cos();
        [cloud.mean[0] + a * cos, cloud.mean[1] + b * cos + c * sin]
    };
    (0..CORNERS).map(corner).collect()
}

/// The plane; the frame that was clicked.
pub(super) fn ui(ui: &Ui, area: Rect, motions: &Motions, context: &Context<'_>) -> Option<usize> {
    let (found, plane) = (motions.found.as_deref()?, motions.preferences.plane);
    let palette = theme::palette(ui);
    let response = ui.interact(area, Id::unique("plane of motions"), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Plane of motions"));
    ui.painter().rect_filled(area, 0.0, palette.plot);
    let places = places(found, plane);
    let clouds = match plane {
        Plane::Apart => found.recognizer.clouds_apart(),
        Plane::Principal => found.recognizer.clouds.clone(),
    };
    let inner = Rect::from_min_max(area.min + vec2(AXIS, 2.0), area.max - vec2(2.0, AXIS));
    let sheet = Sheet::new(inner, &places, &clouds);
    regions(ui, &sheet, &clouds);
    let strength = if motions.marks.is_stale { FAR } else { 1.0 };
    curve(ui, &sheet, &places, context, strength);
    let now = places.iter().find(|place| place.frame == context.selection.frame);
    let now = now.map(|place| Rect::from_center_size(sheet.place(place.at), Vec2::splat(NOW)));
    let (taken, names) = names(ui, &sheet, found, &clouds, now);
    dots(ui, &sheet, found, &places, context, taken);
    ui.painter().extend(names);
    axes(ui, area, found, plane);
    current(ui, &sheet, found, plane, context.selection.frame);
    let pointer = response.hover_pos();
    let under = pointer.and_then(|pointer| sheet.frame_at(&places, pointer));
    if let Some(place) = under.and_then(|frame| places.iter().find(|place| place.frame == frame)) {
        let at = sheet.place(place.at);
        ui.painter().circle_stroke(at, 5.0, Stroke::new(1.5, palette.text));
        card(ui, found, place.frame, at);
    }
    under.filter(|_| response.clicked())
}

fn regions(ui: &Ui, sheet: &Sheet, clouds: &[PlaneCloud]) {
    let painter = ui.painter().with_clip_rect(sheet.area);
    for (class, cloud) in clouds.iter().enumerate() {
        let colour = motion_colours(Some(class)).fill;
        let corners: Vec<Pos2> = edge(cloud).into_iter().map(|corner| sheet.place(corner)).collect();
        let stroke = Stroke::new(1.0, colour.gamma_multiply(REGION_EDGE));
        painter.add(Shape::convex_polygon(corners, colour.gamma_multiply(REGION), stroke));
    }
}

/// The names of the regions, moved apart where they would lie on one another or on the frame of `now`: where they stand, and what to
/// paint.
fn names(
    ui: &Ui,
    sheet: &Sheet,
    found: &RecognisedMotions,
    clouds: &[PlaneCloud],
    now: Option<Rect>,
) -> (Vec<Rect>, Vec<Shape>) {
    let font = TextStyle::Small.resolve(ui.style());
    let palette = theme::palette(ui);
    let mut taken: Vec<Rect> = now.into_iter().collect();
    let mut shapes = Vec::new();
    for (class, (cloud, name)) in clouds.iter().zip(&found.names).enumerate() {
        let galley = ui.painter().layout_no_wrap(name.clone(), font.clone(), palette.text);
        let middle = sheet.place(cloud.mean);
        let at = |down: f32| {
            let size = galley.size() + vec2(8.0, 0.0);
            let place = Align2::CENTER_CENTER.anchor_size(middle + vec2(0.0, down * (size.y + 1.0)), size);
            let [left, right] = [sheet.area.left() - place.left(), sheet.area.right() - place.right()];
            place.translate(vec2(left.max(0.0) + right.min(0.0), 0.0))
        };
        let is_inside = |place: &Rect| sheet.area.expand(0.5).contains_rect(*place);
        let is_free = |place: &Rect| is_inside(place) && !taken.iter().any(|other| other.intersects(*place));
        let nearby = (0..=clouds.len()).flat_map(|step| [step as f32, -(step as f32)]).map(at);
        // Where the plane is too small for all, the rows below name the colours.
        let Some(place) = nearby.into_iter().find(is_free) else { continue };
        taken.push(place);
        shapes.push(Shape::rect_filled(place, 3.0, palette.plot.gamma_multiply(0.75)));
        let bar = Rect::from_min_max(place.min, pos2(place.left() + 3.0, place.bottom()));
        shapes.push(Shape::rect_filled(bar, 1.0, motion_colours(Some(class)).fill));
        shapes.push(Shape::galley(place.min + vec2(6.0, 0.0), galley, palette.text));
    }
    (taken, shapes)
}

/// The curve, stronger about the frame on the screen.
fn curve(ui: &Ui, sheet: &Sheet, places: &[Place], context: &Context<'_>, strength: f32) {
    let painter = ui.painter().with_clip_rect(sheet.area);
    let near = (NEAR_S * frame_rate(context)) as usize;
    let is_near = |place: &Place| place.frame.abs_diff(context.selection.frame) <= near;
    for strong in [false, true] {
        for pair in places.windows(2).filter(|pair| pair[0].run == pair[1].run) {
            if is_near(&pair[1]) != strong {
                continue;
            }
            let colour = motion_colours(pair[1].class).fill;
            let colour = colour.gamma_multiply(if strong { strength } else { FAR * strength });
            let width = if strong { 2.0 * size::CURVE } else { size::CURVE };
            painter
                .line_segment([sheet.place(pair[0].at), sheet.place(pair[1].at)], Stroke::new(width, colour));
        }
    }
}

fn frame_rate(context: &Context<'_>) -> f64 {
    context.session.take.as_ref().map_or(30.0, |take| take.take().frame_rate())
}

/// A dot every n seconds, with its time where nothing else stands.
fn dots(
    ui: &Ui,
    sheet: &Sheet,
    found: &RecognisedMotions,
    places: &[Place],
    context: &Context<'_>,
    mut taken: Vec<Rect>,
) {
    let palette = theme::palette(ui);
    let rate = frame_rate(context);
    let [first, last] = [places.first(), places.last()].map(|place| place.map_or(0, |place| place.frame));
    let seconds = (last - first) as f64 / rate;
    let steps = [1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 3600.0];
    let step = steps.into_iter().find(|step| seconds / step <= MOST_DOTS as f64).unwrap_or(86_400.0);
    let mut next = 0.0;
    let mut marked = Vec::new();
    for place in places {
        let at_s = place.frame as f64 / rate;
        if at_s + 1e-9 >= next {
            let begun_s = (at_s / step).floor() * step;
            next = begun_s + step;
            marked.push((place, begun_s, sheet.place(place.at)));
        }
    }
    taken.extend(marked.iter().map(|(.., at)| Rect::from_center_size(*at, Vec2::splat(DOT))));
    for (place, begun_s, at) in marked {
        ui.painter().circle(at, 2.5, palette.plot, Stroke::new(1.5, motion_colours(place.class).fill));
        let text = format!("{} s", format::short(begun_s));
        let galley = ui.painter().layout_no_wrap(text, tick().resolve(ui.style()), palette.text2);
        let label = Align2::LEFT_BOTTOM.anchor_size(at + vec2(5.0, -1.0), galley.size());
        if !taken.iter().any(|other| other.intersects(label)) {
            ui.painter().galley(label.min, galley, palette.text2);
            taken.push(label);
        }
        let mark = ui.interact(
            Rect::from_center_size(at, Vec2::splat(8.0)),
            Id::unique(("second of the motion", place.frame)),
            Sense::hover(),
        );
        let name = format!("Frame {} on the plane: {}", place.frame, found.name(place.class));
        mark.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, name.as_str()));
    }
}

fn axes(ui: &Ui, area: Rect, found: &RecognisedMotions, plane: Plane) {
    let palette = theme::palette(ui);
    let [across, up] = words::axes(&found.recognizer, plane);
    let font = tick().resolve(ui.style());
    let corner = area.left_bottom() + vec2(AXIS, -AXIS);
    ui.painter().hline(corner.x..=area.right(), corner.y, palette.hairline());
    ui.painter().vline(corner.x, area.top()..=corner.y, palette.hairline());
    let below = pos2(0.5 * (corner.x + area.right()), area.bottom() - 2.0);
    ui.painter().text(below, Align2::CENTER_BOTTOM, across, font.clone(), palette.text2);
    let galley = ui.painter().layout_no_wrap(up, font, palette.text2);
    let middle = 0.5 * (area.top() + corner.y);
    let start = pos2(area.left() + 2.0, middle + 0.5 * galley.size().x);
    let turned = egui::epaint::TextShape::new(start, galley, palette.text2);
    ui.painter().add(turned.with_angle(-std::f32::consts::FRAC_PI_2));
}

/// The frame on the screen.
fn current(ui: &Ui, sheet: &Sheet, found: &RecognisedMotions, plane: Plane, frame: usize) {
    let Some(named) = found.frame(frame) else { return };
    let at = sheet.place(if plane == Plane::Apart { named.apart } else { named.place });
    let colours = motion_colours(named.class);
    ui.painter().circle(at, 6.5, colours.fill, Stroke::new(3.5, data_colours::CASING));
    ui.painter().circle_stroke(at, 6.5, Stroke::new(2.0, data_colours::SELECTED));
}

fn card(ui: &Ui, found: &RecognisedMotions, frame: usize, at: Pos2) {
    let Some(named) = found.frame(frame) else { return };
    let id = ui.scope_id().with("place of a motion");
    let anchor = PopupAnchor::Position(at);
    Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), id, anchor).gap(10.0).show(|ui| {
        let name = format::capitalised(found.name(named.class));
        ui.label(format!("Frame {}: {name}", format::count(frame as i64)));
        let what = if named.class.is_some() { "probability" } else { found.likeliest(named) };
        ui.label(format!("{} {}", format::capitalised(what), whole_percent(named.confidence)));
        ui.label("Click: go to this frame");
    });
}
