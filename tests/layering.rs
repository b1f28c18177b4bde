//! The house's rules, which the tables of ARCHITECTURE.md say: which crate, which module of the core and which room of `src/` may
//! use which; features do not know each other; files stay small. And the picture of the house in ARCHITECTURE.md is the code's.

#![expect(clippy::unwrap_used, reason = "a panic is a test's answer")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Arrows from one feature to another that are allowed, and why.
const EXCEPTIONS: [(&str, &str, &str); 0] = [];

/// Most lines of a file.
const MOST_LINES: usize = 450;

/// The rooms from the roof down.
const ROOMS: [&str; 6] = ["cli", "app", "shell", "features", "context", "session"];

/// Crates that only some of the rooms may use.
const CRATES: [&str; 6] = ["cli", "runs", "document", "take", "jobs", "ui"];

/// Modules that every module of the core may use; `fixtures` is compiled for tests only.
const EVERYWHERE: [&str; 3] = ["numbers", "statistics", "fixtures"];

/// The lines about the picture in ARCHITECTURE.md.
const PICTURE: [&str; 2] = ["<!-- the house: made from the code -->", "<!-- the end of the house -->"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A file: its module path, and its code without comments and tests.
struct Source {
    path: String,
    module: Vec<String>,
    code: String,
    lines: usize,
}

impl Source {
    fn room(&self) -> &str {
        self.module.first().map_or("", String::as_str)
    }

    /// Module paths inside the crate that the code names, by `crate::…` or by `super::…`, and [`CRATES`].
    fn uses(&self) -> BTreeSet<Vec<String>> {
        let names = |name: &&str| self.code.contains(&format!("backlit_{name}::"));
        let mut found: BTreeSet<_> =
            CRATES.into_iter().filter(names).map(|name| vec![name.to_owned()]).collect();
        for (start, _) in self.code.match_indices("crate::") {
            paths(&[], &self.code[start + "crate::".len()..], &mut found);
        }
        for depth in 1..=self.module.len() {
            let supers = "super::".repeat(depth);
            for (start, _) in self.code.match_indices(&supers) {
                let is_whole = !self.code[..start].ends_with("super::");
                let rest = &self.code[start + supers.len()..];
                if is_whole && !rest.starts_with("super::") {
                    paths(&self.module[..self.module.len() - depth], rest, &mut found);
                }
            }
        }
        found
    }
}

/// The module paths at the beginning of `text`, which may be a group, below `base`.
fn paths(base: &[String], text: &str, found: &mut BTreeSet<Vec<String>>) {
    if let Some(group) = text.strip_prefix('{') {
        let mut depth = 0;
        let mut first = 0;
        for (index, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth > 0 => depth -= 1,
                ',' | '}' if depth == 0 => {
                    paths(base, group[first..index].trim(), found);
                    first = index + 1;
                    if c == '}' {
                        return;
                    }
                }
                _ => {}
            }
        }
        return;
    }
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    let mut path = base.to_vec();
    let name = &text[..end];
    if name.is_empty() || name.starts_with(char::is_uppercase) {
        found.insert(path);
        return;
    }
    path.push(name.to_owned());
    match text[end..].strip_prefix("::") {
        Some(rest) => paths(&path, rest, found),
        None => {
            found.insert(path);
        }
    }
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
}

/// The code without comments and without what is compiled for tests only.
fn without_tests(text: &str) -> String {
    let mut code = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let line = line.split("//").next().unwrap_or_default();
        if line.trim() == "#[cfg(test)]" {
            let indentation = line.len() - line.trim_start().len();
            let close = format!("{}}}", " ".repeat(indentation));
            for line in lines.by_ref() {
                // rustfmt closes an item with the indentation that it was opened with.
                let is_statement = line.ends_with(';') && line.len() - line.trim_start().len() == indentation;
                if line == close || is_statement {
                    break;
                }
            }
            continue;
        }
        code.push_str(line);
        code.push('\n');
    }
    code
}

/// The files below `folder` of the project, without tests.
fn sources_of(folder: &str) -> Vec<Source> {
    let below = root().join(folder);
    let mut files = Vec::new();
    rust_files(&below, &mut files);
    assert!(files.len() > 150, "the sources were not found");
    let source = |path: &PathBuf| {
        let inside = path.strip_prefix(&below).unwrap();
        let text = fs::read_to_string(path).unwrap();
        let module: Vec<String> =
            inside.with_extension("").iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        Source {
            path: format!("{folder}/{}", inside.display()),
            module,
            code: without_tests(&text),
            lines: text.lines().count(),
        }
    };
    let is_code = |source: &Source| {
        let is_test = source.module.last().is_some_and(|name| name == "tests" || name == "testing");
        !is_test && !["lib", "main", "prelude"].contains(&source.room())
    };
    files.iter().map(source).filter(is_code).collect()
}

fn sources() -> Vec<Source> {
    sources_of("src")
}

/// A table of ARCHITECTURE.md that begins with this cell: what each of its first column may use, the last column. "`fit` and
/// what it may use" is `fit` and what its own row says.
fn allowed(head: &str) -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let table = text.split(&format!("| {head} |")).nth(1).expect("the table is there");
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let names = |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let mut table: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split('|').collect();
        let last = cells[cells.len() - 2];
        let mut may: BTreeSet<String> = names(last).into_iter().collect();
        if let Some((of, _)) = last.split_once(" and what it may use") {
            may.extend(table[names(of).last().unwrap()].clone());
        }
        table.extend(names(cells[1]).into_iter().map(|name| (name, may.clone())));
    }
    table
}

/// Arrows from one row of a table to another that the table does not allow.
fn forbidden(sources: &[Source], allowed: &BTreeMap<String, BTreeSet<String>>, free: &[&str]) -> Vec<String> {
    let mut wrong = Vec::new();
    for source in sources {
        let Some(may) = allowed.get(source.room()) else {
            wrong.push(format!("{}: `{}` has no row", source.path, source.room()));
            continue;
        };
        for path in source.uses() {
            let Some(target) = path.first() else { continue };
            let is_held = allowed.contains_key(target) || CRATES.contains(&target.as_str());
            let is_free = target == source.room() || free.contains(&target.as_str());
            if is_held && !is_free && !may.contains(target) {
                wrong.push(format!("{} uses {}", source.path, path.join("::")));
            }
        }
    }
    wrong
}

#[test]
fn rooms_use_only_what_they_may() {
    let allowed = allowed("room of `src/`");
    assert_eq!(allowed.len(), ROOMS.len(), "the table of rooms was not understood");
    let wrong = forbidden(&sources(), &allowed, &[]);
    assert!(wrong.is_empty(), "ARCHITECTURE.md does not allow:\n{}", wrong.join("\n"));
}

#[test]
fn modules_of_the_core_use_only_what_they_may() {
    let allowed = allowed("module");
    assert!(allowed.len() > 25 && allowed["search"].contains("render"), "the table was not understood");
    let mut sources = sources_of("crates/tracking/src");
    for source in &mut sources {
        // What is shown under another name is not used.
        let is_used = |line: &&str| !line.starts_with("pub use crate::");
        source.code = source.code.lines().filter(is_used).flat_map(|line| [line, "\n"]).collect();
    }
    let wrong = forbidden(&sources, &allowed, &EVERYWHERE);
    assert!(wrong.is_empty(), "ARCHITECTURE.md does not allow:\n{}", wrong.join("\n"));
    let arrows: usize = sources.iter().map(|source| source.uses().len()).sum();
    assert!(arrows > 300, "only {arrows} arrows were found");
}

/// The first word of a crate's row is its folder or, of a library of its own, its name.
#[test]
fn crates_use_only_what_they_may() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let table = text.split("| crate |").nth(1).unwrap();
    let mut count = 0;
    for row in table.lines().skip(2).take_while(|line| line.starts_with("| `crates/")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let folder = cells[1].split('`').nth(1).unwrap();
        let may: BTreeSet<&str> = cells[cells.len() - 2].split(", ").collect();
        let manifest: toml::Table =
            fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap().parse().unwrap();
        let inside = |name: &String| {
            name.strip_prefix("backlit-")
                .or((name == "egui-painter").then_some("egui-painter"))
                .map(str::to_owned)
        };
        let used = manifest
            .get("dependencies")
            .and_then(toml::Value::as_table)
            .into_iter()
            .flat_map(toml::Table::keys)
            .filter_map(inside);
        let wrong: Vec<String> = used.filter(|name| !may.contains(name.as_str())).collect();
        assert!(wrong.is_empty(), "{folder} uses {wrong:?}; ARCHITECTURE.md allows {may:?}");
        count += 1;
    }
    let folders = fs::read_dir(root().join("crates")).unwrap().count();
    assert_eq!(count, folders, "every crate has a row");
}

#[test]
fn the_core_knows_no_window() {
    let manifests = ["document", "tracking", "cli"].map(|name| format!("crates/{name}/Cargo.toml"));
    for file in manifests.into_iter().chain(["crates/document/src/lib.rs".to_owned()]) {
        let text = without_tests(&fs::read_to_string(root().join(&file)).unwrap());
        let is_window = |word: &&str| ["egui", "eframe", "rfd"].iter().any(|window| word.starts_with(window));
        let window: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).filter(is_window).collect();
        assert!(window.is_empty(), "{file} mentions {window:?}");
    }
}

#[test]
fn arrows_are_found_in_every_spelling() {
    let code = "use crate::body::Pose;\nuse crate::{camera::{Camera, Rig}, render::View};\n\
                let x: super::super::track::Fit = crate::filter::belief();\nuse super::limb::Limb;";
    let module = ["search", "limbs"].map(str::to_owned).to_vec();
    let source = |code: &str| Source {
        path: String::new(),
        module: module.clone(),
        code: without_tests(code),
        lines: 0,
    };
    let first = |code: &str| -> BTreeSet<String> {
        source(code).uses().into_iter().filter_map(|path| path.first().cloned()).collect()
    };
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
    assert_eq!(first(code), names(&["body", "camera", "filter", "render", "search", "track"]));
    let text =
        "use crate::a::b;\n#[cfg(test)]\nmod tests {\n    use crate::c;\n}\nuse crate::d::e; // crate::f\n";
    assert_eq!(first(text), names(&["a", "d"]));
}

#[test]
fn features_do_not_know_each_other() {
    let mut wrong = BTreeSet::new();
    for source in sources().iter().filter(|source| source.room() == "features") {
        let Some(own) = source.module.get(1) else { continue };
        for path in source.uses().iter().filter(|path| path.first().is_some_and(|room| room == "features")) {
            let Some(other) = path.get(1).filter(|other| *other != own) else { continue };
            if !EXCEPTIONS.iter().any(|(from, to, _)| from == own && to == other) {
                wrong.insert(format!("{} uses {}", source.path, path.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "{} arrows:\n{}", wrong.len(), Vec::from_iter(wrong).join("\n"));
}

#[test]
fn no_room_is_in_a_circle() {
    let mut arrows: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for source in sources() {
        let to = source.uses().into_iter().filter_map(|path| path.first().cloned());
        arrows.entry(source.room().to_owned()).or_default().extend(to);
    }
    // Rooms that use none of the others any more are taken away until nothing changes.
    while let Some(room) = arrows
        .iter()
        .find(|(room, to)| to.iter().all(|to| to == *room || !arrows.contains_key(to)))
        .map(|it| it.0.clone())
    {
        arrows.remove(&room);
    }
    assert!(arrows.is_empty(), "in a circle: {:?}", arrows.keys());
}

#[test]
fn files_are_small_and_of_one_module_style() {
    let long = sources().into_iter().filter(|source| source.lines > MOST_LINES);
    let long: Vec<String> =
        long.map(|source| format!("{} has {} lines", source.path, source.lines)).collect();
    assert!(long.is_empty(), "{}", long.join("\n"));
    let style = sources().into_iter().find(|source| source.path.ends_with("mod.rs"));
    assert!(style.is_none(), "foo.rs beside foo/, not {}", style.unwrap().path);
}

/// The rooms from the roof down with what each uses, and the features by name.
fn picture() -> String {
    let sources = sources();
    let mut text = String::from("```text\n");
    for room in ROOMS {
        let of_room = || sources.iter().filter(|source| source.room() == room);
        let uses: BTreeSet<String> =
            of_room().flat_map(Source::uses).filter_map(|path| path.first().cloned()).collect();
        let below = ROOMS.iter().chain(&CRATES).filter(|other| **other != room && uses.contains(**other));
        let below: Vec<&str> = below.copied().collect();
        let arrow = if below.is_empty() { "" } else { "→ " };
        text += format!("{room:<10} {arrow}{}", below.join(" ")).trim_end();
        text.push('\n');
        if room == "features" {
            let names: BTreeSet<&str> =
                of_room().filter_map(|source| source.module.get(1)).map(String::as_str).collect();
            text += &format!("           [ {} ]\n", Vec::from_iter(names).join(" | "));
        }
    }
    text + "```\n"
}

#[test]
fn the_picture_in_architecture_is_the_codes() {
    let path = root().join("ARCHITECTURE.md");
    let text = fs::read_to_string(&path).unwrap();
    let [begin, end] = PICTURE;
    let (before, rest) = text.split_once(begin).expect("where the picture begins");
    let (old, after) = rest.split_once(end).expect("where the picture ends");
    let new = format!("\n{}", picture());
    if std::env::var_os("UPDATE_ARCHITECTURE").is_some() {
        fs::write(&path, format!("{before}{begin}{new}{end}{after}")).unwrap();
    } else {
        assert_eq!(old, new, "UPDATE_ARCHITECTURE=1 cargo test --test layering makes it again");
    }
}

/// Files of the program that name a solid; the kernels' own words for shapes are beside the first.
const NAMING_SOLIDS: [&str; 5] = [
    "crates/tracking/src/render/primitive.rs",
    "crates/tracking/src/render/renderer.rs",
    "crates/ui/src/drawing/limbs.rs",
    "src/context/command/table.rs",
    "src/features/scene/raster/shapes.rs",
];

#[test]
fn a_solid_is_named_in_few_files() {
    let mut files = Vec::new();
    rust_files(&root().join("src"), &mut files);
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        rust_files(&entry.unwrap().path().join("src"), &mut files);
    }
    files.retain(|file| {
        let text = fs::read_to_string(file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        ["RendererKind::Cylinder", "\"cylinder\"", "\"Cylinder\""].iter().any(|name| code.contains(name))
    });
    files.sort();
    assert_eq!(files, NAMING_SOLIDS.map(|file| root().join(file)));
}
