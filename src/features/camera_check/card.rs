//! The card: what is being done, what is wrong with which camera and what can be done about it, and how far every two cameras
//! agree.

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_runs::camera_check::{FindingWords, NOTHING_WRONG, is_repairable};
use backlit_runs::changes::change_text;
use backlit_tracking::camera::Camera;
use backlit_tracking::diagnosis::{Diagnosis, FaultKind, Finding, PairAgreement};
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    camera_badge, hint, primary_button, search_card, text_button, work_head, work_progress, work_results,
    work_row,
};
use egui::{RichText, TextStyle, Ui, vec2};

use super::{CameraCheck, look_at};
use crate::context::command::{Command, HistoryCommand};
use crate::context::{Context, Requests, SessionRequest, ShellRequest, command_button};

/// Width of the card.
const WIDTH: f32 = 620.0;
/// Where the numbers of two cameras end, from the right edge: without keypoints and with them.
const COLUMNS: [f32; 3] = [220.0, 110.0, 8.0];
const KEYPOINT_COLUMNS: [f32; 5] = [380.0, 290.0, 190.0, 90.0, 8.0];
/// Two cameras stand out that a repair brings together by more than this factor.
const WRONG_FROM: f64 = 2.0;

impl CameraCheck {
    /// Shows the card, and says whether it stays.
    pub(super) fn show(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Some(take) = context.session.take.clone() else { return false };
        let modal = search_card(ui.ctx(), "camera check").show(ui.ctx(), |ui| {
            let text = "What all cameras see of the person must fit together. Where it does not, every usual fault is \
                        tried, and the likeliest is told. The person must move.";
            work_head(ui, WIDTH, "Check cameras", text);
            if self.work.is_busy() {
                self.progress(ui);
            } else {
                self.outcome(ui, &take, context, requests);
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
        match self.work.progress().copied() {
            None => work_progress(ui, "Silhouettes", [0, 1]),
            Some((stage, done)) => work_progress(ui, stage.text(done), done),
        }
    }

    fn outcome(&mut self, ui: &mut Ui, take: &Footage, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        if let Some(what) = self.repaired_now(context) {
            let text = format!("In use now: cameras with this repaired: {what}. Undo takes it back.");
            ui.label(RichText::new(text).color(palette.ok));
        }
        let Some(found) = self.work.result() else {
            return self.work.no_result(ui, "The check was stopped.");
        };
        let is_current = self.work.is_current(context);
        if !is_current {
            hint(ui, "What stands below is about the cameras before. Check again to see what is left.");
            ui.add_space(space::WIDGET);
        }
        let mut used = None;
        work_results(ui, |ui| {
            let cameras = take.take().rig().cameras();
            used = findings(ui, take, &found.diagnosis, is_current, context, requests);
            changes(ui, take, &found.changes, requests);
            pairs(ui, cameras, &found.diagnosis);
        });
        if let Some(index) = used {
            let findings = found.diagnosis.findings[..=index].to_vec();
            self.use_repaired(&findings, context, requests);
        }
    }

    /// Whether the card is closed.
    fn buttons(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_newest = context.history.undo_text() == Some(&*Edit::SetCalibration(None).text());
        let has_undo = is_newest && self.repaired_now(context).is_some();
        let is_old = !self.work.is_current(context);
        self.work.buttons(ui, ("Check", is_old), |ui| {
            if has_undo {
                let undo = Command::History(HistoryCommand::Undo);
                command_button::named_button(ui, context, requests, undo, "Undo repair");
            }
            command_button::button(ui, context, requests, Command::CameraRefinement);
        })
    }
}

/// What was found; the index of the one whose repair is to be used.
fn findings(
    ui: &mut Ui,
    take: &Footage,
    found: &Diagnosis,
    is_current: bool,
    context: &Context<'_>,
    requests: &mut Requests,
) -> Option<usize> {
    let palette = theme::palette(ui);
    if found.findings.is_empty() {
        let text = format!("{}.", format::capitalised(NOTHING_WRONG));
        ui.label(RichText::new(text).color(palette.ok));
    }
    let take = take.take();
    let last = found.findings.iter().rposition(|finding| is_repairable(finding.kind));
    let mut used = None;
    for (index, finding) in found.findings.iter().enumerate() {
        ui.horizontal_top(|ui| {
            match finding.camera {
                Some(camera) => {
                    camera_badge(ui, camera);
                }
                None => {
                    ui.allocate_space(vec2(size::BADGE, size::BADGE));
                }
            }
            ui.vertical(|ui| {
                finding_text(ui, finding, take.rig().cameras(), context, requests);
                if !is_current {
                    return;
                }
                ui.add_space(space::ROW);
                if finding.kind == FaultKind::Offset {
                    command_button::button(ui, context, requests, Command::Offsets);
                }
                if is_repairable(finding.kind) {
                    let text = "Use repaired cameras";
                    let button =
                        if last == Some(index) { primary_button(ui, text) } else { text_button(ui, text) };
                    let tooltip = match index {
                        0 => "Puts cameras with this repaired in the place of the take’s; its files stay as they are",
                        _ => {
                            "Puts cameras with this and what stands above it repaired in the place of the take’s; its files \
                             stay as they are"
                        }
                    };
                    if button.on_hover_text(tooltip).clicked() {
                        used = Some(index);
                    }
                }
            });
        });
        ui.add_space(space::WIDGET);
    }
    if take.rig().count() == 2 && !found.findings.is_empty() {
        hint(ui, "Two cameras show that something is wrong, but not in which.");
    }
    used
}

/// A finding in words.
fn finding_text(
    ui: &mut Ui,
    finding: &Finding,
    cameras: &[Camera],
    context: &Context<'_>,
    requests: &mut Requests,
) {
    let palette = theme::palette(ui);
    let words = FindingWords::of(finding, cameras);
    let sentence = |text: &str| RichText::new(format!("{}.", format::capitalised(text)));
    match finding.camera {
        Some(_) => {
            let tooltip = match finding.since_s {
                Some(_) => "Select this camera, and go to the frame from which on it is wrong",
                None => "Select this camera",
            };
            if ui.link(RichText::new(words.what).color(palette.text)).on_hover_text(tooltip).clicked() {
                look_at(finding, context, requests);
            }
        }
        None => {
            ui.label(sentence(&words.what).color(palette.text));
        }
    }
    if !words.sizes.is_empty() {
        ui.label(RichText::new(format::capitalised(&words.sizes)).color(palette.text2));
    }
    for line in words.apart.iter().chain(&words.rivals) {
        ui.label(sentence(line).small().color(palette.text2));
    }
    if let Some(advice) = words.advice {
        ui.label(sentence(advice).small().color(palette.warn));
    }
}

/// Backgrounds that change; a click goes to the frame.
fn changes(ui: &mut Ui, take: &Footage, found: &[BackgroundChange], requests: &mut Requests) {
    let palette = theme::palette(ui);
    for change in found {
        ui.horizontal_top(|ui| {
            camera_badge(ui, change.camera);
            let text = RichText::new(change_text(change, take.take())).color(palette.text);
            if ui.link(text).on_hover_text("Select this camera, and go to the frame").clicked() {
                requests.request(ShellRequest::Camera(change.camera));
                requests.request(SessionRequest::Frame(change.from));
            }
        });
        ui.add_space(space::WIDGET);
    }
}

/// How far every two cameras agree, and how large the subject is.
fn pairs(ui: &mut Ui, cameras: &[Camera], found: &Diagnosis) {
    let palette = theme::palette(ui);
    ui.spacing_mut().item_spacing.y = 0.0;
    let has_keypoints = found.keypoint_noise_px.is_some();
    let (titles, columns): (&[&str], &[f32]) = match has_keypoints {
        false => (&["apart, px", "repaired, px", "of the frames, %"], &COLUMNS),
        true => {
            (&["silhouettes, px", "repaired", "keypoints, px", "repaired", "frames, %"], &KEYPOINT_COLUMNS)
        }
    };
    let titles: Vec<String> = titles.iter().map(|title| (*title).to_owned()).collect();
    work_row(ui, (&[], "cameras"), (&titles, columns), (TextStyle::Small, palette.text3));
    for PairAgreement { cameras: pair, apart_px, keypoints_apart_px, share } in &found.pairs {
        let names = pair.map(|camera| cameras.get(camera).map_or("", Camera::name)).join(", ");
        let [before, after] = apart_px.map(|px| px.unwrap_or(f64::NAN));
        let colour = if after < before / WRONG_FROM { palette.warn } else { palette.text2 };
        let mut numbers = vec![format::number(before, 2), format::number(after, 2)];
        if has_keypoints {
            numbers.extend(keypoints_apart_px.map(|px| format::number(px.unwrap_or(f64::NAN), 2)));
        }
        numbers.push(format::number(100.0 * share, 0));
        work_row(ui, (pair, &names), (&numbers, columns), (TextStyle::Body, colour));
    }
    if let Some(tall) = found.subject_m {
        ui.add_space(space::ROW);
        hint(ui, format!("The subject’s largest extent is {} m.", format::number(tall, 2)));
    }
}
