//! The card: what of every camera is free, how far the work is, what was changed and by how much, and how well each camera found
//! is predicted by the others.

use backlit_document::edit::Edit;
use backlit_runs::camera_refinement::{HELD, changes, progress_text};
use backlit_tracking::body_fit::{
    CameraChoice, CameraRefinementProgress, CameraRefinementStep, RefinedCamera,
};
use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    checkbox, hint, primary_button, search_card, work_head, work_progress, work_results, work_row,
};
use egui::{RichText, TextStyle, Ui};

use super::{CameraRefinement, RefinedRig};
use crate::context::command::{Command, HistoryCommand};
use crate::context::{Context, Requests, command_button};

/// Width of the card.
const WIDTH: f32 = 620.0;
/// Where numbers end, from the right edge.
const COLUMNS: [f32; 2] = [110.0, 8.0];
/// A camera stands out whose silhouettes the others predict worse by more than this, as IoU.
const WORSE_BY: f64 = 0.005;

impl CameraRefinement {
    /// Shows the card, and says whether it stays.
    pub(super) fn show(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        if context.session.take.is_none() {
            return false;
        }
        let modal = search_card(ui.ctx(), "camera refinement").show(ui.ctx(), |ui| {
            let text = "The person is followed, beginning in the first frame that has a pose. Then poses, body sizes and \
                        cameras are fitted together to the silhouettes of well-spread frames. Turn and place of each \
                        camera are always free.";
            work_head(ui, WIDTH, "Refine cameras", text);
            if self.work.is_busy() {
                self.progress(ui);
            } else {
                free(ui, &mut self.choice);
                self.outcome(ui, context, requests);
            }
            self.buttons(ui, context, requests)
        });
        let is_left = modal.inner || modal.should_close();
        if is_left {
            self.work.stop();
        }
        !is_left
    }

    fn progress(&self, ui: &mut Ui) {
        let at = self.work.progress().copied();
        let text = at.map_or_else(|| "silhouettes".to_owned(), progress_text);
        work_progress(ui, format::capitalised(&text), at.map_or([0, 1], share));
    }

    fn outcome(&self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        if self.work.outcome().is_none() {
            return;
        }
        ui.add_space(space::WIDGET);
        let Some(rig) = self.work.result() else { return self.work.no_result(ui, "") };
        match self.in_use(context) {
            Some((_, true)) => {
                let text = "In use now: the cameras below. Undo takes them back. Track again with them.";
                ui.label(RichText::new(text).color(palette.ok));
            }
            _ if !self.work.is_current(context) => {
                hint(
                    ui,
                    "What stands below is about other cameras. Refine again to begin with those in use.",
                );
            }
            _ => {}
        }
        work_results(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            held_out(ui, rig);
            ui.add_space(space::WIDGET);
            changed(ui, rig, &rig.choice);
            ui.add_space(space::WIDGET);
            hint(ui, format!("{}.", format::capitalised(HELD)));
            if rig.choice.offset || rig.choice.drift {
                ui.add_space(space::ROW);
                hint(ui, "Clocks are told, not changed. Shift cameras by whole frames with this:");
                ui.add_space(space::ROW);
                command_button::button(ui, context, requests, Command::Offsets);
            }
        });
    }

    /// Whether the card is closed.
    fn buttons(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let in_use = self.in_use(context).map(|(_, is_used)| is_used);
        let is_current = self.work.is_current(context);
        let is_newest = context.history.undo_text() == Some(&*Edit::SetCalibration(None).text());
        let is_old = !is_current && in_use != Some(true);
        let mut is_taken = false;
        let is_closed = self.work.buttons(ui, ("Refine", is_old), |ui| {
            if in_use == Some(true) && is_newest {
                let undo = Command::History(HistoryCommand::Undo);
                command_button::named_button(ui, context, requests, undo, "Undo refinement");
            }
            let tooltip = "Puts these cameras in the place of the take’s; its files stay as they are";
            if in_use == Some(false) && is_current {
                is_taken = primary_button(ui, "Use refined cameras").on_hover_text(tooltip).clicked();
            }
        });
        if is_taken {
            self.use_refined(context, requests);
        }
        is_closed
    }
}

/// What is free beside turn and place.
fn free(ui: &mut Ui, choice: &mut CameraChoice) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::GUTTER_MARGIN;
        for (is_free, name, tooltip) in [
            (&mut choice.focal_length, "Focal length", "One factor on fx and fy of each camera"),
            (&mut choice.principal_point, "Principal point", "cx and cy of each camera"),
            (&mut choice.offset, "Clock offset", "By how much each camera’s clock is late"),
            (&mut choice.drift, "Clock drift", "By how much each camera’s clock goes slow"),
        ] {
            checkbox(ui, is_free, name).on_hover_text(tooltip);
        }
    });
}

/// How much is done, of how much: each round is followed by its stages.
fn share(at: CameraRefinementProgress) -> [usize; 2] {
    let CameraRefinementProgress { round, rounds, step } = at;
    let [done, all] = match step {
        CameraRefinementStep::Following(_) => [0, 1],
        CameraRefinementStep::Body(at) | CameraRefinementStep::Cameras(at) => [at.stage, at.stages],
        CameraRefinementStep::Judging(..) => [1, 1],
    };
    [round * all + done, rounds * all]
}

fn cameras(rig: &RefinedRig) -> impl Iterator<Item = (usize, &RefinedCamera)> {
    rig.cameras.iter().copied().zip(&rig.found.cameras)
}

fn changed(ui: &mut Ui, rig: &RefinedRig, choice: &CameraChoice) {
    let palette = theme::palette(ui);
    head(ui, "Changed", ["by", "±"]);
    for (index, camera) in cameras(rig) {
        for (row, (what, numbers)) in changes(camera, choice).into_iter().enumerate() {
            let badge: &[usize] = if row == 0 { &[index] } else { &[] };
            let words = if row == 0 { format!("{}: {what}", camera.camera.name()) } else { what.to_owned() };
            work_row(ui, (badge, &words), (&numbers, &COLUMNS), (TextStyle::Body, palette.text2));
        }
    }
}

fn held_out(ui: &mut Ui, rig: &RefinedRig) {
    let palette = theme::palette(ui);
    head(ui, "Predicted by the other cameras, IoU in frames held out", ["before", "refined"]);
    for (index, camera) in cameras(rig) {
        let [before, after] = camera.held_out_iou.map(|iou| iou.unwrap_or(f64::NAN));
        let colour = if after < before - WORSE_BY { palette.warn } else { palette.text2 };
        let numbers = [before, after].map(|iou| format::number(iou, 3));
        work_row(ui, (&[index], camera.camera.name()), (&numbers, &COLUMNS), (TextStyle::Body, colour));
    }
    ui.add_space(space::ROW);
    together(ui, rig);
}

/// What all cameras say together.
fn together(ui: &mut Ui, rig: &RefinedRig) {
    let [before, after] = [&rig.found.before, &rig.found.body]
        .map(|body| body.iou[1].map_or_else(String::new, |iou| format::number(iou, 3)));
    let frames = format::counted(rig.found.body.frames.len(), "frame");
    hint(ui, format!("IoU of all cameras in {frames}: {before}, refined {after}."));
}

fn head(ui: &mut Ui, title: &str, columns: [&str; 2]) {
    let style = (TextStyle::Small, theme::palette(ui).text3);
    work_row(ui, (&[], title), (&columns.map(str::to_owned), &COLUMNS), style);
}
