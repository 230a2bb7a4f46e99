//! The clipboard, read on a thread of its own: the program that holds it may never answer.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{Event, Key, Modifiers, Pos2};
use winit::event_loop::EventLoopProxy;

use super::wake::Woken;

/// A text to be pasted, as far as there is one.
#[derive(Debug)]
pub(crate) enum Pasted {
    /// A text from the clipboard.
    Text(String),
    /// The text that is selected somewhere, for this point.
    Selection(Pos2, String),
    /// No text: there is none, or the program that holds it does not answer.
    Nothing,
    /// No text, because only the connection of the window reaches the clipboard.
    Unreachable,
}

/// The reader of the clipboard, which reads one text at a time.
#[derive(Debug, Default)]
pub(crate) struct ClipboardReader {
    is_reading: Arc<AtomicBool>,
}

impl ClipboardReader {
    /// Begins to read the clipboard, or for a point the text that is selected somewhere; the window
    /// is woken with the answer.
    pub(crate) fn ask(&self, selection: Option<Pos2>, proxy: &EventLoopProxy<Woken>) {
        let proxy = proxy.clone();
        self.begin(selection, read, move |pasted| {
            // After the event loop has ended, nothing is pasted any more.
            let _ = proxy.send_event(Woken::Pasted(pasted));
        });
    }

    fn begin(
        &self,
        selection: Option<Pos2>,
        read: impl FnOnce(Option<Pos2>) -> Pasted + Send + 'static,
        answer: impl FnOnce(Pasted) + Send + 'static,
    ) {
        if self.is_reading.swap(true, Ordering::AcqRel) {
            return;
        }
        let is_reading = Arc::clone(&self.is_reading);
        std::thread::spawn(move || {
            let pasted = read(selection);
            is_reading.store(false, Ordering::Release);
            answer(pasted);
        });
    }
}

fn read(selection: Option<Pos2>) -> Pasted {
    let Ok(mut clipboard) = arboard::Clipboard::new() else { return Pasted::Unreachable };
    match selection {
        None => match clipboard.get_text() {
            Ok(text) if !text.is_empty() => Pasted::Text(text.replace("\r\n", "\n")),
            _ => Pasted::Nothing,
        },
        Some(point) => {
            selected(&mut clipboard).map_or(Pasted::Nothing, |text| Pasted::Selection(point, text))
        }
    }
}

#[cfg(all(unix, not(target_os = "macos")))]
fn selected(clipboard: &mut arboard::Clipboard) -> Option<String> {
    use arboard::{GetExtLinux, LinuxClipboardKind};
    let text = clipboard.get().clipboard(LinuxClipboardKind::Primary).text().ok()?;
    (!text.is_empty()).then_some(text)
}

#[cfg(not(all(unix, not(target_os = "macos"))))]
fn selected(_: &mut arboard::Clipboard) -> Option<String> {
    None
}

/// Turns the keys for cutting and copying into egui's events for them, and removes those for
/// pasting. Returns true if there was one.
pub(crate) fn take_keys(events: &mut Vec<Event>) -> bool {
    let mut pastes = false;
    events.retain_mut(|event| {
        let Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
        let (key, modifiers) = (*key, *modifiers);
        if means(key, modifiers, [Key::Cut, Key::X])
            || on_windows(key, Key::Delete, modifiers.shift)
        {
            *event = Event::Cut;
        } else if means(key, modifiers, [Key::Copy, Key::C])
            || on_windows(key, Key::Insert, modifiers.ctrl)
        {
            *event = Event::Copy;
        } else if means(key, modifiers, [Key::Paste, Key::V])
            || on_windows(key, Key::Insert, modifiers.shift)
        {
            pastes = true;
            return false;
        }
        true
    });
    pastes
}

fn means(key: Key, modifiers: Modifiers, [named, letter]: [Key; 2]) -> bool {
    key == named || (key == letter && modifiers.command_only())
}

fn on_windows(key: Key, wanted: Key, is_held: bool) -> bool {
    cfg!(target_os = "windows") && is_held && key == wanted
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn one_owner_that_does_not_answer_holds_up_neither_the_window_nor_a_second_thread() {
        let reader = ClipboardReader::default();
        let ((release, held), (sender, answers)) = (channel::<()>(), channel());
        let again = sender.clone();
        let slow = move |_| {
            held.recv().unwrap();
            Pasted::Nothing
        };
        reader.begin(None, slow, move |pasted| sender.send(pasted).unwrap());
        // A second request while the first is waiting is ignored.
        reader.begin(
            None,
            |_| Pasted::Text("late".into()),
            move |pasted| {
                again.send(pasted).unwrap();
            },
        );
        release.send(()).unwrap();
        assert!(matches!(answers.recv().unwrap(), Pasted::Nothing));
        assert!(answers.recv().is_err(), "only one was read");
    }

    #[test]
    fn the_keys_of_the_clipboard_become_its_events() {
        let key = |key, modifiers| Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        };
        let mut events = vec![
            key(Key::X, Modifiers::COMMAND),
            key(Key::C, Modifiers::COMMAND),
            key(Key::V, Modifiers::NONE),
        ];
        assert!(!take_keys(&mut events));
        assert_eq!(events, [Event::Cut, Event::Copy, key(Key::V, Modifiers::NONE)]);
        events.push(key(Key::V, Modifiers::COMMAND));
        assert!(take_keys(&mut events));
        assert_eq!(events.len(), 3);
    }
}
