//! The layers drawn over the colours.

use egui::Ui;

use crate::action::Action;
use crate::settings::Layers;

/// Shows one checkbox per layer; returns an action if one has changed.
pub(crate) fn layers_panel(ui: &mut Ui, layers: &Layers) -> Option<Action> {
    let mut changed = *layers;
    for (layer, name, sentence) in [
        (
            &mut changed.curve,
            "Energy curve",
            "Starts inside it have too little energy ever to flip",
        ),
        (
            &mut changed.trust,
            "Doubts",
            "Hatched where independent answers disagree; needs accuracy exact",
        ),
        (&mut changed.legend, "Legend", "What the colours mean, in the lower left corner"),
        (&mut changed.grid, "Grid of angles", "Lines at round parts of π"),
        (&mut changed.borders, "Borders of tiles", "What is computed as one piece"),
        (
            &mut changed.swing,
            "Pendulum at the pointer",
            "Swings once the map is complete and the pointer rests",
        ),
    ] {
        ui.checkbox(layer, name).on_hover_text(sentence);
    }
    (changed != *layers).then_some(Action::Layers(changed))
}
