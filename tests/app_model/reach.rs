//! The controls of all sections have names, and the keyboard reaches and shows them.

use std::path::Path;

use egui::accesskit::{Action as Doing, Toggled};
use egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::{AccessKitNode, NodeT, Queryable};

use crate::{Desktop, click, model, press};
use flipmap_window::folders::Folders;

/// The sections of the side panel.
const SECTIONS: [&str; 6] =
    ["Explore", "Pendulum & question", "Colours", "Picture & film", "Laboratory", "Settings"];

/// An app model with a pin, a bookmark, a notice and the window's measurements.
fn crowded(folder: &Path) -> Desktop {
    let mut desktop = model(Folders::under(folder), None);
    desktop.event(Event::Paste("nonsense".to_string()));
    press(&mut desktop, Modifiers::NONE, Key::P);
    press(&mut desktop, Modifiers::NONE, Key::Space);
    click(&mut desktop, "Keep this view");
    press(&mut desktop, Modifiers::NONE, Key::F12);
    desktop.run_steps(5);
    desktop
}

/// Role and name of a control.
fn told(node: &AccessKitNode) -> (Role, String) {
    (node.role(), node.label().unwrap_or_default())
}

/// Roles and names of all controls that the keyboard should reach.
fn controls(desktop: &Desktop) -> Vec<(Role, String)> {
    let nodes = desktop.root().children_recursive().map(|node| node.accesskit_node());
    let usable = |node: &AccessKitNode| {
        node.data().supports_action(Doing::Focus) && !node.data().is_disabled()
    };
    nodes.filter(usable).map(|node| told(&node)).collect()
}

/// Opens the section of this name, if it is closed.
fn open_section(desktop: &mut Desktop, name: &str) {
    let rail = desktop.get_by_role_and_label(Role::Button, name);
    if rail.accesskit_node().toggled() != Some(Toggled::True) {
        rail.click();
        desktop.run_steps(4);
    }
}

#[test]
fn everything_has_a_name_for_screen_readers() {
    let folder = tempfile::tempdir().unwrap();
    let mut desktop = crowded(folder.path());
    let mut count = 0;
    for section in SECTIONS {
        open_section(&mut desktop, section);
        let controls = controls(&desktop);
        count += controls.len();
        let nameless: Vec<_> = controls.iter().filter(|(_, name)| name.trim().is_empty()).collect();
        assert!(nameless.is_empty(), "{section}: {nameless:#?}");
    }
    assert!(count > 150, "{count} controls");
}

#[test]
fn the_keyboard_reaches_everything_and_what_it_reaches_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let mut desktop = crowded(folder.path());
    let window = desktop.ctx.content_rect();
    for section in SECTIONS {
        open_section(&mut desktop, section);
        let all = controls(&desktop);
        let mut reached = Vec::new();
        for _ in 0..all.len() + 20 {
            press(&mut desktop, Modifiers::NONE, Key::Tab);
            // The panel scrolls in the frame after the one that moves the focus.
            desktop.run_steps(3);
            let focused = desktop.root().children_recursive().find(|node| node.is_focused());
            let Some(node) = focused else { continue };
            let middle = node.rect().center();
            assert!(window.contains(middle), "{section}: {:?}", told(&node.accesskit_node()));
            reached.push(told(&node.accesskit_node()));
        }
        let missed: Vec<_> = all.iter().filter(|control| !reached.contains(control)).collect();
        assert!(missed.is_empty(), "{section}: {missed:#?}");
    }
}

/// egui refuses negative sizes; a window can be smaller than any panel.
#[test]
fn every_section_and_figure_is_drawn_in_windows_of_any_size() {
    let folder = tempfile::tempdir().unwrap();
    let mut desktop = crowded(folder.path());
    let sizes = [[60.0, 60.0], [96.0, 840.0], [1100.0, 60.0], [230.0, 200.0], [700.0, 90.0]];
    let large = egui::vec2(1100.0, 700.0);
    for section in SECTIONS {
        desktop.set_size(large);
        desktop.run_steps(3);
        open_section(&mut desktop, section);
        for [width, height] in sizes {
            desktop.set_size(egui::vec2(width, height));
            desktop.run_steps(3);
        }
    }
    // The lesson shows one figure after another.
    desktop.set_size(large);
    press(&mut desktop, Modifiers::COMMAND, Key::K);
    desktop.event(Event::Text("seven".to_string()));
    desktop.run_steps(2);
    press(&mut desktop, Modifiers::NONE, Key::Enter);
    for _ in 0..7 {
        for [width, height] in sizes {
            desktop.set_size(egui::vec2(width, height));
            desktop.run_steps(3);
        }
        desktop.set_size(large);
        press(&mut desktop, Modifiers::NONE, Key::PageDown);
    }
}
