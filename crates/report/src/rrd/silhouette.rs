//! The outlines of [`outline::path`](crate::outline::path) as lines.

/// Closed lines, in pixels whose corners are at integers.
pub(super) fn outlines(path: &str) -> Vec<Vec<[f32; 2]>> {
    path.split_terminator('z').map(outline).collect()
}

/// One of them: `M1 0h2v1h-2`.
fn outline(text: &str) -> Vec<[f32; 2]> {
    let starts = text.char_indices().filter(|(_, letter)| letter.is_ascii_alphabetic());
    let starts: Vec<usize> = starts.map(|(start, _)| start).chain([text.len()]).collect();
    let (mut at, mut line) = ([0.0_f32; 2], Vec::new());
    for ends in starts.windows(2) {
        let (command, numbers) = text[ends[0]..ends[1]].split_at(1);
        let numbers: Vec<f32> = numbers.split(' ').filter_map(|number| number.parse().ok()).collect();
        match (command, numbers.as_slice()) {
            ("M", &[x, y]) => at = [x, y],
            ("h", &[across]) => at[0] += across,
            ("v", &[down]) => at[1] += down,
            _ => continue,
        }
        line.push(at);
    }
    line.extend(line.first().copied());
    line
}

#[cfg(test)]
mod tests {
    use backlit_tracking::silhouette::{Label, Mask};

    use super::*;
    use crate::outline::path;

    #[test]
    fn outlines_are_closed_lines_along_the_border() {
        let mask = Mask::from_ascii(".##?\n.#..\n...#").unwrap();
        let lines = outlines(&path(&mask, Label::Subject));
        assert_eq!(lines.len(), 2);
        for line in &lines {
            assert_eq!(line.first(), line.last());
        }
        let length = |line: &Vec<[f32; 2]>| -> f32 {
            line.windows(2)
                .map(|ends| (ends[0][0] - ends[1][0]).abs() + (ends[0][1] - ends[1][1]).abs())
                .sum()
        };
        let mut lengths: Vec<f32> = lines.iter().map(length).collect();
        lengths.sort_by(f32::total_cmp);
        assert_eq!(lengths, [4.0, 8.0]);
        assert!(outlines("").is_empty());
    }
}
