//! The rail at the window's right edge: one icon for each section of the side panel.

use egui::Ui;

use super::icon::{Icon, IconButton};
use crate::action::Action;
use crate::sections::Section;

/// Width of the rail in points.
pub(crate) const RAIL_POINTS: f32 = 44.0;
/// Side of a button in points.
const SIDE: f32 = 40.0;

/// Shows the rail; `open` is the section that is shown. Returns the user's action.
pub(crate) fn rail(ui: &mut Ui, open: Option<Section>) -> Option<Action> {
    let mut chosen = None;
    ui.spacing_mut().item_spacing.y = 4.0;
    ui.vertical_centered(|ui| {
        for section in Section::ALL {
            let button = IconButton {
                name: section.name(),
                icon: icon_of(section),
                side: SIDE,
                enabled: true,
                is_chosen: Some(open == Some(section)),
            };
            if button.show(ui).on_hover_text(section.name()).clicked() {
                chosen = Some(Action::Section(section));
            }
        }
    });
    chosen
}

fn icon_of(section: Section) -> fn(&Icon) {
    match section {
        Section::Explore => Icon::explore,
        Section::Scene => Icon::pendulum,
        Section::Colours => Icon::colours,
        Section::Film => Icon::film,
        Section::Lab => Icon::lab,
        Section::Settings => Icon::settings,
    }
}
