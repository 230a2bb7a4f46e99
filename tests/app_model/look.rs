//! The look of the map: favourite colours on digits, colours that run, the legend.

use super::*;

#[test]
fn digits_bring_kept_colours_back_also_in_the_next_window() {
    let folder = tempfile::tempdir().unwrap();
    let folders = || Folders::under(folder.path());
    let mut desktop = model(folders(), None);
    press(&mut desktop, Modifiers::NONE, Key::Num2);
    assert!(notices(&desktop).contains("No colours are kept under 2; Ctrl+2 keeps"));
    let plain = desktop.state().state.picture.clone();
    desktop.state_mut().state.picture.palette = "magma".to_string();
    desktop.state_mut().state.picture.relief = 0.4;
    let kept = desktop.state().state.picture.clone();
    press(&mut desktop, Modifiers::SHIFT, Key::Num2);
    assert!(notices(&desktop).contains("The key 2 brings these colours back."));
    desktop.state_mut().state.picture = plain.clone();
    press(&mut desktop, Modifiers::NONE, Key::Num2);
    assert_eq!(desktop.state().state.picture, kept);
    desktop.state_mut().save();
    drop(desktop);
    let mut next = model(folders(), Some(Document::default()));
    assert_eq!(next.state().state.picture, plain);
    press(&mut next, Modifiers::NONE, Key::Num2);
    assert_eq!(next.state().state.picture, kept);
    press(&mut next, Modifiers::NONE, Key::F1);
    next.get_by_label("Favourite colours; with Ctrl, save the current ones");
}

#[test]
fn edges_are_smoothed_while_the_map_rests_as_far_as_is_asked() {
    let coast = BuiltIn::named("tip").unwrap().document();
    let mut desktop = model(Folders::none(), Some(coast));
    let simulated = counts(&desktop).simulated;
    click(&mut desktop, "Settings");
    until(&mut desktop, "the panel", |desktop| desktop.query_by_label("4 samples").is_some());
    let refined = |desktop: &Desktop| desktop.state().compute.explorer.is_done();
    for choice in ["4 samples", "16 samples"] {
        let before = counts(&desktop).simulated;
        click(&mut desktop, choice);
        assert!(desktop.state().progress().refines && !refined(&desktop), "{choice}");
        let progress = desktop.state().progress();
        assert!((0.5..1.0).contains(&progress.way), "edges are a part of the way: {progress:?}");
        assert!(progress.idle && progress.done == progress.wanted, "the view stays complete");
        until(&mut desktop, "finer samples", refined);
        assert!(counts(&desktop).simulated > before + simulated / 20, "{choice}");
        assert_eq!(desktop.state().progress().way, 1.0);
    }
    let all = counts(&desktop).simulated;
    click(&mut desktop, "1 sample");
    desktop.run_steps(5);
    assert_eq!(counts(&desktop).simulated, all);
}

#[test]
fn the_colours_run_and_compute_nothing() {
    let mut desktop = home();
    let simulated = counts(&desktop).simulated;
    let picture = |desktop: &Desktop| desktop.state().state.picture.clone();
    let before = picture(&desktop);
    click(&mut desktop, "Colours");
    until(&mut desktop, "the panel", |desktop| desktop.query_by_label("Cycle colours").is_some());
    click(&mut desktop, "Cycle colours");
    until(&mut desktop, "the palette to move on", |desktop| picture(desktop).offset > 0.05);
    assert!(picture(&desktop).mirror, "a palette with ends shows no seam");
    click(&mut desktop, "Cycle colours");
    let stands = picture(&desktop);
    desktop.run_steps(5);
    assert_eq!(picture(&desktop), stands);
    assert!(stands.palette == before.palette && stands.times == before.times);
    assert_eq!(counts(&desktop).simulated, simulated);
}

#[test]
fn the_legend_lies_over_the_map_when_asked() {
    let mut desktop = home();
    let legend = "Legend: iris from 0.319275 s to 30 s";
    assert!(desktop.query_by_label(legend).is_none());
    press(&mut desktop, Modifiers::NONE, Key::L);
    desktop.run_steps(3);
    let bounds = desktop.get_by_label(legend).rect();
    assert!(bounds.left() < 60.0 && bounds.bottom() > 300.0, "the lower left: {bounds:?}");
    assert!(desktop.state().state.layers.legend);
    press(&mut desktop, Modifiers::NONE, Key::L);
    desktop.run_steps(3);
    assert!(desktop.query_by_label(legend).is_none());
}
