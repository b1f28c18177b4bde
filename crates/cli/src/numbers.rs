//! Numbers of the command line. Each has a range, which its help says.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use clap::builder::TypedValueParser;

/// Reads a number of this range.
pub(crate) fn within<T>(range: RangeInclusive<T>) -> impl TypedValueParser<Value = T>
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    // Who cannot read a half reads whole numbers.
    let kind = if "0.5".parse::<T>().is_ok() { "a number" } else { "a whole number" };
    move |text: &str| {
        let number = text.trim().parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("expected {kind} from {} to {}", range.start(), range.end()))
    }
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;

    use clap::{Arg, Command, Subcommand};

    /// All commands below one, with their names.
    fn commands(command: &Command, name: &str, out: &mut Vec<(String, Command)>) {
        for inner in command.get_subcommands() {
            let name = format!("{name} {}", inner.get_name());
            commands(inner, &name, out);
            out.push((name, inner.clone()));
        }
    }

    /// What comes of a text for one option.
    fn given(argument: &Arg, text: &str) -> Result<(), String> {
        let alone = Arg::new("n").long("n").value_parser(argument.get_value_parser().clone());
        let command = Command::new("one").arg(alone.allow_hyphen_values(true));
        let found = command.try_get_matches_from(["one".to_owned(), format!("--n={text}")]);
        found.map(drop).map_err(|error| error.to_string())
    }

    /// Every option that is a number says its range, takes both ends of it, and nothing beyond.
    #[test]
    fn every_number_has_the_range_that_its_help_says() {
        let mut all = Vec::new();
        commands(&crate::Command::augment_subcommands(Command::new("backlit")), "", &mut all);
        let mut wrong = Vec::new();
        let mut count = 0;
        let kinds = [TypeId::of::<usize>(), TypeId::of::<u8>(), TypeId::of::<u16>(), TypeId::of::<u32>()];
        let kinds = kinds.into_iter().chain([TypeId::of::<u64>(), TypeId::of::<i64>(), TypeId::of::<f64>()]);
        let kinds: Vec<TypeId> = kinds.collect();
        for (name, command) in &all {
            for argument in command.get_arguments() {
                let parser = argument.get_value_parser().type_id();
                let Some(kind) = kinds.iter().find(|kind| parser == **kind) else { continue };
                count += 1;
                let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
                let range = help.rsplit_once(" to ").and_then(|(before, after)| {
                    let (first, last) = (before.rsplit_once('[')?.1, after.split_once(']')?.0);
                    Some([first.parse::<f64>().ok()?, last.parse::<f64>().ok()?])
                });
                let option = format!("{name} --{}", argument.get_id());
                let Some([first, last]) = range else {
                    wrong.push(format!("{option}: no range in its help: {help}"));
                    continue;
                };
                let step = if *kind == TypeId::of::<f64>() { 0.01 * last } else { 1.0 };
                for good in [first, last] {
                    wrong.extend(given(argument, &good.to_string()).err());
                }
                let beyond = [first - step, last + step].map(|number| number.to_string());
                for bad in
                    beyond.iter().map(String::as_str).chain(["nan", "inf", "1e400", "99999999999999999999"])
                {
                    let expected = format!("from {first} to {last}");
                    if !given(argument, bad).is_err_and(|error| error.contains(&expected)) {
                        wrong.push(format!("{option} takes {bad}"));
                    }
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
        assert!(count > 50, "{count}");
    }
}
