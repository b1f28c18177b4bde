//! Where to put cameras: sets of those there are, and places for one more, over a floor. The mathematics is
//! [`backlit_tracking::observability::plan`]; here is what is compared, and what came of it.

use std::sync::Arc;

use backlit_plot::{FloorMap, MapCamera};
use backlit_tracking::body::Model;
use backlit_tracking::camera::{Camera, CameraError};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::observability::plan::{
    CameraPlan, Floor, FloorArea, PLANNED_NOISE, PlaceFigures, PlannedSet, camera_ring,
};
use backlit_tracking::observability::{Noise, camera_subsets};
use backlit_words::format;

/// Cells along the longer side of an area, where nothing else is said.
pub const CELLS: usize = 5;
/// Most cameras of which triples are compared, and pairs.
const TRIPLES_UP_TO: usize = 8;
const PAIRS_UP_TO: usize = 12;
/// Places for one more camera, where nothing else is said: their number around, and heights, metres.
const AROUND: usize = 12;
const HEIGHTS_M: [f64; 2] = [1.2, 2.4];
/// The side of an area where no two cameras see a person whole, metres.
const FALLBACK_M: f64 = 2.0;
/// A ring is no narrower than that, metres.
const LEAST_RADIUS_M: f64 = 1.0;

/// Where one more camera may stand: on rings about the middle of the area.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateRing {
    /// Places on each ring.
    pub around: usize,
    /// Metres from the middle.
    pub radius_m: f64,
    /// Heights of the rings above the floor, metres.
    pub heights_m: Vec<f64>,
}

impl CandidateRing {
    /// As far away as the cameras are, in the middle of them.
    #[must_use]
    pub fn like(cameras: &[Arc<Camera>], floor: &Floor, area: &FloorArea) -> Self {
        let away = |camera: &Arc<Camera>| {
            let place = floor.place(camera.centre());
            (place[0] - area.middle[0]).hypot(place[1] - area.middle[1])
        };
        let mut radii: Vec<f64> = cameras.iter().map(away).collect();
        radii.sort_by(f64::total_cmp);
        let radius_m = radii.get(radii.len() / 2).copied().unwrap_or_default().max(LEAST_RADIUS_M);
        Self { around: AROUND, radius_m, heights_m: HEIGHTS_M.to_vec() }
    }
}

/// What is planned for.
#[derive(Debug, Clone)]
pub struct PlanSubject {
    /// The body.
    pub model: Arc<Model>,
    /// The cameras there are, or are to be.
    pub cameras: Vec<Arc<Camera>>,
    /// The floor.
    pub floor: Floor,
    /// The part of it where people are.
    pub area: FloorArea,
    /// Where one more camera may stand; it is like the first one.
    pub candidates: CandidateRing,
    /// σ√κ, grey levels.
    pub noise: f64,
    /// The solid and the last stage's ramp.
    pub fit: FitOptions,
}

impl PlanSubject {
    /// A plan of the usual size: the area is what two cameras see of a person. Lenses are taken for ideal, as pictures are made.
    #[must_use]
    pub fn new(model: Arc<Model>, cameras: Vec<Arc<Camera>>, floor: Floor) -> Self {
        let ideal = |camera: Arc<Camera>| {
            if camera.distortion().is_none() { camera } else { Arc::new(camera.without_distortion()) }
        };
        let cameras: Vec<Arc<Camera>> = cameras.into_iter().map(ideal).collect();
        let area = FloorArea::seen_by(&cameras, &floor, CELLS).unwrap_or_else(|| {
            let places: Vec<[f64; 2]> = cameras.iter().map(|camera| floor.place(camera.centre())).collect();
            let mean = |axis: usize| {
                places.iter().map(|place| place[axis]).sum::<f64>() / places.len().max(1) as f64
            };
            FloorArea::new([mean(0), mean(1)], [FALLBACK_M; 2], CELLS)
        });
        let candidates = CandidateRing::like(&cameras, &floor, &area);
        let fit = FitOptions::default();
        Self { model, cameras, floor, area, candidates, noise: PLANNED_NOISE, fit }
    }
}

/// A plan being made, place by place.
#[derive(Debug, Clone)]
pub struct PlanRun {
    subject: PlanSubject,
    plan: CameraPlan,
    candidates: Vec<Arc<Camera>>,
    places: Vec<[f64; 2]>,
    /// By place, then by set.
    found: Vec<Vec<PlaceFigures>>,
}

impl PlanRun {
    /// Puts the candidates up, and says which sets are compared.
    ///
    /// # Errors
    /// A camera that cannot be made.
    pub fn new(subject: PlanSubject) -> Result<Self, CameraError> {
        let PlanSubject { cameras, floor, area, candidates: ring, .. } = &subject;
        let mut candidates = Vec::new();
        if let Some(like) = cameras.first() {
            for height_m in &ring.heights_m {
                let name = format!("{} m high", format::number(*height_m, 1));
                let of_height =
                    camera_ring(like, floor, area.middle, [ring.radius_m, *height_m], ring.around, &name);
                candidates.extend(of_height?);
            }
        }
        let given: Vec<usize> = (0..cameras.len()).collect();
        let mut sets = planned_sets(&given);
        sets.extend((0..candidates.len()).map(|index| [given.as_slice(), &[given.len() + index]].concat()));
        let all: Vec<Arc<Camera>> = cameras.iter().chain(&candidates).cloned().collect();
        let noise = Noise::white(subject.noise);
        let plan = CameraPlan::new(&subject.model, (*floor, area), &all, sets, noise, &subject.fit)?;
        Ok(Self { places: area.places(), found: Vec::new(), plan, candidates, subject })
    }

    /// How many places are done, and how many there are.
    #[must_use]
    pub fn progress(&self) -> [usize; 2] {
        [self.found.len(), self.places.len()]
    }

    /// Looks at the next place; whether there is another.
    pub fn step(&mut self) -> bool {
        if let Some(&place) = self.places.get(self.found.len()) {
            self.found.push(self.plan.at(place));
        }
        self.found.len() < self.places.len()
    }

    /// What came of the places that are done.
    #[must_use]
    pub fn result(&self) -> PlanResult {
        let count = self.subject.cameras.len();
        let set = |(index, cameras): (usize, &Vec<usize>)| PlannedSet {
            cameras: cameras.clone(),
            places: self.found.iter().map(|sets| sets[index]).collect(),
        };
        let all = self.plan.sets().iter().enumerate().map(set);
        let (mut sets, mut additions): (Vec<_>, Vec<_>) =
            all.partition(|set| set.cameras.iter().all(|camera| *camera < count));
        for sorted in [&mut sets, &mut additions] {
            sorted.sort_by(|a, b| {
                (a.cameras.len().cmp(&b.cameras.len()))
                    .then(a.mean_m().total_cmp(&b.mean_m()))
                    .then_with(|| a.cameras.cmp(&b.cameras))
            });
        }
        PlanResult {
            subject: self.subject.clone(),
            candidates: self.candidates.clone(),
            bodies: self.plan.body_count(),
            sets,
            additions,
        }
    }
}

/// All sets of few cameras; of more, single cameras, pairs, triples, all but one, and all, as far as there are not too many.
fn planned_sets(cameras: &[usize]) -> Vec<Vec<usize>> {
    let mut sets = camera_subsets(cameras);
    let count = cameras.len();
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| vec![a, b]));
    let more: Vec<Vec<usize>> = if count <= TRIPLES_UP_TO {
        pairs.flat_map(|pair| (pair[1] + 1..count).map(move |c| vec![pair[0], pair[1], c])).collect()
    } else if count <= PAIRS_UP_TO {
        pairs.collect()
    } else {
        Vec::new()
    };
    sets.extend(more.into_iter().map(|set| set.into_iter().map(|at| cameras[at]).collect()));
    sets.sort();
    sets.dedup();
    sets
}

/// What came of a plan.
#[derive(Debug, Clone)]
pub struct PlanResult {
    /// What was planned for.
    pub subject: PlanSubject,
    /// Where one more camera was tried: their indices follow those of the cameras there are.
    pub candidates: Vec<Arc<Camera>>,
    /// Bodies at each place.
    pub bodies: usize,
    /// Sets of the cameras there are, small ones first, of one size the best first.
    pub sets: Vec<PlannedSet>,
    /// All cameras there are and one more, the best first.
    pub additions: Vec<PlannedSet>,
}

impl PlanResult {
    /// All cameras there are.
    #[must_use]
    pub fn whole(&self) -> Option<&PlannedSet> {
        self.sets.iter().find(|set| set.cameras.len() == self.subject.cameras.len())
    }

    /// The best set of a size.
    #[must_use]
    pub fn best(&self, count: usize) -> Option<&PlannedSet> {
        self.sets.iter().find(|set| set.cameras.len() == count)
    }

    /// The camera that can be left out best, and the set without it. `None` with fewer than two.
    #[must_use]
    pub fn spare(&self) -> Option<(usize, &PlannedSet)> {
        let count = self.subject.cameras.len();
        let without = self.best(count.checked_sub(1).filter(|left| *left > 0)?)?;
        Some(((0..count).find(|camera| !without.cameras.contains(camera))?, without))
    }

    /// The camera that a set has beside those there are.
    #[must_use]
    pub fn added<'a>(&'a self, set: &PlannedSet) -> Option<&'a Arc<Camera>> {
        self.candidates.get(set.cameras.last()?.checked_sub(self.subject.cameras.len())?)
    }

    /// Names of a set's cameras, with commas.
    #[must_use]
    pub fn names(&self, set: &PlannedSet) -> String {
        let all: Vec<&Arc<Camera>> = self.subject.cameras.iter().chain(&self.candidates).collect();
        let names = set.cameras.iter().filter_map(|&camera| all.get(camera));
        names.map(|camera| camera.name()).collect::<Vec<_>>().join(", ")
    }

    /// A camera as a map shows it.
    #[must_use]
    pub fn on_map(&self, camera: &Camera, is_added: bool) -> MapCamera {
        let looks = camera.axis_in_world();
        let name = if is_added { "added".to_owned() } else { camera.name().to_owned() };
        let floor = &self.subject.floor;
        MapCamera { name, place: floor.place(camera.centre()), looks: floor.place(looks), is_added }
    }

    /// The floor with all cameras there are, and beside it with the one more that brings most.
    #[must_use]
    pub fn map(&self) -> FloorMap {
        let given: Vec<MapCamera> =
            self.subject.cameras.iter().map(|camera| self.on_map(camera, false)).collect();
        let millimetres =
            |set: &PlannedSet| set.places.iter().map(|place| 1e3 * place.mean_m).collect::<Vec<f64>>();
        let name = |set: &PlannedSet, what: &str| {
            format!("{what}: {} mm over the area", format::number(1e3 * set.mean_m(), 0))
        };
        let mut maps = Vec::new();
        if let Some(whole) = self.whole() {
            maps.push((
                name(whole, &format::counted(given.len(), "camera")),
                millimetres(whole),
                given.clone(),
            ));
        }
        if let Some((best, camera)) = self.additions.first().and_then(|set| Some((set, self.added(set)?))) {
            let cameras = [given.as_slice(), &[self.on_map(camera, true)]].concat();
            maps.push((name(best, "with one more"), millimetres(best), cameras));
        }
        let area = &self.subject.area;
        FloorMap {
            title: "What cameras know of a body on the floor".to_owned(),
            subtitle: format!(
                "mean deviation of joints, mm, one standard deviation in the worst direction, of {} bodies at each place",
                self.bodies
            ),
            middle: area.middle,
            size_m: area.size_m,
            cells: area.cells,
            maps,
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_lab::synthetic::studio;
    use backlit_tracking::body::builtin;
    use glam::DVec3;

    use super::*;

    #[test]
    fn sets_of_a_plan_are_pairs_and_triples_as_far_as_there_are_few() {
        assert_eq!(planned_sets(&[0, 1, 2, 3]).len(), 15);
        assert_eq!(planned_sets(&(0..6).collect::<Vec<_>>()).len(), 6 + 15 + 20 + 6 + 1);
        assert_eq!(planned_sets(&(0..10).collect::<Vec<_>>()).len(), 10 + 45 + 10 + 1);
        assert!(planned_sets(&[]).is_empty());
    }

    #[test]
    fn a_plan_says_what_to_leave_out_and_what_to_add() {
        let cameras = studio::pinholes([48, 64]).unwrap();
        let floor = Floor { up: DVec3::Z, height_m: 0.0 };
        let mut subject = PlanSubject::new(Arc::new(builtin::full_body()), cameras, floor);
        assert!(subject.area.middle.iter().all(|along| along.abs() < 1.0), "{:?}", subject.area);
        subject.area = FloorArea::new([0.0; 2], [1.0, 0.5], 2);
        subject.candidates = CandidateRing { around: 3, radius_m: 2.5, heights_m: vec![1.5] };
        let mut run = PlanRun::new(subject).unwrap();
        assert_eq!(run.progress(), [0, 2]);
        assert!(run.step() && !run.step());
        let found = run.result();
        assert_eq!((found.sets.len(), found.additions.len(), found.bodies), (15, 3, 12));
        let means = |count: usize| found.best(count).unwrap().mean_m();
        assert!(means(1) > means(2) && means(2) > means(3) && means(3) > means(4));
        let best = &found.additions[0];
        assert!(best.mean_m() < found.whole().unwrap().mean_m());
        assert!(found.added(best).unwrap().name().starts_with("1.5 m high"));
        let (spare, without) = found.spare().unwrap();
        assert!(!without.cameras.contains(&spare) && without.cameras.len() == 3);
        let map = found.map();
        assert_eq!(map.maps.iter().map(|(.., cameras)| cameras.len()).collect::<Vec<_>>(), [4, 5]);
    }
}
