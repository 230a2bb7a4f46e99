//! Makes a scene from Python's arguments: a name, a file or a text, and words.
use flipmap::{BuiltIn, Document, Setting, named_document};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Converts an error in the arguments into Python's `ValueError`.
pub(crate) fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Loads a scene and sets words of it. The default is home, or the middle of the plane if `words`
/// has one. A text of several lines is TOML.
pub(crate) fn document(scene: Option<&str>, words: &[(String, String)]) -> PyResult<Document> {
    let document = match scene {
        Some(text) if text.contains('\n') => Document::parse(text).map_err(value_error)?,
        Some(name) => named_document(name).map_err(value_error)?,
        None if words.iter().any(|(name, _)| name == "plane") => Document::default(),
        None => BuiltIn::home().document(),
    };
    with_words(document, words)
}

/// Sets words of a scene.
pub(crate) fn with_words(document: Document, words: &[(String, String)]) -> PyResult<Document> {
    let words = words.iter().map(|(name, text)| {
        let unknown = || value_error(format!("there is no word {name}"));
        Ok((Setting::named(name).ok_or_else(unknown)?, text.as_str()))
    });
    let words = words.collect::<PyResult<Vec<_>>>()?;
    let scene = document.scene().with_words(words).map_err(value_error)?;
    Ok(document.with_scene(scene))
}
