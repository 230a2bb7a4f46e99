//! The display that a window opens on: its scale, its depth, and what its environment says of it.

use std::ffi::{OsStr, OsString};
use std::ops::RangeInclusive;
use std::path::PathBuf;

use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowAttributes};

/// Variable with which the user sets the scale of X11 displays.
pub const SCALE_VARIABLE: &str = "WINIT_X11_SCALE_FACTOR";
/// The value of [`SCALE_VARIABLE`] that derives the scale from the size of the screen.
const SCALE_BY_SIZE: &str = "randr";
/// Scales at which the window can be laid out: physical pixels per logical one.
const SCALES: RangeInclusive<f64> = 0.25..=8.0;
/// Largest side of a window in pixels, which every graphics adapter can draw.
const MAX_SIDE: f64 = 8192.0;
/// Width and height of a new window in logical pixels.
const SIZE: [f64; 2] = [1280.0, 800.0];
/// Least width and height of a window in logical pixels.
const MIN_SIZE: [f64; 2] = [320.0, 240.0];
/// Depths in bits of the displays that graphics drivers draw on.
const USUAL_DEPTHS: [u16; 2] = [24, 32];

/// A scale of the display at which the window cannot be laid out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the display's scale is {0}; it must be from 0.25 to 8 (on X11, Xft.dpi from 24 to 768)")]
pub struct UnusableScale(f64);

/// The screens of a display, as far as a new window depends on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Screens {
    /// Largest scale of a screen.
    scale: f64,
    /// Depth in bits, if drivers do not draw in it.
    pub odd_depth: Option<u16>,
}

impl Screens {
    /// Returns the screens of the display, unless one has an unusable scale.
    pub(crate) fn of(event_loop: &ActiveEventLoop) -> Result<Self, UnusableScale> {
        let mut screens = Screens { scale: 1.0, odd_depth: None };
        for screen in event_loop.available_monitors() {
            screens.scale = screens.scale.max(usable(screen.scale_factor())?);
            let depth = screen.video_modes().next().map(|mode| mode.bit_depth());
            screens.odd_depth = depth.filter(|bits| !USUAL_DEPTHS.contains(bits));
        }
        Ok(screens)
    }

    /// Returns how the window is to be opened.
    pub(crate) fn attributes(&self) -> WindowAttributes {
        let most = MAX_SIDE / self.scale;
        let size = |[width, height]: [f64; 2]| LogicalSize::new(width.min(most), height.min(most));
        Window::default_attributes()
            .with_title("flipmap")
            // Screen readers must know of the window before it is shown.
            .with_visible(false)
            .with_inner_size(size(SIZE))
            .with_min_inner_size(size(MIN_SIZE))
    }
}

fn usable(scale: f64) -> Result<f64, UnusableScale> {
    if SCALES.contains(&scale) { Ok(scale) } else { Err(UnusableScale(scale)) }
}

/// A variable of the environment with which no window could be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadVariable {
    /// Name of the variable.
    pub name: &'static str,
    /// Sentence that says what is wrong and what follows, without its full stop.
    pub why: String,
}

/// Returns the variables that must be removed before a window is opened. `value_of` reads one.
pub fn bad_variables(value_of: impl Fn(&str) -> Option<OsString>) -> Vec<BadVariable> {
    let set = |name: &str| value_of(name).filter(|value| !value.is_empty());
    let scale = set(SCALE_VARIABLE).filter(|value| !is_scale(value)).map(|value| {
        let value = value.to_string_lossy();
        let why = format!(
            "{SCALE_VARIABLE} is '{value}'; it must be {SCALE_BY_SIZE} or a number from 0.25 to 8, \
             so it is ignored"
        );
        BadVariable { name: SCALE_VARIABLE, why }
    });
    let compositor = set("WAYLAND_DISPLAY").filter(|name| {
        // Without X11 there is nothing to open instead.
        set("DISPLAY").is_some() && !answers(name, set("XDG_RUNTIME_DIR"))
    });
    let compositor = compositor.map(|value| {
        let value = value.to_string_lossy();
        let why = format!("no compositor answers at WAYLAND_DISPLAY={value}, so X11 is used");
        BadVariable { name: "WAYLAND_DISPLAY", why }
    });
    scale.into_iter().chain(compositor).collect()
}

fn is_scale(value: &OsStr) -> bool {
    let Some(text) = value.to_str() else { return false };
    text.eq_ignore_ascii_case(SCALE_BY_SIZE)
        || text.parse().is_ok_and(|scale| SCALES.contains(&scale))
}

/// Returns true if something listens at the socket of a Wayland display.
#[cfg(unix)]
fn answers(name: &OsStr, runtime_folder: Option<OsString>) -> bool {
    // An absolute name replaces the folder.
    let socket = PathBuf::from(runtime_folder.unwrap_or_default()).join(name);
    std::os::unix::net::UnixStream::connect(socket).is_ok()
}

#[cfg(not(unix))]
fn answers(_: &OsStr, _: Option<OsString>) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the names of the bad variables in an environment.
    fn bad(environment: &[(&str, &str)]) -> Vec<&'static str> {
        let value_of = |name: &str| {
            let found = environment.iter().find(|(other, _)| *other == name);
            found.map(|(_, value)| OsString::from(value))
        };
        bad_variables(value_of).into_iter().map(|bad| bad.name).collect()
    }

    #[test]
    fn scales_that_no_window_can_have_are_removed() {
        for good in ["", "1", "2.5", "randr", "RANDR", "8", "0.25"] {
            assert_eq!(bad(&[(SCALE_VARIABLE, good)]), [""; 0], "{good}");
        }
        for wrong in ["0", "-1", "NaN", "inf", "1e9", "1e-9", "abc", " "] {
            assert_eq!(bad(&[(SCALE_VARIABLE, wrong)]), [SCALE_VARIABLE], "{wrong}");
        }
        let told = bad_variables(|name| (name == SCALE_VARIABLE).then(|| "two".into()));
        assert!(told[0].why.contains("'two'") && told[0].why.contains("from 0.25 to 8"));
    }

    #[test]
    fn every_scale_gives_a_window_that_can_be_drawn_or_a_reason() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(usable(scale).is_err(), "{scale}");
        }
        for scale in [0.25, 1.0, 8.0] {
            let shape = Screens { scale: usable(scale).unwrap(), odd_depth: None }.attributes();
            let size = shape.inner_size.unwrap().to_physical::<f64>(scale);
            assert!(size.width <= MAX_SIDE && size.height <= MAX_SIDE, "{size:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_compositor_that_is_not_there_gives_way_to_x11() {
        let folder = tempfile::tempdir().unwrap();
        let folder_name = folder.path().to_str().unwrap();
        let socket = folder.path().join("wayland-7");
        let beside = |others: &[(&'static str, &'static str)]| {
            let mut all = vec![("XDG_RUNTIME_DIR", folder_name), ("WAYLAND_DISPLAY", "wayland-7")];
            all.extend(others);
            bad(&all)
        };
        assert_eq!(beside(&[("DISPLAY", ":0")]), ["WAYLAND_DISPLAY"]);
        assert_eq!(beside(&[]), [""; 0], "there is no X11 either");
        let listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert_eq!(beside(&[("DISPLAY", ":0")]), [""; 0]);
        drop(listener);
        assert_eq!(beside(&[("DISPLAY", ":0")]), ["WAYLAND_DISPLAY"], "nobody listens any more");
    }
}
