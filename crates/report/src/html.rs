//! The page: its form, filled. Everything a user named is escaped.

use std::fmt::Write;

use backlit_words::format;

use crate::escape;
use crate::page::{Cell, Page, Table};
use crate::wire;

const FORM: &str = include_str!("../assets/page.html");
const STYLE: &str = include_str!("../assets/page.css");
/// The script's parts in their order: each knows those before it.
const SCRIPT: [&str; 7] = [
    include_str!("../assets/data.js"),
    include_str!("../assets/capsules.js"),
    include_str!("../assets/views.js"),
    include_str!("../assets/scene.js"),
    include_str!("../assets/curves.js"),
    include_str!("../assets/steps.js"),
    include_str!("../assets/page.js"),
];

/// The whole page as one HTML text. The same page gives the same text, to the letter.
pub fn to_html(page: &Page) -> String {
    let data = escape::json(&wire::data(page).to_string());
    let mut out = String::with_capacity(FORM.len() + STYLE.len() + data.len() + (64 << 10));
    let mut rest = FORM;
    // What is put in is not looked at again, so no name can be taken for a place of the form.
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((name, after)) = after.split_once("}}") else { break };
        out.push_str(before);
        part(&mut out, page, name, &data);
        rest = after;
    }
    out.push_str(rest);
    out
}

/// Writes the part of the page that a place of the form names.
fn part(out: &mut String, page: &Page, name: &str, data: &str) {
    match name {
        "title" => out.push_str(&escape::html(&page.title)),
        "style" => out.push_str(STYLE),
        "script" => SCRIPT.into_iter().for_each(|part| out.push_str(part)),
        "data" => out.push_str(data),
        "about" => out.push_str(&escape::html(&about(page))),
        "version" => out.push_str(env!("CARGO_PKG_VERSION")),
        "notes" => notes(out, page),
        "bookmarks" => bookmarks(out, page),
        "lost" => lost(out, page),
        "tables" => page.tables.iter().for_each(|table| self::table(out, table)),
        "settings" => settings(out, page),
        "commands" => commands(out, page),
        _ => {}
    }
}

/// "70 frames (0 to 69) at 60 frames a second, 4 cameras".
fn about(page: &Page) -> String {
    let ends = page.frames.first().zip(page.frames.last());
    let range = ends.map_or(String::new(), |(first, last)| format!(" ({} to {})", first.number, last.number));
    let cameras = match page.cameras.len() {
        0 => String::new(),
        count => format!(", {}", format::counted(count, "camera")),
    };
    let rate = format::short(page.frame_rate);
    format!("{}{range} at {rate} frames a second{cameras}", format::counted(page.frames.len(), "frame"))
}

fn notes(out: &mut String, page: &Page) {
    for note in &page.notes {
        let _ = write!(out, "<p class=\"note\">{}</p>", escape::html(note));
    }
}

/// A link that sets the frame.
fn link(frame: usize) -> String {
    format!("<a href=\"#frame={frame}\">frame {frame}</a>")
}

fn bookmarks(out: &mut String, page: &Page) {
    if page.bookmarks.is_empty() {
        return;
    }
    out.push_str(
        "<section aria-labelledby=\"bookmarks\"><h2 id=\"bookmarks\">Bookmarks</h2><ul class=\"links\">",
    );
    for (index, bookmark) in page.bookmarks.iter().enumerate() {
        let camera = bookmark.camera.and_then(|camera| page.cameras.get(camera));
        let joint = bookmark.joint.map(|joint| match joint.checked_sub(1) {
            Some(limb) => page.limbs.get(limb).map_or("", |limb| limb.joint.as_str()),
            None => "root",
        });
        let places = camera.map(|camera| camera.name.as_str()).into_iter().chain(joint);
        let places: String = places.map(|place| format!(", {}", escape::html(place))).collect();
        let (frame, text) = (bookmark.frame, escape::html(&bookmark.text));
        let _ = write!(out, "<li><a href=\"#bookmark={index}\">Frame {frame}{places}</a> {text}</li>");
    }
    out.push_str("</ul></section>");
}

/// Lost frames, those that follow one another as one.
fn lost(out: &mut String, page: &Page) {
    let lost: Vec<(usize, &str)> =
        page.frames.iter().filter_map(|frame| Some((frame.number, frame.lost.as_deref()?))).collect();
    if lost.is_empty() {
        return;
    }
    out.push_str("<section aria-labelledby=\"lost\"><h2 id=\"lost\">Lost frames</h2><ul class=\"links\">");
    for run in lost.chunk_by(|a, b| a.0 + 1 == b.0 && a.1 == b.1) {
        let (Some(&(first, why)), Some(&(last, _))) = (run.first(), run.last()) else { continue };
        let to = if last > first { format!(" to {last}") } else { String::new() };
        let _ = write!(out, "<li>{}{to}: {}</li>", link(first), escape::html(why));
    }
    out.push_str("</ul></section>");
}

fn table(out: &mut String, table: &Table) {
    let id = format!(
        "table-{}",
        escape::html(&table.title.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "-"))
    );
    let [opened, named, closed] = match table.is_folded {
        true => ["<details><summary>", "</summary>", "</details>"],
        false => [""; 3],
    };
    let title = escape::html(&table.title);
    let _ = write!(out, "<section aria-labelledby=\"{id}\">{opened}<h2 id=\"{id}\">{title}</h2>{named}");
    if !table.note.is_empty() {
        let _ = write!(out, "<p class=\"hint\">{}</p>", escape::html(&table.note));
    }
    let _ = write!(
        out,
        "<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-labelledby=\"{id}\"><table><thead><tr>"
    );
    let is_number = |column: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(column));
        cells.clone().count() > 0 && cells.clone().all(|cell| is_numeric(&cell.text))
    };
    let numeric: Vec<bool> = (0..table.columns.len()).map(is_number).collect();
    let class = |column: usize| if numeric.get(column) == Some(&true) { " class=\"number\"" } else { "" };
    for (column, title) in table.columns.iter().enumerate() {
        let _ = write!(out, "<th scope=\"col\"{}>{}</th>", class(column), escape::html(title));
    }
    out.push_str("</tr></thead><tbody>");
    for row in &table.rows {
        out.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            let text = self::cell(cell);
            let _ = match column {
                0 => write!(out, "<th scope=\"row\">{text}</th>"),
                _ => write!(out, "<td{}>{text}</td>", class(column)),
            };
        }
        out.push_str("</tr>");
    }
    let _ = write!(out, "</tbody></table></div>{closed}</section>");
}

fn cell(cell: &Cell) -> String {
    let text = escape::html(&cell.text);
    match cell.frame {
        Some(frame) => format!("<a href=\"#frame={frame}\">{text}</a>"),
        None => text,
    }
}

/// Whether a field is a number, or the dash of one that is not known.
fn is_numeric(text: &str) -> bool {
    text.is_empty() || text == "–" || text.replace(['\u{2212}', '\u{2009}'], "").parse::<f64>().is_ok()
}

fn settings(out: &mut String, page: &Page) {
    if page.settings.is_empty() {
        return;
    }
    out.push_str("<section aria-labelledby=\"settings\"><h2 id=\"settings\">Settings</h2><table><tbody>");
    for [name, value] in &page.settings {
        let [name, value] = [name, value].map(|text| escape::html(text));
        let _ = write!(out, "<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>");
    }
    out.push_str("</tbody></table></section>");
}

fn commands(out: &mut String, page: &Page) {
    if page.commands.is_empty() {
        return;
    }
    out.push_str("<section aria-labelledby=\"commands\"><h2 id=\"commands\">Commands</h2>");
    for command in &page.commands {
        let [title, line] = [&command.title, &command.line].map(|text| escape::html(text));
        let _ = write!(out, "<h3>{title}</h3><pre tabindex=\"0\"><code>{line}</code></pre>");
    }
    out.push_str("</section>");
}
