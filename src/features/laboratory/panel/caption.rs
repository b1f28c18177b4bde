//! Why they differ, in words, and what the colours of the pictures mean.

use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{
    NO_GRADIENT, PICTURE_GROUND, REPORT_BOTH, REPORT_DATA, REPORT_MODEL,
};
use backlit_ui::style::theme::residual_colour;
use egui::{
    Color32, Rect, RichText, ScrollArea, Sense, Separator, StrokeKind, TextFormat, Ui, text::LayoutJob, vec2,
};

use super::{Bench, Wish};
use crate::features::laboratory::story::tell;
use crate::features::laboratory::{Lineup, StartChoice};

/// Size of a swatch.
const SWATCH: egui::Vec2 = vec2(40.0, 11.0);
/// Line height of the caption where there is little room.
const COMPACT_LINE: f32 = 17.0;
/// Height of a row of the legend there, with what is between two.
const COMPACT_ROW: f32 = 21.0;

/// The caption and the legend; what has no room is scrolled to.
pub(crate) fn ui(ui: &mut Ui, bench: &Bench<'_>, wishes: &mut Vec<Wish>) {
    let palette = theme::palette(ui);
    let laboratory = bench.laboratory;
    let story = tell(bench.comparison, laboratory.lineup, bench.key);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = if bench.room.is_compact { 4.0 } else { 8.0 };
        let title = if bench.room.is_compact { theme::column_heading() } else { theme::title() };
        ui.label(RichText::new(&story.title).text_style(title).color(palette.text));
        let errors = story.errors.iter().filter(|_| !bench.room.is_compact);
        for paragraph in story.paragraphs.iter().chain(errors) {
            text(ui, paragraph, bench.room.is_compact);
        }
        ui.add(Separator::default().spacing(if bench.room.is_compact { 5.0 } else { 6.0 }));
        if bench.room.is_compact {
            ui.spacing_mut().interact_size.y = COMPACT_LINE;
            ui.spacing_mut().item_spacing.y = 2.0;
        }
        legend(ui, bench);
        next(ui, bench, wishes);
    });
}

fn text(ui: &mut Ui, paragraph: &str, is_compact: bool) {
    let (style, line_height) = if is_compact {
        (egui::TextStyle::Body, COMPACT_LINE)
    } else {
        (theme::caption(), theme::CAPTION_LINE_HEIGHT)
    };
    let format = TextFormat {
        font_id: style.resolve(ui.style()),
        color: theme::palette(ui).text,
        line_height: Some(line_height),
        ..TextFormat::default()
    };
    let mut job = LayoutJob::default();
    job.append(paragraph, 0.0, format);
    ui.label(job);
}

fn legend(ui: &mut Ui, bench: &Bench<'_>) {
    row(ui, &format!("Darkens / lightens as the {}", moving(bench)), |ui, rect| {
        for step in 0..rect.width() as usize {
            let share = step as f32 / rect.width() * 2.0 - 1.0;
            let colour = residual_colour(share * 255.0);
            let bar = Rect::from_min_size(rect.min + vec2(step as f32, 0.0), vec2(1.0, rect.height()));
            ui.painter().rect_filled(bar, 0.0, colour);
        }
    });
    row(ui, "In the ramp, but does not push", |ui, rect| {
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, PICTURE_GROUND);
        let mut x = rect.left() - rect.height();
        while x < rect.right() {
            let line = [egui::pos2(x, rect.bottom()), egui::pos2(x + rect.height(), rect.top())];
            painter.line_segment(line, egui::Stroke::new(1.6, NO_GRADIENT));
            x += 6.0;
        }
    });
    // The pictures say that themselves: with many words above, what follows needs the room.
    let room = ui.clip_rect().bottom() - ui.cursor().top();
    if bench.room.is_compact && room < 2.0 * COMPACT_ROW {
        return;
    }
    row(ui, "Data only / model only / both", |ui, rect| {
        for (index, grey) in [REPORT_DATA, REPORT_MODEL, REPORT_BOTH].into_iter().enumerate() {
            let corner = rect.min + vec2(14.0 * index as f32, 0.0);
            let swatch = Rect::from_min_size(corner, vec2(12.0, rect.height()));
            let stroke = theme::palette(ui).edge();
            ui.painter().rect(swatch, 0.0, Color32::from_gray(grey), stroke, StrokeKind::Inside);
        }
    });
}

fn moving(bench: &Bench<'_>) -> String {
    use crate::features::laboratory::PushAxis;
    match bench.axis {
        PushAxis::Move(_) => bench.axis.text().to_owned(),
        _ => format!("{} {}", bench.limb, bench.axis.text()),
    }
}

fn row(ui: &mut Ui, words: &str, paint: impl FnOnce(&Ui, Rect)) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(SWATCH, Sense::hover());
        paint(ui, rect);
        let text = RichText::new(words).color(theme::palette(ui).text2);
        ui.add(egui::Label::new(text).truncate());
    });
}

/// What to try next, as a link.
fn next(ui: &mut Ui, bench: &Bench<'_>, wishes: &mut Vec<Wish>) {
    let laboratory = bench.laboratory;
    let demonstration = bench.context.session.demonstration();
    let offered = StartChoice::offered(demonstration);
    let at = offered.iter().position(|start| *start == laboratory.start).unwrap_or(0);
    let other = offered[(at + offered.len() - 1) % offered.len()];
    let lineup = Lineup::ALL[(Lineup::ALL.iter().position(|(l, _)| *l == laboratory.lineup).unwrap_or(0)
        + 1)
        % Lineup::ALL.len()];
    ui.horizontal_wrapped(|ui| {
        let palette = theme::palette(ui);
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(RichText::new("Next:").color(palette.accent_text));
        let link =
            |ui: &mut Ui, text: String| ui.link(RichText::new(text).color(palette.accent_text)).clicked();
        let text = other.text();
        if link(ui, text[..1].to_lowercase() + &text[1..]) {
            wishes.push(Wish::Start(other));
        }
        ui.label(RichText::new("or").color(palette.accent_text));
        if link(ui, format!("compare {}", lineup.1.to_lowercase())) {
            wishes.push(Wish::Lineup(lineup.0));
        }
    });
}
