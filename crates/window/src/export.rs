//! Exports in the background: a view as a picture or as numbers at any size, computed by an engine
//! of its own with the same loop and files as `flipmap render`; and films (`film_run.rs`).

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::film_run::{FilmRequest, FilmRunError, film};
use flipmap_engine::Cells;
use flipmap_engine::choice::{EngineRequest, choose};
use flipmap_engine::run_settings::RunSpec;
use flipmap_render::Watch;
use flipmap_render::output::{Paths, PictureRecipe, RenderError, is_one_file, sentence};
use flipmap_render::tiles::Renderer;
use flipmap_scene::{Document, DocumentError, RunTable};

/// The content of an exported file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExportKind {
    /// A picture.
    #[default]
    Png,
    /// Flip times as a NumPy array.
    Raw,
}

/// A request to export a view to a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportRequest {
    /// Scene to export, and how it is painted.
    pub document: Document,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Path of the file.
    pub path: PathBuf,
    /// Content of the file.
    pub kind: ExportKind,
}

/// The progress of an export.
#[derive(Clone, Debug, PartialEq)]
pub enum ExportStage {
    /// The engine is being started; holds its message.
    Starting(String),
    /// The export is running.
    Running {
        /// Share of the work that is done.
        share: f64,
        /// The speed of the work or the time that it still takes, in words.
        pace: String,
    },
    /// The file is complete.
    Done {
        /// Duration of the export in s.
        secs: f64,
    },
    /// The export was cancelled; there is no file.
    Cancelled {
        /// True if the computed part is kept, so that the same export can continue from it.
        resumes: bool,
    },
    /// The export failed; holds the reason as a sentence. There is no file.
    Failed(String),
}

/// An export, running or finished.
#[derive(Debug)]
pub struct Export {
    path: PathBuf,
    is_film: bool,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    stage: Mutex<ExportStage>,
    cancelled: AtomicBool,
}

impl Shared {
    fn stage(&self) -> MutexGuard<'_, ExportStage> {
        // A stage is replaced as a whole, so a thread that panicked left a valid one.
        self.stage.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

impl Export {
    /// Starts an export; calls `wake` whenever its stage has changed.
    pub fn start(
        request: ExportRequest,
        engine_request: EngineRequest,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        Export::spawn(request.path.clone(), wake, move |set, stopped| {
            run(&request, &engine_request, set, stopped)
        })
    }

    /// Starts a film; calls `wake` whenever its stage has changed.
    pub(crate) fn start_film(
        request: FilmRequest,
        engine_request: EngineRequest,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        let mut export = Export::spawn(request.path.clone(), wake, move |set, stopped| {
            Ok(film(&request, &engine_request, set, stopped)?)
        });
        export.is_film = true;
        export
    }

    /// Runs the work of an export on a thread. It gets a function to call with each stage and one
    /// that returns true once it should stop.
    fn spawn(
        path: PathBuf,
        wake: impl Fn() + Send + Sync + 'static,
        work: impl FnOnce(&Reporter, &Stopped) -> Result<(), Failure> + Send + 'static,
    ) -> Self {
        let stage = Mutex::new(ExportStage::Starting("starting an engine".to_string()));
        let shared = Arc::new(Shared { stage, cancelled: AtomicBool::new(false) });
        let reporter = Arc::clone(&shared);
        let thread = std::thread::spawn(move || {
            let set = |stage| {
                *reporter.stage() = stage;
                wake();
            };
            let begun = Instant::now();
            let stopped = || reporter.cancelled.load(Ordering::Relaxed);
            set(match work(&set, &stopped) {
                Ok(()) => ExportStage::Done { secs: begun.elapsed().as_secs_f64() },
                Err(Failure::Render(RenderError::Stopped)) => {
                    ExportStage::Cancelled { resumes: false }
                }
                Err(Failure::Film(FilmRunError::Stopped)) => {
                    ExportStage::Cancelled { resumes: true }
                }
                Err(failure) => ExportStage::Failed(sentence(&failure)),
            });
        });
        Export { path, is_film: false, shared, thread: Some(thread) }
    }

    /// Returns the path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns true if the export is a film.
    pub(crate) fn is_film(&self) -> bool {
        self.is_film
    }

    /// Returns the current stage.
    pub(crate) fn stage(&self) -> ExportStage {
        self.shared.stage().clone()
    }

    /// Returns true if the export has not ended and `path` leads to its file.
    pub(crate) fn will_write(&self, path: &Path) -> bool {
        self.is_unfinished() && is_one_file(&self.path, path)
    }

    /// Returns true if the export has not ended.
    pub(crate) fn is_unfinished(&self) -> bool {
        matches!(self.stage(), ExportStage::Starting(_) | ExportStage::Running { .. })
    }

    /// Asks the export to stop, which takes a moment.
    pub(crate) fn cancel(&self) {
        self.shared.cancelled.store(true, Ordering::Relaxed);
    }

    /// Waits until the export has ended and returns its last stage.
    pub fn wait(mut self) -> ExportStage {
        self.join();
        self.stage()
    }

    fn join(&mut self) {
        if self.thread.take().is_some_and(|thread| thread.join().is_err()) {
            let lost = "the export ended unexpectedly; see the log, and try again";
            *self.shared.stage() = ExportStage::Failed(lost.to_string());
        }
    }
}

/// Cancels an unfinished export and waits for its thread, so that it leaves nothing behind.
impl Drop for Export {
    fn drop(&mut self) {
        self.cancel();
        self.join();
    }
}

/// The reason why there is no file.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Scene(#[from] DocumentError),
    #[error(transparent)]
    Words(#[from] flipmap_scene::SceneError),
    #[error(transparent)]
    Choice(#[from] flipmap_engine::choice::ChoiceError),
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error(transparent)]
    Film(#[from] FilmRunError),
}

impl From<flipmap_engine::EngineError> for Failure {
    fn from(error: flipmap_engine::EngineError) -> Self {
        Failure::Render(error.into())
    }
}

/// A function to call with each stage of an export.
type Reporter<'a> = dyn Fn(ExportStage) + Sync + 'a;
/// A function that returns true once an export should stop.
type Stopped<'a> = dyn Fn() -> bool + Sync + 'a;

/// Time between two reports of progress.
const TICK: Duration = Duration::from_millis(100);

fn run(
    request: &ExportRequest,
    engine_request: &EngineRequest,
    set: &Reporter,
    stopped: &Stopped,
) -> Result<(), Failure> {
    let words = RunTable { size: Some(request.size), ..request.document.run.clone() };
    let RunSpec { setting, verify, table } = RunSpec::resolve(words)?;
    let engine_request = EngineRequest { setting, verify, ..engine_request.clone() }
        .answering(&request.document.question);
    let mut document = Document { run: table, ..request.document.clone() };
    document.check()?;
    document.view = document.view.fitted(request.size.map(f64::from));
    document.picture.samples = document.picture.samples_of(request.size);
    let (document, paths) = (document.settled(), request.paths());
    let recipe = PictureRecipe {
        document: &document,
        size: request.size,
        cells: Cells::Auto,
        paths: &paths,
    };
    recipe.check()?;
    let starting = |text: &str| set(ExportStage::Starting(text.to_string()));
    let mut renderer = Renderer::try_from(choose(&engine_request, &starting)?)?;
    recipe.render(&mut renderer, &mut None, &InWindow::new(set, stopped))?;
    Ok(())
}

/// The watch over an export, which reports progress every [`TICK`] and can stop it.
struct InWindow<'a> {
    begun: Instant,
    told: Mutex<Option<Instant>>,
    set: &'a Reporter<'a>,
    stopped: &'a Stopped<'a>,
}

impl<'a> InWindow<'a> {
    fn new(set: &'a Reporter<'a>, stopped: &'a Stopped<'a>) -> Self {
        InWindow { begun: Instant::now(), told: Mutex::default(), set, stopped }
    }
}

impl Watch for InWindow<'_> {
    fn keep_going(&self, done: u64, total: u64) -> bool {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.is_none_or(|told| told.elapsed() >= TICK) {
            *told = Some(Instant::now());
            let done = done as f64;
            let pixels_per_sec = done / self.begun.elapsed().as_secs_f64().max(1e-3);
            let pace = format!("{} pixels/s", thousands(pixels_per_sec));
            (self.set)(ExportStage::Running { share: done / total as f64, pace });
        }
        !(self.stopped)()
    }
}

impl ExportRequest {
    fn paths(&self) -> Paths {
        // Here `-` is a file of that name; on the command line it would mean standard output.
        let path = if self.path.as_os_str() == "-" { Path::new("./-") } else { &self.path };
        let path = Some(path.to_path_buf());
        match self.kind {
            ExportKind::Png => Paths { picture: path, ..Paths::default() },
            ExportKind::Raw => Paths { raw: path, ..Paths::default() },
        }
    }
}

/// Formats a count with non-breaking spaces between its thousands.
pub(super) fn thousands(count: f64) -> String {
    let digits = format!("{count:.0}");
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| str::from_utf8(group).ok()).collect();
    groups.join("\u{a0}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::EngineKind;
    use flipmap_scene::{BuiltIn, location};

    fn request(path: PathBuf) -> ExportRequest {
        let mut document = BuiltIn::named("filigree").unwrap().document();
        document.run.accuracy = Some("fast".to_string());
        ExportRequest { document, size: [48, 32], path, kind: ExportKind::Png }
    }

    fn fast() -> EngineRequest {
        EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() }
    }

    #[test]
    fn stages_lead_from_the_start_to_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        let (sender, woken) = std::sync::mpsc::channel();
        let export = Export::start(request(path.clone()), fast(), move || {
            let _ = sender.send(());
        });
        woken.recv().unwrap();
        assert!(matches!(export.wait(), ExportStage::Done { .. }));
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let picture = flipmap_render::output::picture_in_png(file, 99).unwrap();
        assert_eq!(picture.size, [48, 32]);
        assert_eq!(picture.document.run.accuracy.as_deref(), Some("fast"));
        assert!(picture.rgb.chunks(3).any(|rgb| rgb != &picture.rgb[..3]));
    }

    #[test]
    fn raw_exports_hold_every_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.npy");
        let request = ExportRequest { kind: ExportKind::Raw, ..request(path.clone()) };
        assert!(matches!(Export::start(request, fast(), || ()).wait(), ExportStage::Done { .. }));
        assert_eq!(std::fs::read(path).unwrap().len(), 128 + 8 * 48 * 32);
    }

    #[test]
    fn what_fails_says_why_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let nowhere = folder.path().join("none/map.png");
        let path = folder.path().join("map.png");
        std::fs::write(&path, "mine").unwrap();
        let mut bad = request(path.clone());
        bad.document.picture.cycles = 0.0;
        let mut large = request(path.clone());
        large.size = [2_000_000, 10];
        let mut narrow = request(path.clone());
        let counts = "flipmap:center=3,4;width=1e-30;budget=0.1;plane=speeds;ask=flips";
        narrow.document = narrow.document.with_scene(location::parse(counts).unwrap());
        for (request, words) in [
            (request(nowhere), "none does not exist"),
            (request("/dev/full".into()), "cannot write /dev/full"),
            (bad, "`cycles` is 0"),
            (large, "2000000"),
            (narrow, "`width` is too small for this plane or question"),
        ] {
            let stage = Export::start(request, fast(), || ()).wait();
            assert!(matches!(&stage, ExportStage::Failed(why) if why.contains(words)), "{stage:?}");
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_cancelled_export_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut request = request(folder.path().join("map.png"));
        request.size = [8000, 8000];
        let export = Export::start(request.clone(), fast(), || ());
        let under_another_name = folder.path().join("./map.png");
        assert!(export.will_write(&under_another_name) && !export.will_write(folder.path()));
        export.cancel();
        while export.will_write(&under_another_name) {
            std::thread::yield_now();
        }
        assert_eq!(export.wait(), ExportStage::Cancelled { resumes: false });
        drop(Export::start(request, fast(), || ()));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_window_writes_files_and_never_to_standard_output() {
        assert_eq!(request("-".into()).paths().picture, Some(PathBuf::from("./-")));
        assert_eq!(request("a.png".into()).paths().picture, Some(PathBuf::from("a.png")));
    }

    #[test]
    fn thousands_are_apart() {
        assert_eq!(thousands(1234567.4), "1\u{a0}234\u{a0}567");
        assert_eq!(thousands(12.0), "12");
    }
}
