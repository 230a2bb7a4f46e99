//! What no window can prevent, told in one sentence: panics of libraries, and displays that go away.

use std::any::Any;
use std::cell::Cell;
use std::io::Write;
use std::panic::PanicHookInfo;
use std::path::Path;

/// Replaces the report of panics, which names paths of the machine that built the program. A panic on
/// the main thread is told by the code that catches it.
pub(crate) fn tell_panics_plainly() {
    std::panic::set_hook(Box::new(|panic| {
        let (words, place) = (words_of(panic.payload()), place_of(panic));
        match std::thread::current().name() {
            Some("main") => log::debug!("panic at {place}: {words}"),
            _ => log::error!("a thread of the window ended unexpectedly at {place}: {words}"),
        }
    }));
}

/// Returns the first line of what a panic says.
pub(crate) fn words_of(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let line = text.and_then(|text| text.lines().next());
    plain(line.unwrap_or("it does not say why"))
}

/// Returns the name of the file in which a panic arose, and the line.
fn place_of(panic: &PanicHookInfo) -> String {
    let Some(location) = panic.location() else { return "an unknown place".to_string() };
    let file = Path::new(location.file()).file_name().unwrap_or_default();
    format!("{}:{}", file.display(), location.line())
}

/// Returns a message of the window system without the place in its source (`os error at FILE:LINE:`)
/// and without its full stop.
pub(crate) fn plain(message: &str) -> String {
    let message = match message.split_once("os error at ") {
        Some((before, after)) => {
            format!("{before}{}", after.split_once(": ").map_or("", |(_, said)| said))
        }
        None => message.to_string(),
    };
    message.trim_end_matches('.').to_string()
}

/// A sentence that is told when the thread ends before it is taken back. Xlib ends a program whose
/// display goes away from inside, with code 1.
struct Farewell(Cell<bool>);

thread_local! {
    static FAREWELL: Farewell = const { Farewell(Cell::new(false)) };
}

impl Drop for Farewell {
    fn drop(&mut self) {
        if self.0.get() {
            // There is nowhere left to report a failure to.
            let _ = writeln!(std::io::stderr(), "flipmap: {GONE}");
        }
    }
}

/// What is told when the display goes away.
pub(crate) const GONE: &str =
    "the display went away; the settings and the keys of the film are kept";

/// Tells [`GONE`] if this thread ends while a window is open.
pub(crate) fn window_is_open(is_open: bool) {
    FAREWELL.with(|farewell| farewell.0.set(is_open));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn what_a_panic_says_names_no_place() {
        let said = |panic: fn()| words_of(catch_unwind(panic).unwrap_err().as_ref());
        assert_eq!(said(|| panic!("broken\nat /root/x.rs")), "broken");
        assert_eq!(said(|| panic!("broken {}", 1)), "broken 1");
        assert_eq!(said(|| std::panic::panic_any(1)), "it does not say why");
        let os = "os error at /root/.cargo/registry/winit/mod.rs:89: no compositor.";
        assert_eq!(plain(os), "no compositor");
        assert_eq!(plain("Nothing is set."), "Nothing is set");
    }
}
