//! The starts that all measurements share, and the truth about some of them.

use rayon::prelude::*;

use super::{ReportError, StopTest};
use flipmap_engine::EventSpec;
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, oracle};
use flipmap_scene::{Fate, Grid, Scene};

/// Pixels along each side of the home map from which the open starts are taken.
const SIDE: u32 = 1024;

/// The open starts of the home map.
pub struct TestSet {
    /// The question that is asked about the starts.
    pub question: EventSpec,
    /// All the open starts, in the order of the pixels.
    pub starts: Vec<[Dd; 2]>,
    /// Some of the starts, evenly spread, with the gold standard's answers.
    pub sample: Vec<([Dd; 2], Outcome)>,
}

impl TestSet {
    /// The test set of the home map, with the truth about `sample` of its starts.
    pub(crate) fn home(sample: usize, stop: StopTest) -> Result<Self, ReportError> {
        let scene = Scene::default();
        let question = EventSpec::from(&scene);
        let starts = open_starts(&scene, SIDE);
        let sample = spread(&starts, sample)
            .into_par_iter()
            .map(|angle| match stop() {
                true => Err(ReportError::Stopped),
                false => Ok((angle, truth(&question, angle))),
            })
            .collect::<Result<_, _>>()?;
        Ok(TestSet { question, starts, sample })
    }
}

/// The starts of a square picture that have to be simulated, in the order of its pixels.
pub(super) fn open_starts(scene: &Scene, side: u32) -> Vec<[Dd; 2]> {
    let grid = Grid::new(scene, [side; 2]);
    let fates = (0..side * side).map(|k| grid.fate(k % side, k / side));
    let open = |fate| if let Fate::Open(angle) = fate { Some(angle) } else { None };
    fates.filter_map(open).collect()
}

fn truth(question: &EventSpec, angle: [Dd; 2]) -> Outcome {
    let angle = angle.map(|theta| theta.hi);
    oracle::outcome(&question.build.pendulum(), angle, question.rule, question.budget_secs)
}

/// Returns `count` elements of `all`, evenly spread and in their order.
pub(super) fn spread<T: Copy>(all: &[T], count: usize) -> Vec<T> {
    let count = count.min(all.len());
    (0..count).map(|k| all[k * all.len() / count]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_covers_everything_evenly() {
        let all: Vec<u32> = (0..10).collect();
        assert_eq!(spread(&all, 3), [0, 3, 6]);
        assert_eq!(spread(&all, 99), all);
        assert_eq!(spread(&all, 0), [0; 0]);
    }
}
