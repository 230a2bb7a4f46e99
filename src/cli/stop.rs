//! Requests to stop: Ctrl-C, SIGTERM and a terminal that closes. Work stops at the next slice,
//! unfinished files are removed, windows close.
//!
//! Commands listen as soon as there is something to stop or to remove. Until then, while engines
//! are measured and films are planned, a signal ends the program at once. A signal that was ignored
//! when the program began, as by `nohup` or for a script's jobs in the background, stays ignored.

use std::sync::atomic::{AtomicBool, Ordering};

use flipmap_render::output::stop_writing_when;

static STOP: AtomicBool = AtomicBool::new(false);

/// Installs a handler that remembers signals instead of letting them end the program.
pub(super) fn listen() -> anyhow::Result<()> {
    listen_and(|| ())
}

/// Installs the same handler, which also calls `wake` so that a sleeping thread notices.
pub(super) fn listen_and(wake: impl Fn() + Send + 'static) -> anyhow::Result<()> {
    stop_writing_when(asked);
    hear(move || {
        STOP.store(true, Ordering::Relaxed);
        wake();
    })
}

/// Returns true if the user has asked to stop.
pub(super) fn asked() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Calls `asked` for every signal that asks to stop, unless it was ignored from the beginning.
#[cfg(unix)]
fn hear(asked: impl Fn() + Send + 'static) -> anyhow::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

    let ignored = ignored();
    let heard = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !is_in(ignored, *signal));
    let mut signals = signal_hook::iterator::Signals::new(heard)?;
    std::thread::Builder::new()
        .name("signals".to_string())
        .spawn(move || signals.forever().for_each(|_| asked()))?;
    Ok(())
}

#[cfg(not(unix))]
fn hear(asked: impl Fn() + Send + 'static) -> anyhow::Result<()> {
    Ok(ctrlc::set_handler(asked)?)
}

/// Makes a file that grows over the limit of `ulimit -f` an error of that file, where the system
/// would end the program.
#[cfg(unix)]
pub(crate) fn outlive_full_files() {
    use std::sync::Arc;
    // Nothing is done but to hear the signal. A failure leaves what the system does.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(false.into()));
}

/// Returns the set of signals that this process ignores, a bit for each; only Linux tells.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    ignored_in(&status).unwrap_or(0)
}

/// Reads the set of ignored signals from the status of a process (proc_pid_status(5)).
#[cfg(unix)]
fn ignored_in(status: &str) -> Option<u64> {
    let set = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(set.trim(), 16).ok()
}

#[cfg(unix)]
fn is_in(set: u64, signal: i32) -> bool {
    set >> (signal - 1) & 1 == 1
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn ignored_signals_are_known_by_their_bits() {
        let set = ignored_in("Name:\tflipmap\nSigIgn:\t0000000000001003\nSigCgt:\t0\n").unwrap();
        let found: Vec<i32> = (1..=64).filter(|signal| is_in(set, *signal)).collect();
        assert_eq!(found, [1, 2, 13], "HUP, INT and PIPE");
        assert_eq!(ignored_in("SigCgt:\t0\n"), None);
    }
}
