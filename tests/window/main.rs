//! The real window: the built program on a virtual display, with software graphics and the CPU
//! engine, driven by X events. Screenshots are kept under `target/window-shots`.
#![cfg(target_os = "linux")]

mod display;
mod likeness;
mod mishaps;
mod session;
mod soak;
mod vitals;

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use display::{LEFT, wait_for};
use flipmap_scene::{BuiltIn, Scene, location};
use image::RgbImage;
use image::imageops::{crop_imm, flip_horizontal};
use likeness::{distance_from_smooth, expected, is_right, likeness, picture};
use rustix::process::Signal;
use session::{Session, Told, WINDOW, keep_settings};

macro_rules! window_tests {
    ($($name:ident)*) => {
        $(
            #[test]
            #[cfg_attr(no_window, ignore = "FLIPMAP_NO_WINDOW=1 declares that there is no display")]
            fn $name() {
                checks::$name();
            }
        )*
    };
}

window_tests! {
    the_home_map_is_the_picture_that_render_makes
    the_wheel_zooms_about_the_pointer_and_going_back_computes_nothing
    a_dragged_map_follows_the_pointer
    a_clicked_pixel_flies_its_pendulum
    any_size_will_do
    pictures_and_locations_are_opened
    keys_and_commands_are_found
    a_lost_device_is_opened_again
    a_window_at_rest_costs_nothing
    edges_are_smoothed_while_the_map_rests
    going_deeper_finds_structure_by_itself
    the_laboratory_is_live
    closing_keeps_where_it_was
    without_a_config_nothing_is_kept
    any_scale_opens_a_window
    a_display_of_other_colours_is_said_to_be_one
    where_no_compositor_answers_x11_is_used
    a_display_that_goes_away_costs_nothing
    a_clipboard_that_does_not_answer_freezes_nothing
    soak
}

/// The part of a screenshot beside the map, where the panels are.
fn side(told: &Told, shot: &RgbImage) -> RgbImage {
    let [map_width, map_height] = told.map_px().map(|side| side as u32);
    crop_imm(shot, map_width, 0, WINDOW[0] - map_width, map_height).to_image()
}

/// The scene with a budget that follows the depth, as in a window where the user has not set it.
fn following(mut scene: Scene) -> Scene {
    scene.question.budget = "auto".parse().unwrap();
    scene
}

fn close_by(a: f64, b: f64, within: f64) -> bool {
    (a - b).abs() <= within
}

/// Options for colours that are the same in every view, of samples as they are.
const PLAIN: [&str; 3] = ["--no-denoise", "--times", "budget"];

mod checks {
    use super::*;

    pub(crate) use super::mishaps::{
        a_clipboard_that_does_not_answer_freezes_nothing,
        a_display_of_other_colours_is_said_to_be_one, a_display_that_goes_away_costs_nothing,
        any_scale_opens_a_window, where_no_compositor_answers_x11_is_used,
    };
    pub(crate) use super::soak::soak;

    pub(crate) fn the_home_map_is_the_picture_that_render_makes() {
        let mut session = Session::open("home", &PLAIN);
        let told = session.told().unwrap();
        let shot = session.shot("map");
        let mut home = following(BuiltIn::home().document().scene());
        home.view = home.view.fitted(told.map_px());
        assert_eq!(told.scene().view.center_rad(), home.view.center_rad());
        home.view.center = told.scene().view.center;
        assert_eq!(told.scene(), home, "the center may have fewer digits, nothing else differs");
        assert!(is_right(&told, &shot));
        // The comparison can fail: the mirrored map has the same colours in other places.
        let [width, height] = told.map_px().map(|side| side as u32);
        let mirrored = flip_horizontal(&crop_imm(&shot, 0, 0, width, height).to_image());
        assert!(likeness(&told, &mirrored, &expected(&told), [0.0; 2]).calm < 0.5);
        assert!(!is_right(&told, &mirrored));
        session.quit();
    }

    pub(crate) fn the_wheel_zooms_about_the_pointer_and_going_back_computes_nothing() {
        let mut session = Session::open("zoom", &PLAIN);
        let home = session.rest("all around home", Told::is_idle);
        let point = [112.0, 231.0];
        let zoomed = session.after(
            "the zoomed map",
            |display| {
                display.point(point[0], point[1]);
                display.wheel_twice(3);
            },
            |told| told.is_idle() && close_by(told.width_rad(), home.width_rad() / 4.0, 1e-9),
        );
        let (before, after) = (home.angle_at(point), zoomed.angle_at(point));
        for axis in [0, 1] {
            assert!(close_by(before[axis], after[axis], 1e-6), "{before:?}, {after:?}");
        }
        assert!(zoomed.number("simulated") > home.number("simulated"));
        session.display.point(1599.0, 999.0);
        sleep(Duration::from_millis(300));
        assert!(is_right(&zoomed, &session.shot("zoomed")));
        for (key, there) in [("BackSpace", &home), ("alt+Right", &zoomed), ("0", &home)] {
            let told = session.after(
                "a view seen before",
                |display| display.key(key),
                |told| told.is_idle() && told.scene() == there.scene(),
            );
            for count in ["simulated", "rhs_evaluations"] {
                assert_eq!(told.number(count), zoomed.number(count), "{key} computed something");
            }
        }
        session.quit();
    }

    pub(crate) fn a_dragged_map_follows_the_pointer() {
        let mut session = Session::open("drag", &[&["filigree"][..], &PLAIN].concat());
        let before = session.rest("all around", Told::is_idle);
        let (from, to) = ([420.0, 240.0], [290.0, 330.0]);
        let dragged = session.after(
            "the dragged map",
            |display| display.drag(from, to),
            |told| told.is_idle() && told.scene() != before.scene(),
        );
        let (grabbed, under) = (before.angle_at(from), dragged.angle_at(to));
        for axis in [0, 1] {
            // Accurate to one pixel, the resolution of a pointer.
            let pixel_rad = dragged.width_rad() / dragged.map_px()[0];
            assert!(close_by(grabbed[axis], under[axis], pixel_rad), "{grabbed:?}, {under:?}");
        }
        session.display.point(1599.0, 999.0);
        sleep(Duration::from_millis(300));
        assert!(is_right(&dragged, &session.shot("dragged")));
        let back = session.after(
            "the map dragged back",
            |display| display.drag(to, from),
            |told| told.is_idle() && close_by(told.angle_at(from)[0], grabbed[0], 1e-3),
        );
        // The pointer may be a pixel off, so that a strip of new cells comes into view.
        let new = back.number("simulated") - dragged.number("simulated");
        assert!(new < 0.05 * dragged.number("simulated"), "seen before, but {new} are new");
        session.quit();
    }

    pub(crate) fn a_clicked_pixel_flies_its_pendulum() {
        let mut session = Session::open("pendulum", &[]);
        let told = session.told().unwrap();
        let empty = side(&told, &session.shot("nothing"));
        let point = [181.0, 163.0];
        session.display.point(point[0], point[1]);
        session.display.click(LEFT);
        let shown = wait_for("the panel of the pendulum", 20, || {
            let shown = side(&told, &session.shot("playing"));
            (shown != empty).then_some(shown)
        });
        let later = wait_for("the pendulum to move", 20, || {
            let later = side(&told, &session.shot("playing"));
            (later != shown).then_some(later)
        });
        assert_ne!(later, empty);
        let flown = |told: &Told| told.is_idle() && told.number("flown") == 1.0;
        let paused = session.after("the pause", |display| display.key("space"), flown);
        let [pinned] = paused.pins()[..] else { panic!("{:?}", paused.pins()) };
        let (clicked, pixel_rad) = (told.angle_at(point), told.width_rad() / told.map_px()[0]);
        for axis in [0, 1] {
            assert!(close_by(pinned[axis], clicked[axis], 2.0 * pixel_rad), "{pinned:?}");
        }
        let still = side(&told, &session.shot("paused"));
        sleep(Duration::from_millis(400));
        assert!(still == side(&told, &session.shot("paused")), "a paused pendulum moved");
        assert_eq!(session.told().unwrap().frames(), paused.frames(), "a paused one is drawn");
        session.quit();
    }

    pub(crate) fn any_size_will_do() {
        let mut session = Session::open("size", &PLAIN);
        for size in [[330, 240], [60, 40], [1600, 1000], [1000, 600]] {
            let told = session.after(
                "the new size",
                |display| display.resize(session.window, size),
                |told| told.map_px()[1] <= f64::from(size[1]),
            );
            let shot = session.shot(&format!("{}x{}", size[0], size[1]));
            assert!(size[0] < 1000 || is_right(&told, &shot), "{size:?}");
        }
        session.quit();
    }

    pub(crate) fn pictures_and_locations_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        let place = following(BuiltIn::named("filigree").unwrap().document().scene());
        fs::write(&path, picture(place.clone(), [48, 32]).1).unwrap();
        let mut session = Session::open("open", &[path.to_str().unwrap()]);
        let opened = session.told().unwrap();
        assert_eq!(location::text(&opened.scene()), location::text(&place));
        assert!(is_right(&opened, &session.shot("picture")));
        session.after(
            "the notice",
            |display| display.key("ctrl+l"),
            |told| told.notices().iter().any(|notice| notice.contains("location was copied")),
        );
        let away = |told: &Told| told.width_rad() > 6.0;
        session.after("the whole map", |display| display.key("0"), away);
        let back = |told: &Told| told.scene() == place;
        session.after("the pasted location", |display| display.key("ctrl+v"), back);
        session.quit();
    }

    pub(crate) fn keys_and_commands_are_found() {
        let mut session = Session::open("keys", &PLAIN);
        session.rest("all around", Told::is_idle);
        // Pictures in the side panel may still be under way.
        let before =
            session.after("the map alone", |display| display.key("F9"), |told| told.is_idle());
        let plain = session.shot("plain");
        session.after("the list of keys", |display| display.key("F1"), |_| true);
        assert!(plain != session.shot("keys"));
        session.after("the map alone", |display| display.key("Escape"), |_| true);
        assert!(plain == session.shot("closed"), "closed, the list leaves nothing behind");
        session.display.key("ctrl+k");
        sleep(Duration::from_millis(300));
        session.display.type_in("energy");
        sleep(Duration::from_millis(300));
        session.shot("commands");
        let told = session.after("the command", |display| display.key("Return"), |_| true);
        assert!(plain != session.shot("no curve"));
        assert_eq!(told.number("simulated"), before.number("simulated"), "a layer is only drawn");
        session.quit();
    }

    pub(crate) fn going_deeper_finds_structure_by_itself() {
        let mut session = Session::open("deeper", &["filigree"]);
        let before = session.rest("all around", Told::is_idle);
        let deep = session.after(
            "a deep view",
            |display| {
                display.point(300.0, 240.0);
                display.key("d");
                sleep(Duration::from_secs(60));
                display.key("Escape");
            },
            // An octave takes two seconds at most, once the first view is drawn.
            |told| told.is_idle() && told.width_rad() < before.width_rad() * 2f64.powi(-20),
        );
        assert!(deep.scene().question.budget.auto);
        session.shot("deep");
        let back = session.after(
            "the view before",
            |display| display.key("BackSpace"),
            |told| told.is_idle() && told.width_rad() > 2.0 * deep.width_rad(),
        );
        assert!(close_by(back.width_rad(), before.width_rad(), 1e-9), "a dive is one step");
        session.quit();
    }

    pub(crate) fn the_laboratory_is_live() {
        let mut session = Session::open("lab", &[]);
        let mut before = session.shot("map");
        for key in ["F2", "F3", "F4", "F6", "F7", "F5"] {
            session.display.key(key);
            sleep(Duration::from_millis(700));
            let shot = session.shot(key);
            assert!(shot != before, "{key} shows nothing new");
            before = shot;
        }
        // Figure 4: a bob is dragged, then the slider of m1 is pressed near its right end.
        session.display.drag([300.0, 250.0], [180.0, 200.0]);
        sleep(Duration::from_millis(300));
        session.display.drag([690.0, 117.0], [700.0, 117.0]);
        sleep(Duration::from_millis(700));
        session.shot("set");
        let told = session.quit().told.unwrap();
        assert_eq!(told.text("figure"), "machine");
        let set = told.numbers("figure_set");
        assert!(set[0] != 2.0 || set[1] != 2.6, "the bob was not dragged: {set:?}");
        assert!(set[2..7] != [1.0, 1.0, 1.0, 1.0, 9.81], "no slider was moved: {set:?}");
        assert!(told.number("figure_secs") > 3.0 && told.number("figure_fps") > 10.0);
    }

    pub(crate) fn a_lost_device_is_opened_again() {
        let mut session = Session::open("lost", &PLAIN);
        session.display.key("F12");
        session.display.key("ctrl+k");
        // Text typed before the field is shown would not reach it.
        sleep(Duration::from_millis(300));
        session.display.type_in("lose the");
        sleep(Duration::from_millis(300));
        let told = session.after(
            "the notice of the loss",
            |display| display.key("Return"),
            |told| told.notices().iter().any(|notice| notice.contains("opened again")),
        );
        let again = likeness(&told, &session.shot("again"), &expected(&told), [0.0; 2]);
        assert!(again.calm > 0.8, "{again:?}: more is wrong than the notice covers");
        // The window works as before.
        session.after(
            "a zoom",
            |display| display.key("plus"),
            |zoomed| zoomed.width_rad() < told.width_rad(),
        );
        session.quit();
    }

    pub(crate) fn edges_are_smoothed_while_the_map_rests() {
        let home = tempfile::tempdir().unwrap();
        keep_settings(home.path(), "greeted = true\nedges = \"16\"\n");
        let mut session = Session::open_in(home, "edges", &[&["tip"][..], &PLAIN].concat());
        let before = session.rest("all around", Told::is_idle);
        let rough = distance_from_smooth(&before, &session.shot("rough"));
        let after = session.rest("finer samples", |told| told.is_idle() && !told.is("refines"));
        assert!(after.number("simulated") > 1.2 * before.number("simulated"));
        let smooth = distance_from_smooth(&after, &session.shot("smooth"));
        println!("{rough} {smooth}");
        assert!(smooth < 0.7 * rough, "{smooth} after {rough}");
        session.quit();
    }

    pub(crate) fn a_window_at_rest_costs_nothing() {
        let session = Session::open("rest", &[]);
        session.rest("all around", Told::is_idle);
        let frames = || session.told().unwrap().frames();
        // Small pictures come after the last tile: on a busy machine, some seconds after.
        let mut drawn = frames();
        for _ in 0..60 {
            sleep(Duration::from_secs(1));
            let before = drawn;
            drawn = frames();
            if drawn == before {
                break;
            }
        }
        let secs = session.processor_secs();
        sleep(Duration::from_secs(3));
        assert_eq!(frames(), drawn, "a frame for nothing");
        let used_secs = session.processor_secs() - secs;
        assert!(used_secs <= 0.03, "{used_secs} s of a processor in 3 s");
        session.quit();
    }

    pub(crate) fn closing_keeps_where_it_was() {
        let zoom = |session: &Session| {
            let wide = session.told().unwrap().width_rad();
            let zoomed = |told: &Told| told.width_rad() < wide;
            session.after("a zoom", |display| display.key("plus"), zoomed).scene()
        };
        let session = Session::open("close", &[]);
        let first = zoom(&session);
        session.display.ask_to_close(session.window);
        let ended = session.ended();
        assert_eq!(ended.code, Some(0), "{}", ended.log);
        let session = Session::open_in(ended.folder, "close", &[]);
        assert_eq!(session.told().unwrap().scene(), first, "it opens where it was left");
        let moved = zoom(&session);
        session.signal(Signal::TERM);
        let ended = session.ended();
        assert_eq!(ended.code, Some(130), "{}", ended.log);
        assert!(ended.log.contains("stopped"), "{}", ended.log);
        let session = Session::open_in(ended.folder, "close", &[]);
        assert_eq!(session.told().unwrap().scene(), moved, "a signal loses nothing either");
        assert_eq!(session.quit().told.unwrap().scene(), moved);
    }

    pub(crate) fn without_a_config_nothing_is_kept() {
        let ended = Session::open("none", &["--no-config"]).quit();
        let files: Vec<_> = fs::read_dir(ended.folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| !["stats.json", "log"].contains(&name.as_str()))
            .collect();
        assert!(files.is_empty(), "{files:?}");
    }
}
