//! A label that says as much as there is room for.

use egui::{Label, Response, RichText, TextStyle, Ui};

/// Shows the first of the texts that fits into the width that is left, the longest first, and nothing where none does:
/// half a sentence is worse. The longest is the tooltip of a shorter one.
pub fn fitting_label(
    ui: &mut Ui,
    texts: &[&str],
    style: TextStyle,
    colour: egui::Color32,
) -> Option<Response> {
    let text = first_that_fits(ui, texts, &style, ui.available_width())?;
    let label = ui.add(Label::new(RichText::new(text).text_style(style).color(colour)).extend());
    Some(if text == texts[0] { label } else { label.on_hover_text(texts[0]) })
}

/// The first of the texts that is no wider than the room.
pub fn first_that_fits<'a>(ui: &Ui, texts: &[&'a str], style: &TextStyle, room: f32) -> Option<&'a str> {
    let font = style.resolve(ui.style());
    let lay_out =
        |text: &str| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), egui::Color32::PLACEHOLDER);
    texts.iter().copied().find(|text| lay_out(text).size().x <= room)
}

#[cfg(test)]
mod tests {
    use egui::{CentralPanel, Color32};

    use super::*;

    #[test]
    fn the_longest_text_that_fits_is_shown() {
        let shown = |width: f32| {
            let mut seen = None;
            let mut window = egui_painter::Headless::new(width, 40.0, 1.0);
            window.run(2, Vec::new(), |ui| {
                CentralPanel::default().show(ui, |ui| {
                    let texts = ["a rather long sentence of words", "a short one"];
                    let label = fitting_label(ui, &texts, TextStyle::Body, Color32::WHITE);
                    seen = label.map(|label| label.rect.width());
                });
            });
            seen
        };
        let [long, short] = [shown(390.0).unwrap(), shown(120.0).unwrap()];
        assert!(long > 150.0 && short < 120.0, "{long} {short}");
        assert_eq!(shown(20.0), None);
    }
}
