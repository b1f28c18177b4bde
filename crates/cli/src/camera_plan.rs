//! `backlit observability --plan`: where to put cameras, before anything is filmed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail, ensure};
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::{atomic, model_file};
use backlit_plot::{AsPicture, Theme, png};
use backlit_runs::camera_plan::{CELLS, PlanResult, PlanRun, PlanSubject};
use backlit_tracking::body::{Model, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, up_of};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::observability::plan::{
    Floor, FloorArea, LOST_M, PLANNED_NOISE, PlannedSet, camera_ring,
};
use backlit_words::joint::joint_name;
use clap::Args;
use glam::DVec3;
use indicatif::ProgressBar;
use serde::Serialize;

use crate::fit_options::{MODEL_HELP, Words, one_of};
use crate::interrupt::{self, Interrupted};
use crate::numbers::within;
use crate::output::{self, number, object};
use crate::table::Table;
use crate::take_options;

/// Candidates that are listed.
const LISTED: usize = 5;
/// Sets of one size that are listed.
const SETS_LISTED: usize = 6;
/// Where a ring of cameras stands if nothing is said: its radius and height, metres.
const RING_M: [f64; 2] = [4.0, 1.5];

const THEMES: Words<Theme> =
    &[("light", "Dark on light", Theme::Light), ("dark", "Light on dark", Theme::Dark)];

/// Where to put cameras.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Where to put cameras")]
pub(crate) struct PlanArguments {
    /// Before filming: which sets of cameras know a body on the floor best, and where one more brings most
    #[arg(long)]
    pub(crate) plan: bool,
    /// This many cameras evenly on a ring that does not exist yet, in place of a take's [1 to 32]
    #[arg(long, value_name = "N", requires = "plan", conflicts_with_all = ["take", "cameras"], value_parser = within(1..=32_usize))]
    ring: Option<usize>,
    /// Radius of the ring of --ring and of those for one more camera, metres [0.5 to 100] [default: 4, or as far away as
    /// the cameras are]
    #[arg(long, value_name = "METRES", requires = "plan", value_parser = within(0.5..=100.0_f64))]
    radius: Option<f64>,
    /// Heights above the floor of the rings for one more camera, metres; the first is that of --ring, 1.5 if nothing is said
    /// [0 to 100] [default: 1.2,2.4]
    #[arg(long, value_name = "METRES,…", value_delimiter = ',', requires = "plan", value_parser = within(0.0..=100.0_f64))]
    heights: Option<Vec<f64>>,
    /// Field of view across the pictures of --ring, degrees [1 to 170]
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0, value_parser = within(1.0..=170.0_f64))]
    field_of_view: f64,
    /// Width and height of the pictures of --ring
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: [u64; 2],
    /// The part of the floor where people are, metres [default: what two cameras see of a person, 1x1 to 6x6]
    #[arg(long, value_name = "WxD", requires = "plan", value_parser = sides)]
    area: Option<[f64; 2]>,
    /// The middle of that part, metres along the floor's axes [default: of what two cameras see]
    #[arg(long, value_name = "X,Y", requires = "plan", allow_hyphen_values = true, value_parser = place)]
    middle: Option<[f64; 2]>,
    /// Places along the longer side of that part [1 to 41]
    #[arg(long, value_name = "N", default_value_t = CELLS, value_parser = within(1..=41_usize))]
    places: usize,
    /// Height of the floor along the world's up, metres [-1000 to 1000] [default: under the take's start, else 0]
    #[arg(long, value_name = "METRES", requires = "plan", value_parser = within(-1000.0..=1000.0_f64))]
    floor: Option<f64>,
    /// Places for one more camera around each ring [0 to 72] [default: 12]
    #[arg(long, value_name = "N", requires = "plan", value_parser = within(0..=72_usize))]
    candidates: Option<usize>,
    /// How silhouettes err: deviation of a pixel as if pixels erred by themselves, grey levels [1 to 100000]
    #[arg(long, value_name = "G", default_value_t = PLANNED_NOISE, value_parser = within(1.0..=100_000.0_f64))]
    noise: f64,
    #[arg(long, value_name = "MODEL", requires = "plan", help = format!("{MODEL_HELP} [default: the take's, else full_body]"))]
    model: Option<String>,
    /// Write the floor with the cameras as a PNG
    #[arg(long, value_name = "FILE", requires = "plan")]
    picture: Option<PathBuf>,
    /// Colours of the picture
    #[arg(long, value_parser = one_of(THEMES), default_value = "light")]
    theme: Theme,
}

impl PlanArguments {
    /// Plans, and prints what came of it.
    pub(crate) fn run(
        &self,
        (take, names): (Option<&Path>, Option<&[String]>),
        fit: FitOptions,
        json: bool,
    ) -> anyhow::Result<()> {
        if let Some(picture) = &self.picture {
            output::check_folder_of(picture)?;
        }
        let mut subject = match take {
            Some(path) => self.of_file(path, names)?,
            None => self.of_ring()?,
        };
        subject.fit = fit;
        subject.noise = self.noise;
        let mut run = PlanRun::new(subject)?;
        let cancel = interrupt::listen()?;
        let bar = ProgressBar::new(run.progress()[1] as u64);
        while run.step() {
            bar.inc(1);
            if cancel.is_cancelled() {
                bar.finish_and_clear();
                return Err(Interrupted.into());
            }
        }
        bar.finish_and_clear();
        let found = run.result();
        if let Some(path) = &self.picture {
            atomic::write(path, &png(found.map().picture(self.theme))?)?;
        }
        output::print_result(json, &answer(&found), || text(&found))
    }

    /// The cameras of a take or of a calibration.
    fn of_file(&self, path: &Path, names: Option<&[String]>) -> anyhow::Result<PlanSubject> {
        let (rig, mut model, start) = if is_take(path) {
            let footage = take_options::open_with_model(path, self.model.as_deref())?;
            let take = footage.take();
            (take.rig().clone(), Arc::clone(take.model()), take.start().cloned())
        } else {
            let found = calibration::load_all(&[path.to_owned()], CalibrationOptions::default())?;
            (found.rig, Arc::new(builtin::full_body()), None)
        };
        if let Some(name) = &self.model {
            model = Arc::new(model_file::resolve(name)?);
        }
        let chosen: Vec<usize> = match names {
            Some(names) => {
                let found: Result<Vec<usize>, _> = names.iter().map(|name| rig.index(name.trim())).collect();
                let mut found = found.context("--cameras")?;
                found.sort_unstable();
                found.dedup();
                found
            }
            None => (0..rig.count()).collect(),
        };
        let up = up_of(rig.cameras()).context("the cameras do not agree on which way is up")?;
        let under = start.map(|start| Floor::under(&model, &start, up).height_m);
        let floor = Floor { up, height_m: self.floor.or(under).unwrap_or_default() };
        let cameras = chosen.into_iter().map(|camera| Arc::new(rig.cameras()[camera].clone())).collect();
        self.subject(model, cameras, floor)
    }

    /// Cameras that are not there yet.
    fn of_ring(&self) -> anyhow::Result<PlanSubject> {
        let Some(count) = self.ring else { bail!("--plan needs a take, a calibration or --ring N") };
        let floor = Floor { up: DVec3::Z, height_m: self.floor.unwrap_or_default() };
        let [width, height] = self.size.map(|side| side as f64);
        let focal = 0.5 * width / (0.5 * self.field_of_view.to_radians()).tan();
        let intrinsics =
            Intrinsics { fx: focal, fy: focal, cx: 0.5 * (width - 1.0), cy: 0.5 * (height - 1.0) };
        let at = CameraFromWorld::looking_at(DVec3::X, DVec3::ZERO, DVec3::Z);
        let like = Camera::new("ring", self.size, intrinsics, Distortion::None, at)?;
        let heights = self.heights.as_deref().and_then(|heights| heights.first().copied());
        let ring = [self.radius.unwrap_or(RING_M[0]), heights.unwrap_or(RING_M[1])];
        let cameras = camera_ring(&like, &floor, self.middle.unwrap_or_default(), ring, count, "cam")?;
        let model = match &self.model {
            Some(name) => model_file::resolve(name)?,
            None => builtin::full_body(),
        };
        self.subject(Arc::new(model), cameras, floor)
    }

    fn subject(
        &self,
        model: Arc<Model>,
        cameras: Vec<Arc<Camera>>,
        floor: Floor,
    ) -> anyhow::Result<PlanSubject> {
        let mut subject = PlanSubject::new(model, cameras, floor);
        let found = subject.area;
        let middle = self.middle.unwrap_or(found.middle);
        subject.area = FloorArea::new(middle, self.area.unwrap_or(found.size_m), self.places);
        let mut ring =
            backlit_runs::camera_plan::CandidateRing::like(&subject.cameras, &floor, &subject.area);
        ring.around = self.candidates.unwrap_or(ring.around);
        ring.radius_m = self.radius.unwrap_or(ring.radius_m);
        if let Some(heights) = &self.heights {
            ring.heights_m.clone_from(heights);
        }
        ring.heights_m.sort_by(f64::total_cmp);
        ring.heights_m.dedup();
        subject.candidates = ring;
        ensure!(!subject.cameras.is_empty(), "there is no camera");
        Ok(subject)
    }
}

/// Whether a path is a take's: a folder with a take file, or a file that says so.
fn is_take(path: &Path) -> bool {
    let says_so = |path: &Path| {
        path.extension().is_some_and(|ending| ending == "toml")
            && fs::read_to_string(path).is_ok_and(|text| text.contains("backlit-take"))
    };
    path.join("take.toml").exists() || says_so(path)
}

fn size(text: &str) -> Result<[u64; 2], &'static str> {
    let found = sides(text).ok().filter(|sides| sides.iter().all(|side| side.fract() == 0.0));
    found.map(|sides| sides.map(|side| side as u64)).ok_or("expected width and height, such as 1280x720")
}

fn sides(text: &str) -> Result<[f64; 2], &'static str> {
    numbers(text, ['x', '×'])
        .filter(|sides| sides.iter().all(|side| *side > 0.0))
        .ok_or("expected width and depth, such as 4x3")
}

fn place(text: &str) -> Result<[f64; 2], &'static str> {
    numbers(text, [',', ',']).ok_or("expected two numbers, such as 0.5,-1")
}

fn numbers(text: &str, between: [char; 2]) -> Option<[f64; 2]> {
    /// Farther than that is a mistake.
    const MOST: f64 = 1e5;
    let (first, second) = text.split_once(between)?;
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.abs() <= MOST);
    Some([number(first)?, number(second)?])
}

/// Millimetres; beyond what is lost no number means anything.
fn millimetres(metres: f64) -> String {
    if metres > LOST_M { format!("> {}", number(1e3 * LOST_M, 0)) } else { number(1e3 * metres, 1) }
}

/// A row of figures over the area.
fn row(found: &PlanResult, set: &PlannedSet) -> [String; 6] {
    let (joint, deviation) = set.worst_joint();
    [
        found.names(set),
        millimetres(set.mean_m()),
        millimetres(set.median_m()),
        millimetres(deviation),
        joint_name(&found.subject.model, joint.into()),
        number(100.0 * set.known(), 0),
    ]
}

fn text(found: &PlanResult) -> String {
    let area = &found.subject.area;
    let places = area.cells[0] * area.cells[1];
    let metres = |values: [f64; 2], between: &str| values.map(|value| number(value, 2)).join(between);
    let mut out = format!(
        "{} m of the floor about ({}), its height {} m: {places} places, {} bodies at each\n\
         deviations of joints in mm, worst direction; in the mean none counts as more than 250\n\n",
        metres(area.size_m, " × "),
        metres(area.middle, ", "),
        number(found.subject.floor.height_m, 2),
        found.bodies,
    );
    let titles = ["cameras", "mean", "middle joint", "worst joint", "", "known, %"];
    let mut table = Table::new(titles);
    let count = found.subject.cameras.len();
    for size in (1..=count).rev() {
        let of_size = found.sets.iter().filter(|set| set.cameras.len() == size);
        of_size.take(SETS_LISTED).for_each(|set| table.row(row(found, set)));
    }
    out += &table.to_text();
    if let Some((spare, without)) = found.spare() {
        out += &format!(
            "\nleft out best: {} (the mean is {} mm without)\n",
            found.subject.cameras[spare].name(),
            millimetres(without.mean_m()),
        );
    }
    out += &additions(found);
    if let Some(whole) = found.whole() {
        out += &format!(
            "\nmean deviation over the floor, mm, all cameras (first axis to the right):\n{}",
            floor(found, whole)
        );
    }
    out
}

/// Where one more camera brings most.
fn additions(found: &PlanResult) -> String {
    let (Some(whole), false) = (found.whole(), found.additions.is_empty()) else { return String::new() };
    let mut table = Table::new([
        "one more at (m along the floor's axes, m high)",
        "from the middle",
        "mean",
        "brings",
        "worst joint",
    ]);
    let Floor { up, height_m } = found.subject.floor;
    for set in found.additions.iter().take(LISTED) {
        let Some(camera) = found.added(set) else { continue };
        let at = found.subject.floor.place(camera.centre());
        let [x, y] = [0, 1].map(|axis| at[axis] - found.subject.area.middle[axis]);
        table.row([
            format!(
                "({}, {}), {}",
                number(at[0], 2),
                number(at[1], 2),
                number(camera.centre().dot(up) - height_m, 1)
            ),
            format!("{}°, {} m", number(y.atan2(x).to_degrees(), 0), number(x.hypot(y), 1)),
            millimetres(set.mean_m()),
            millimetres(whole.mean_m() - set.mean_m()),
            millimetres(set.worst_joint().1),
        ]);
    }
    format!("\n{}", table.to_text())
}

/// The area seen from above, a number a place.
fn floor(found: &PlanResult, set: &PlannedSet) -> String {
    let [columns, rows] = found.subject.area.cells;
    let line = |row: usize| {
        let cells = &set.places[row * columns..][..columns];
        let cells = cells.iter().map(|place| format!("{:>6}", number(1e3 * place.mean_m, 0)));
        cells.collect::<String>() + "\n"
    };
    (0..rows).rev().map(line).collect()
}

/// The answer as JSON has it; what is without bound is null.
fn answer(found: &PlanResult) -> impl Serialize {
    let bounded = |value: f64| Some(value).filter(|value| value.is_finite());
    let model = &found.subject.model;
    let set = |set: &PlannedSet| {
        let (joint, deviation) = set.worst_joint();
        object! {
            cameras: set.cameras.clone(),
            mean_m: set.mean_m(),
            middle_joint_m: bounded(set.median_m()),
            worst_joint: joint_name(model, joint.into()),
            worst_joint_m: bounded(deviation),
            known: set.known(),
            places: set.places.iter().map(|place| object! {
                mean_m: place.mean_m,
                middle_joint_m: bounded(place.median_m),
                worst_joint: joint_name(model, place.worst.0.into()),
                worst_joint_m: bounded(place.worst.1),
                known: place.known,
            }).collect::<Vec<_>>(),
        }
    };
    let camera = |camera: &Arc<Camera>| {
        object! {
            name: camera.name().to_owned(),
            centre: camera.centre().to_array(),
            place: found.subject.floor.place(camera.centre()),
        }
    };
    let (floor, area) = (&found.subject.floor, &found.subject.area);
    object! {
        up: floor.up.to_array(),
        axes: floor.axes().map(|axis| axis.to_array()),
        floor_m: floor.height_m,
        middle: area.middle,
        size_m: area.size_m,
        cells: area.cells,
        places: area.places(),
        bodies: found.bodies,
        noise: found.subject.noise,
        // Sets name cameras by their place here.
        cameras: found.subject.cameras.iter().chain(&found.candidates).map(camera).collect::<Vec<_>>(),
        given: found.subject.cameras.len(),
        sets: found.sets.iter().map(set).collect::<Vec<_>>(),
        additions: found.additions.iter().map(set).collect::<Vec<_>>(),
        spare: found.spare().map(|(camera, _)| camera),
    }
}
