//! Matches on methods, questions and outputs name every case, so that a new one cannot fall into the
//! branch of another in silence.

use std::fs;

use syn::visit::{self, Visit};
use syn::{Arm, ExprMatch, ItemMod, Pat, Path, parse_file};

use crate::sources::product_files;

/// The enums whose matches name every case.
const WATCHED: [&str; 7] =
    ["FilmKind", "Method", "Needs", "Pair", "PlannedOutput", "QuestionName", "Scheme"];

/// Returns true if a pattern, or one of its alternatives, is a variant of a watched enum.
fn is_watched(pattern: &Pat) -> bool {
    let of = |path: &Path| {
        path.segments.len() > 1 && WATCHED.iter().any(|name| path.segments[0].ident == name)
    };
    match pattern {
        Pat::Or(all) => all.cases.iter().any(is_watched),
        Pat::Tuple(tuple) => tuple.elems.iter().any(is_watched),
        Pat::Path(path) => of(&path.path),
        Pat::Struct(found) => of(&found.path),
        Pat::TupleStruct(found) => of(&found.path) || found.elems.iter().any(is_watched),
        Pat::Reference(inner) => is_watched(&inner.pat),
        Pat::Ident(named) => named.subpat.as_ref().is_some_and(|(_, inner)| is_watched(inner)),
        _ => false,
    }
}

/// Returns true if a pattern takes everything: `_`, a name, or a tuple of those.
fn takes_all(pattern: &Pat) -> bool {
    match pattern {
        Pat::Wild(_) => true,
        // A name in capitals is a variant without fields, or a constant.
        Pat::Ident(named) => {
            let name = named.ident.to_string();
            named.subpat.is_none() && !name.starts_with(|letter: char| letter.is_uppercase())
        }
        Pat::Or(all) => all.cases.iter().any(takes_all),
        Pat::Tuple(tuple) => tuple.elems.iter().all(takes_all),
        _ => false,
    }
}

/// The first lines of matches that have a branch for all other cases.
struct CatchAlls(Vec<usize>);

impl<'ast> Visit<'ast> for CatchAlls {
    fn visit_expr_match(&mut self, found: &'ast ExprMatch) {
        let is_open = |arm: &Arm| arm.guard.is_none() && takes_all(&arm.pat);
        if found.arms.iter().any(|arm| is_watched(&arm.pat)) && found.arms.iter().any(is_open) {
            self.0.push(found.match_token.span.start().line);
        }
        visit::visit_expr_match(self, found);
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if !is_tests(module) {
            visit::visit_item_mod(self, module);
        }
    }
}

/// Returns true for a module of tests.
fn is_tests(module: &ItemMod) -> bool {
    module.attrs.iter().any(|attribute| attribute.path().is_ident("cfg")) && module.ident == "tests"
}

fn catch_alls(text: &str) -> Vec<usize> {
    let mut found = CatchAlls(Vec::new());
    found.visit_file(&parse_file(text).expect("Rust"));
    found.0
}

#[test]
fn matches_on_methods_questions_and_outputs_name_every_case() {
    let of = |arms: &str| catch_alls(&format!("fn f() {{ match x {{ {arms} }} }}")).len();
    assert_eq!(of("Method::Rk4 { .. } => 1, _ => 2"), 1);
    assert_eq!(of("Method::Rk4 { .. } => 1, other => 2"), 1);
    assert_eq!(of("(Method::Rk4 { .. }, Precision::F32) => 1, _ => 2"), 1);
    assert_eq!(of("Some(Needs::End) => 1, _ => 2"), 1);
    assert_eq!(of("Method::Rk4 { .. } => 1, Method::Taylor { .. } => 2"), 0);
    assert_eq!(of("Method::Rk4 { .. } => 1, (Method::Taylor { .. }) => 2"), 0);
    assert_eq!(of("(Method::Rk4 { .. }, _) => 1, (Method::Taylor { .. }, _) => 2"), 0);
    assert_eq!(of("Some(Method::Rk4 { .. }) => 1, Some(Method::Taylor { .. }) | None => 2"), 0);
    assert_eq!(of("Precision::F32 => 1, _ => 2"), 0);
    let found = product_files().into_iter().flat_map(|path| {
        let lines = catch_alls(&fs::read_to_string(&path).unwrap());
        lines.into_iter().map(move |line| format!("{}:{line}", path.display()))
    });
    let found: Vec<String> = found.collect();
    assert!(found.is_empty(), "these have a branch for the rest: {found:#?}");
}
