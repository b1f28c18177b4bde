//! What is typed and chosen for a basin, and the experiment's options that follow.

use backlit_runs::basin::{
    Angle, BasinOptions, ComparedFit, Direction, FitChoice, MOST_CELLS, MOST_COMPARED, RandomStarts,
    SUCCESS_MM, StartGrid, Starts, Target, name_choices,
};
use backlit_tracking::body::Model;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::search::start::{LEVELS, Level};
use serde::{Deserialize, Serialize};

use crate::context::command::BasinView;

/// Most starts of an angle.
pub(crate) const MOST_STARTS: usize = 500;
const MOST_ANGLES: usize = 12;

/// The pose that starts are drawn about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reference {
    /// The one on the screen; fits are to end where its own fit ends.
    #[default]
    Pose,
    /// The take's true pose, where that is known; fits are to end there.
    Truth,
}

/// A direction of the map: an angle of a joint, or of the one that is held.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MapDirection {
    /// Name of the joint's limb; `None`, or one that the body does not have, is the joint that is held.
    pub joint: Option<String>,
    /// Which of its angles.
    pub angle: Angle,
}

impl MapDirection {
    /// The joint's rotation in a body; `held` where it has no such joint.
    pub(crate) fn rotation(&self, model: &Model, held: usize) -> usize {
        let limb = self.joint.as_deref().and_then(|name| model.limb_index(name));
        limb.map_or(held, |limb| model.limbs()[limb].rotation)
    }
}

/// The settings. They are kept from start to start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BasinSettings {
    /// What starts are drawn about.
    pub reference: Reference,
    /// Whether the held joint alone is turned.
    pub only_held: bool,
    /// Angles, degrees, as they are typed.
    pub(crate) angles: String,
    /// Moves of the root, centimetres, as they are typed: one for each angle, the last one for all that follow.
    pub(crate) root_cm: String,
    /// Starts of each angle.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// A fit that ends nearer than this has found its target, millimetres.
    pub(crate) success_mm: f64,
    /// Fits to compare with the current choices.
    pub compared: Vec<ComparedFit>,
    /// What the map sets off across and up.
    pub directions: [MapDirection; 2],
    /// How far it does, degrees.
    pub map_degrees: f64,
    /// Its cells across and up.
    pub cells: usize,
}

impl Default for BasinSettings {
    fn default() -> Self {
        let list = |value: fn(&Level) -> String| LEVELS.iter().map(value).collect::<Vec<_>>().join(" ");
        Self {
            reference: Reference::default(),
            only_held: false,
            angles: list(|level| level.degrees.to_string()),
            root_cm: list(|level| format!("{:.0}", 100.0 * level.metres)),
            starts: 20,
            seed: 1,
            success_mm: SUCCESS_MM,
            compared: Vec::new(),
            directions: [Angle::Flexion, Angle::Sideways].map(|angle| MapDirection { joint: None, angle }),
            map_degrees: 60.0,
            cells: 11,
        }
    }
}

impl BasinSettings {
    /// The levels that are typed.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub(crate) fn levels(&self) -> Result<Vec<Level>, String> {
        let angles = numbers(&self.angles, "Angles", 180.0)?;
        let roots = numbers(&self.root_cm, "Root", 200.0)?;
        if angles.is_empty() {
            return Err("Angles: expected degrees, such as 5 10 20".to_owned());
        }
        if angles.len() > MOST_ANGLES {
            return Err(format!("Angles: expected {MOST_ANGLES} at most"));
        }
        let mut levels: Vec<Level> = Vec::with_capacity(angles.len());
        for (index, angle) in angles.into_iter().enumerate() {
            if angle.fract() != 0.0 || angle == 0.0 {
                return Err(format!("Angles: {angle} is not a whole number of degrees above 0"));
            }
            let degrees = angle as u32;
            if levels.iter().any(|level| level.degrees == degrees) {
                return Err(format!("Angles: {degrees} is given twice"));
            }
            let metres = roots.get(index).or(roots.last()).map_or(0.0, |cm| 0.01 * cm);
            levels.push(Level { degrees, metres });
        }
        levels.sort_by_key(|level| level.degrees);
        Ok(levels)
    }

    /// The choices of fit: the current ones first, each named by what differs.
    pub(crate) fn choices(&self, current: &FitOptions) -> Vec<FitChoice> {
        let mut choices = vec![FitChoice::downhill("", current.clone())];
        choices.extend(self.compared.iter().take(MOST_COMPARED).map(|compared| compared.choice()));
        name_choices(&mut choices);
        choices
    }

    /// The options of a view's experiment. `held` is the rotation that is held.
    ///
    /// # Errors
    /// Returns an error if what is typed is wrong.
    pub(crate) fn options(
        &self,
        view: BasinView,
        current: &FitOptions,
        model: &Model,
        held: usize,
    ) -> Result<BasinOptions, String> {
        let direction = |direction: &MapDirection| Direction {
            rotation: direction.rotation(model, held),
            angle: direction.angle,
        };
        let starts = match view {
            BasinView::Angles => Starts::Random(RandomStarts {
                rotation: self.only_held.then_some(held),
                levels: self.levels()?,
                starts: self.starts.clamp(1, MOST_STARTS),
                seed: self.seed,
            }),
            BasinView::Map => Starts::Grid(StartGrid {
                directions: self.directions.each_ref().map(direction),
                degrees: self.map_degrees,
                cells: self.cells.clamp(2, MOST_CELLS),
            }),
        };
        let target = match self.reference {
            Reference::Pose => Target::Fit,
            Reference::Truth => Target::Reference,
        };
        Ok(BasinOptions { choices: self.choices(current), starts, target, success_mm: self.success_mm })
    }
}

/// The numbers of a list with blanks or commas between them.
fn numbers(text: &str, name: &str, most: f64) -> Result<Vec<f64>, String> {
    let words =
        text.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|word| !word.is_empty());
    let number = |word: &str| {
        let value = word.trim_end_matches(['°', 'c', 'm']).parse::<f64>().ok();
        value
            .filter(|value| value.is_finite() && (0.0..=most).contains(value))
            .ok_or_else(|| format!("{name}: “{word}” is not a number from 0 to {most}"))
    };
    words.map(number).collect()
}

#[cfg(test)]
mod tests {
    use backlit_runs::basin::ComparedMethod;
    use backlit_tracking::fit::Preset;
    use backlit_tracking::render::RendererKind;

    use super::*;

    #[test]
    fn the_settings_begin_with_the_commands_levels() {
        assert_eq!(BasinSettings::default().levels().unwrap(), LEVELS);
    }

    #[test]
    fn lists_are_read_and_what_is_wrong_is_said() {
        let levels = |angles: &str, root: &str| {
            BasinSettings { angles: angles.to_owned(), root_cm: root.to_owned(), ..BasinSettings::default() }
                .levels()
        };
        let level = |degrees, metres| Level { degrees, metres };
        assert_eq!(levels("20°, 10", "").unwrap(), [level(10, 0.0), level(20, 0.0)]);
        assert_eq!(levels("5 10 20", "1 2").unwrap(), [level(5, 0.01), level(10, 0.02), level(20, 0.02)]);
        for (angles, root, said) in [
            ("", "", "expected degrees"),
            ("5 x", "", "“x”"),
            ("5 5", "", "twice"),
            ("2.5", "", "whole"),
            ("5", "900", "900"),
        ] {
            let error = levels(angles, root).unwrap_err();
            assert!(error.contains(said), "{angles}: {error}");
        }
    }

    #[test]
    fn a_joint_that_another_body_has_is_the_held_one() {
        let model = backlit_tracking::body::builtin::full_body();
        let direction = |name: &str| MapDirection { joint: Some(name.to_owned()), angle: Angle::Twist };
        let forearm = model.limbs()[model.limb_index("right forearm").unwrap()].rotation;
        assert_eq!(direction("right forearm").rotation(&model, 2), forearm);
        assert_eq!(direction("tail").rotation(&model, 2), 2);
    }

    #[test]
    fn choices_are_named_by_what_differs() {
        let robust = FitOptions::preset(Preset::Robust);
        let names = |compared: Vec<ComparedFit>| -> Vec<String> {
            let settings = BasinSettings { compared, ..BasinSettings::default() };
            settings.choices(&robust).into_iter().map(|choice| choice.name).collect()
        };
        assert_eq!(names(Vec::new()), ["Robust"]);
        let report =
            ComparedFit { method: ComparedMethod::Preset(Preset::Report), renderer: RendererKind::Capsule };
        assert_eq!(names(vec![report]), ["Robust", "Report 2004"]);
        let search = ComparedFit { method: ComparedMethod::Search, renderer: RendererKind::Capsule };
        assert_eq!(names(vec![search]), ["Robust", "Robust, search"]);
        assert_eq!(names(vec![search, search]), ["Robust", "Robust, search", "Robust, search (2)"]);
        let same =
            ComparedFit { method: ComparedMethod::Preset(Preset::Robust), renderer: RendererKind::Capsule };
        assert_eq!(names(vec![search, same]), ["Robust", "Robust, search", "Robust (2)"]);
        let cylinder = ComparedFit { renderer: RendererKind::Cylinder, ..search };
        assert_eq!(names(vec![search, cylinder]), ["Capsule", "Capsule, search", "Cylinder, search"]);
    }
}
