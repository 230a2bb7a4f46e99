//! A run of the program in a window on its own display.

use std::cell::RefCell;
use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use flipmap_numbers::{Exact, Scalar};
use flipmap_scene::{Scene, location};
use image::RgbImage;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tempfile::TempDir;

use super::display::{Display, SCREEN, wait_for};

/// A lock that runs windows one after another: two at once would slow down each other's engines.
static ALONE: Mutex<()> = Mutex::new(());

/// Waits until no other window is open.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Width and height of the window in pixels.
pub(crate) const WINDOW: [u32; 2] = [900, 640];

/// A running program with an open window.
pub(crate) struct Session {
    /// The display that the window is on.
    pub display: Display,
    /// X identifier of the window.
    pub window: u32,
    name: &'static str,
    shots: u32,
    child: RefCell<Child>,
    /// Home folder of the run; `None` after its end.
    folder: Option<TempDir>,
    _alone: MutexGuard<'static, ()>,
}

/// The statistics that the window wrote last.
#[derive(Debug)]
pub(crate) struct Told(Value);

impl Told {
    /// A number of the statistics.
    pub(crate) fn number(&self, key: &str) -> f64 {
        self.0[key].as_f64().unwrap_or_else(|| panic!("{key} of {}", self.0))
    }

    /// A truth value of the statistics.
    pub(crate) fn is(&self, key: &str) -> bool {
        self.0[key].as_bool().unwrap_or_else(|| panic!("{key} of {}", self.0))
    }

    /// A text of the statistics.
    pub(crate) fn text(&self, key: &str) -> &str {
        self.0[key].as_str().unwrap_or_else(|| panic!("{key} of {}", self.0))
    }

    /// An array of numbers of the statistics.
    pub(crate) fn numbers(&self, key: &str) -> Vec<f64> {
        serde_json::from_value(self.0[key].clone()).unwrap()
    }

    /// The scene that the window shows.
    pub(crate) fn scene(&self) -> Scene {
        location::parse(self.0["location"].as_str().unwrap()).unwrap()
    }

    /// Width of the view, rad.
    pub(crate) fn width_rad(&self) -> f64 {
        self.scene().view.width_rad().hi
    }

    /// Centre of the view, rad.
    pub(crate) fn center_rad(&self) -> [Exact; 2] {
        self.scene().view.center_rad()
    }

    /// Width and height of the map in pixels.
    pub(crate) fn map_px(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.0["map_px"][axis].as_f64().unwrap())
    }

    /// Starts of the pinned pixels.
    pub(crate) fn pins(&self) -> Vec<[f64; 2]> {
        serde_json::from_value(self.0["pins"].clone()).unwrap()
    }

    /// Messages that are shown.
    pub(crate) fn notices(&self) -> Vec<String> {
        serde_json::from_value(self.0["notices"].clone()).unwrap()
    }

    /// Returns true if nothing is left to compute, in the view or around it.
    pub(crate) fn is_idle(&self) -> bool {
        self.0["idle"] == true
    }

    /// Number of frames drawn so far.
    pub(crate) fn frames(&self) -> u64 {
        self.0["frame_ms"]["count"].as_u64().unwrap()
    }

    /// The start under a point of the window.
    pub(crate) fn angle_at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.map_px();
        let pixel_rad = self.width_rad() / width;
        let center = self.center_rad().map(Exact::to_f64);
        [center[0] + (x - width / 2.0) * pixel_rad, center[1] - (y - height / 2.0) * pixel_rad]
    }
}

/// Prevents the greeting of the first start, the magnet of the wheel, and finer samples at edges from being
/// computed. Settings that exist already are kept.
fn greet(home: &Path) {
    if !settings_in(home).exists() {
        keep_settings(home, "greeted = true\nedges = \"1\"\nmagnet = false\n");
    }
}

fn settings_in(home: &Path) -> PathBuf {
    home.join(".config/flipmap/settings.toml")
}

/// Writes the settings that a window in a home folder opens with.
pub(crate) fn keep_settings(home: &Path, text: &str) {
    let settings = settings_in(home);
    fs::create_dir_all(settings.parent().unwrap()).unwrap();
    fs::write(settings, text).unwrap();
}

impl Session {
    /// Opens the window in its own home folder and waits until its map is complete.
    pub(crate) fn open(name: &'static str, arguments: &[&str]) -> Self {
        Self::open_in(tempfile::tempdir().unwrap(), name, arguments)
    }

    /// Opens the window in the home folder of an earlier run and waits until its map is complete.
    pub(crate) fn open_in(folder: TempDir, name: &'static str, arguments: &[&str]) -> Self {
        let alone = alone();
        let display = Display::open();
        if !arguments.contains(&"--no-config") {
            greet(folder.path());
        }
        // The statistics of an earlier run must not be taken for those of this one.
        let _ = fs::remove_file(folder.path().join("stats.json"));
        let child = Command::new(env!("CARGO_BIN_EXE_flipmap"))
            .args(["explore", "--engine", "cpu", "--accuracy", "fast", "--stats"])
            .arg(folder.path().join("stats.json"))
            .args(arguments)
            .current_dir(folder.path())
            .env("DISPLAY", &display.name)
            .env("HOME", folder.path())
            .env("XDG_RUNTIME_DIR", folder.path())
            .env_remove("XDG_CONFIG_HOME")
            .env_remove("XDG_DATA_HOME")
            .env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"))
            .env("RUST_LOG", "warn,wgpu_hal=off")
            .env_remove("WAYLAND_DISPLAY")
            .stderr(File::create(folder.path().join("log")).unwrap())
            .spawn()
            .unwrap();
        let window = wait_for("the window", 30, || display.window("flipmap"));
        // A quarter of the work of the default size.
        display.resize(window, WINDOW);
        display.focus(window);
        // Moves the pointer out of the area that is compared.
        display.point(f64::from(SCREEN[0]), f64::from(SCREEN[1]));
        let (folder, child) = (Some(folder), RefCell::new(child));
        let session = Session { display, window, name, shots: 0, child, folder, _alone: alone };
        session.rest("the first map", |told| told.map_px()[1] < f64::from(WINDOW[1]));
        session
    }

    /// The statistics that the window wrote when it last came to rest.
    pub(crate) fn told(&self) -> Option<Told> {
        let text = fs::read(self.path("stats.json")).ok()?;
        Some(Told(serde_json::from_slice(&text).expect("the file is whole")))
    }

    /// Waits until the window is at rest with a complete map and a condition holds.
    pub(crate) fn rest(&self, what: &str, holds: impl Fn(&Told) -> bool) -> Told {
        let holds = |told: &Told| {
            told.number("tiles") > 0.0
                && told.number("tiles_done") == told.number("tiles")
                && holds(told)
        };
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(150) {
            if let Some(told) = self.told().filter(holds) {
                return told;
            }
            self.check_alive();
            sleep(Duration::from_millis(20));
        }
        panic!(
            "no {what} in two minutes and a half; it last told {:?} and said {}",
            self.told(),
            self.log()
        )
    }

    /// Panics if the program has ended by itself.
    pub(crate) fn check_alive(&self) {
        let ended = self.child.borrow_mut().try_wait().unwrap();
        assert!(ended.is_none(), "the window is gone ({ended:?}): {}", self.log());
    }

    /// Performs an action and waits until the window is at rest after it and a condition holds.
    pub(crate) fn after(
        &self,
        what: &str,
        act: impl FnOnce(&Display),
        holds: impl Fn(&Told) -> bool,
    ) -> Told {
        let frames = self.told().map_or(0, |told| told.frames());
        act(&self.display);
        self.rest(what, |told| told.frames() > frames && holds(told))
    }

    /// Takes a screenshot and keeps it for inspection under `target/window-shots`.
    pub(crate) fn shot(&mut self, what: &str) -> RgbImage {
        let image = self.display.shot();
        self.shots += 1;
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("window-shots");
        fs::create_dir_all(&folder).unwrap();
        let name = format!("{}-{}-{what}.png", self.name, self.shots);
        image.save(folder.join(name)).unwrap();
        image
    }

    /// The output of the program so far.
    pub(crate) fn log(&self) -> String {
        fs::read_to_string(self.path("log")).unwrap()
    }

    /// Process id of the program.
    pub(crate) fn id(&self) -> u32 {
        self.child.borrow().id()
    }

    /// Seconds of processor time used so far.
    pub(crate) fn processor_secs(&self) -> f64 {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
        // User and system time, in hundredths of a second on every common Linux system.
        let ticks = |place: usize| fields[place].parse::<f64>().unwrap();
        (ticks(11) + ticks(12)) / 100.0
    }

    /// Sends the program a signal.
    pub(crate) fn signal(&self, signal: Signal) {
        let id = Pid::from_raw(self.id() as i32).unwrap();
        kill_process(id, signal).unwrap();
    }

    /// Waits until the program has ended by itself; returns its exit code, output and statistics.
    pub(crate) fn ended(mut self) -> Ended {
        let status = wait_for("the end", 30, || self.child.borrow_mut().try_wait().unwrap());
        let told = self.told();
        let log = self.log();
        assert_eq!(status.signal(), None, "killed; it had said {log}");
        Ended { code: status.code(), log, told, folder: self.folder.take().unwrap() }
    }

    /// Quits with the keyboard, and panics if anything went wrong.
    pub(crate) fn quit(self) -> Ended {
        self.display.key("ctrl+q");
        let ended = self.ended();
        assert_eq!(ended.code, Some(0), "{}", ended.log);
        ended
    }

    /// Path of a file of this session.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.as_ref().expect("it is there until the end").path().join(name)
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let child = self.child.get_mut();
        if child.try_wait().is_ok_and(|status| status.is_none()) {
            // An error means that the program has ended meanwhile, which is fine.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The result of a finished run.
pub(crate) struct Ended {
    /// Exit code of the program.
    pub code: Option<i32>,
    /// Output of the program.
    pub log: String,
    /// Statistics written at the end.
    pub told: Option<Told>,
    /// Home folder of the run.
    pub folder: TempDir,
}
