//! Phrases that say which values a setting can have, made from ranges and from closed sets.

use std::fmt::Display;
use std::ops::RangeInclusive;

/// Jaro–Winkler similarity above which a word counts as a mistyped name.
const MIN_LIKENESS: f64 = 0.8;

/// Returns the name that is most similar to a mistyped one, if any is similar enough.
pub(crate) fn closest<'a>(
    names: impl IntoIterator<Item = &'a str>,
    typed: &str,
) -> Option<&'a str> {
    let typed = typed.trim().to_lowercase();
    let all = names.into_iter().map(|name| (strsim::jaro_winkler(name, &typed), name));
    let alike = all.filter(|(likeness, _)| *likeness > MIN_LIKENESS);
    alike.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, name)| name)
}

/// Returns the value called `typed` in a closed set, or a phrase that lists the set.
pub fn named<T: Copy>(what: &str, set: &[(&'static str, T)], typed: &str) -> Result<T, String> {
    known(set, typed).ok_or_else(|| not_among(what, &names_of(set), typed))
}

/// Returns the value with this name in a closed set.
pub(crate) fn known<T: Copy>(set: &[(&str, T)], name: &str) -> Option<T> {
    set.iter().find(|(other, _)| *other == name).map(|(_, value)| *value)
}

/// Returns the names of a closed set.
pub(crate) fn names_of<T>(set: &[(&'static str, T)]) -> Vec<&'static str> {
    set.iter().map(|(name, _)| *name).collect()
}

/// Returns a phrase that lists a closed set, with the name that a mistyped one may stand for.
pub fn not_among(what: &str, names: &[&str], typed: &str) -> String {
    listed(what, names) + &did_you_mean(names, typed)
}

/// Returns a phrase that lists a closed set, as in "the rules are second, first, either".
pub(crate) fn listed(what: &str, names: &[&str]) -> String {
    format!("the {what} are {}", names.join(", "))
}

/// Returns the end of a sentence that asks for the name most like a mistyped one, if there is one.
pub fn did_you_mean(names: &[&str], typed: &str) -> String {
    closest(names.iter().copied(), typed)
        .map_or(String::new(), |name| format!("; did you mean '{name}'?"))
}

/// Returns a range as a phrase, as in "between 1e-9 and 1000".
pub fn between(range: &RangeInclusive<f64>) -> String {
    format!("between {} and {}", short(*range.start()), short(*range.end()))
}

/// Returns names in a row with a word before the last, as in "second, first or either".
pub fn in_a_row<T: Display>(names: &[T], word: &str) -> String {
    let names: Vec<String> = names.iter().map(T::to_string).collect();
    match &names[..] {
        [before @ .., last] if !before.is_empty() => format!("{} {word} {last}", before.join(", ")),
        _ => names.concat(),
    }
}

/// Largest number of characters of a number that is written plainly, as in 100000 or 0.0001.
const MAX_PLAIN_CHARACTERS: usize = 6;

/// Writes a number plainly or, if that is long, in powers of ten.
fn short(number: f64) -> String {
    let [plain, power] = [format!("{number}"), format!("{number:e}")];
    if plain.len() > MAX_PLAIN_CHARACTERS && power.len() < plain.len() { power } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_short() {
        assert_eq!(between(&(1e-9..=1e6)), "between 1e-9 and 1e6");
        assert_eq!(between(&(-360.0..=360.0)), "between -360 and 360");
        assert_eq!(between(&(0.0..=1.0)), "between 0 and 1");
        assert_eq!(between(&(2.0..=1e5)), "between 2 and 100000");
    }

    #[test]
    fn a_mistyped_name_is_recognised_and_another_is_not() {
        let set = [("second", 2), ("first", 1)];
        assert_eq!(named("bobs", &set, "first"), Ok(1));
        let mistyped = "the bobs are second, first; did you mean 'second'?";
        assert_eq!(named("bobs", &set, "Secnod"), Err(mistyped.to_string()));
        assert_eq!(named("bobs", &set, "xyz"), Err("the bobs are second, first".to_string()));
        assert_eq!(in_a_row(&["a", "b", "c"], "or"), "a, b or c");
        assert_eq!((in_a_row(&["a"], "or"), in_a_row::<&str>(&[], "or")), ("a".into(), "".into()));
    }
}
