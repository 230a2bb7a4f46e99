//! The commands, each with a name and most with a key: one list serves the keyboard, the list of
//! keys and the command palette.

use std::borrow::Cow;
use std::collections::BTreeMap;

use egui::{Key, KeyboardShortcut, Modifiers};
use glam::DVec2;

use super::action::{Action, LabAction, Look};
use super::favourites::DIGITS;
use super::light::switched;
use super::panels::colours::any_palette;
use super::sections::PANELS;
use super::settings::{EdgeSamples, Layers, Theme};
use super::state::{AppState, Dialog};
use flipmap_engine::Accuracy;
use flipmap_lab::Figure;
use flipmap_scene::palette::Palette;
use flipmap_scene::{BUILT_IN, PictureTable};
use flipmap_screen::flight::playback::Playback;

/// An action with a name.
pub(crate) struct Command {
    /// Short description of the command.
    pub name: Cow<'static, str>,
    /// Shortcuts that trigger it; the first is its usual one.
    pub keys: Vec<KeyboardShortcut>,
    /// Action that it triggers.
    pub action: Action,
    /// Other words, in lower case, under which it is found.
    pub also: &'static str,
    /// Palette whose colours are shown beside the name, if it is about one.
    pub swatch: Option<String>,
}

impl Command {
    /// Returns the command, which is also found under these words.
    fn also(self, also: &'static str) -> Self {
        Command { also, ..self }
    }
}

/// Share of the canvas by which an arrow key moves the view.
pub(crate) const STEP: f64 = 0.15;
/// Zoom factor of a key press.
const KEY_ZOOM: f64 = std::f64::consts::SQRT_2;

pub(crate) const PLAIN: Modifiers = Modifiers::NONE;

fn key(modifiers: Modifiers, key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(modifiers, key)
}

/// Returns every command, as it would act on a state.
pub(crate) fn commands(state: &AppState) -> Vec<Command> {
    let mut commands = doing(state);
    commands.extend(showing(&state.layers));
    commands.extend(teaching());
    commands.extend(moving());
    #[cfg(feature = "rigs")]
    if state.shown.debug {
        commands.push(command("Lose the graphics device", [], Action::LoseDevice));
    }
    commands
}

fn command(
    name: impl Into<Cow<'static, str>>,
    keys: impl IntoIterator<Item = KeyboardShortcut>,
    action: Action,
) -> Command {
    let name = name.into();
    Command { name, keys: keys.into_iter().collect(), action, also: "", swatch: None }
}

fn moving() -> Vec<Command> {
    let step = |x, y| Action::Look(Look::Step(DVec2::new(x, y) * STEP));
    let zoom = |factor| Action::Look(Look::Zoom { factor, about: DVec2::ZERO });
    vec![
        command("Move left", [key(PLAIN, Key::ArrowLeft)], step(-1.0, 0.0)),
        command("Move right", [key(PLAIN, Key::ArrowRight)], step(1.0, 0.0)),
        command("Move up", [key(PLAIN, Key::ArrowUp)], step(0.0, -1.0)),
        command("Move down", [key(PLAIN, Key::ArrowDown)], step(0.0, 1.0)),
        command("Zoom in", [key(PLAIN, Key::Plus), key(PLAIN, Key::Equals)], zoom(KEY_ZOOM)),
        command("Zoom out", [key(PLAIN, Key::Minus)], zoom(1.0 / KEY_ZOOM)),
        command("The whole map", [key(PLAIN, Key::Num0)], Action::Look(Look::Home)),
        command(
            "Back (undo)",
            [
                key(PLAIN, Key::Backspace),
                key(Modifiers::ALT, Key::ArrowLeft),
                key(Modifiers::COMMAND, Key::Z),
            ],
            Action::Look(Look::Back),
        )
        .also("previous view"),
        command(
            "Forward (redo)",
            [
                key(Modifiers::ALT, Key::ArrowRight),
                key(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z),
            ],
            Action::Look(Look::Forward),
        )
        .also("next view"),
    ]
}

fn showing(layers: &Layers) -> Vec<Command> {
    let layer = |change: fn(&mut Layers)| {
        let mut layers = *layers;
        change(&mut layers);
        Action::Layers(layers)
    };
    let keyed = |letter| [key(PLAIN, letter)];
    vec![
        command("Energy curve", keyed(Key::C), layer(|layers| layers.curve ^= true)),
        command("Hatch doubtful pixels", keyed(Key::T), layer(|layers| layers.trust ^= true)),
        command("Legend", keyed(Key::L), layer(|layers| layers.legend ^= true)),
        command("Grid of angles", keyed(Key::G), layer(|layers| layers.grid ^= true)),
        command("Borders of tiles", keyed(Key::B), layer(|layers| layers.borders ^= true)),
        command("Pendulum at the pointer", keyed(Key::H), layer(|layers| layers.swing ^= true)),
        command("Panels and toolbar", keyed(Key::F9), Action::Toggle(Dialog::Side))
            .also("hide show clean rail side"),
        command("All pendulums in the whole window", keyed(Key::F), Action::Toggle(Dialog::Stage)),
        command(
            "Keys",
            [key(PLAIN, Key::F1), key(PLAIN, Key::Questionmark)],
            Action::Toggle(Dialog::Help),
        ),
        command("What you are seeing", [], Action::Toggle(Dialog::Greeting)),
        command(
            "Commands",
            [key(Modifiers::COMMAND, Key::K), key(Modifiers::COMMAND, Key::P)],
            Action::Toggle(Dialog::Commands),
        ),
        command("What the window measures", keyed(Key::F12), Action::Toggle(Dialog::Debug)),
        command("Full screen", keyed(Key::F11), Action::FullScreen),
    ]
}

fn doing(state: &AppState) -> Vec<Command> {
    let accuracy = |accuracy| Action::Accuracy(accuracy);
    let scale = |factor: f32| Action::UiScale(state.look.ui_scale * factor);
    let ctrl = |letter| [key(Modifiers::COMMAND, letter)];
    vec![
        command("Pin the middle of the map", [key(PLAIN, Key::P)], Action::Pin(DVec2::ZERO)),
        command("Go deeper here, or stop", [key(PLAIN, Key::D)], Action::GoDeeper),
        command("Play or pause", [key(PLAIN, Key::Space)], Action::PlayPause),
        command(
            "Time on the map, or the whole map",
            [key(PLAIN, Key::M)],
            Action::Timeline(state.shown.timeline.xor(Some(Playback::default()))),
        ),
        command("Relief", [key(PLAIN, Key::R)], Action::Picture(switched(&state.picture)))
            .also("light shadow emboss shading landscape"),
        command("Open a scene or a picture…", ctrl(Key::O), Action::AskForFile),
        command("Save the picture on the screen", ctrl(Key::S), Action::SavePicture)
            .also("screenshot png export"),
        command("Copy the picture on the screen", ctrl(Key::C), Action::CopyPicture)
            .also("clipboard share"),
        command("Copy the location", ctrl(Key::L), Action::CopyLocation).also("share"),
        command("Copy the link", [], Action::CopyLink).also("share browser page web address url"),
        command("Accuracy: lesson", [], accuracy(Accuracy::Lesson)),
        command("Accuracy: fast", [], accuracy(Accuracy::Fast)),
        command("Accuracy: balanced", [], accuracy(Accuracy::Balanced)),
        command("Accuracy: exact", [], accuracy(Accuracy::Exact)),
        command(
            "Interface larger",
            [key(Modifiers::COMMAND, Key::Plus), key(Modifiers::COMMAND, Key::Equals)],
            scale(1.1),
        ),
        command("Interface smaller", ctrl(Key::Minus), scale(1.0 / 1.1)),
        command("Dark", [], Action::Theme(Theme::Dark)).also("theme"),
        command("Light", [], Action::Theme(Theme::Light)).also("theme"),
        command("Animate moves on or off", [], Action::Animate(!state.look.animate)),
        command("Anti-aliasing at rest: none", [], Action::Edges(EdgeSamples::One)),
        command("Anti-aliasing at rest: 4 samples", [], Action::Edges(EdgeSamples::Four)),
        command("Anti-aliasing at rest: 16 samples", [], Action::Edges(EdgeSamples::Sixteen)),
        command("Close what is open", [key(PLAIN, Key::Escape)], Action::Escape),
        command("Quit", ctrl(Key::Q), Action::Quit),
    ]
}

/// The commands of the laboratory.
fn teaching() -> Vec<Command> {
    let lab = |action| Action::InLab(action);
    let figures = Figure::all().map(|figure| {
        command(figure.title(), [key(PLAIN, figure.key())], Action::Lab(Some(figure)))
    });
    let others = [
        command("Lesson of the seven figures", [], lab(LabAction::Lesson)),
        command("Next figure", [key(PLAIN, Key::PageDown)], lab(LabAction::Step(1))),
        command("Previous figure", [key(PLAIN, Key::PageUp)], lab(LabAction::Step(-1))),
        command("Figure slower", [key(PLAIN, Key::Comma)], lab(LabAction::ShiftSpeed(-1))),
        command("Figure faster", [key(PLAIN, Key::Period)], lab(LabAction::ShiftSpeed(1))),
        command(
            "Projector: large, few controls",
            [key(PLAIN, Key::F10)],
            lab(LabAction::Projector),
        ),
        command("Leave the lab", [], Action::Lab(None)),
    ];
    figures.chain(others).collect()
}

/// Returns the commands for colours kept under digits; the list of keys has one line for all of
/// them.
pub(crate) fn favourites() -> Vec<Command> {
    const KEYS: [Key; 9] = [
        Key::Num1,
        Key::Num2,
        Key::Num3,
        Key::Num4,
        Key::Num5,
        Key::Num6,
        Key::Num7,
        Key::Num8,
        Key::Num9,
    ];
    let of_digit = |(digit, number): (u8, Key)| {
        let (show, keep) = (Action::Favourite(digit), Action::KeepFavourite(digit));
        [
            command(format!("Favourite colours {digit}"), [key(PLAIN, number)], show),
            command(
                format!("Keep these colours as {digit}"),
                [key(Modifiers::COMMAND, number), key(Modifiers::SHIFT, number)],
                keep,
            ),
        ]
    };
    DIGITS.zip(KEYS).flat_map(of_digit).collect()
}

/// Returns the commands that only the command palette lists: panels, places, palettes and
/// favourites. Other callers avoid the cost of reading the scenes.
pub(crate) fn choices(picture: &PictureTable, kept: &BTreeMap<String, String>) -> Vec<Command> {
    let panels = PANELS.map(|panel| {
        let name = format!("{} › {}", panel.section.name(), panel.name);
        command(name, [], Action::Panel(panel.name)).also(panel.also)
    });
    fn painted(picture: &PictureTable, change: impl FnOnce(&mut PictureTable)) -> Action {
        let mut picture = picture.clone();
        change(&mut picture);
        Action::Picture(picture)
    }
    let colours = [
        command("Random palette", [], painted(picture, |p| p.palette = any_palette()))
            .also("colours die"),
        command("Smooth the grain on or off", [], painted(picture, |p| p.denoise ^= true))
            .also("denoise noise velvet"),
        command("Spread the palette over this view", [], painted(picture, |p| p.times.clear()))
            .also("colours equalise histogram auto times"),
    ];
    let places = BUILT_IN.iter().map(|place| {
        let show = Action::Visit(Box::new(place.document()));
        command(format!("Place: {}", place.name), [], show)
    });
    let built_in = Palette::names().map(|name| (name, name));
    let kept = kept.iter().map(|(name, text)| (name.as_str(), text.as_str()));
    let palettes = built_in.chain(kept).map(|(name, text)| {
        let palette = text.to_string();
        let swatch = Some(palette.clone());
        let action = painted(picture, |picture| picture.palette = palette);
        Command { swatch, ..command(format!("Palette: {name}"), [], action) }
    });
    colours.into_iter().chain(panels).chain(places).chain(palettes).chain(favourites()).collect()
}

/// Returns the text of a shortcut, such as `Ctrl+K`.
pub(crate) fn shortcut_text(shortcut: &KeyboardShortcut) -> String {
    let mut text = String::new();
    for (held, name) in [
        (shortcut.modifiers.command, "Ctrl+"),
        (shortcut.modifiers.alt, "Alt+"),
        (shortcut.modifiers.shift, "Shift+"),
    ] {
        if held {
            text.push_str(name);
        }
    }
    // Arrows are named, because not every font has their symbols.
    text + match shortcut.logical_key {
        Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown => {
            shortcut.logical_key.name()
        }
        key => key.symbol_or_name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::tests::state;

    #[test]
    fn every_name_and_every_key_is_used_once() {
        let state = state();
        let mut commands = commands(&state);
        commands.extend(choices(&state.picture, &BTreeMap::new()));
        let mut names: Vec<_> = commands.iter().map(|command| command.name.clone()).collect();
        let mut keys: Vec<String> =
            commands.iter().flat_map(|c| &c.keys).map(shortcut_text).collect();
        let (all_names, all_keys) = (names.len(), keys.len());
        names.sort_unstable();
        names.dedup();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!((names.len(), keys.len()), (all_names, all_keys));
    }
}
