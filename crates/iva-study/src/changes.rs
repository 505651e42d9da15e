//! Differences between two resolved studies, in words.

use std::collections::BTreeMap;

use toml::{Table, Value};

use crate::source::shortened;

/// Largest number of differences that are listed.
const NAMED: usize = 5;

/// The differences between two resolved studies, one sentence a key. The section `[report]` is not compared.
pub(crate) fn changes(was: &str, is: &str) -> Vec<String> {
    let (was, is) = (keys(was), keys(is));
    let all: BTreeMap<&String, ()> = was.keys().chain(is.keys()).map(|key| (key, ())).collect();
    let shown = |value: Option<&String>| value.map_or("not given".to_owned(), |it| shortened(it));
    let mut found: Vec<String> = all
        .into_keys()
        .filter(|key| was.get(*key) != is.get(*key))
        .map(|key| format!("{key} was {}, is {}", shown(was.get(key)), shown(is.get(key))))
        .collect();
    if found.is_empty() {
        found.push("the numbers of a record or of the points differ".to_owned());
    }
    if found.len() > NAMED {
        let more = found.len() - NAMED;
        found.truncate(NAMED);
        found.push(format!("{more} more"));
    }
    found
}

/// Every key of a study but those of `[report]`, with its value in TOML.
fn keys(text: &str) -> BTreeMap<String, String> {
    let mut keys = BTreeMap::new();
    let mut study: Table = text.parse().unwrap_or_default();
    study.remove("report");
    collect(&mut keys, "", &Value::Table(study));
    keys
}

/// Adds the keys below `path` with their values.
fn collect(keys: &mut BTreeMap<String, String>, path: &str, value: &Value) {
    let below =
        |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(name, it)| collect(keys, &below(name), it)),
        Value::Array(items) if items.iter().any(Value::is_table) => {
            for (index, item) in items.iter().enumerate() {
                collect(keys, &below(&index.to_string()), item);
            }
        }
        plain => {
            keys.insert(path.to_owned(), plain.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_differ_are_named() {
        let was = "[run]\nperiods = 30.0\n[sweep]\ngap = [1.0, 2.0]\n[report]\ncount = 3";
        let is = "[run]\nperiods = 40.0\n[sweep]\ngap = [1.0, 2.5]\nmass = [3.0]";
        assert_eq!(
            changes(was, is),
            [
                "run.periods was 30.0, is 40.0",
                "sweep.gap was [1.0, 2.0], is [1.0, 2.5]",
                "sweep.mass was not given, is [3.0]",
            ]
        );
    }

    #[test]
    fn equal_texts_differ_in_what_their_files_hold() {
        assert_eq!(changes("a = 1", "a = 1"), ["the numbers of a record or of the points differ"]);
    }
}
