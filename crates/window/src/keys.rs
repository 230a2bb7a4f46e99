//! The keyboard: which command a key triggers, on every layout.
//!
//! A key does what its label says: what it types, whether or not Shift is needed for it. Where the
//! label means nothing to any command, as on Cyrillic keyboards and on the row of digits of French
//! ones, its place counts: the letter or digit there on an American keyboard.

use egui::{Event, InputState, Key, KeyboardShortcut, Modifiers};

use super::action::Action;
use super::commands::{PLAIN, commands, favourites};
use super::state::AppState;

/// A key that was pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Press {
    /// Key by its label, or by its place if its label has no name.
    key: Key,
    /// Key of an American keyboard in the same place.
    place: Option<Key>,
    modifiers: Modifiers,
    /// Character that the key typed; none with Ctrl and for keys such as the arrows.
    typed: Option<char>,
}

impl Press {
    /// Returns the press at an index of the events; what it typed follows it.
    fn at(events: &[Event], index: usize) -> Option<Self> {
        let Event::Key { key, physical_key: place, pressed: true, modifiers, .. } = events[index]
        else {
            return None;
        };
        let typed = match events.get(index + 1) {
            Some(Event::Text(text)) => text.chars().next(),
            _ => None,
        };
        Some(Press { key, place, modifiers, typed })
    }

    /// Returns the key that the label names, if it names any, and the modifiers that count.
    fn by_label(&self) -> Option<(Key, Modifiers)> {
        let named = |typed: char| Key::from_name(typed.encode_utf8(&mut [0; 4]));
        let key = match self.typed {
            Some(typed) => named(typed)?,
            None => self.key,
        };
        // Shift, where it was needed to type a character other than a letter, is a part of it.
        let is_symbol = self.typed.is_some_and(|typed| !typed.is_alphabetic() && typed != ' ');
        let shift = self.modifiers.shift && !is_symbol;
        Some((key, Modifiers { shift, ..self.modifiers }))
    }

    /// Returns the key by its place, if the label is none of the Latin letters and digits.
    fn by_place(&self) -> Option<(Key, Modifiers)> {
        let place = self.place?;
        let is_foreign = match self.typed {
            Some(typed) if is_digit(place) => !typed.is_ascii_alphanumeric(),
            Some(typed) => is_letter(place) && !typed.is_ascii(),
            None => is_digit(place) && !is_letter(self.key),
        };
        is_foreign.then_some((place, self.modifiers))
    }

    /// Returns the index of the shortcut that is meant; the more modifiers a shortcut has, the
    /// earlier it is among them.
    fn meant(&self, shortcuts: &[(KeyboardShortcut, Action)]) -> Option<usize> {
        let find =
            |(key, held)| shortcuts.iter().position(|(shortcut, _)| fits(shortcut, key, held));
        self.by_label().and_then(find).or_else(|| self.by_place().and_then(find))
    }
}

/// Returns true if a key with these modifiers is the shortcut. Alt, which types other characters on
/// some systems, must be held for it; Shift may be held besides.
fn fits(shortcut: &KeyboardShortcut, key: Key, held: Modifiers) -> bool {
    let wanted = shortcut.modifiers;
    shortcut.logical_key == key && wanted.alt == held.alt && held.matches_logically(wanted)
}

fn is_digit(key: Key) -> bool {
    (Key::Num0..=Key::Num9).contains(&key)
}

fn is_letter(key: Key) -> bool {
    (Key::A..=Key::Z).contains(&key)
}

fn is_function_key(key: Key) -> bool {
    (Key::F1..=Key::F12).contains(&key)
}

/// Takes the shortcuts of commands out of the input and returns their actions. While `typing`,
/// takes only those that no text field needs.
pub(crate) fn pressed(input: &mut InputState, state: &AppState, typing: bool) -> Vec<Action> {
    let for_text = |key: &KeyboardShortcut| {
        let types = key.modifiers == PLAIN || key.modifiers == Modifiers::SHIFT;
        types && !is_function_key(key.logical_key) && key.logical_key != Key::Escape
    };
    let mut shortcuts: Vec<(KeyboardShortcut, Action)> = commands(state)
        .into_iter()
        .chain(favourites())
        .flat_map(|c| c.keys.into_iter().map(move |key| (key, c.action.clone())))
        .filter(|(key, _)| !typing || !for_text(key))
        .collect();
    let held = |of: Modifiers| [of.alt, of.shift, of.command].into_iter().filter(|h| *h).count();
    shortcuts.sort_by_key(|(key, _)| std::cmp::Reverse(held(key.modifiers)));
    let meant: Vec<Option<usize>> = (0..input.events.len())
        .map(|index| Press::at(&input.events, index)?.meant(&shortcuts))
        .collect();
    let mut kept = meant.iter().map(Option::is_none);
    input.events.retain(|_| kept.next().unwrap_or(true));
    meant.into_iter().flatten().map(|index| shortcuts[index].1.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::Look;
    use crate::commands::STEP;
    use crate::state::Dialog;
    use crate::state::tests::state;
    use glam::DVec2;

    /// Returns the actions of a key in a place, with the text that it types after it, if any.
    fn actions(
        [key, place]: [Key; 2],
        text: Option<&str>,
        modifiers: Modifiers,
        typing: bool,
    ) -> Vec<Action> {
        let mut input = InputState::default();
        let physical_key = Some(place);
        let press = Event::Key { key, physical_key, pressed: true, repeat: false, modifiers };
        let text = text.map(|text| Event::Text(text.to_string()));
        input.events.extend(std::iter::once(press).chain(text));
        pressed(&mut input, &state(), typing)
    }

    /// Returns the actions of a key in a place, with the character that it types on a layout, as the
    /// system reports them.
    fn typed(place: Key, text: &str, modifiers: Modifiers) -> Vec<Action> {
        let key = Key::from_name(text).unwrap_or(place);
        actions([key, place], (!modifiers.command).then_some(text), modifiers, false)
    }

    fn named(key: Key, modifiers: Modifiers, typing: bool) -> Vec<Action> {
        actions([key; 2], None, modifiers, typing)
    }

    const SHIFT: Modifiers = Modifiers::SHIFT;
    const CTRL: Modifiers = Modifiers { ctrl: true, command: true, ..PLAIN };

    #[test]
    fn keys_become_actions_unless_a_text_field_wants_them() {
        assert_eq!(named(Key::Num0, PLAIN, false), [Action::Look(Look::Home)]);
        assert_eq!(named(Key::Num0, PLAIN, true), []);
        assert_eq!(named(Key::Num3, SHIFT, true), []);
        assert_eq!(named(Key::F1, PLAIN, true), [Action::Toggle(Dialog::Help)]);
        assert_eq!(named(Key::ArrowLeft, Modifiers::ALT, false), [Action::Look(Look::Back)]);
        let left = Action::Look(Look::Step(DVec2::new(-STEP, -0.0)));
        assert_eq!(named(Key::ArrowLeft, PLAIN, false), [left]);
        assert_eq!(named(Key::Z, CTRL | SHIFT, false), [Action::Look(Look::Forward)]);
        let alt_gr = Modifiers { alt: true, ..CTRL };
        assert_eq!(named(Key::Q, alt_gr, false), [], "an @ on a German keyboard does not quit");
    }

    #[test]
    fn digits_recall_on_every_layout_and_never_keep() {
        for (layout, place, text, modifiers) in [
            ("American", Key::Num1, "1", PLAIN),
            ("French", Key::Num1, "1", SHIFT),
            ("French without Shift", Key::Num1, "&", PLAIN),
            ("Swiss", Key::Num1, "1", PLAIN),
            ("Russian", Key::Num1, "1", PLAIN),
            ("Caps Lock on a French one", Key::Num1, "1", PLAIN),
        ] {
            assert_eq!(typed(place, text, modifiers), [Action::Favourite(1)], "{layout}");
        }
        for (place, text) in [(Key::Num2, "é"), (Key::Num3, "\""), (Key::Num4, "'")] {
            let digit = place.name().parse().unwrap();
            assert_eq!(typed(place, text, PLAIN), [Action::Favourite(digit)], "{text}");
        }
        assert_eq!(typed(Key::Num6, "6", SHIFT), [Action::Favourite(6)]);
        assert_eq!(typed(Key::Num0, "à", PLAIN), [Action::Look(Look::Home)]);
    }

    #[test]
    fn ctrl_and_a_digit_keeps_on_every_layout_and_shift_where_it_types_no_digit() {
        for text in ["3", "\"", "#"] {
            assert_eq!(typed(Key::Num3, text, CTRL), [Action::KeepFavourite(3)], "{text}");
        }
        assert_eq!(typed(Key::Num4, "'", CTRL), [Action::KeepFavourite(4)], "French");
        assert_eq!(typed(Key::Num6, "6", CTRL | SHIFT), [Action::KeepFavourite(6)], "French");
        for (place, text, digit) in [(Key::Num1, "!", 1), (Key::Num3, "#", 3), (Key::Num3, "§", 3)]
        {
            assert_eq!(typed(place, text, SHIFT), [Action::KeepFavourite(digit)], "{text}");
        }
    }

    #[test]
    fn signs_do_what_their_label_says() {
        let zooms = |place, text, modifiers| {
            let actions = typed(place, text, modifiers);
            let [Action::Look(Look::Zoom { factor, .. })] = actions[..] else {
                panic!("{text}: {actions:?}")
            };
            factor > 1.0
        };
        for (place, modifiers) in [
            (Key::Equals, SHIFT),       // American, French
            (Key::CloseBracket, PLAIN), // German
            (Key::Num1, SHIFT),         // Swiss
            (Key::Plus, PLAIN),         // the block of digits
        ] {
            assert!(zooms(place, "+", modifiers), "{place:?}");
        }
        for (place, modifiers) in [(Key::Minus, PLAIN), (Key::Slash, PLAIN), (Key::Num6, PLAIN)] {
            assert!(!zooms(place, "-", modifiers), "{place:?}");
        }
        for place in [Key::Slash, Key::Minus, Key::M, Key::Num7] {
            assert_eq!(typed(place, "?", SHIFT), [Action::Toggle(Dialog::Help)], "{place:?}");
        }
        assert_eq!(typed(Key::Minus, "ß", PLAIN), [], "German");
        assert_eq!(typed(Key::Minus, ")", PLAIN), [], "French");
    }

    #[test]
    fn letters_are_those_of_the_label_or_else_of_the_place() {
        let palette = Action::Toggle(Dialog::Commands);
        assert_eq!(typed(Key::K, "л", CTRL), std::slice::from_ref(&palette), "Russian");
        assert_eq!(typed(Key::V, "k", CTRL), [palette], "Dvorak");
        assert_eq!(typed(Key::D, "в", PLAIN), [Action::GoDeeper], "Russian");
        assert_eq!(typed(Key::D, "В", SHIFT), [Action::GoDeeper], "Russian");
        assert_eq!(typed(Key::H, "d", PLAIN), [Action::GoDeeper], "Dvorak");
        assert_eq!(typed(Key::D, "e", PLAIN), [], "Dvorak has an E there");
        assert_eq!(typed(Key::Q, "'", PLAIN), [], "Dvorak");
        assert_eq!(typed(Key::Comma, "б", PLAIN), [], "Russian");
        assert_eq!(typed(Key::W, "z", CTRL), [Action::Look(Look::Back)], "French");
        assert_eq!(typed(Key::Y, "z", CTRL), [Action::Look(Look::Back)], "German");
        assert!(matches!(typed(Key::Semicolon, "m", PLAIN)[..], [Action::Timeline(_)]), "French");
        assert!(matches!(typed(Key::M, "ь", PLAIN)[..], [Action::Timeline(_)]), "Russian");
    }
}
