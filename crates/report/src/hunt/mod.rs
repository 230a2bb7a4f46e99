//! A hunt for wrong pixels: random scenes rendered with every pixel checked, and the pixels not marked as
//! uncertain compared with a referee that shares nothing with the engines but the right-hand side.
//!
//! [`scenes`] draws what is asked, [`how`] the engine, configuration and cells by which it is computed;
//! [`start`] places the pixels, [`referee`] follows them, and [`answers`] reads and judges.

mod answers;
mod how;
mod referee;
mod scenes;
mod start;

use std::path::Path;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;

use self::answers::{Answer, Judged, RefereeVerdict};
use self::how::{How, Renderers};
use self::scenes::Scenes;
use super::{ReportError, StopTest};
use flipmap_engine::choice::{Chosen, EngineRequest, choose};
use flipmap_engine::plain_file::read_text;
use flipmap_engine::{Engine, EngineError, IntegratorConfig, Trust};
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::Status;
use flipmap_render::tiles::preview::preview;
use flipmap_render::tiles::{Samples, Work, check_feasible};
use flipmap_scene::question::Needs;
use flipmap_scene::question::{MAX_CHANNELS, QuestionName};
use flipmap_scene::{PlaneKind, Scene, Setting, View};

/// Pixels along each side of a window.
const SIDE: u32 = 32;
/// Number of pixels that are judged of a deep window, or of one of growth, where each takes a long solution
/// of its own; and of those that a window marks.
const SAMPLE: usize = 16;

/// Time limit for rendering a window; a slower one is skipped.
const RENDER_PATIENCE: Duration = Duration::from_secs(60);
/// Time limit for judging a window, whose pixels are taken in random order.
const WINDOW_PATIENCE: Duration = Duration::from_secs(40);
/// Time limit for judging one pixel.
const PIXEL_PATIENCE: Duration = Duration::from_secs(10);

/// The results of a hunt.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Hunt {
    /// Seed that the scenes were drawn from.
    pub seed: u64,
    /// Number of windows rendered and judged.
    pub windows: usize,
    /// Number of windows skipped because they took too long to render.
    pub too_slow: usize,
    /// Number of windows skipped because they are refused, or no engine of this machine computes them.
    pub refused: usize,
    /// Number of simulated pixels in the windows.
    pub simulated: usize,
    /// Number of pixels marked as uncertain.
    pub marked: usize,
    /// Windows in which more than one simulated pixel in twenty was marked.
    pub doubtful: Vec<DoubtfulWindow>,
    /// Number of unmarked pixels that were judged.
    pub judged: usize,
    /// Number of judged pixels that the referee could not decide.
    pub untold: usize,
    /// Unmarked pixels that are wrong.
    pub wrong: Vec<WrongPixel>,
}

/// An unmarked pixel that is wrong.
#[derive(Clone, Debug, Serialize)]
pub struct WrongPixel {
    /// The command that renders the picture with the pixel.
    pub command: String,
    /// The lure that the scene was drawn for.
    pub lure: String,
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// The engine's answer: seconds, or a status.
    pub given: String,
    /// The true outcome, in the same form.
    pub truth: String,
    /// Trust reported with the answer.
    pub trust: Trust,
}

/// A window in which more than one simulated pixel in twenty was marked as uncertain. Where nearly all of
/// its marked answers are right, the doubt was false.
#[derive(Clone, Debug, Serialize)]
pub struct DoubtfulWindow {
    /// The command that renders the picture.
    pub command: String,
    /// The lure that the scene was drawn for.
    pub lure: String,
    /// Number of simulated pixels.
    pub simulated: usize,
    /// Number of marked pixels.
    pub marked: usize,
    /// Number of marked answers that were judged.
    pub judged: usize,
    /// Number of these that are right.
    pub right: usize,
}

impl Hunt {
    /// Returns true if a file holds the results of a hunt, of this version or another.
    pub fn is_in(path: &Path) -> bool {
        let found = read_text(path).ok().and_then(|text| serde_json::from_str(&text).ok());
        let Some(serde_json::Value::Object(found)) = found else { return false };
        ["seed", "windows", "wrong"].iter().all(|key| found.contains_key(*key))
    }

    /// Hunts for `minutes`, through `most_windows` at most, or until stopped; calls `told` after
    /// every window that is rendered in time.
    pub fn run(
        minutes: f64,
        most_windows: usize,
        seed: u64,
        request: &EngineRequest,
        stop: StopTest,
        told: &mut dyn FnMut(&Hunt),
    ) -> Result<Hunt, ReportError> {
        let until = Instant::now() + Duration::from_secs_f64(60.0 * minutes);
        let mut hunt = Hunt { seed, ..Hunt::default() };
        let mut scenes = Scenes::new(seed);
        let Chosen { mut engine, config, .. } = choose(request, &|_| {})?;
        let mut renderers = Renderers::new(request);
        while Instant::now() < until && hunt.windows < most_windows && !stop() {
            let keep_going = || !stop();
            let (scene, lure) = scenes.next(engine.as_mut(), config, &keep_going)?;
            let (how, picks) = (scenes.how(request.kind), scenes.seed());
            // A scene drawn out of range is skipped.
            let Ok(scene) = scene.checked() else { continue };
            let window = Window { scene, how, lure: format!("{lure:?}") };
            log::debug!("{lure:?}: {}", window.command());
            let begun = Instant::now();
            let in_time = || keep_going() && begun.elapsed() < RENDER_PATIENCE;
            match window.rendered(&mut renderers, &in_time)? {
                Rendering::Done(samples) => {
                    log::debug!("judging");
                    hunt.judge(&window, &samples, picks, stop);
                    told(&hunt);
                }
                Rendering::Refused => hunt.refused += 1,
                Rendering::Late => hunt.too_slow += 1,
            }
        }
        Ok(hunt)
    }

    /// Judges a window and adds the results, unless it is stopped midway.
    fn judge(&mut self, window: &Window, samples: &Samples, picks: u64, stop: StopTest) {
        let jury = Jury { samples, judged: Judged::new(&window.scene, SIDE), stop };
        let is_simulated = |k: &usize| samples.get(*k).status != Status::Forbidden;
        let is_marked = |k: &usize| samples.trust(*k) == Trust::Uncertain;
        let simulated = (0..samples.len()).filter(is_simulated).count();
        let mut places: Vec<usize> = (0..samples.len()).collect();
        fastrand::Rng::with_seed(picks).shuffle(&mut places);
        let (marked, mut unmarked): (Vec<usize>, Vec<usize>) =
            places.into_iter().partition(is_marked);
        if jury.judged.deep || window.ends() == Needs::Growth {
            unmarked.truncate(SAMPLE);
        }
        let verdicts = jury.verdicts(&unmarked);
        let is_doubtful = marked.len() * 20 > simulated;
        let of_marked =
            if is_doubtful { jury.verdicts(&marked[..marked.len().min(SAMPLE)]) } else { vec![] };
        if stop() {
            return;
        }
        self.windows += 1;
        self.simulated += simulated;
        self.marked += marked.len();
        if is_doubtful {
            self.doubtful.push(window.doubted(simulated, marked.len(), &of_marked));
        }
        self.judged += verdicts.len();
        for (k, verdict) in verdicts {
            match verdict {
                RefereeVerdict::Right => {}
                RefereeVerdict::Untold => self.untold += 1,
                RefereeVerdict::Wrong(truth) => self.wrong.push(window.wrong(samples, k, &truth)),
            }
        }
    }
}

/// The samples of a window and the referee that judges them.
struct Jury<'a> {
    samples: &'a Samples,
    judged: Judged<'a>,
    stop: StopTest<'a>,
}

impl Jury<'_> {
    /// The verdicts on some samples, as many as are reached in time.
    fn verdicts(&self, places: &[usize]) -> Vec<(usize, RefereeVerdict)> {
        let until = Instant::now() + WINDOW_PATIENCE;
        let is_over = || (self.stop)() || Instant::now() > until;
        let one = |&k: &usize| {
            let begun = Instant::now();
            let give_up = || is_over() || begun.elapsed() > PIXEL_PATIENCE;
            (k, self.judged.verdict(pixel(k), &answer(self.samples, k), &give_up))
        };
        places.par_iter().take_any_while(|_| !is_over()).map(one).collect()
    }
}

/// A scene, the way in which it is computed, and the lure that it was drawn for.
struct Window {
    scene: Scene,
    how: How,
    lure: String,
}

/// The result of rendering a window.
enum Rendering {
    Done(Samples),
    /// Cannot be computed in this way, or on this machine.
    Refused,
    /// Took too long.
    Late,
}

impl Window {
    fn ends(&self) -> Needs {
        self.scene.question.ask.kind().needs
    }

    /// The samples of the window, with every pixel checked.
    fn rendered(
        &self,
        renderers: &mut Renderers,
        keep_going: &(dyn Fn() -> bool + Sync),
    ) -> Result<Rendering, ReportError> {
        let Some(renderer) = renderers.of(&self.how, self.ends())? else {
            return Ok(Rendering::Refused);
        };
        let (scene, size, cells) = (&self.scene, [SIDE; 2], self.how.cells);
        if check_feasible(scene, size, &renderer.config(), cells).is_err() {
            return Ok(Rendering::Refused);
        }
        renderer.second_opinion(scene, size, cells, keep_going)?;
        let mut work = renderer.work(scene, size).with_cells(cells);
        let samples = preview(&mut work, size, renderer.engine(), &|_| keep_going())?;
        Ok(samples.map_or(Rendering::Late, Rendering::Done))
    }

    /// The command that renders the picture again.
    fn command(&self) -> String {
        let scene = &self.scene;
        let is_section = scene.plane.kind == PlaneKind::Section;
        let has_effect = |word: Setting| match word {
            Setting::Rule | Setting::Count => scene.question.ask == QuestionName::Flip,
            Setting::At => scene.question.at.is_some(),
            Setting::Energy => is_section,
            Setting::Origin => !is_section,
            _ => true,
        };
        let option = |setting: Setting| format!("--{}={}", setting.name(), setting.text(scene));
        let options: Vec<String> =
            Setting::all().filter(|setting| has_effect(*setting)).map(option).collect();
        let (how, options) = (self.how.options(), options.join(" "));
        format!("flipmap render {how} --size {SIDE}x{SIDE} {options} -o hunted.png")
    }

    fn wrong(&self, samples: &Samples, k: usize, truth: &Answer) -> WrongPixel {
        WrongPixel {
            command: self.command(),
            lure: self.lure.clone(),
            pixel: pixel(k),
            given: self.words(&answer(samples, k)),
            truth: self.words(truth),
            trust: samples.trust(k),
        }
    }

    fn doubted(
        &self,
        simulated: usize,
        marked: usize,
        verdicts: &[(usize, RefereeVerdict)],
    ) -> DoubtfulWindow {
        let is_right =
            |verdict: &&(usize, RefereeVerdict)| matches!(verdict.1, RefereeVerdict::Right);
        DoubtfulWindow {
            command: self.command(),
            lure: self.lure.clone(),
            simulated,
            marked,
            judged: verdicts.len(),
            right: verdicts.iter().filter(is_right).count(),
        }
    }

    /// An answer in words: seconds, or a status, or the values of all channels.
    fn words(&self, (status, values): &Answer) -> String {
        let channels = self.scene.question.ask.kind().channels;
        match (status, channels.len()) {
            (Status::Answered, 1) => format!("{:?} {}", values[0], channels[0].unit),
            (Status::Answered, count) => format!("{:?}", &values[..count]),
            (status, _) => format!("{status:?}").to_lowercase(),
        }
    }
}

/// The answer of a sample.
fn answer(samples: &Samples, k: usize) -> Answer {
    let mut values = [0.0; MAX_CHANNELS];
    let given = samples.values(k);
    values[..given.len()].copy_from_slice(given);
    (samples.get(k).status, values)
}

fn pixel(place: usize) -> [u32; 2] {
    [place as u32 % SIDE, place as u32 / SIDE]
}

/// A view an eighth as wide around the two neighbours that differ most in a row through the middle,
/// or `None` if all are alike.
fn edge(
    scene: &Scene,
    engine: &mut dyn Engine,
    config: IntegratorConfig,
    unit_secs: f64,
) -> Result<Option<Scene>, EngineError> {
    const ALONG: u32 = 16;
    let mut work = Work::new(scene, [ALONG, 1], config, ALONG as usize);
    let Some(row) = preview(&mut work, [ALONG, 1], engine, &|_| true)? else { return Ok(None) };
    let differ = |k: usize| match (row.get(k), row.get(k + 1)) {
        (a, b) if a.status == Status::Forbidden || b.status == Status::Forbidden => 0.0,
        (a, b) if a.status != b.status => 1e9,
        (a, b) => (a.time - b.time).abs() / unit_secs,
    };
    let most = (0..ALONG as usize - 1).max_by(|&a, &b| differ(a).total_cmp(&differ(b)));
    let Some(place) = most.filter(|&k| differ(k) > 1e-3) else { return Ok(None) };
    let width = scene.view.width_rad().to_f64();
    let by = width * ((place as f64 + 1.0) / f64::from(ALONG) - 0.5);
    let digits = (14.0 - width.log10()).ceil().max(12.0) as usize;
    let [across, above] = scene.view.center_rad();
    let center = [across + Exact::from_f64(by), above].map(|theta| theta.decimal(digits));
    let view = View { center, width: format!("{:.2e}", width / 8.0), ..scene.view.clone() };
    Ok(Some(Scene { view, ..scene.clone() }))
}
