//! Windows where coordinates go wrong: across the seam, and below the resolution of the numbers.

use super::{BALANCED, HardBench, HardCase, HardFinding, LESSON, Of, apart, count};
use flipmap_engine::{EngineError, EventSpec};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::{Fate, Grid, Scene, View};

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "windows across the seam",
        expected: "the home map with its quarters exchanged, pixel by pixel, whatever whole turns \
                   the centre is away",
        why: "the plane of starts is a torus: a whole turn of a rod is no change",
        of: Of::Engine,
        run: seam,
    },
    HardCase {
        name: "windows below the resolution",
        expected: "a staircase: one answer for each start that the precision can tell apart, all \
                   within what the neighbours' times span",
        why: "a start is rounded once, before the first step, and from there on equal starts are \
              equal pendulums",
        of: Of::Engine,
        run: staircase,
    },
];

const SIDE: u32 = 32;

fn window(center: [&str; 2], width: &str) -> Scene {
    let view =
        View { center: center.map(str::to_string), width: width.to_string(), ..View::default() };
    Scene { view, ..Scene::default() }
}

/// Outcomes of all pixels, row by row from the top.
fn picture(bench: &mut HardBench, scene: &Scene) -> Result<Vec<Outcome>, EngineError> {
    let question = EventSpec { budget_secs: 6.0, ..EventSpec::from(scene) };
    let grid = Grid::new(scene, [SIDE; 2]);
    let fates = (0..SIDE * SIDE).map(|k| grid.fate(k % SIDE, k / SIDE)).collect::<Vec<_>>();
    let open = |fate: &Fate| match fate {
        Fate::Open(start) => Some(*start),
        Fate::BesideTop(moments) => Some(moments.angle),
        Fate::Known(_) | Fate::Thrown(_) => None,
    };
    let starts: Vec<[Dd; 2]> = fates.iter().filter_map(open).collect();
    let mut answers = bench.answers(&question, BALANCED, &starts)?.into_iter();
    let outcome = |fate: Fate| match fate {
        Fate::Open(_) | Fate::BesideTop(_) => {
            answers.next().unwrap_or(Outcome::without_time(Status::Failed))
        }
        Fate::Known(outcome) => outcome,
        Fate::Thrown(_) => unreachable!("views of starts at rest"),
    };
    Ok(fates.into_iter().map(outcome).collect())
}

fn seam(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    const WIDTH: &str = "6.28318530717958647692528676655900577";
    const PI: &str = "3.14159265358979323846264338327950288";
    const MINUS_PI: &str = "-3.14159265358979323846264338327950288";
    const THREE_PI: &str = "9.42477796076937971538793014983850865";
    let home = picture(bench, &window(["0", "0"], WIDTH))?;
    let half = SIDE / 2;
    let exchanged: Vec<Outcome> = (0..SIDE * SIDE)
        .map(|k| [(k % SIDE + half) % SIDE, (k / SIDE + half) % SIDE])
        .map(|[column, row]| home[(row * SIDE + column) as usize])
        .collect();
    let (mut worst, mut same) = (0f64, 0);
    for center in [[PI, PI], [MINUS_PI, PI], [PI, THREE_PI], [MINUS_PI, MINUS_PI]] {
        let there = picture(bench, &window(center, WIDTH))?;
        worst = there.iter().zip(&exchanged).map(|(a, b)| apart(a, b)).fold(worst, f64::max);
        same += there.iter().zip(&exchanged).filter(|(a, b)| a == b).count();
    }
    HardFinding::new(
        worst <= 1e-6 && count(&home, Status::Answered) > 100,
        format!("{same} of {} pixels bit for bit, the rest within {worst:.0e} s", 4 * home.len()),
    )
}

fn staircase(bench: &mut HardBench) -> Result<HardFinding, EngineError> {
    let scene = window(["2.1", "2.3"], "4e-15");
    let grid = Grid::new(&scene, [SIDE; 2]);
    let question = EventSpec::from(&scene);
    let starts: Vec<[Dd; 2]> =
        (0..SIDE * SIDE).map(|k| grid.angle_from_pixel(k % SIDE, k / SIDE)).collect();
    // Fixed steps run in angles: what f64 cannot hold of a start is lost before the first step.
    let answers = bench.answers(&question, LESSON, &starts)?;
    let rounded: Vec<[Dd; 2]> = starts.iter().map(|s| s.map(|theta| Dd::new(theta.hi))).collect();
    let same = answers == bench.answers(&question, LESSON, &rounded)?;
    let steps = distinct(rounded.iter().map(|s| s.map(|theta| theta.hi.to_bits())));
    let exact =
        distinct(starts.iter().map(|s| s.map(|theta| theta.lo.to_bits() ^ theta.hi.to_bits())));
    let times = distinct(answers.iter().map(|outcome| outcome.time.to_bits()));
    let adaptive = bench.answers(&question, BALANCED, &starts)?;
    let spread = |outcomes: &[Outcome]| {
        let times = || outcomes.iter().map(|outcome| outcome.time);
        times().fold(0.0, f64::max) - times().fold(f64::INFINITY, f64::min)
    };
    let (spread, adaptive_spread) = (spread(&answers), spread(&adaptive));
    let all = count(&answers, Status::Answered) + count(&adaptive, Status::Answered);
    HardFinding::new(
        same && times <= steps
            && steps < exact
            && spread < 1e-12
            && adaptive_spread < 1e-12
            && all == 2 * starts.len(),
        format!(
            "{exact} starts 1e-16 rad apart are {steps} in f64 and get {times} answers, which span \
             {spread:.0e} s (adaptive steps: {adaptive_spread:.0e} s)"
        ),
    )
}

fn distinct<T: Ord>(values: impl Iterator<Item = T>) -> usize {
    values.collect::<std::collections::BTreeSet<T>>().len()
}
