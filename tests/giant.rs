//! Stills that are larger than memory: memory use does not grow with a picture's height.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::sync::Mutex;

use flipmap_engine::mock::MockEngine;
use flipmap_engine::{IntegratorConfig, Method, Precision};
use flipmap_render::output::{Paths, RenderClock, Sinks, render_pass};
use flipmap_render::tiles::{Counts, Work};
use flipmap_scene::{Document, Sampling};

const CONFIG: IntegratorConfig =
    IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
/// Width of a poster in pixels.
const WIDTH: u32 = 60_000;
/// Number of rows of the largest picture of that width whose lower half is the mirror image of its
/// upper half. The mirrored rows are held in memory until they are due.
const MIRRORED_HEIGHT: u32 = 1118;
/// A lock for one measurement at a time, since each measures the whole process.
static MEASURING: Mutex<()> = Mutex::new(());

/// A memory statistic of the process in bytes, if the system provides it.
fn memory(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    Some(line.trim_start_matches(':').trim().trim_end_matches(" kB").parse::<u64>().ok()? << 10)
}

/// Returns the peak growth of memory use during a run in bytes, if the system can reset earlier
/// peaks.
fn growth(run: impl FnOnce()) -> Option<u64> {
    let _alone = MEASURING.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let forgotten = fs::write("/proc/self/clear_refs", "5");
    let before = memory("VmRSS");
    run();
    forgotten.ok()?;
    memory("VmHWM")?.checked_sub(before?)
}

/// Draws the home scene as `flipmap render` does, with an engine that takes no time.
fn render(size: [u32; 2], paths: &Paths) -> Counts {
    let document = Document::default();
    let mut engine = MockEngine { job_size: 1 << 15, ..MockEngine::default() };
    let mut sinks = Sinks::open(paths, &document, size).unwrap();
    let mut counts = Counts::default();
    for pass in sinks.passes(Sampling::SINGLE) {
        let mut work = Work::new(&document.scene(), size, CONFIG, engine.job_size);
        let (clock, keep_going) = (&mut RenderClock::default(), &mut |_: &Counts| true);
        render_pass(&mut work, &mut engine, &mut sinks, &pass, clock, keep_going).unwrap();
        counts += work.counts();
    }
    sinks.finish().unwrap();
    assert_eq!(counts.pixels, u64::from(size[0]) * u64::from(size[1]));
    counts
}

/// Runs a closure and asserts that memory grows by less than `most_mib`.
fn in_little_memory(most_mib: u64, run: impl FnOnce()) {
    let Some(grown) = growth(run) else { return };
    println!("memory grew by {} MiB", grown >> 20);
    assert!(grown >> 20 < most_mib, "memory grew by {} MiB", grown >> 20);
}

/// Decodes the first rows of a PNG file; returns its width and their bytes.
fn first_rows(path: &Path, rows: usize) -> (u32, Vec<u8>) {
    let file = BufReader::new(File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let width = reader.info().width;
    let mut bytes = Vec::new();
    for _ in 0..rows {
        bytes.extend_from_slice(reader.next_row().unwrap().unwrap().data());
    }
    (width, bytes)
}

#[test]
fn all_outputs_of_a_wide_still_fit_in_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| Some(folder.path().join(name));
    let paths = Paths {
        picture: at("map.png"),
        pyramid: at("map"),
        raw: at("map.npy"),
        exr: at("map.exr"),
        trust: at("trust.png"),
    };
    let size = [WIDTH, 300];
    // An output that held all its samples would need as much memory again.
    in_little_memory(256, || assert!(render(size, &paths).simulated > 0));

    let bytes = fs::metadata(paths.raw.unwrap()).unwrap().len();
    assert_eq!(bytes, 128 + 8 * u64::from(size[0]) * u64::from(size[1]));
    let (width, picture) = first_rows(&paths.picture.unwrap(), 100);
    assert_eq!(width, WIDTH);
    let (_, tile) = first_rows(&folder.path().join("map/map_files/16/100_0.png"), 100);
    let (row, left) = (3 * WIDTH as usize, 3 * 100 * 256);
    for (y, pixels) in tile.chunks(3 * 256).enumerate() {
        assert!(pixels == &picture[y * row + left..][..3 * 256], "row {y}");
    }
    let folder_of = |level: u32| folder.path().join(format!("map/map_files/{level}"));
    let tiles = |level| fs::read_dir(folder_of(level)).unwrap().count();
    assert_eq!([tiles(16), tiles(15), tiles(8), tiles(0)], [2 * 235, 118, 1, 1]);
}

#[test]
fn a_mirror_image_that_waits_for_its_turn_fits_too() {
    let folder = tempfile::tempdir().unwrap();
    let paths = Paths { raw: Some(folder.path().join("map.npy")), ..Paths::default() };
    in_little_memory(512, || {
        let counts = render([WIDTH, MIRRORED_HEIGHT], &paths);
        assert!(counts.simulated <= counts.pixels / 2, "it was no mirror image");
    });
}

#[test]
fn the_longest_sides_can_be_begun_and_given_up() {
    // The memory of this test must not count as that of another.
    let _alone = MEASURING.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| Some(folder.path().join(name));
    let paths = Paths {
        picture: at("map.png"),
        pyramid: at("map"),
        raw: at("map.npy"),
        exr: at("map.exr"),
        trust: None,
    };
    let size = [1_000_000, 1_000_000];
    let document = Document::default();
    let mut engine = MockEngine::default();
    let mut sinks = Sinks::open(&paths, &document, size).unwrap();
    let pass = &sinks.passes(Sampling::SINGLE)[0];
    let mut work = Work::new(&document.scene(), size, CONFIG, engine.job_size);
    for _ in 0..2 {
        for row in work.work(&mut engine, None).unwrap() {
            assert_eq!(row.tile.size, [size[0], 1]);
            sinks.write(pass, &row.samples).unwrap();
        }
    }
    drop(sinks);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
#[ignore = "ten minutes and more: cargo test --release --test giant -- --ignored"]
fn a_whole_giant_fits_in_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| Some(folder.path().join(name));
    let paths = Paths { picture: at("map.png"), pyramid: at("map"), ..Paths::default() };
    in_little_memory(1024, || assert!(render([WIDTH, WIDTH], &paths).simulated > 0));
    let tiles = fs::read_dir(folder.path().join("map/map_files/16")).unwrap().count();
    assert_eq!(tiles, 235 * 235);
    println!("the picture has {} MiB", fs::metadata(paths.picture.unwrap()).unwrap().len() >> 20);
}
