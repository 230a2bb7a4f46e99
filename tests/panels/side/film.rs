//! Films in the side panel: keys, the preview, and films being made.

use flipmap_window::film_draft::FilmDraft;
use flipmap_window::panels::film::{FilmAction, film_panel};

use super::*;

/// The panel of a film through views of these widths, one film of which is being made.
pub(super) fn panel(widths: &[&str]) -> Harness<'static, Shown<FilmDraft, FilmAction>> {
    let mut draft =
        FilmDraft { path: "/no/such/folder/film.mp4".to_string(), ..FilmDraft::default() };
    for width in widths {
        let mut document = Document::default();
        document.view.width = width.to_string();
        draft.add(document);
    }
    let stage = ExportStage::Running { share: 0.25, pace: "7 min left".to_string() };
    let of = |name: &str, is_film| ExportStatus {
        name: name.to_string(),
        stage: stage.clone(),
        is_film,
    };
    let exports = vec![of("map.png", false), of("film.mp4", true)];
    harness(
        [340.0, 460.0],
        draft,
        move |ui, draft| film_panel(ui, draft, &exports),
        |draft, action| match action {
            FilmAction::Change(new) => *draft = *new,
            FilmAction::Preview(clock) => draft.clock = clock,
            _ => {}
        },
    )
}

#[test]
fn keys_are_timed_gone_to_and_removed() {
    let mut harness = panel(&["6.3", "0.2", "1e-5"]);
    type_over(&mut harness, "Seconds to key 2", "2");
    assert_eq!(harness.state().state.keys[2].secs, 7.0);
    press(&mut harness, "3: 10⁻⁵ wide");
    assert_eq!(harness.state().asked.last(), Some(&FilmAction::Go(2)));
    press(&mut harness, "Remove key 1");
    let draft = &harness.state().state;
    assert_eq!((draft.keys.len(), draft.keys[1].secs), (2, 5.0));
    press(&mut harness, "Add this view");
    assert_eq!(harness.state().asked.last(), Some(&FilmAction::Add));
}

#[test]
fn a_film_is_previewed_and_made_once_it_has_two_keys() {
    let mut harness = panel(&["6.3"]);
    assert!(harness.query_by_label("Preview").is_none());
    harness.get_by_label_contains("needs two keys");
    press(&mut harness, "Make film");
    assert!(harness.state().asked.is_empty(), "a film of one view cannot be made");

    let mut harness = panel(&["6.3", "0.2"]);
    press(&mut harness, "Preview");
    assert!(harness.state().state.clock.is_playing());
    press(&mut harness, "Pause");
    assert!(!harness.state().state.clock.is_playing());
    choose(&mut harness, "Frames", "640 × 360");
    type_over(&mut harness, "Per second", "24");
    let draft = &harness.state().state;
    assert_eq!((draft.size, draft.fps), ([640, 360], 24.0));
    for (name, asked) in [
        ("Make film", FilmAction::Start),
        ("Choose…", FilmAction::Browse),
        ("Save keys", FilmAction::SaveKeys),
        ("Open keys", FilmAction::OpenKeys),
        ("Stop film.mp4", FilmAction::Export(ExportAction::Cancel(1))),
    ] {
        press(&mut harness, name);
        assert_eq!(harness.state().asked.last(), Some(&asked), "{name}");
    }
    assert!(harness.query_by_label("Stop map.png").is_none(), "pictures have a panel of their own");
}
