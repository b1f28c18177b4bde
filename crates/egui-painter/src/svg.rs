//! What egui paints as a drawing of lines and letters, for papers: sharp at any size, and words stay words.

use std::fmt::Write;

use egui::epaint::text::PlacedRow;
use egui::epaint::{ClippedShape, ColorMode, Mesh, TextShape, TextureId};
use egui::{Color32, FontFamily, Pos2, Rect, Shape, Stroke, Vec2};

/// Letters of a font that only egui has are set in one that looks like it.
const PROPORTIONAL: &str = "Inter, Helvetica, Arial, sans-serif";
const MONOSPACE: &str = "JetBrains Mono, Menlo, Consolas, monospace";

/// Shapes as an SVG of `size` points, a pixel each, on a ground of one colour.
///
/// Rectangles, circles, lines, curves and letters are drawn as such, letters in fonts of the reader's system, as wide as
/// egui has set them. Meshes without a texture become triangles of one colour each. Pictures and paint callbacks are
/// left out.
#[must_use]
pub fn svg(shapes: &[ClippedShape], size: Vec2, background: Color32) -> String {
    let whole = Rect::from_min_size(Pos2::ZERO, size);
    let mut drawing = Drawing { text: String::new(), clips: 0 };
    let [width, height] = [size.x, size.y].map(number);
    drawing.push(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">"
    ));
    drawing.push(format_args!("<rect width=\"{width}\" height=\"{height}\"{}/>", fill(background)));
    for ClippedShape { clip_rect, shape, transform_after_tessellation } in shapes {
        let clip = clip_rect.intersect(whole);
        if !clip.is_positive() || matches!(shape, Shape::Noop) {
            continue;
        }
        let needs_clip = !clip.contains_rect(shape.visual_bounding_rect().intersect(whole));
        if needs_clip {
            drawing.clips += 1;
            let id = drawing.clips;
            drawing.push(format_args!(
                "<clipPath id=\"c{id}\"><rect{}/></clipPath><g clip-path=\"url(#c{id})\">",
                rect(clip)
            ));
        }
        let mut shape = shape.clone();
        shape.transform(*transform_after_tessellation);
        drawing.shape(&shape);
        if needs_clip {
            drawing.push(format_args!("</g>"));
        }
    }
    drawing.push(format_args!("</svg>"));
    drawing.text
}

struct Drawing {
    text: String,
    clips: usize,
}

impl Drawing {
    fn push(&mut self, line: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(line);
        self.text.push('\n');
    }

    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Noop | Shape::Callback(_) | Shape::Band(_) => {}
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| self.shape(shape)),
            Shape::Circle(circle) => {
                let [x, y, r] = [circle.center.x, circle.center.y, circle.radius].map(number);
                let look = format!("{}{}", fill(circle.fill), stroke(circle.stroke));
                self.push(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{look}/>"));
            }
            Shape::Ellipse(ellipse) => {
                let [x, y] = [ellipse.center.x, ellipse.center.y].map(number);
                let [rx, ry] = [ellipse.radius.x, ellipse.radius.y].map(number);
                let turn = number(ellipse.angle.to_degrees());
                let look = format!("{}{}", fill(ellipse.fill), stroke(ellipse.stroke));
                self.push(format_args!(
                    "<ellipse cx=\"{x}\" cy=\"{y}\" rx=\"{rx}\" ry=\"{ry}\" transform=\"rotate({turn} {x} {y})\"{look}/>"
                ));
            }
            Shape::LineSegment { points: [a, b], stroke: line } => {
                let [x1, y1, x2, y2] = [a.x, a.y, b.x, b.y].map(number);
                let look = stroke(*line);
                self.push(format_args!("<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"{look}/>"));
            }
            Shape::Path(path) => {
                let look = format!("{}{}", fill(path.fill), path_stroke(&path.stroke));
                let points = points(&path.points);
                let name = if path.closed { "polygon" } else { "polyline" };
                self.push(format_args!("<{name} points=\"{points}\"{look}/>"));
            }
            Shape::Rect(shape) => {
                let radius = shape.corner_radius.average();
                let radius = if radius > 0.0 { format!(" rx=\"{}\"", number(radius)) } else { String::new() };
                let look = format!("{}{}", fill(shape.fill), stroke(shape.stroke));
                self.push(format_args!("<rect{}{radius}{look}/>", rect(shape.rect)));
            }
            Shape::Text(text) => text.galley.rows.iter().for_each(|row| self.row(text, row)),
            Shape::Mesh(mesh) => self.mesh(mesh),
            Shape::QuadraticBezier(curve) => {
                let look = format!("{}{}", fill(curve.fill), path_stroke(&curve.stroke));
                let [a, b, c] = curve.points.map(point);
                self.push(format_args!("<path d=\"M{a} Q{b} {c}\"{look}/>"));
            }
            Shape::CubicBezier(curve) => {
                let look = format!("{}{}", fill(curve.fill), path_stroke(&curve.stroke));
                let [a, b, c, d] = curve.points.map(point);
                self.push(format_args!("<path d=\"M{a} C{b} {c} {d}\"{look}/>"));
            }
        }
    }

    /// A row, in pieces of one colour.
    fn row(&mut self, shape: &TextShape, row: &PlacedRow) {
        let Some(format) = shape.galley.job.sections.first().map(|section| &section.format) else { return };
        let family = match format.font_id.family {
            FontFamily::Monospace => MONOSPACE,
            FontFamily::Proportional | FontFamily::Name(_) => PROPORTIONAL,
        };
        let size = number(format.font_id.size);
        let colour_of = |first_vertex: u32| {
            let own = row.visuals.mesh.vertices.get(first_vertex as usize).map(|vertex| vertex.color);
            match (shape.override_text_color, own) {
                (Some(colour), _) => colour,
                (None, Some(own)) if own != Color32::PLACEHOLDER => own,
                _ => shape.fallback_color,
            }
        };
        let mut rest = &row.glyphs[..];
        while let Some(first) = rest.first() {
            let colour = colour_of(first.first_vertex);
            let same = |glyph: &&egui::epaint::text::Glyph| {
                glyph.chr == ' ' || colour_of(glyph.first_vertex) == colour
            };
            let count = rest.iter().take_while(same).count().max(1);
            let (piece, later) = rest.split_at(count);
            rest = later;
            let text: String = piece.iter().map(|glyph| glyph.chr).collect();
            if text.trim().is_empty() {
                continue;
            }
            let width: f32 = piece.iter().map(|glyph| glyph.advance_width).sum();
            let at = shape.pos + row.pos.to_vec2() + first.pos.to_vec2();
            let [x, y, width] = [at.x, at.y, width].map(number);
            let turn = if shape.angle == 0.0 {
                String::new()
            } else {
                let [px, py] = [shape.pos.x, shape.pos.y].map(number);
                format!(" transform=\"rotate({} {px} {py})\"", number(shape.angle.to_degrees()))
            };
            let look = fill(colour.gamma_multiply(shape.opacity_factor));
            self.push(format_args!(
                "<text x=\"{x}\" y=\"{y}\" font-family=\"{family}\" font-size=\"{size}\" textLength=\"{width}\" \
                 lengthAdjust=\"spacingAndGlyphs\" xml:space=\"preserve\"{turn}{look}>{}</text>",
                escaped(&text)
            ));
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        if mesh.texture_id != TextureId::default() {
            return;
        }
        for corners in mesh.indices.chunks_exact(3) {
            let corner = |index: usize| mesh.vertices.get(corners[index] as usize);
            let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
            let points = points(&[a.pos, b.pos, c.pos]);
            self.push(format_args!("<polygon points=\"{points}\"{}/>", fill(a.color)));
        }
    }
}

/// A number without needless digits.
fn number(value: f32) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn point(at: Pos2) -> String {
    format!("{} {}", number(at.x), number(at.y))
}

fn points(all: &[Pos2]) -> String {
    let all: Vec<String> = all.iter().map(|at| format!("{},{}", number(at.x), number(at.y))).collect();
    all.join(" ")
}

fn rect(rect: Rect) -> String {
    let [x, y, width, height] = [rect.min.x, rect.min.y, rect.width(), rect.height()].map(number);
    format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

/// A colour as it is written, and how opaque it is. egui's colours are premultiplied.
fn colour(colour: Color32) -> (String, Option<String>) {
    let [r, g, b, a] = colour.to_srgba_unmultiplied();
    let opacity = (a < 255).then(|| number(f32::from(a) / 255.0));
    (format!("#{r:02x}{g:02x}{b:02x}"), opacity)
}

fn fill(of: Color32) -> String {
    if of.a() == 0 {
        return " fill=\"none\"".to_owned();
    }
    let (colour, opacity) = colour(of);
    let opacity = opacity.map_or_else(String::new, |opacity| format!(" fill-opacity=\"{opacity}\""));
    format!(" fill=\"{colour}\"{opacity}")
}

fn stroke(line: Stroke) -> String {
    if line.width <= 0.0 || line.color.a() == 0 {
        return String::new();
    }
    let (colour, opacity) = colour(line.color);
    let opacity = opacity.map_or_else(String::new, |opacity| format!(" stroke-opacity=\"{opacity}\""));
    format!(" stroke=\"{colour}\" stroke-width=\"{}\"{opacity}", number(line.width))
}

fn path_stroke(line: &egui::epaint::PathStroke) -> String {
    match line.color {
        ColorMode::Solid(colour) => stroke(Stroke::new(line.width, colour)),
        ColorMode::UV(_) => String::new(),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use egui::{CentralPanel, RichText, pos2};

    use crate::Headless;

    #[test]
    fn words_lines_and_rings_are_what_they_are() {
        let mut window = Headless::new(120.0, 60.0, 1.0);
        let svg = window.svg(3, Vec::new(), |ui| {
            CentralPanel::default().show(ui, |ui| {
                ui.label(RichText::new("a < b & c").color(egui::Color32::RED));
                let painter = ui.painter();
                painter.circle_stroke(pos2(40.0, 40.0), 5.0, (1.5, egui::Color32::BLUE));
                painter.line_segment([pos2(1.0, 2.0), pos2(3.25, 4.0)], (1.0, egui::Color32::GREEN));
            });
        });
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{svg}");
        assert!(svg.contains(">a &lt; b &amp; c</text>") && svg.contains("fill=\"#ff0000\""), "{svg}");
        assert!(
            svg.contains("<circle cx=\"40\" cy=\"40\" r=\"5\" fill=\"none\" stroke=\"#0000ff\""),
            "{svg}"
        );
        assert!(svg.contains("<line x1=\"1\" y1=\"2\" x2=\"3.25\" y2=\"4\" stroke=\"#00ff00\""), "{svg}");
    }
}
