//! Reports on deep pictures: the digits used, the horizon, and where structure ends.

use flipmap_engine::{DepthStats, IntegratorConfig};
use flipmap_render::tiles::Counts;
use flipmap_scene::{Budget, Scene};

/// Statistics of deep pixels as a JSON object.
pub(super) fn depth_object(
    depth: DepthStats,
    config: IntegratorConfig,
    scene: &Scene,
) -> serde_json::Value {
    serde_json::json!({
        "digits": depth.digits,
        "integrated": depth.integrated,
        "cells": depth.cells,
        "cell_steps": depth.cell_steps,
        "cell_seconds": depth.cell_secs,
        "line_samples": depth.line_samples,
        "told_by_lines": depth.told_by_lines,
        "begins_secs": depth.begins_secs,
        "decades_a_second": depth.decades_a_second,
        "horizon_secs": depth.horizon_secs(config.precision),
        "structure_ends_at": depth.structure_ends_at(scene.question.budget.secs),
        "budget_secs": scene.question.budget.secs,
    })
}

/// Prints the statistics of deep pixels, and advice if nothing is left to see.
pub(super) fn tell_depth(
    depth: DepthStats,
    config: IntegratorConfig,
    scene: &Scene,
    counts: &Counts,
) {
    let budget = scene.question.budget;
    let follows = if budget.auto { " (chosen for this depth)" } else { "" };
    if depth.digits == 0 && depth.integrated == 0 {
        super::tell("flipmap: depth: all pixels are forbidden by their energy");
    } else if depth.integrated == 0 {
        super::tell(&format!(
            "flipmap: depth: all pixels are known from polynomials, computed with {} digits",
            depth.digits
        ));
    } else {
        let [first, last] = depth.begins_secs;
        super::tell(&format!(
            "flipmap: depth: followed with {} digits for {first:.1} to {last:.1} s, then in {}; \
             trusted {}; a budget of {} s{follows} shows structure down to widths of {:.0e}",
            depth.digits,
            config.precision,
            depth.horizon_words(config.precision),
            budget.secs,
            depth.structure_ends_at(budget.secs),
        ));
    }
    if counts.flipped == 0 && counts.unflipped > 0 && !budget.auto {
        let auto = Budget { auto: true, ..budget }.for_view(&scene.build, &scene.view).secs;
        super::tell(&format!(
            "flipmap: warning: nothing flips within the budget of {} s at this depth, so there is \
             nothing to see; --budget auto would use {auto} s",
            budget.secs
        ));
    }
}
