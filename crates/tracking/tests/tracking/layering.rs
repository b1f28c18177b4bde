//! The house's rule of who may know whom: data flows one way, and `use` follows it.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules that each module may use, besides `numbers` and `statistics`. A new module needs a row.
fn allowed(module: &str) -> Option<Vec<&'static str>> {
    let fit = ["residual", "render", "body", "camera", "silhouette", "optimize", "cancel"];
    Some(match module {
        "lib" => Vec::new(),
        "geometry" | "cancel" | "processor" | "names" | "numbers" | "statistics" => Vec::new(),
        "prior" => vec!["geometry"],
        "optimize" | "silhouette" => vec!["processor"],
        "body" => vec!["geometry", "names"],
        "camera" => vec!["geometry", "names", "optimize"],
        "segment" => vec!["silhouette", "cancel", "processor"],
        "render" => vec!["body", "camera", "silhouette", "geometry", "cancel", "processor"],
        "residual" => {
            vec!["prior", "render", "body", "camera", "silhouette", "optimize", "geometry", "processor"]
        }
        "filter" => vec!["geometry"],
        "metrics" => vec!["body"],
        "posing" => vec!["body", "residual", "optimize"],
        "synchronise" => vec!["camera", "silhouette"],
        "visual_hull" => vec!["camera", "silhouette", "cancel"],
        "cues" => vec!["residual", "render", "body", "camera", "silhouette"],
        "fit" => fit.to_vec(),
        "observability" => vec!["fit", "residual", "render", "body", "camera", "optimize", "geometry"],
        "search" => [&fit[..], &["fit", "posing", "metrics", "geometry", "visual_hull"]].concat(),
        "particles" => [&fit[..], &["fit", "geometry", "search"]].concat(),
        "templates" => [&fit[..], &["fit", "geometry", "search", "particles"]].concat(),
        "acquisition" => [&fit[..], &["fit", "search", "templates"]].concat(),
        "initialisation" => [&fit[..], &["fit", "search", "particles", "templates", "acquisition"]].concat(),
        "track" => [&fit[..], &["fit", "cues", "search", "filter"]].concat(),
        "body_fit" => [&fit[..], &["fit", "track", "metrics", "search"]].concat(),
        "body_spheres" => [&fit[..], &["fit", "names"]].concat(),
        _ => return None,
    })
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Lines without comments, and without `#[cfg(test)]` modules; line numbers stay.
fn code_lines(text: &str) -> Vec<(usize, String)> {
    let mut lines = Vec::new();
    let mut all = text.lines().enumerate();
    while let Some((number, line)) = all.next() {
        let code = line.split("//").next().unwrap_or_default();
        if code.trim() == "#[cfg(test)]" {
            // rustfmt closes an item with the indentation that it was opened with.
            let indentation = code.len() - code.trim_start().len();
            let close = format!("{}}}", " ".repeat(indentation));
            for (_, line) in all.by_ref() {
                let is_statement = line.trim_end().ends_with(';') && !line.starts_with(&format!("{close} "));
                if line == close || (is_statement && line.len() - line.trim_start().len() == indentation) {
                    break;
                }
            }
            continue;
        }
        lines.push((number + 1, code.to_owned()));
    }
    lines
}

fn identifier(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    &text[..end]
}

/// Modules of the crate that a piece of code names by `crate::…` or by enough `super::`.
fn arrows(code: &str, depth: usize) -> Vec<String> {
    let root_by_super = "super::".repeat(depth);
    let mut found = Vec::new();
    for prefix in ["crate::", root_by_super.as_str()] {
        for (start, _) in code.match_indices(prefix) {
            let before = code[..start].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':' || c == '$') {
                continue;
            }
            let rest = &code[start + prefix.len()..];
            match rest.strip_prefix('{') {
                // use crate::{body::Pose, camera::{Camera, Rig}}: the names at depth one.
                Some(group) => {
                    let (mut nested, mut is_first) = (0, true);
                    for (index, c) in group.char_indices() {
                        match c {
                            '{' => nested += 1,
                            '}' if nested == 0 => break,
                            '}' => nested -= 1,
                            ',' if nested == 0 => is_first = true,
                            _ if is_first && !c.is_whitespace() => {
                                found.push(identifier(&group[index..]).to_owned());
                                is_first = false;
                            }
                            _ => {}
                        }
                    }
                }
                None => found.push(identifier(rest).to_owned()),
            }
        }
    }
    found.retain(|name| name != "super" && name != "self");
    found
}

#[test]
fn modules_use_only_what_they_may() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    assert!(files.len() > 30, "the sources were not found");
    let (mut failures, mut count) = (Vec::new(), 0);
    for path in &files {
        let inside = path.strip_prefix(&source).unwrap();
        let parts: Vec<&str> = inside.iter().map(|part| part.to_str().unwrap()).collect();
        let module = parts[0].trim_end_matches(".rs");
        let Some(allowed) = allowed(module) else {
            failures.push(format!("{}: module `{module}` has no row in the table", inside.display()));
            continue;
        };
        // How many `super` lead to the crate's root.
        let depth = parts.len();
        let lines = code_lines(&fs::read_to_string(path).unwrap());
        // Joined, so that a group over several lines is one. What is shown under another name is not used.
        let code = lines.iter().filter(|(_, line)| !line.trim_start().starts_with("pub use crate::"));
        let code: String = code.map(|(_, line)| format!("{line}\n")).collect();
        for target in arrows(&code, depth) {
            count += 1;
            if target != module
                && !["numbers", "statistics", "fixtures"].contains(&target.as_str())
                && !allowed.contains(&target.as_str())
            {
                let needle = format!("{target}::");
                let line = lines.iter().find(|(_, line)| line.contains(&needle)).map_or(0, |(n, _)| *n);
                failures.push(format!("{}:{line}: `{module}` uses `{target}`", inside.display()));
            }
        }
    }
    failures.dedup();
    assert!(failures.is_empty(), "{} arrows against the rule:\n{}", failures.len(), failures.join("\n"));
    assert!(count > 50, "only {count} arrows were found");
}

#[test]
fn arrows_are_found_in_every_spelling() {
    let code = "use crate::body::Pose;\nuse crate::{camera::{Camera, Rig}, render::View};\n\
                let x: super::super::track::Fit = crate::filter::belief();\nuse super::limb::Limb;\n\
                macro_crate::no; super::super::super::above";
    assert_eq!(arrows(code, 2), ["body", "camera", "render", "filter", "track"]);
    let text = "use crate::a;\n#[cfg(test)]\nmod tests {\n    use crate::b;\n}\nuse crate::c; // crate::d\n";
    let code: String = code_lines(text).into_iter().map(|(_, line)| line + "\n").collect();
    assert_eq!(arrows(&code, 1), ["a", "c"]);
}

#[test]
fn the_core_knows_no_window() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut failures = Vec::new();
    for file in ["../../crates/document/src/lib.rs", "Cargo.toml"] {
        let text = fs::read_to_string(root.join(file)).unwrap();
        for window in ["egui", "eframe", "rfd"] {
            for (number, line) in code_lines(&text) {
                if line.split(|c: char| !c.is_alphanumeric()).any(|word| word.starts_with(window)) {
                    failures.push(format!("{file}:{number}: mentions {window}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
