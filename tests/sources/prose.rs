//! Rules about names, comments and sizes that a machine can check from the text alone.

use std::fs;
use std::path::{Path, PathBuf};

use flipmap_shaders::KERNEL_PARTS;

use crate::sources::product_files;

/// The source files, each with its text before its unit tests.
fn sources() -> Vec<(PathBuf, String)> {
    let before_tests = |file: PathBuf| {
        let text = fs::read_to_string(&file).unwrap();
        (file, text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().to_string())
    };
    product_files().into_iter().map(before_tests).collect()
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
        // Every subcommand has its own `Options`, and a build without graphics its own `Adapter`.
        let names = text.lines().filter_map(shared_type);
        for name in names.filter(|name| !["Adapter", "Options"].contains(name)) {
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
        // A signature in a trait has no body.
        let closes = |line: &&str| line.starts_with(&format!("{indent})")) && line.ends_with(';');
        let signature = lines[k..=k + end].iter().any(closes);
        (!signature).then(|| (head.trim(), lines[k..=k + end].to_vec()))
    };
    let opens = |k: &usize| fits(private(lines[*k])) && !lines[*k].ends_with([';', '}']);
    (0..lines.len()).filter(opens).filter_map(item).collect()
}

fn is_function(line: &str) -> bool {
    line.trim_start_matches("const ").starts_with("fn ")
}

/// The tableau of a method of order eight is long.
const TABLES: [(&str, &str); 1] = [("embedded/dop853.rs", "fn trial<T: Real>(")];

/// A line of a shader file without what the template engine replaces.
fn without_templates(line: &str) -> String {
    let mut left = line.to_string();
    for [begin, end] in [["{%", "%}"], ["{{", "}}"], ["{#", "#}"]] {
        while let Some(from) = left.find(begin) {
            let to = left[from..].find(end).map_or(left.len(), |by| from + by + end.len());
            left.replace_range(from..to, "");
        }
    }
    left
}

/// Returns the lines of a shader file that stand outside its declarations, and the lengths of its
/// functions by their first lines.
fn shader_outline(text: &str) -> (Vec<String>, Vec<(String, usize)>) {
    const DECLARATIONS: [&str; 9] =
        ["//", "@", "fn ", "struct ", "const ", "alias ", "var<", "}", ")"];
    let (mut depth, mut loose, mut functions) = (0, Vec::new(), Vec::new());
    for line in text.lines().map(without_templates) {
        let code = line.split("//").next().unwrap_or_default();
        if depth == 0 && line.starts_with("fn ") {
            functions.push((line.clone(), 0));
        }
        if let Some((_, lines)) = functions.last_mut().filter(|_| depth > 0 || code.contains('{')) {
            *lines += 1;
        }
        let declares = DECLARATIONS.iter().any(|begin| line.starts_with(begin));
        if depth == 0 && !line.trim().is_empty() && !declares {
            loose.push(line.clone());
        }
        depth += code.matches(['{', '(']).count();
        depth -= code.matches(['}', ')']).count();
    }
    (loose, functions)
}

#[test]
fn shader_files_hold_whole_functions_and_short_ones() {
    let (loose, functions) = shader_outline("fn a() {\n    b();\n}\n    let c = 1;\n");
    assert_eq!((loose, functions), (vec!["    let c = 1;".into()], vec![("fn a() {".into(), 3)]));
    let parts = KERNEL_PARTS.iter().filter(|(name, _)| *name != "outcome.wgsl");
    for (name, text) in parts {
        let (loose, functions) = shader_outline(text);
        assert!(loose.is_empty(), "{name} has loose lines: {loose:?}");
        for (head, lines) in functions {
            assert!(lines <= 60, "{name}: {head} has {lines} lines");
        }
    }
}

#[test]
fn functions_are_short() {
    let mut lengths = Vec::new();
    for (file, text) in sources() {
        for (head, lines) in items(&text, is_function) {
            let table = TABLES.iter().any(|(end, name)| file.ends_with(end) && head == *name);
            assert!(lines.len() <= 60 || table, "{}: {head}: {}", file.display(), lines.len());
            lengths.push(lines.len());
        }
    }
    lengths.sort_unstable();
    assert!(lengths.len() > 1000);
    assert!(lengths[lengths.len() / 2] < 10, "the median is {}", lengths[lengths.len() / 2]);
}
