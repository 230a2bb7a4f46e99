//! Random input for an arbitrarily long time: whatever a user does to the window, it keeps running,
//! stays within its limit of memory, keeps no handle or thread that it does not need, and logs no
//! unexpected warnings.
//!
//! `FLIPMAP_SOAK_SECS` sets the duration (default 30), `FLIPMAP_SOAK_SEED` the seed (default 1).

use std::thread::sleep;
use std::time::{Duration, Instant};

use flipmap_window::settings::Settings;

use super::display::{Display, LEFT};
use super::session::{Session, WINDOW, keep_settings};
use super::vitals::Watch;

/// Memory that the process may use in addition to its tile cache, MiB, as measured over ten
/// minutes: about 100 for the map's tiles on the card, which a software driver keeps in main
/// memory; 100 for the code of the driver and the program; 200 for data of driver, interface and
/// deep views; and up to 150 that the allocator keeps free in its two heaps. After a lost device, the
/// new one has its tiles before those of the lost one are freed.
const BESIDE_MIB: f64 = 600.0;
/// The same after minutes, in MiB. What the program itself holds does not grow (334 MiB, 245 of them
/// software Vulkan's, after 150 s by heaptrack), but the system's allocator keeps several times as
/// much of what software Vulkan has freed: at most 1.65 GiB in 20 minutes, with eleven lost devices.
const BESIDE_LATER_MIB: f64 = 2000.0;
/// Duration in s up to which the first bound holds.
const SHORT_SECS: u64 = 60;

/// Keys that neither quit the program nor select from a list by accident.
const KEYS: [&str; 24] = [
    "Left",
    "Right",
    "Up",
    "Down",
    "plus",
    "minus",
    "0",
    "BackSpace",
    "alt+Left",
    "alt+Right",
    "c",
    "t",
    "g",
    "b",
    "p",
    "space",
    "F1",
    "F9",
    "F12",
    "Escape",
    "ctrl+l",
    "ctrl+v",
    "Tab",
    "shift+Tab",
];

/// Commands to run by name.
const COMMANDS: [&str; 6] = ["whole", "zoom in", "borders", "light", "dark", "smooth moves"];

/// Time between simulated losses of the graphics device, which happen only while the window's statistics
/// are shown: the window gives up after five within a minute.
const LOSE_EVERY: Duration = Duration::from_secs(15);

/// Expected warnings: the machine has no real screen, clipboard manager or file dialogs, the device
/// is lost on purpose, and the random user pins too many pixels and tries to descend in questions
/// and planes without descents.
const EXPECTED: [&str; 9] = [
    "winit::platform_impl",
    "clipboard manager",
    "rfd::backend",
    "Software rasterizer",
    "device is gone",
    "pins are in use",
    "has no file dialog",
    "Nothing leads deeper here: `ask` is",
    "Nothing leads deeper here: `plane` is",
];

/// SplitMix64 generator: the same actions for the same seed.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a random number below `count`.
    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn one_of<'a>(&mut self, all: &[&'a str]) -> &'a str {
        all[self.below(all.len())]
    }

    fn point(&mut self, [width, height]: [u32; 2]) -> [f64; 2] {
        [width, height].map(|side| self.below(side as usize) as f64)
    }
}

/// Performs one random action; returns the window's size after it.
fn act(session: &Session, chance: &mut Chance, size: [u32; 2]) -> [u32; 2] {
    let display = &session.display;
    let [x, y] = chance.point(size);
    match chance.below(16) {
        0..=4 => {
            display.point(x, y);
            display.wheel_twice([-1, 1, 1, 2][chance.below(4)]);
        }
        5..=7 => display.drag([x, y], chance.point(size)),
        8 | 9 => {
            display.point(x, y);
            display.click(LEFT);
        }
        10 => {
            display.point(x, y);
            display.click(LEFT);
            display.click(LEFT);
        }
        11..=13 => display.key(chance.one_of(&KEYS)),
        14 => command(display, chance.one_of(&COMMANDS)),
        _ => {
            let size = [60 + chance.below(1100) as u32, 60 + chance.below(840) as u32];
            display.resize(session.window, size);
            return size;
        }
    }
    size
}

/// Runs a command by name from the command palette.
fn command(display: &Display, name: &str) {
    display.key("ctrl+k");
    // Text typed before the field is shown would not reach it.
    sleep(Duration::from_millis(250));
    display.type_in(name);
    display.key("Return");
    sleep(Duration::from_millis(50));
    // If nothing was found, the list is still open.
    display.key("Escape");
}

/// A number from an environment variable, or a default.
fn request(name: &str, else_this: u64) -> u64 {
    std::env::var(name).map_or(else_this, |text| text.parse().expect("a whole number"))
}

/// Performs random actions, then checks memory use and warnings.
pub(crate) fn soak() {
    let (secs, seed) = (request("FLIPMAP_SOAK_SECS", 30), request("FLIPMAP_SOAK_SEED", 1));
    let home = tempfile::tempdir().unwrap();
    let kept_mib = *Settings::CACHE_MIB.start();
    keep_settings(home.path(), &format!("cache_mib = {kept_mib}\n"));
    let mut session = Session::open_in(home, "soak", &[]);
    session.display.key("F12");
    let (mut chance, mut size, mut done) = (Chance(seed), WINDOW, 0u32);
    let (begun, mut lose_at) = (Instant::now(), LOSE_EVERY);
    let mut watch = Watch::new(session.id(), Duration::from_secs(secs));
    while begun.elapsed() < Duration::from_secs(secs) {
        size = act(&session, &mut chance, size);
        done += 1;
        if begun.elapsed() >= lose_at {
            lose_at += LOSE_EVERY;
            command(&session.display, "lose the graphics");
        }
        session.check_alive();
        watch.look();
        sleep(Duration::from_millis(chance.below(60) as u64));
    }
    session.shot("end");
    let ended = session.quit();
    let told = ended.told.unwrap();
    let mib = |key| told.number(key) / f64::from(1 << 20);
    println!(
        "seed {seed}: {done} doings in {secs} s, {} frames, {} lost devices, {:.0} pendulums, \
         {:.0} MiB of tiles, at most {:.0} MiB in all",
        told.frames(),
        ended.log.matches("device is gone").count(),
        told.number("simulated"),
        mib("cache_bytes"),
        mib("peak_bytes"),
    );
    watch.check();
    assert!(mib("cache_bytes") <= f64::from(kept_mib), "more tiles than allowed");
    let beside = if secs <= SHORT_SECS { BESIDE_MIB } else { BESIDE_LATER_MIB };
    assert!(mib("peak_bytes") <= f64::from(kept_mib) + beside, "too much memory");
    let unexpected: Vec<&str> = ended
        .log
        .lines()
        .filter(|line| !EXPECTED.iter().any(|known| line.contains(known)))
        .collect();
    assert!(unexpected.is_empty(), "{unexpected:#?}");
}
