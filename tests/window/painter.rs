//! A gallery of the theme in both of its versions.

use crate::support;
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::Theme;
use backlit_ui::widgets::{
    Icon, ValueSlider, camera_badge, checkbox, icon_button, icon_toggle, primary_button, segmented,
};
use egui::{ComboBox, Grid, ProgressBar, Rect, RichText, Slider, TextStyle, Ui, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};

const SIZE: egui::Vec2 = vec2(660.0, 440.0);

struct Gallery {
    limb: &'static str,
    weight: f64,
    flexion: f64,
    used: bool,
    renderer: &'static str,
    name: String,
}

impl Default for Gallery {
    fn default() -> Self {
        Self {
            limb: "Arm",
            weight: 0.42,
            flexion: 1.48,
            used: true,
            renderer: "Capsule",
            name: "Balancing".to_owned(),
        }
    }
}

impl Gallery {
    fn ui(&mut self, ui: &mut Ui) {
        egui::CentralPanel::default().show(ui, |ui| {
            ui.columns_const(|[left, right]| {
                self.controls(left);
                Self::text(right);
            });
            ui.add_space(theme::space::GROUP);
            ui.separator();
            icons(ui);
        });
    }

    fn controls(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            primary_button(ui, "Track forward");
            let _ = ui.button("Mirror");
            ui.add_enabled(false, egui::Button::new("Refit"));
        });
        ui.horizontal(|ui| {
            segmented(ui, &mut self.limb, &[("Limb", "Limb"), ("Arm", "Arm"), ("Body", "Body")]);
        });
        ui.horizontal(|ui| {
            for index in 0..9 {
                camera_badge(ui, index);
            }
        });
        ui.horizontal(|ui| {
            let label = ui.label("Weight");
            ui.add(Slider::new(&mut self.weight, 0.0..=1.0)).labelled_by(label.id);
        });
        ui.horizontal(|ui| {
            ui.label("Flexion");
            let slider = ValueSlider::new(&mut self.flexion, -0.4..=2.6, "Flexion");
            let limits = Some((-0.2, 2.4, 0.05));
            ui.add(ValueSlider { origin: 0.0, limits, is_held: true, ..slider });
            ui.add(ValueSlider {
                limits: Some((0.3, 2.4, 0.05)),
                width: 90.0,
                ..ValueSlider::new(&mut 2.4, 0.0..=3.0, "Twist")
            });
        });
        ui.horizontal(|ui| {
            checkbox(ui, &mut self.used, "Used in the fit");
            checkbox(ui, &mut false, "Both sides");
            ui.add_enabled_ui(false, |ui| checkbox(ui, &mut true, "Pinned"));
        });
        ui.horizontal(|ui| {
            ui.radio_value(&mut self.renderer, "Capsule", "Capsule");
            ui.radio_value(&mut self.renderer, "Cylinder", "Cylinder");
        });
        ui.horizontal(|ui| {
            ComboBox::from_label("Renderer").selected_text(self.renderer).show_ui(ui, |_| {});
        });
        ui.horizontal(|ui| {
            let label = ui.label("Take");
            ui.text_edit_singleline(&mut self.name).labelled_by(label.id);
        });
        let _ = ui.selectable_label(true, "Right forearm");
        ui.add(ProgressBar::new(0.44).desired_width(160.0).text("31 of 70"));
    }

    fn text(ui: &mut Ui) {
        let palette = theme::palette(ui);
        ui.label(RichText::new("Renderer laboratory").text_style(theme::title()));
        ui.label(RichText::new("Capsule").text_style(theme::column_heading()));
        ui.heading("Observability");
        ui.label("A round end fades out over a band.");
        ui.small("Last refit: cost 6.4e7 to 5.1e7");
        ui.label(RichText::new("Seen from the side, a flat end").text_style(theme::caption()));
        ui.label(RichText::new(format::ratio(0.8042)).text_style(theme::headline()));
        ui.label(RichText::new("0   10   20   30").text_style(theme::tick()).color(palette.text2));
        Grid::new("numbers").num_columns(2).show(ui, |ui| {
            for (name, value) in [
                ("Spurious", format::count(1_074)),
                ("Flexion", format::degrees(-0.1466)),
                ("Wrist at", format::metres(-1.028)),
                ("Cost", format::cost(2.1e-7)),
                ("Fell by", format::percent(0.317)),
            ] {
                ui.label(RichText::new(name).color(palette.text2));
                ui.monospace(value);
                ui.end_row();
            }
        });
        let words = [
            ("text2", palette.text2),
            ("text3", palette.text3),
            ("accent", palette.accent_text),
            ("info", palette.info),
            ("warn", palette.warn),
            ("error", palette.error),
            ("ok", palette.ok),
        ];
        ui.horizontal(|ui| {
            for (word, colour) in words {
                ui.label(RichText::new(word).text_style(TextStyle::Small).color(colour));
            }
        });
    }
}

fn icons(ui: &mut Ui) {
    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
    ui.horizontal_wrapped(|ui| {
        for icon in Icon::ALL {
            let name = format!("{icon:?}");
            if icon == Icon::Link {
                icon_toggle(ui, icon, &name, "Zoom all pictures together", &mut true);
            } else {
                icon_button(ui, icon, &name, &name);
            }
        }
    });
    ui.add_space(theme::space::WIDGET);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 10.0), egui::Sense::hover());
    let columns = rect.width() as usize;
    for column in 0..columns {
        let share = column as f32 / (columns - 1) as f32;
        let at = |top: f32| Rect::from_min_size(rect.min + vec2(column as f32, top), vec2(1.0, 5.0));
        ui.painter().rect_filled(at(0.0), 0, theme::residual_colour(share * 510.0 - 255.0));
        ui.painter().rect_filled(at(5.0), 0, theme::gradient_colour(share));
    }
}

fn gallery_snapshot(theme: Theme) {
    let mut harness = support::harness_builder(SIZE, theme)
        .build_ui_state(|ui, gallery: &mut Gallery| gallery.ui(ui), Gallery::default());
    harness.run();
    let picture = harness.render().expect("the CPU painter does not fail");
    Snapshots::default().picture(&picture, &format!("gallery_{}", theme_name(theme)));
}

#[test]
fn the_gallery_in_the_dark_theme() {
    gallery_snapshot(Theme::Dark);
}

#[test]
fn the_gallery_in_the_light_theme() {
    gallery_snapshot(Theme::Light);
}

#[test]
fn widgets_answer_to_their_names() {
    let mut harness = support::harness_builder(SIZE, Theme::Dark)
        .build_ui_state(|ui, gallery: &mut Gallery| gallery.ui(ui), Gallery::default());
    harness.get_by_label("Body").click();
    harness.run();
    assert_eq!(harness.state().limb, "Body");
    harness.get_by_label("Used in the fit").click();
    harness.run();
    assert!(!harness.state().used);
    harness.get_by_role_and_label(egui::Role::Slider, "Flexion").focus();
    harness.run();
    harness.key_press(egui::Key::ArrowRight);
    harness.run();
    assert!((harness.state().flexion - 1.51).abs() < 1e-9, "{}", harness.state().flexion);
}
