//! Outlines of the subject along the edges of its pixels, for drawing.

use super::mask::{Label, Mask};

/// The directions of a step along pixel edges, each turned right of the one before (y points down).
const STEPS: [(isize, isize); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// From a corner, the pixel ahead and to the right of each step; the one ahead and to the left is that of the step before.
const AHEAD_RIGHT: [(isize, isize); 4] = [(0, 0), (-1, 0), (-1, -1), (0, -1)];

/// The borders of the subject as closed polylines in pixel coordinates (pixel centres at integers, so corners at halves).
///
/// Each polyline has the subject on its right as seen on the screen: clockwise around a region, anticlockwise around a
/// hole. The last point joins the first and does not repeat it; only corners are listed. Pixels that touch at a corner
/// belong together. Unknown pixels are not subject. The image's border is a border.
///
/// ```
/// use backlit_tracking::silhouette::{Mask, contours};
///
/// let mask = Mask::from_ascii(".##.")?;
/// assert_eq!(contours(&mask), [[[0.5, -0.5], [2.5, -0.5], [2.5, 0.5], [0.5, 0.5]]]);
/// # Ok::<(), backlit_tracking::silhouette::MaskError>(())
/// ```
pub fn contours(mask: &Mask) -> Vec<Vec<[f32; 2]>> {
    let width = mask.width();
    // Every outline passes along the top edge of some subject pixel; each top edge is walked once.
    let mut top_edge_walked = vec![false; mask.labels().len()];
    let mut outlines = Vec::new();
    for y in 0..mask.height() {
        for x in 0..width {
            let at = (x as isize, y as isize);
            if !top_edge_walked[y * width + x] && is_subject(mask, at) && !is_subject(mask, (at.0, at.1 - 1))
            {
                outlines.push(walk(mask, at, &mut top_edge_walked));
            }
        }
    }
    outlines
}

/// Walks the outline that begins at the upper left corner of pixel `start`, along its top edge.
fn walk(mask: &Mask, start: (isize, isize), top_edge_walked: &mut [bool]) -> Vec<[f32; 2]> {
    let mut corners = Vec::new();
    let (mut corner, mut direction) = (start, 0);
    loop {
        if direction == 0 {
            // Heading right, the subject pixel below the edge is the one ahead and to the right.
            top_edge_walked[corner.1 as usize * mask.width() + corner.0 as usize] = true;
        }
        corner = (corner.0 + STEPS[direction].0, corner.1 + STEPS[direction].1);
        let subject_at =
            |offset: (isize, isize)| is_subject(mask, (corner.0 + offset.0, corner.1 + offset.1));
        let next = if subject_at(AHEAD_RIGHT[(direction + 3) % 4]) {
            (direction + 3) % 4
        } else if subject_at(AHEAD_RIGHT[direction]) {
            direction
        } else {
            (direction + 1) % 4
        };
        if next != direction {
            corners.push([corner.0 as f32 - 0.5, corner.1 as f32 - 0.5]);
        }
        direction = next;
        if corner == start && direction == 0 {
            // The corner at the start was met last; it reads better first.
            corners.rotate_right(1);
            return corners;
        }
    }
}

/// Whether a pixel is subject; outside the image none is.
fn is_subject(mask: &Mask, (x, y): (isize, isize)) -> bool {
    let inside = usize::try_from(x).ok().zip(usize::try_from(y).ok());
    inside.and_then(|(x, y)| mask.get(x, y)) == Some(Label::Subject)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Twice the signed area; positive when clockwise on the screen.
    fn doubled_area(outline: &[[f32; 2]]) -> f32 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum()
    }

    #[test]
    fn a_hole_has_an_outline_of_its_own() {
        let mask = Mask::from_ascii("###\n#?#\n###").unwrap();
        let outlines = contours(&mask);
        assert_eq!(outlines[0], [[-0.5, -0.5], [2.5, -0.5], [2.5, 2.5], [-0.5, 2.5]]);
        assert_eq!(outlines.len(), 2);
        assert_eq!(doubled_area(&outlines[1]), -2.0);
    }

    #[test]
    fn pixels_that_touch_at_a_corner_belong_together() {
        let mask = Mask::from_ascii("#.\n.#").unwrap();
        let outlines = contours(&mask);
        assert_eq!(outlines.len(), 1);
        assert_eq!(outlines[0].len(), 8);
    }

    #[test]
    fn nothing_has_no_outline() {
        assert!(contours(&Mask::filled(3, 2, Label::Unknown).unwrap()).is_empty());
    }

    proptest! {
        #[test]
        fn outlines_enclose_exactly_the_subject(
            width in 1..9_usize,
            labels in proptest::collection::vec(prop_oneof![Just(Label::Background), Just(Label::Subject)], 72),
        ) {
            let height = 72 / width;
            let mask = Mask::new(width, height, labels[..width * height].to_vec()).unwrap();
            let area: f32 = contours(&mask).iter().map(|outline| doubled_area(outline)).sum::<f32>() / 2.0;
            prop_assert_eq!(area, mask.count(Label::Subject) as f32, "{}", mask);
        }
    }
}
