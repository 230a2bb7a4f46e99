//! Refuses pictures that no engine can compute.

use flipmap_engine::pace::Pace;
use flipmap_engine::{Cells, EngineError, EventSpec, IntegratorConfig};
use flipmap_scene::{Grid, Scene, SceneError};

/// Returns an error if a picture of `size` pixels needs too many steps for its budget, or if its
/// starts would be equal numbers and cannot be followed as cells.
pub fn check_feasible(
    scene: &Scene,
    size: [u32; 2],
    config: &IntegratorConfig,
    cells: Cells,
) -> Result<(), EngineError> {
    check_steps(scene, config)?;
    let grid = Grid::new(scene, size);
    let (cells, setting, value) = if grid.cell_plane().is_some() {
        (cells, "cells", "never")
    } else {
        (Cells::Never, "width", "too small for this plane or question")
    };
    let checked = cells.check(config, grid.pixel_rad());
    checked.map_err(|error| {
        let error = error.in_unit(scene.plane.axes()[0].unit());
        SceneError::new(setting, value, error.to_string()).into()
    })
}

/// Returns true if the pixels of a grid are followed as cells, so that none has a state from which a
/// later run could go on.
pub fn follows_cells(grid: &Grid, config: &IntegratorConfig, cells: Cells) -> bool {
    grid.cell_plane().is_some() && cells.are_followed(config, grid.pixel_rad())
}

/// Returns an error if a configuration needs too many steps for a scene's budget.
pub fn check_steps(scene: &Scene, config: &IntegratorConfig) -> Result<(), EngineError> {
    let question = EventSpec::from(scene);
    if question.build.gravity.value() > 0.0 {
        let pace = Pace::new(&question, config);
        pace.map_err(|error| EngineError::Unsupported(error.to_string()))?;
    }
    Ok(())
}
