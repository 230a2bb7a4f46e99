//! The settings as the entries of a file: which of them are unusable, and which belong to this window.

use std::collections::BTreeSet;

use toml::{Table, Value};

use super::settings::Settings;
use flipmap_scene::Document;
use flipmap_scene::palette::Palette;

/// A value that a setting cannot have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{name}` is {value}; it must be {}, so it is left out", allowed(name))]
pub(super) struct BadValue {
    /// Name of the setting, with that of its table.
    name: String,
    /// The value as it was written.
    value: String,
}

/// Returns what the setting of this name can be.
fn allowed(name: &str) -> String {
    let table = name.split_once('.').map_or(name, |(table, _)| table);
    match table {
        "theme" => "\"system\", \"dark\" or \"light\"".to_string(),
        "ui_scale" => range("a number", &Settings::UI_SCALES),
        "cache_mib" => range("a whole number", &Settings::CACHE_MIB),
        "edges" => "\"1\", \"4\" or \"16\"".to_string(),
        "recent" => "a list of paths".to_string(),
        "recent_commands" => "a list of names".to_string(),
        "last_scene" => "the text of a scene".to_string(),
        "favourites" => "a table of colours".to_string(),
        "palettes" => "a name and its colours".to_string(),
        "film" => "as in a film that this program kept".to_string(),
        _ => "true or false".to_string(),
    }
}

fn range<T: std::fmt::Display>(kind: &str, range: &std::ops::RangeInclusive<T>) -> String {
    format!("{kind} from {} to {}", range.start(), range.end())
}

/// Removes the values that no settings can have, and returns them.
pub(super) fn remove_bad(settings: &mut Table) -> Vec<BadValue> {
    let mut bad = Vec::new();
    settings.retain(|key, value| {
        let fits = |value: &Value| is_usable(key, value);
        if fits(value) {
            return true;
        }
        let mut refuse = |name: &str, value: &Value| {
            bad.push(BadValue { name: name.to_string(), value: value.to_string() });
        };
        match &mut *value {
            Value::Table(inner) => inner.retain(|name, value| {
                let fits =
                    fits(&Value::Table(Table::from_iter([(name.to_string(), value.clone())])));
                if !fits {
                    refuse(&format!("{key}.{name}"), value);
                }
                fits
            }),
            Value::Array(list) => list.retain(|entry| {
                let fits = fits(&Value::Array(vec![entry.clone()]));
                if !fits {
                    refuse(key, entry);
                }
                fits
            }),
            other => refuse(key, other),
        }
        fits(value)
    });
    bad
}

/// Returns true if settings can have this value.
fn is_usable(key: &str, value: &Value) -> bool {
    let settings = Table::from_iter([(key.to_string(), value.clone())]).try_into::<Settings>();
    settings
        .is_ok_and(|settings| settings.palettes.values().all(|text| Palette::named(text).is_ok()))
}

/// Applies to `theirs`, which the file holds, what this window changed between `base` and `ours`.
pub(super) fn merge(theirs: &mut Table, base: &Table, ours: &Table) {
    for key in changed(base, ours) {
        match (ours.get(key), theirs.get_mut(key)) {
            (Some(Value::Table(ours)), Some(Value::Table(theirs))) => {
                let none = Table::new();
                let base = base.get(key).and_then(Value::as_table).unwrap_or(&none);
                changed(base, ours).into_iter().for_each(|key| replace(theirs, key, ours.get(key)));
            }
            (Some(Value::Array(ours)), Some(Value::Array(theirs))) => {
                // The list of recent files: the newest first, each once.
                let older = theirs.iter().filter(|entry| !ours.contains(entry));
                let all = ours.iter().chain(older).take(Settings::MAX_RECENT_FILES);
                *theirs = all.cloned().collect();
            }
            (ours, _) => replace(theirs, key, ours),
        }
    }
}

/// Returns the keys whose values differ.
fn changed<'a>(base: &'a Table, ours: &'a Table) -> BTreeSet<&'a String> {
    let all = base.keys().chain(ours.keys());
    all.filter(|key| base.get(*key) != ours.get(*key)).collect()
}

fn replace(table: &mut Table, key: &str, value: Option<&Value>) {
    match value {
        Some(value) => _ = table.insert(key.to_string(), value.clone()),
        None => _ = table.remove(key),
    }
}

/// Logs unknown keys, which come from a newer program or are misspelt.
pub(super) fn warn_of_unknown(found: &Table) {
    for key in unknown_keys(found) {
        log::warn!("settings.toml: unknown key '{key}' is ignored");
    }
}

fn unknown_keys(found: &Table) -> Vec<String> {
    let full = Settings { last_scene: Some(Document::default()), ..Settings::default() };
    let known = Table::try_from(full).expect("settings are a table");
    let inner = |table: &Table, key: &str| table.get(key)?.as_table().cloned();
    let mut unknown: Vec<String> =
        found.keys().filter(|key| !known.contains_key(*key)).cloned().collect();
    if let (Some(known), Some(found)) = (inner(&known, "layers"), inner(found, "layers")) {
        let extra = found.keys().filter(|key| !known.contains_key(*key));
        unknown.extend(extra.map(|key| format!("layers.{key}")));
    }
    unknown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_do_no_harm() {
        let text = "last_scene = \"format = 99\"\nlights = true\n[layers]\nsky = 1\n";
        let mut table: Table = text.parse().unwrap();
        assert_eq!(unknown_keys(&table), ["lights", "layers.sky"]);
        assert_eq!(remove_bad(&mut table), []);
    }

    #[test]
    fn palettes_that_cannot_be_used_are_named() {
        let text = "[palettes]\nfire = \"#000000,#ff0000\"\nfog = \"grey\"\n";
        let mut table: Table = text.parse().unwrap();
        let bad = remove_bad(&mut table);
        assert_eq!(
            bad[0].to_string(),
            "`palettes.fog` is \"grey\"; it must be a name and its colours, so it is left out"
        );
        let settings: Settings = table.try_into().unwrap();
        assert_eq!(settings.palettes.keys().collect::<Vec<_>>(), ["fire"]);
    }

    #[test]
    fn only_what_this_window_changed_is_merged() {
        let table = |text: &str| text.parse::<Table>().unwrap();
        let mut theirs = table("a = 2\nb = 2\nnew = 1\n[t]\nx = 2\ny = 2\n");
        let base = table("a = 1\nb = 1\ngone = 1\n[t]\nx = 1\ny = 1\n");
        merge(&mut theirs, &base, &table("a = 1\nb = 3\n[t]\nx = 1\ny = 3\n"));
        assert_eq!(theirs, table("a = 2\nb = 3\nnew = 1\n[t]\nx = 2\ny = 3\n"));
    }
}
