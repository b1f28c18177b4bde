//! `${NAME}` and `${NAME:-default}` in paths.

/// The text with every variable replaced by its value.
///
/// # Errors
/// The name of the first variable that is not set and has no default.
pub(super) fn expand(text: &str, value: &dyn Fn(&str) -> Option<String>) -> Result<String, String> {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, from)) = rest.split_once("${") {
        let Some((variable, after)) = from.split_once('}') else { break };
        out.push_str(before);
        let (name, default) = match variable.split_once(":-") {
            Some((name, default)) => (name, Some(default)),
            None => (variable, None),
        };
        // As in a shell, an empty value counts as none where there is a default.
        let found = value(name).filter(|found| default.is_none() || !found.is_empty());
        match found.as_deref().or(default) {
            Some(found) => out.push_str(found),
            None => return Err(name.to_owned()),
        }
        rest = after;
    }
    Ok(out + rest)
}

/// The process's own environment. Names that an environment cannot have are not set.
pub(super) fn of_process(name: &str) -> Option<String> {
    if name.is_empty() || name.contains(['=', '\0']) {
        return None;
    }
    std::env::var(name).ok().map(from_here)
}

/// A folder that a user names from where they stand is that folder, wherever the take lies.
fn from_here(value: String) -> String {
    let path = std::path::Path::new(&value);
    if !path.is_relative() || value.is_empty() || !path.is_dir() {
        return value;
    }
    match std::path::absolute(path) {
        Ok(absolute) => absolute.to_string_lossy().into_owned(),
        Err(_) => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relative_folder_is_taken_from_where_the_user_stands() {
        // Tests run in the package's folder.
        assert!(std::path::Path::new(&from_here("src".to_owned())).is_absolute());
        for kept in ["/data", "no such folder", ""] {
            assert_eq!(from_here(kept.to_owned()), kept);
        }
    }

    #[test]
    fn variables_and_defaults() {
        let value = |name: &str| match name {
            "DATA" => Some("/data".to_owned()),
            "EMPTY" => Some(String::new()),
            _ => None,
        };
        assert_eq!(expand("${DATA}/a${DATA:-x}", &value).unwrap(), "/data/a/data");
        assert_eq!(expand("${NONE:-../b}/c${EMPTY:-d}${EMPTY}", &value).unwrap(), "../b/cd");
        assert_eq!(expand("a$b{c}", &value).unwrap(), "a$b{c}");
        assert_eq!(expand("a${b", &value).unwrap(), "a${b");
        assert_eq!(expand("${NONE}", &value).unwrap_err(), "NONE");
        assert_eq!(of_process(""), None);
        assert_eq!(of_process("A=B"), None);
    }
}
