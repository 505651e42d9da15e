//! Checked reading of single values of a study file, with errors at their place.

use std::ops::Range;

use iva_sweep::Invalid;
use iva_sweep::fields::{Allowed, FieldId, nearest};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::error::Error;
use crate::source::{Source, shortened};

/// A value with its place in the file.
pub(crate) type Value<'t> = Spanned<DeValue<'t>>;
/// A key with its place in the file.
pub(crate) type Key<'t> = Spanned<DeString<'t>>;

/// The entries of a table in the order of the file.
pub(crate) fn entries<'a, 't>(table: &'a DeTable<'t>) -> Vec<(&'a Key<'t>, &'a Value<'t>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// The value of a float or integer; `None` for another type.
pub(crate) fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i128::from_str_radix(integer.as_str(), integer.radix()).map(|number| number as f64).ok()
        }
        _ => None,
    }
}

/// Reads a number in the allowed range.
pub(crate) fn number(
    source: &Source,
    field: &str,
    value: &Value<'_>,
    allowed: Allowed,
) -> Result<f64, Error> {
    let words = allowed.words();
    let Some(number) = as_number(value.get_ref()) else {
        let kind = with_article(value.get_ref());
        return Err(source.bad_value(field, value.span(), &format!("give {words}, not {kind}")));
    };
    if allowed.contains(number) {
        Ok(number)
    } else {
        Err(source.bad_value(field, value.span(), &format!("give {words}")))
    }
}

/// Reads a whole number from `least` to `most`.
pub(crate) fn whole_number(
    source: &Source,
    field: &str,
    value: &Value<'_>,
    (least, most): (u64, u64),
) -> Result<u64, Error> {
    let number = match value.get_ref() {
        // A double would round numbers beyond 2⁵³.
        DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        other => as_number(other)
            .filter(|number| number.fract() == 0.0)
            .filter(|number| (least as f64..=most as f64).contains(number))
            .map(|number| number as u64),
    };
    number.filter(|number| (least..=most).contains(number)).ok_or_else(|| {
        let allowed = format!("give a whole number from {least} to {most}");
        source.bad_value(field, value.span(), &allowed)
    })
}

/// Reads a boolean.
pub(crate) fn truth(source: &Source, field: &str, value: &Value<'_>) -> Result<bool, Error> {
    match value.get_ref() {
        DeValue::Boolean(truth) => Ok(*truth),
        _ => Err(source.bad_value(field, value.span(), "give true or false")),
    }
}

/// Reads a list; `of` names its items in the error.
pub(crate) fn list<'a, 't>(
    source: &Source,
    field: &str,
    value: &'a Value<'t>,
    of: &str,
) -> Result<&'a [Value<'t>], Error> {
    match value.get_ref() {
        DeValue::Array(items) => Ok(items),
        other => {
            let kind = with_article(other);
            Err(source.bad_value(field, value.span(), &format!("give a list of {of}, not {kind}")))
        }
    }
}

/// Reads one of the `known` names, which `find` converts.
pub(crate) fn name<T>(
    source: &Source,
    field: &str,
    value: &Value<'_>,
    known: &[&str],
    find: impl Fn(&str) -> Option<T>,
) -> Result<T, Error> {
    let found = match value.get_ref() {
        DeValue::String(text) => find(text),
        _ => None,
    };
    found.ok_or_else(|| {
        let near = match value.get_ref() {
            DeValue::String(text) => nearest(text, known.iter().copied()),
            _ => None,
        };
        let rule = match near {
            Some(near) => format!("no such name; did you mean \"{near}\"?"),
            None => format!("give {}", one_of(known)),
        };
        source.bad_value(field, value.span(), &rule)
    })
}

/// Reads a list of `known` names, each at most once.
pub(crate) fn names<T: PartialEq>(
    source: &Source,
    field: &str,
    value: &Value<'_>,
    known: &[&str],
    find: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Error> {
    let items = list(source, field, value, "names")?;
    let mut found = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        let field = format!("{field}[{index}]");
        let one = name(source, &field, item, known, &find)?;
        if found.contains(&one) {
            return Err(source.bad_value(&field, item.span(), "give each name once"));
        }
        found.push(one);
    }
    Ok(found)
}

/// Reads a section, the table under a key.
pub(crate) fn table<'a, 't>(
    source: &Source,
    field: &str,
    key: &Key<'t>,
    value: &'a Value<'t>,
) -> Result<&'a DeTable<'t>, Error> {
    match value.get_ref() {
        DeValue::Table(table) => Ok(table),
        DeValue::Array(items) if items.iter().any(|item| item.get_ref().is_table()) => Err(source
            .error(
                key.span(),
                format!("{field} is given as a list; write [{field}] once, in single brackets"),
            )),
        _ => Err(source.bad_value(
            field,
            value.span(),
            &format!("give a section: a line [{field}] and its keys below"),
        )),
    }
}

/// The error for an unknown key, with the section it belongs in, a similar key or all known ones.
pub(crate) fn unknown_key(source: &Source, section: &str, key: &Key<'_>, known: &[&str]) -> Error {
    let name = key.get_ref().as_ref();
    let path = match section {
        "" => name.to_owned(),
        _ => format!("{section}.{name}"),
    };
    let elsewhere = FieldId::all()
        .map(FieldId::info)
        .find(|info| info.name == name && info.part.name() != section);
    let hint = match (elsewhere, nearest(name, known.iter().copied())) {
        (Some(info), _) => format!("it belongs in [{}]", info.part.name()),
        (None, Some(near)) => format!("did you mean `{near}`?"),
        (None, None) => format!("known keys: {}", known.join(", ")),
    };
    source.error(key.span(), format!("{}: no such key; {hint}", shortened(&path)))
}

/// The error of an [`Invalid`] value at a place of the file.
pub(crate) fn at(source: &Source, span: Range<usize>, invalid: &Invalid) -> Error {
    source.error(span, invalid.to_string())
}

/// The known names as a phrase: `"a"`, `"a" or "b"`, `one of "a", "b", "c"`.
pub(crate) fn one_of(known: &[&str]) -> String {
    let quoted: Vec<String> = known.iter().map(|name| format!("\"{name}\"")).collect();
    match quoted.as_slice() {
        [one] => one.clone(),
        [one, other] => format!("{one} or {other}"),
        many => format!("one of {}", many.join(", ")),
    }
}

/// The name of a value's type, with its article.
fn with_article(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text in quotes",
        DeValue::Integer(_) | DeValue::Float(_) => "a single number",
        DeValue::Boolean(_) => "a truth value",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
