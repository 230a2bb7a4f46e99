//! A hunt for wrong pixels: random scenes rendered with `exact`, and the pixels not marked as
//! uncertain compared with a referee that shares nothing with the engines but the right-hand side.

mod referee;
mod scenes;

use std::path::Path;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;

use self::referee::Referee;
use self::scenes::{Scenes, start};
use super::{ReportError, StopTest};
use crate::engine::choice::{Chosen, EngineRequest, choose};
use crate::engine::plain_file::read_text;
use crate::engine::{Engine, EngineError, IntegratorConfig, Trust};
use crate::physics::flip::right_secs;
use crate::physics::{Angle, Dd, Fixed, Outcome, Scalar, Status, Theta};
use crate::scene::{Scene, View, Word};
use crate::tiles::preview::preview;
use crate::tiles::{Renderer, Samples, Work};

/// Pixels along each side of a window.
const SIDE: u32 = 32;
/// Number of pixels of a deep window that are judged: each takes a long solution of its own.
const DEEP_SAMPLE: usize = 16;

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
    /// Number of simulated pixels in the windows.
    pub simulated: usize,
    /// Number of pixels marked as uncertain.
    pub marked: usize,
    /// Number of windows in which more than one simulated pixel in twenty was marked.
    pub windows_mostly_marked: usize,
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
        let checked = choose(request, &|_| {})?.engine;
        let mut exact = Renderer::of(checked, config, true, request.threads)?;
        while Instant::now() < until && hunt.windows < most_windows && !stop() {
            let go_on = || !stop();
            let (scene, lure) = scenes.next(engine.as_mut(), config, &go_on)?;
            let picks = scenes.seed();
            // A scene drawn out of range is skipped.
            let Ok(scene) = scene.checked() else { continue };
            log::debug!("{lure:?}: {}", command(&scene));
            let begun = Instant::now();
            let in_time = || go_on() && begun.elapsed() < RENDER_PATIENCE;
            let Some(samples) = exact.render_while(&scene, [SIDE; 2], &|_| in_time())? else {
                hunt.too_slow += 1;
                continue;
            };
            log::debug!("judging");
            hunt.judge(&scene, &format!("{lure:?}"), &samples, picks, stop);
            told(&hunt);
        }
        Ok(hunt)
    }

    /// Judges a window and adds the results, unless it is stopped midway.
    fn judge(&mut self, scene: &Scene, lure: &str, samples: &Samples, picks: u64, stop: StopTest) {
        let all = 0..samples.len();
        let is_simulated = |k: &usize| samples.get(*k).status != Status::Forbidden;
        let marked = |k: &usize| samples.trust(*k) == Trust::Uncertain;
        let simulated = all.clone().filter(is_simulated).count();
        let count = all.clone().filter(marked).count();
        let mut unmarked: Vec<usize> = all.filter(|k| !marked(k)).collect();
        let deep = is_deep(&scene.view);
        fastrand::Rng::with_seed(picks).shuffle(&mut unmarked);
        if deep {
            unmarked.truncate(DEEP_SAMPLE);
        }
        let until = Instant::now() + WINDOW_PATIENCE;
        let is_over = || stop() || Instant::now() > until;
        let one = |k: usize| {
            let begun = Instant::now();
            let give_up = || is_over() || begun.elapsed() > PIXEL_PATIENCE;
            (k, verdict(scene, pixel(k), &samples.get(k), deep, &give_up))
        };
        let verdicts: Vec<(usize, RefereeVerdict)> =
            unmarked.into_par_iter().take_any_while(|_| !is_over()).map(one).collect();
        if stop() {
            return;
        }
        self.judged += verdicts.len();
        self.windows += 1;
        self.simulated += simulated;
        self.marked += count;
        self.windows_mostly_marked += usize::from(count * 20 > simulated);
        for (k, verdict) in verdicts {
            match verdict {
                RefereeVerdict::Right => {}
                RefereeVerdict::Untold => self.untold += 1,
                RefereeVerdict::Wrong(truth) => self.wrong.push(WrongPixel {
                    command: command(scene),
                    lure: lure.to_string(),
                    pixel: pixel(k),
                    given: words(&samples.get(k)),
                    truth: words(&truth),
                    trust: samples.trust(k),
                }),
            }
        }
    }
}

fn pixel(place: usize) -> [u32; 2] {
    [place as u32 % SIDE, place as u32 / SIDE]
}

fn words(outcome: &Outcome) -> String {
    match outcome.status {
        Status::Flipped => format!("{:?} s", outcome.time),
        status => format!("{status:?}").to_lowercase(),
    }
}

/// The command that renders the picture again.
fn command(scene: &Scene) -> String {
    let options: Vec<String> = Word::ALL
        .iter()
        .map(|(setting, word)| format!("--{setting}={}", word.text(scene)))
        .collect();
    format!(
        "flipmap render --accuracy exact --engine cpu --size {SIDE}x{SIDE} {} -o hunted.png",
        options.join(" ")
    )
}

/// Returns true if f64 cannot distinguish the pixels of a view well enough to judge them.
fn is_deep(view: &View) -> bool {
    view.width_rad().to_f64() / view.stretch.max(1.0) < 1e-9
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
    let center = [across + Theta::from_f64(by), above].map(|theta| theta.decimal(digits));
    let view = View { center, width: format!("{:.2e}", width / 8.0), ..scene.view.clone() };
    Ok(Some(Scene { view, ..scene.clone() }))
}

/// Function that returns true when the referee should give up.
type GiveUp<'a> = &'a (dyn Fn() -> bool + Sync);

/// The referee's verdict on an answer.
enum RefereeVerdict {
    Right,
    Wrong(Outcome),
    Untold,
}

fn verdict(
    scene: &Scene,
    pixel: [u32; 2],
    given: &Outcome,
    deep: bool,
    give_up: GiveUp,
) -> RefereeVerdict {
    let angle = start(scene, SIDE, pixel);
    let judge = |truth: Option<Outcome>, other: Option<Outcome>| match (truth, other) {
        (Some(truth), Some(other)) if is_same(scene, &truth, &other, 0.01) => {
            let right = is_same(scene, given, &truth, 1.0);
            Some(if right { RefereeVerdict::Right } else { RefereeVerdict::Wrong(truth) })
        }
        _ => None,
    };
    if !deep {
        // Far fewer digits than the truth has, but a wrong answer is not confirmed by accident.
        let agrees =
            |truth: Option<Outcome>| truth.is_some_and(|truth| is_same(scene, given, &truth, 0.2));
        if agrees(truth::<f64>(scene, angle, 8, 5e-14, give_up))
            || agrees(truth::<Dd>(scene, angle, 11, 1e-27, give_up))
        {
            return RefereeVerdict::Right;
        }
        let short = truth::<Fixed<3>>(scene, angle, 13, 1e-33, give_up);
        let long = truth::<Fixed<4>>(scene, angle, 16, 1e-50, give_up);
        if let Some(verdict) = judge(long, short) {
            return verdict;
        }
    }
    let long = truth::<Fixed<6>>(scene, angle, 22, 1e-85, give_up);
    let longest = truth::<Fixed<8>>(scene, angle, 28, 1e-120, give_up);
    judge(longest, long).unwrap_or(RefereeVerdict::Untold)
}

/// Returns true if two outcomes agree in status and, if flipped, within `share` of what is right.
fn is_same(scene: &Scene, a: &Outcome, b: &Outcome, share: f64) -> bool {
    let within = share * right_secs(scene.build.unit_secs());
    a.status == b.status && (a.time - b.time).abs() <= within
}

/// The outcome of a start in a number type's digits, or `None` if it cannot be decided in them.
fn truth<T: Scalar + Angle>(
    scene: &Scene,
    angle: [Theta; 2],
    columns: usize,
    tolerance: f64,
    give_up: GiveUp,
) -> Option<Outcome> {
    let (exact, unit_secs) = scene.build.reduced_in::<Theta>();
    let circles = angle.map(Angle::sin_cos);
    let depth = exact.depth(circles.map(|(_, cos)| cos));
    if exact.forbids_depth(scene.question.rule, depth) {
        return Some(Outcome::without_time(Status::Forbidden));
    }
    let budget = Theta::from_f64(scene.question.budget.secs) / unit_secs;
    let referee = Referee {
        pendulum: exact.map(T::from_theta),
        rule: scene.question.rule,
        budget: T::from_theta(budget),
        columns,
        tolerance,
        give_up,
    };
    let [(y1, x1), (y2, x2)] = circles;
    let outcome = referee.outcome([x1, y1, x2, y2].map(T::from_theta))?;
    let time = outcome.time.to_f64() * unit_secs.to_f64();
    Some(Outcome { status: outcome.status, time })
}
