//! The demonstration that is open: its fits in the laboratory, its sentences, and what to try next.

mod next;

use backlit_formats::Footage;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{Icon, icon_button};
use egui::{
    Align, Button, Frame, Label, Layout as Direction, Margin, Panel, RichText, Role, Sense, Ui, WidgetInfo,
    vec2,
};

use self::next::Opening;
use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::preferences::Layout;
use crate::context::unavailable::Why;
use crate::context::unavailable::because;
use crate::context::{Context, DesktopRequest, FeatureRequest, PaneEvent, Requests, ShellRequest};

#[derive(Debug, Default, Clone)]
pub(crate) struct Demonstrations {
    /// Which one is explained, until that is closed.
    explained: Option<Demonstration>,
}

impl Feature for Demonstrations {
    fn run(&mut self, command: Command, _: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Demonstration(which) = command else { return false };
        requests.request(DesktopRequest::Open(TakeSource::Demonstration(which)));
        true
    }

    fn unavailable(&self, command: Command, _: &Context<'_>) -> Why {
        let Command::Demonstration(which) = command else { return None };
        let missing = "BACKLIT_DATA does not name a folder that has the real footage";
        because(!which.is_available(), missing)
    }

    fn reset(&mut self, _: &Footage) {
        self.explained = None;
    }

    fn at_rest(&self) -> Self {
        self.clone()
    }
}

impl Demonstrations {
    /// Arranges the window for a demonstration that has just been opened.
    pub(crate) fn begin(&mut self, which: Demonstration, requests: &mut Requests) {
        requests.request(ShellRequest::CloseNotices);
        self.explained = Some(which);
        match next::of(which).0 {
            Opening::Laboratory(over, camera) => {
                requests.request(ShellRequest::Layout(Layout::Demonstrate));
                requests.request(FeatureRequest::RunLaboratory { over, camera: Some(camera) });
            }
            Opening::Tiles(pane, command) => {
                requests.request(ShellRequest::Layout(Layout::Pose));
                if let Some(pane) = pane {
                    requests.request(ShellRequest::Pane(pane, PaneEvent::Open));
                }
                requests.run(command);
            }
        }
    }

    /// What the demonstration shows and what to try, above the cameras' views or the laboratory, until it is closed.
    pub(crate) fn ui(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        if self.explained.is_some_and(|which| explanation(ui, which, context, requests)) {
            self.explained = None;
        }
    }
}

/// The sentences with a button for each thing to try, as wide as the centre; whether they are closed.
fn explanation(ui: &mut Ui, which: Demonstration, context: &Context<'_>, requests: &mut Requests) -> bool {
    let mut is_closed = false;
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.raised).inner_margin(Margin::symmetric(10, 6));
    Panel::top("explanation").resizable(false).show_separator_line(true).frame(frame).show(ui, |ui| {
        ui.with_layout(Direction::right_to_left(Align::Min), |ui| {
            is_closed = icon_button(ui, Icon::Close, "Close explanation", "Close").clicked();
            ui.with_layout(Direction::left_to_right(Align::Min), |ui| {
                let (rect, mark) = ui.allocate_exact_size(vec2(size::ICON, size::BUTTON), Sense::hover());
                mark.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Explanation"));
                Icon::Info.paint(ui.painter(), rect, palette.info);
                ui.add_space(space::ROW);
                ui.vertical(|ui| {
                    ui.add(Label::new(RichText::new(which.explanation()).color(palette.text)).wrap());
                    ui.horizontal_wrapped(|ui| {
                        for suggestion in next::of(which).1 {
                            let is_active = suggestion.is_active(context);
                            let button = ui.add(Button::new(suggestion.text).selected(is_active));
                            if button.on_hover_text(suggestion.tooltip()).clicked() {
                                suggestion.request(which, context, requests);
                            }
                        }
                    });
                });
            });
        });
    });
    is_closed
}
