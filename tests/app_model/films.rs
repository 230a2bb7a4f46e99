//! Films in the window: planned view by view, previewed, and made by the program itself.

use std::process::Command;

use flipmap_scene::keys::Keys;
use flipmap_window::film_run::FilmOrder;

use super::*;

/// The program's own command for a film.
fn film_command(order: &FilmOrder) -> std::io::Result<Command> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flipmap"));
    let [width, height] = order.size;
    command.arg("video").arg(order.keys).arg("-o").arg(order.output);
    command.args(["--engine", "cpu", "--progress", "json"]);
    command.args(["--size", &format!("{width}x{height}"), "--fps", &order.fps.to_string()]);
    Ok(command)
}

/// A desktop with a film of two views in its panel.
fn planned() -> Desktop {
    let options = options(Folders::none(), None);
    let mut desktop = model_of(&WindowOptions { film_command: Some(film_command), ..options });
    click(&mut desktop, "Picture & film");
    desktop.run_steps(30);
    click(&mut desktop, "Add this view");
    press(&mut desktop, Modifiers::NONE, Key::Plus);
    settle(&mut desktop);
    click(&mut desktop, "Add this view");
    desktop
}

#[test]
fn the_preview_moves_the_map_along_the_path_until_the_user_does() {
    let mut desktop = planned();
    let widths = |desktop: &Desktop| {
        let keys = desktop.state().films.draft.keys.iter();
        keys.map(|key| key.scene.view.width_rad().hi).collect::<Vec<_>>()
    };
    let [wide, narrow] = widths(&desktop)[..] else { panic!("two keys") };
    assert!((wide / narrow - std::f64::consts::SQRT_2).abs() < 1e-6);
    click(&mut desktop, "Preview");
    until(&mut desktop, "the middle of the film", |desktop| {
        let width = desktop.state().state.camera.width();
        width < 0.95 * wide && width > 1.05 * narrow
    });
    press(&mut desktop, Modifiers::NONE, Key::ArrowLeft);
    assert!(!desktop.state().films.draft.clock.is_playing(), "the user looks elsewhere");
    click(&mut desktop, "Preview");
    until(&mut desktop, "the end of the film", |desktop| {
        !desktop.state().films.draft.clock.is_playing()
    });
    settle(&mut desktop);
    assert!((desktop.state().state.camera.width() / narrow - 1.0).abs() < 1e-9);
    assert!(desktop.state().state.rests(), "nothing is dragged any more");
}

#[test]
fn a_film_is_made_as_from_a_terminal_and_what_cannot_be_says_why() {
    let mut desktop = planned();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    desktop.state_mut().films.draft.size = [48, 32];
    desktop.state_mut().films.draft.fps = 1.0;
    type_over(&mut desktop, Role::TextInput, "Film to", &path("film.txt"));
    click(&mut desktop, "Make film");
    until(&mut desktop, "the refusal", |desktop| {
        desktop.query_by_label_contains("film.txt: a film is an .mp4").is_some()
    });
    click(&mut desktop, "Dismiss film.txt");
    type_over(&mut desktop, Role::TextInput, "Film to", &path("film"));
    click(&mut desktop, "Make film");
    until(&mut desktop, "the film", |desktop| desktop.query_by_label_contains("Done in").is_some());
    type_over(&mut desktop, Role::TextInput, "Keyframes file", &path("keys.toml"));
    click(&mut desktop, "Save keys");
    assert!(notices(&desktop).contains("keys.toml"));
    let keys = Keys::parse(&fs::read_to_string(path("keys.toml")).unwrap()).unwrap();
    assert_eq!(keys.keys, desktop.state().films.draft.keys);
    let again = Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .args(["video", &path("keys.toml"), "-o", &path("again"), "--engine", "cpu"])
        .args(["--size", "48x32", "--fps", "1"])
        .output()
        .unwrap();
    assert!(again.status.success(), "{again:?}");
    let frames = |name: &str| {
        let mut files: Vec<PathBuf> = fs::read_dir(folder.path().join(name))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|ending| ending == "png"))
            .collect();
        files.sort();
        files.iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(frames("film").len(), 5);
    assert!(frames("film") == frames("again"), "one film from the window and from a terminal");
}

#[test]
fn a_film_that_is_stopped_ends_its_process_and_keeps_its_samples() {
    let mut desktop = planned();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film").display().to_string();
    // Large enough to be under way when it is stopped.
    desktop.state_mut().films.draft.size = [4096, 2160];
    type_over(&mut desktop, Role::TextInput, "Film to", &path);
    click(&mut desktop, "Make film");
    until(&mut desktop, "the first samples", |desktop| {
        desktop.query_by_label_contains(" %, ").is_some()
    });
    click(&mut desktop, "Stop film");
    until(&mut desktop, "the stop", |desktop| {
        desktop.query_by_label_contains("it continues where it stopped").is_some()
    });
    assert!(folder.path().join("film.samples/plan.toml").is_file());
}

/// A film that takes longer than its test.
#[cfg(unix)]
fn endless_film(_: &FilmOrder) -> std::io::Result<Command> {
    let mut command = Command::new("sleep");
    command.arg("600");
    Ok(command)
}

#[cfg(unix)]
#[test]
fn closing_during_a_film_asks_first_and_the_keys_are_there_again() {
    use flipmap_window::action::Action;
    use flipmap_window::state::Effect;
    let folder = tempfile::tempdir().unwrap();
    let opened = || {
        let options = options(Folders::under(folder.path()), Some(Document::default()));
        model_of(&WindowOptions { film_command: Some(endless_film), ..options })
    };
    let mut desktop = opened();
    if desktop.query_by_label("Look around").is_some() {
        click(&mut desktop, "Look around");
    }
    let draft = &mut desktop.state_mut().films.draft;
    let mut deep = Document::default();
    deep.view.width = "0.1".to_string();
    [Document::default(), deep].into_iter().for_each(|scene| draft.add(scene));
    draft.fps = 24.0;
    draft.path = folder.path().join("long.mp4").display().to_string();
    let keys = draft.keys.clone();
    click(&mut desktop, "Picture & film");
    desktop.run_steps(30);
    click(&mut desktop, "Make film");
    let quit = |desktop: &mut Desktop| desktop.state_mut().act(vec![Action::Quit]);
    assert_eq!(quit(&mut desktop), [], "it asks");
    desktop.run_steps(5);
    desktop.get_by_label_contains("made again, it continues where it stopped");
    click(&mut desktop, "Keep it open");
    desktop.run_steps(5);
    assert!(desktop.query_by_label("Keep it open").is_none());
    assert_eq!(quit(&mut desktop), []);
    assert_eq!(quit(&mut desktop), [Effect::Quit], "asked twice, it closes");
    assert_eq!(desktop.state_mut().save(), None);
    drop(desktop);
    let mut again = opened();
    let draft = &again.state().films.draft;
    assert_eq!((&draft.keys, draft.fps), (&keys, 24.0));
    assert!(draft.path.ends_with("long.mp4"));
    assert_eq!(quit(&mut again), [Effect::Quit], "nothing is at stake");
}
