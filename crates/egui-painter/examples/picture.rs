//! Runs a small app without a window, clicks in it, and writes its picture.
//!
//! `cargo run -p egui-painter --example picture -- picture.png`

use egui::{CentralPanel, Event, Modifiers, PointerButton, Pos2, ProgressBar, Slider, Ui};
use egui_painter::Headless;

struct Greeter {
    name: String,
    years: u32,
    button: Pos2,
}

impl Greeter {
    fn ui(&mut self, ui: &mut Ui) {
        CentralPanel::default().show(ui, |ui| {
            ui.heading("No display here");
            ui.horizontal(|ui| {
                ui.label("Name");
                ui.text_edit_singleline(&mut self.name);
            });
            ui.add(Slider::new(&mut self.years, 0..=120).text("years"));
            let older = ui.button("A year older");
            self.button = older.rect.center();
            self.years += u32::from(older.clicked());
            ui.add(ProgressBar::new(self.years as f32 / 120.0).show_percentage());
            ui.label(format!("{} is {} years old.", self.name, self.years));
        });
    }
}

fn main() -> Result<(), image::ImageError> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "picture.png".to_owned());
    let mut app = Greeter { name: "Ada".to_owned(), years: 36, button: Pos2::ZERO };
    let mut window = Headless::new(320.0, 200.0, 2.0);
    window.run(2, Vec::new(), |ui| app.ui(ui));

    let pos = app.button;
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let click = vec![Event::PointerMoved(pos), button(true), button(false)];
    let image = window.frames(3, click, |ui| app.ui(ui));
    println!("{path}: {} × {} pixels, {} is {}", image.width(), image.height(), app.name, app.years);
    image.save(path)
}
