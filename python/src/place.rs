//! Where the pixels of a map lie, and the scenes of its tiles.

use flipmap::Document;
use flipmap_scene::{PixelAxes, View};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::map::{Run, settled};
use crate::scene::value_error;

/// Returns where the pixels of a map's scene lie: `names`, `units` and `center` of both axes, the
/// coordinates of the `first` pixel, also `first_from_center`, their changes by columns (`right`)
/// and by rows (`down`), and whether the view `is_upright`.
#[pyfunction]
pub(crate) fn frame<'py>(
    py: Python<'py>,
    scene: &str,
    size: [u32; 2],
) -> PyResult<Bound<'py, PyDict>> {
    let axes = axes(scene, size)?;
    let frame = PyDict::new(py);
    frame.set_item("names", axes.axes.map(|axis| axis.name()))?;
    frame.set_item("units", axes.axes.map(|axis| axis.unit()))?;
    frame.set_item("has_units_apart", axes.axes[0].unit() != axes.axes[1].unit())?;
    frame.set_item("center", axes.center.clone())?;
    frame.set_item("first", axes.coordinates(0, 0))?;
    frame.set_item("first_from_center", axes.offset(0, 0))?;
    frame.set_item("right", axes.right)?;
    frame.set_item("down", axes.down())?;
    frame.set_item("shape", [size[1], size[0]])?;
    frame.set_item("is_upright", axes.is_upright())?;
    Ok(frame)
}

/// Returns the bytes (f64) of a coordinate of the pixels' middles, or of its distance from the
/// centre: along the first row or column if the view is upright, and else of all pixels.
#[pyfunction]
pub(crate) fn coordinates<'py>(
    py: Python<'py>,
    scene: &str,
    size: [u32; 2],
    axis: usize,
    from_center: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    if axis > 1 {
        return Err(PyIndexError::new_err("a map has two axes"));
    }
    let axes = axes(scene, size)?;
    let [columns, rows] = match (axes.is_upright(), axis) {
        (true, 0) => [size[0], 1],
        (true, _) => [1, size[1]],
        (false, _) => size,
    };
    let place = |column, row| match from_center {
        true => axes.offset(column, row)[axis],
        false => axes.coordinates(column, row)[axis],
    };
    let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let bytes: Vec<u8> =
        pixels.flat_map(|(column, row)| place(column, row).to_ne_bytes()).collect();
    Ok(PyBytes::new(py, &bytes))
}

fn axes(scene: &str, size: [u32; 2]) -> PyResult<PixelAxes> {
    let document = Document::parse(scene).map_err(value_error)?;
    Ok(PixelAxes::new(&document.scene(), size))
}

/// Returns the scene that `render` would compute, as text, with a fixed budget; and its view's
/// centre, width, stretch, and whether it is upright.
#[pyfunction]
pub(crate) fn whole(
    scene: Option<&str>,
    words: Vec<(String, String)>,
    size: [u32; 2],
    run: Run,
) -> PyResult<(String, [String; 2], String, f64, bool)> {
    let (mut document, _) = settled(scene, &words, size, &run)?;
    document.question.budget.auto = false;
    let View { center, width, stretch, rotate, .. } = document.view.clone();
    Ok((document.text(), center, width, stretch, rotate == 0.0))
}

/// Returns the text of a scene with another centre, width and size.
#[pyfunction]
pub(crate) fn part(
    scene: &str,
    center: [String; 2],
    width: String,
    size: [u32; 2],
) -> PyResult<String> {
    let mut document = Document::parse(scene).map_err(value_error)?;
    document.view = View { center, width, ..document.view };
    document.run.size = Some(size);
    Ok(document.checked().map_err(value_error)?.text())
}
