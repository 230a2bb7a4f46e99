//! Rules about names, comments and sizes that a machine can check from the text alone.

use std::fs;
use std::path::{Path, PathBuf};

use crate::sources::{product_files, rust_files};

/// Files with their text before their unit tests.
fn before_tests(files: Vec<PathBuf>) -> Vec<(PathBuf, String)> {
    let before_tests = |file: PathBuf| {
        let text = fs::read_to_string(&file).unwrap();
        (file, text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().to_string())
    };
    files.into_iter().map(before_tests).collect()
}

fn sources() -> Vec<(PathBuf, String)> {
    before_tests(product_files())
}

/// First words of doc comments that do not say what an item is or does.
const HEADLESS: &str = "What Which Whether Where How Who Whose Why When If Because So As Once \
    Until While Than That Of From To In On At With By Beside For After Before Without Not And Or \
    But More Less Larger Smaller Also Only Even Everything Nothing There They It Its These Those \
    This Is Are Has Have Likewise";

/// Marks of the doc comments of items and of modules.
const MARKS: [&str; 2] = ["///", "//!"];

/// The first lines of doc comments that are headless clauses or single words, with their numbers.
fn headless_docs<'a>(text: &'a str, mark: &str) -> Vec<(usize, &'a str)> {
    let docs: Vec<Option<&str>> =
        text.lines().map(|line| line.trim_start().strip_prefix(mark).map(str::trim)).collect();
    let is_headless = |k: usize, doc: &str| {
        let first = doc.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        let alone = !doc.contains(' ') && !docs.get(k + 1).is_some_and(Option::is_some);
        alone || HEADLESS.split_whitespace().any(|word| word == first)
    };
    let begins = |k: usize| k == 0 || docs[k - 1].is_none();
    let all = docs.iter().enumerate().filter_map(|(k, doc)| Some((k, (*doc)?)));
    let bad = all.filter(|&(k, doc)| begins(k) && is_headless(k, doc));
    bad.map(|(k, doc)| (k + 1, doc)).collect()
}

#[test]
fn doc_comments_say_what_an_item_is_or_does() {
    let others = ["tests", "examples", "benches"].map(|folder| rust_files(Path::new(folder)));
    for (file, text) in sources().into_iter().chain(before_tests(others.concat())) {
        for mark in MARKS {
            let found = headless_docs(&text, mark);
            assert!(found.is_empty(), "{}: {found:?}", file.display());
        }
    }
    for mark in MARKS {
        let bad = "/// Which.\nx\n/// Whether it is.\ny\n/// Mass in kg.\nz\n/// kg.\nw";
        let bad = bad.replace("///", mark);
        let found: Vec<usize> = headless_docs(&bad, mark).iter().map(|(line, _)| *line).collect();
        assert_eq!(found, [1, 3, 7], "the test can fail");
    }
}

/// The types in the glossary of ARCHITECTURE.md.
fn glossary_types() -> Vec<String> {
    let text = fs::read_to_string("ARCHITECTURE.md").unwrap();
    let rows = text.split("## Glossary").nth(1).unwrap().lines();
    let column = rows.filter_map(|row| row.split('|').nth(2));
    let code = |name: &str| Some(name.trim().strip_prefix('`')?.strip_suffix('`')?.to_string());
    column.flat_map(|cell| cell.split(',')).filter_map(code).collect()
}

/// The line without its visibility.
fn private(line: &str) -> &str {
    let line = line.trim_start();
    match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ").map_or(line, |(_, rest)| rest),
        Some(rest) => rest.trim_start(),
        None => line,
    }
}

/// The name that a line defines as a type.
fn defined_type(line: &str) -> Option<&str> {
    let kinds = ["struct ", "enum ", "trait ", "type "];
    let name = kinds.iter().find_map(|kind| private(line).strip_prefix(kind))?;
    name.split(|c: char| !c.is_alphanumeric()).next()
}

/// The name that a line defines as a type that other modules see.
fn shared_type(line: &str) -> Option<&str> {
    let is_shared = line.trim_start().starts_with("pub") && !line.contains("type ");
    defined_type(line).filter(|_| is_shared)
}

#[test]
fn a_name_that_modules_share_names_one_type() {
    let all = sources();
    let mut homes = std::collections::BTreeMap::<&str, Vec<&Path>>::new();
    for (file, text) in &all {
        // Every subcommand has its own `Options`.
        for name in text.lines().filter_map(shared_type).filter(|name| *name != "Options") {
            homes.entry(name).or_default().push(file);
        }
    }
    assert!(homes.len() > 300, "{}", homes.len());
    let shared: Vec<_> = homes.into_iter().filter(|(_, files)| files.len() > 1).collect();
    assert!(shared.is_empty(), "{shared:?}");
    assert_eq!(shared_type("    pub(super) struct Cell {"), Some("Cell"));
    assert_eq!(shared_type("    struct Cell {"), None);
}

#[test]
fn a_word_of_the_glossary_names_one_type() {
    let all = sources();
    let defined: Vec<&str> =
        all.iter().flat_map(|(_, text)| text.lines()).filter_map(defined_type).collect();
    let times = |name: &str| defined.iter().filter(|other| **other == name).count();
    let names = glossary_types();
    assert!(names.len() > 25, "{names:?}");
    for name in names {
        assert_eq!(times(&name), 1, "{name} is the name of {} types", times(&name));
    }
    assert_eq!(defined_type("    pub(super) enum Cell {"), Some("Cell"));
    assert!(times("Output") > 1, "the test can fail");
}

/// Lines of every item whose first line fits, up to the line that closes it.
fn items(text: &str, fits: impl Fn(&str) -> bool) -> Vec<(&str, Vec<&str>)> {
    let lines: Vec<&str> = text.lines().collect();
    let item = |k: usize| {
        let head = lines[k];
        let indent = &head[..head.len() - head.trim_start().len()];
        let end = lines[k..].iter().position(|line| *line == format!("{indent}}}"))?;
        Some((head.trim(), lines[k..=k + end].to_vec()))
    };
    let opens = |k: &usize| fits(private(lines[*k])) && !lines[*k].ends_with([';', '}']);
    (0..lines.len()).filter(opens).filter_map(item).collect()
}

fn is_function(line: &str) -> bool {
    line.trim_start_matches("const ").starts_with("fn ")
}

/// The tableau of a method of order eight is long.
const TABLES: [&str; 1] = ["pub fn dop853<T: Real>("];

#[test]
fn functions_are_short() {
    let mut lengths = Vec::new();
    for (file, text) in sources() {
        for (head, lines) in items(&text, is_function) {
            let table = TABLES.contains(&head);
            assert!(lines.len() <= 60 || table, "{}: {head}: {}", file.display(), lines.len());
            lengths.push(lines.len());
        }
    }
    lengths.sort_unstable();
    assert!(lengths.len() > 1000);
    assert!(lengths[lengths.len() / 2] < 10, "the median is {}", lengths[lengths.len() / 2]);
}

#[test]
fn structs_have_few_fields() {
    let mut seen = 0;
    for (file, text) in sources() {
        for (head, lines) in items(&text, |line| line.starts_with("struct ")) {
            let deeper = head.len() - head.trim_start().len() + 4;
            let is_field = |line: &&&str| {
                let name = private(line).split(':').next().unwrap_or_default();
                line.contains(": ")
                    && line.len() - line.trim_start().len() >= deeper
                    && name.chars().all(|c| c.is_alphanumeric() || c == '_')
            };
            let fields = lines[1..].iter().filter(is_field).count();
            assert!(fields <= 20, "{}: {head} has {fields} fields", file.display());
            seen += fields;
        }
    }
    assert!(seen > 500, "{seen}");
}
