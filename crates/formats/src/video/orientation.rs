//! How a stored picture is turned to be shown.

/// First a mirroring left to right, then quarter turns clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Orientation {
    pub(super) mirrored: bool,
    /// Quarter turns clockwise, 0 to 3.
    pub(super) turns: u8,
}

/// Side of the squares in which a picture is turned, so that rows and columns both stay in the processor's cache.
const BLOCK: usize = 32;

impl Orientation {
    /// From a track's matrix: a stored (x, y) is shown at (a x + c y, b x + d y), y down. Only signs and what is
    /// largest count.
    pub(super) fn of_matrix(a: i32, b: i32, c: i32, d: i32) -> Self {
        let mirrored = i64::from(a) * i64::from(d) < i64::from(b) * i64::from(c);
        // Where x goes, or comes from if it was mirrored first.
        let sign = if mirrored { -1 } else { 1 };
        let (x, y) = (sign * i64::from(a), sign * i64::from(b));
        let turns = match (x.abs() >= y.abs(), x >= 0, y >= 0) {
            (true, true, _) => 0,
            (false, _, true) => 1,
            (true, false, _) => 2,
            (false, _, false) => 3,
        };
        Self { mirrored, turns }
    }

    /// Width and height when shown.
    pub(super) fn size(self, [width, height]: [usize; 2]) -> [usize; 2] {
        if self.turns.is_multiple_of(2) { [width, height] } else { [height, width] }
    }

    /// Turns a plane, rows one after the other.
    pub(super) fn turn<T: Copy + Default>(self, plane: &[T], [width, height]: [usize; 2]) -> Vec<T> {
        let [out_width, _] = self.size([width, height]);
        // Where (0, 0) is shown, and the steps in the shown picture of one step right and one down.
        let (across, down) = (out_width as isize, 1_isize);
        let (w, h) = (width as isize - 1, height as isize - 1);
        let (mut origin, mut right, below) = match self.turns {
            0 => (0, down, across),
            1 => (h, across, -down),
            2 => (w + h * across, -down, -across),
            _ => (w * across, -across, down),
        };
        if self.mirrored {
            origin += w * right;
            right = -right;
        }
        let mut out = vec![T::default(); plane.len()];
        for top in (0..height).step_by(BLOCK) {
            for left in (0..width).step_by(BLOCK) {
                for y in top..(top + BLOCK).min(height) {
                    for x in left..(left + BLOCK).min(width) {
                        let to = origin + x as isize * right + y as isize * below;
                        out[to as usize] = plane[y * width + x];
                    }
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turned by the matrix itself, pixel by pixel.
    fn by_matrix([a, b, c, d]: [i32; 4], plane: &[u8], [width, height]: [usize; 2]) -> Vec<u8> {
        let places: Vec<(i32, i32, u8)> = (0..height * width)
            .map(|k| {
                let (x, y) = ((k % width) as i32, (k / width) as i32);
                (a * x + c * y, b * x + d * y, plane[k])
            })
            .collect();
        let mut places = places;
        places.sort_by_key(|&(x, y, _)| (y, x));
        places.into_iter().map(|(_, _, value)| value).collect()
    }

    #[test]
    fn all_eight_ways_are_those_of_the_matrix() {
        let size = [37, 70];
        let plane: Vec<u8> = (0..size[0] * size[1]).map(|k| (k * 7 % 251) as u8).collect();
        for matrix in [
            [1, 0, 0, 1],
            [0, 1, -1, 0],
            [-1, 0, 0, -1],
            [0, -1, 1, 0],
            [-1, 0, 0, 1],
            [1, 0, 0, -1],
            [0, 1, 1, 0],
            [0, -1, -1, 0],
        ] {
            let [a, b, c, d] = matrix;
            let orientation = Orientation::of_matrix(a << 16, b << 16, c << 16, d << 16);
            let turned = orientation.turn(&plane, size);
            assert_eq!(turned, by_matrix(matrix, &plane, size), "{matrix:?} {orientation:?}");
            let [width, height] = orientation.size(size);
            assert_eq!(width, if a == 0 { size[1] } else { size[0] });
            assert_eq!(width * height, turned.len());
        }
    }
}
