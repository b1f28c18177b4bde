//! What is painted into a mask by hand.

use serde::{Deserialize, Serialize};

use super::{Label, Mask};

/// A line that a round brush draws: every pixel no farther than the radius from it gets the label.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stroke {
    /// What its pixels are.
    pub label: Label,
    /// The brush's radius, pixels.
    pub radius_px: f32,
    /// The line's corners by column and row, in pixels; a single one is a dab.
    pub points: Vec<[f32; 2]>,
}

/// Why a stroke cannot be painted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum StrokeError {
    #[error("`radius_px` is {0}; expected a number from 0 to {MAX_RADIUS_PX}")]
    Radius(f32),
    #[error("`points` is empty; expected at least one point")]
    Empty,
    #[error("`points[{0}]` is [{1}, {2}]; expected numbers from -{MAX_PX} to {MAX_PX}")]
    Point(usize, f32, f32),
}

/// Pictures have fewer pixels on a side; no point outside one needs to be farther away.
const MAX_PX: f32 = 65_536.0;
const MAX_RADIUS_PX: f32 = 1024.0;

impl Stroke {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A radius or a point that is not finite or larger than any picture, and a stroke without a point.
    pub fn check(&self) -> Result<(), StrokeError> {
        if !(0.0..=MAX_RADIUS_PX).contains(&self.radius_px) {
            return Err(StrokeError::Radius(self.radius_px));
        }
        let is_far = |point: &[f32; 2]| point.iter().any(|at| !(-MAX_PX..=MAX_PX).contains(at));
        match self.points.iter().position(is_far) {
            Some(index) => Err(StrokeError::Point(index, self.points[index][0], self.points[index][1])),
            None if self.points.is_empty() => Err(StrokeError::Empty),
            None => Ok(()),
        }
    }

    /// Paints it into a mask. What lies outside the picture is left out.
    pub fn paint(&self, mask: &mut Mask) {
        let last = self.points.last().copied();
        let lines = self.points.windows(2).map(|two| [two[0], two[1]]);
        for line in lines.chain(last.filter(|_| self.points.len() == 1).map(|point| [point, point])) {
            self.paint_line(line, mask);
        }
    }

    fn paint_line(&self, [from, to]: [[f32; 2]; 2], mask: &mut Mask) {
        let size = [mask.width(), mask.height()];
        // The pixels of the line's box, grown by the radius; a cast saturates.
        let span = |axis: usize| {
            let low = from[axis].min(to[axis]) - self.radius_px;
            let high = from[axis].max(to[axis]) + self.radius_px;
            let end = if high < 0.0 { 0 } else { (high.floor() as usize + 1).min(size[axis]) };
            (low.ceil().max(0.0) as usize).min(end)..end
        };
        let along = [to[0] - from[0], to[1] - from[1]];
        let length_squared = along[0] * along[0] + along[1] * along[1];
        for y in span(1) {
            for x in span(0) {
                let off = [x as f32 - from[0], y as f32 - from[1]];
                let share = if length_squared > 0.0 {
                    ((off[0] * along[0] + off[1] * along[1]) / length_squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let apart = (off[0] - share * along[0]).hypot(off[1] - share * along[1]);
                if apart <= self.radius_px {
                    mask.paint_pixel(y * size[0] + x, self.label);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn painted(label: Label, radius_px: f32, points: &[[f32; 2]]) -> String {
        let mut mask = Mask::from_ascii("~~~~~~~\n.......\n#######\n???????").unwrap();
        Stroke { label, radius_px, points: points.to_vec() }.paint(&mut mask);
        mask.to_string()
    }

    #[test]
    fn pixels_near_the_line_get_the_label() {
        assert_eq!(
            painted(Label::Subject, 0.5, &[[1.0, 0.0], [4.0, 0.0]]),
            "~####~~\n.......\n#######\n???????\n"
        );
        assert_eq!(painted(Label::Subject, 1.0, &[[3.0, 1.0]]), "~~~#~~~\n..###..\n#######\n???????\n");
        assert_eq!(painted(Label::Unknown, 0.0, &[[2.0, 2.0]]), "~~~~~~~\n.......\n##?####\n???????\n");
        // A corner is painted once more, and what lies outside is left out.
        let hook = [[-9.0, 3.0], [1.0, 3.0], [1.0, -5.0]];
        assert_eq!(painted(Label::Background, 0.2, &hook), "~.~~~~~\n.......\n#.#####\n..?????\n");
        assert_eq!(
            painted(Label::Subject, 2.0, &[[-40.0, -40.0], [90.0, -30.0]]),
            painted(Label::Subject, 0.0, &[])
        );
    }

    #[test]
    fn what_is_no_stroke_is_said() {
        let stroke = |radius_px, points: &[[f32; 2]]| Stroke {
            label: Label::Subject,
            radius_px,
            points: points.to_vec(),
        };
        assert_eq!(stroke(3.0, &[[0.0, 0.0]]).check(), Ok(()));
        let said = |stroke: Stroke| stroke.check().unwrap_err().to_string();
        assert_eq!(said(stroke(-1.0, &[[0.0, 0.0]])), "`radius_px` is -1; expected a number from 0 to 1024");
        assert_eq!(said(stroke(1.0, &[])), "`points` is empty; expected at least one point");
        assert!(
            said(stroke(1.0, &[[0.0, 0.0], [f32::NAN, 1.0]]))
                .starts_with("`points[1]` is [NaN, 1]; expected")
        );
    }
}
