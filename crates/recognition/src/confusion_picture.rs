//! A confusion matrix as a picture (SVG): rows are what motions were, columns what they were called, the darker the more of the row.

use std::fmt::Write;

use crate::evaluation::Confusion;

/// Side of a field, px.
const FIELD: usize = 56;
/// Room for names at the left and at the top.
const MARGIN: usize = 120;

/// The matrix of windows with the clips' in small numbers below.
#[must_use]
pub fn to_svg(confusion: &Confusion) -> String {
    let count = confusion.classes.len();
    let side = MARGIN + count * FIELD + 20;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{side}\" height=\"{}\" viewBox=\"0 0 {side} {}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        side + 30,
        side + 30
    );
    for (index, class) in confusion.classes.iter().enumerate() {
        let (middle, before) = (MARGIN + index * FIELD + FIELD / 2, MARGIN - 8);
        let name = escaped(class);
        write_text(&mut out, [before, middle + 4], "text-anchor=\"end\"", &name);
        let turned = format!("text-anchor=\"start\" transform=\"rotate(-45 {middle} {before})\"");
        write_text(&mut out, [middle, before], &turned, &name);
    }
    for row in 0..count {
        let all: usize = confusion.windows[row].iter().sum();
        for column in 0..count {
            let windows = confusion.windows[row][column];
            let part = windows as f64 / all.max(1) as f64;
            let [x, y] = [column, row].map(|index| MARGIN + index * FIELD);
            let shade = |full: f64| (255.0 + (full - 255.0) * part) as u8;
            let [r, g, b] = if row == column { [30.0, 110.0, 70.0] } else { [170.0, 50.0, 40.0] }.map(shade);
            let ink = if part > 0.55 { "#ffffff" } else { "#222222" };
            let _ = writeln!(
                out,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{FIELD}\" height=\"{FIELD}\" fill=\"rgb({r},{g},{b})\" stroke=\"#dddddd\"/>"
            );
            if windows > 0 {
                let style = format!("text-anchor=\"middle\" fill=\"{ink}\"");
                write_text(&mut out, [x + FIELD / 2, y + 26], &style, &format!("{:.0} %", 100.0 * part));
            }
            let clips = confusion.clips[row][column];
            if clips > 0 {
                let style = format!("text-anchor=\"middle\" font-size=\"11\" fill=\"{ink}\"");
                write_text(&mut out, [x + FIELD / 2, y + 44], &style, &clips.to_string());
            }
        }
    }
    let legend = "rows: what it was; columns: what it was called; per cent of windows, number of clips";
    write_text(&mut out, [MARGIN, side + 8], "font-size=\"11\"", legend);
    out.push_str("</svg>\n");
    out
}

fn write_text(out: &mut String, [x, y]: [usize; 2], attributes: &str, words: &str) {
    let _ = writeln!(out, "<text x=\"{x}\" y=\"{y}\" {attributes}>{words}</text>");
}

fn escaped(text: &str) -> String {
    let letters = text.chars().filter(|letter| !letter.is_control()).take(24);
    letters
        .map(|letter| match letter {
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '&' => "&amp;".to_owned(),
            '"' => "&quot;".to_owned(),
            other => other.to_string(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_count_is_in_the_picture() {
        let confusion = Confusion {
            classes: vec!["a<b".to_owned(), "run".to_owned()],
            clips: vec![vec![17, 0], vec![3, 29]],
            windows: vec![vec![90, 10], vec![0, 50]],
        };
        let svg = to_svg(&confusion);
        for expected in ["a&lt;b", ">run<", ">90 %<", ">10 %<", ">100 %<", ">17<", ">29<", ">3<"] {
            assert!(svg.contains(expected), "{expected}");
        }
        assert!(!svg.contains("a<b") && !svg.contains(">0 %<"));
    }
}
