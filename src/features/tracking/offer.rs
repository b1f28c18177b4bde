//! What could help where a track does not believe its limbs: what is not on already and can be had for the take, each with what it
//! costs.

use std::collections::BTreeMap;

use backlit_document::edit::Edit;
use backlit_document::tracking_choices::{CueChoice, TrackPrior, TrackingChoices};
use backlit_tracking::cues::Cue;
use backlit_ui::style::{format, theme};
use egui::{Button, RichText, Ui};

use super::Tracking;
use crate::context::command::{Command, TrackingCommand};
use crate::context::{Context, Requests, SessionRequest};

/// A limb that is not believed in this share of the frames is worth a word, and in so many of them at least.
const MANY: f64 = 0.1;
const FEW: usize = 3;

/// Something that could help: its name, what it does, and the tracking with it.
type Offer = (&'static str, &'static str, TrackingChoices);

impl Tracking {
    /// One quiet sentence on the limb that is believed least, and what to try.
    pub(crate) fn offer(&self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let Some(sentence) = doubtful(context).filter(|_| !self.is_busy()) else { return };
        let offers = offers(context);
        if offers.is_empty() {
            return;
        }
        let palette = theme::palette(ui);
        ui.add_space(theme::space::ROW);
        let text = RichText::new(format!("{sentence} Try with")).small().color(palette.text2);
        ui.add(egui::Label::new(text).wrap());
        ui.horizontal_wrapped(|ui| {
            for (name, tooltip, choices) in offers {
                if ui.add(Button::new(name)).on_hover_text(tooltip).clicked() {
                    requests.edit(Edit::SetTracking(choices));
                    let first = context.document().estimates.first_key_value();
                    requests.others.extend(first.map(|(frame, _)| SessionRequest::Frame(*frame).into()));
                    requests.run(Command::Tracking(TrackingCommand::Forward));
                }
            }
        });
    }
}

/// The limb that is not believed in most frames, if these are many.
fn doubtful(context: &Context<'_>) -> Option<String> {
    let document = context.document();
    let mut frames: BTreeMap<usize, usize> = BTreeMap::new();
    for doubt in document.doubted().flat_map(|(_, told)| told.doubts()) {
        *frames.entry(doubt.limb).or_default() += 1;
    }
    let (limb, count) = frames.into_iter().max_by_key(|(_, count)| *count)?;
    let is_many = count >= FEW && count as f64 >= MANY * document.estimates.len() as f64;
    let name = format::capitalised(&document.model.limbs().get(limb)?.name);
    is_many.then(|| format!("{name} doubtful in {count} of {} frames.", document.estimates.len()))
}

/// What is not on already and can be had for this take.
fn offers(context: &Context<'_>) -> Vec<Offer> {
    let choices = context.document().tracking;
    let shown = context.session.shown_frame(context.selection.frame);
    let has = |cue: Cue| choices.cues.cues().contains(&cue);
    let of_cameras = || shown.into_iter().flat_map(|frame| &frame.cameras);
    let [keypoints, pictures] = [
        !has(Cue::Keypoints) && of_cameras().any(|camera| !camera.keypoints.is_empty()),
        !has(Cue::Flow) && of_cameras().any(|camera| camera.image.is_some()),
    ];
    let likely = choices.prior == TrackPrior::None && context.document().fit.prior.is_none();
    let with = |added: CueChoice| match (choices.cues, added) {
        (CueChoice::None, added) => TrackingChoices { cues: added, ..choices },
        _ => TrackingChoices { cues: CueChoice::All, ..choices },
    };
    [
        likely.then_some((
            "Likely poses, 1.1× time",
            "Poses that recorded people took are preferred where silhouettes do not decide",
            TrackingChoices { prior: TrackPrior::People, ..choices },
        )),
        keypoints.then_some((
            "Keypoints, up to 1.7× time",
            "The take’s 2-D keypoints of another tool pull at limbs that no silhouette shows",
            with(CueChoice::Keypoints),
        )),
        pictures.then_some((
            "Flow and stereo, up to 2× time",
            "Optic flow and stereo points of the pictures pull at limbs that no silhouette shows",
            with(CueChoice::Pictures),
        )),
    ]
    .into_iter()
    .flatten()
    .collect()
}
