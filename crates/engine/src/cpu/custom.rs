//! Any embedded pair on the processor's lanes and threads.

use std::sync::atomic::AtomicBool;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::adaptive::PairSteps;
use super::lane_scheduler::{Chunk, ChunkResult};
use super::lanes::F64Lanes;
use super::{CHUNK, lane_loop};
use crate::pace::{Adaptive, Pace};
use crate::{
    EngineError, EventSpec, IntegratorConfig, Job, Keep, Method, Precision, Starts, start,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::Outcome;
use flipmap_pendulum::control::Control;
use flipmap_pendulum::embedded::EmbeddedPair;

/// Integrates pendulums from rest at `angles` (rad) by a pair defined outside this crate, in f64 on
/// the widest lanes of the processor and on all of its threads, with an error of `tolerance`
/// allowed in a step at the release. Step size control and the search for crossings of the top are
/// those of flipmap's own methods.
pub fn outcomes<P: EmbeddedPair>(
    question: &EventSpec,
    tolerance: f64,
    angles: &[[Dd; 2]],
) -> Result<Vec<Outcome>, EngineError> {
    // A pendulum at rest begins in the same state whatever the adaptive method.
    let config = IntegratorConfig { method: Method::dop853(tolerance), precision: Precision::F64 };
    let starts = Starts::Rest(angles.to_vec());
    let job = Job { id: 0, question: *question, config, starts, keep: Keep::NOTHING };
    let states = start::states(&job)?;
    let adaptive = Adaptive::new(question, Control::new(tolerance, P::ORDER));
    let cancelled = AtomicBool::new(false);
    let pace = Pace::Adaptive(adaptive);
    let outcomes = |starts| {
        let keep = Keep::NOTHING;
        let chunk = Chunk { question, config, pace, starts, keep, cancelled: &cancelled };
        let pair = std::marker::PhantomData::<P>;
        let result = Arch::new().dispatch(OnLanes { chunk: &chunk, adaptive, pair });
        result.expect("it is never cancelled").outcomes
    };
    Ok(states.par_chunks(CHUNK).flat_map_iter(outcomes).collect())
}

struct OnLanes<'a, P> {
    chunk: &'a Chunk<'a>,
    adaptive: Adaptive,
    pair: std::marker::PhantomData<P>,
}

impl<P: EmbeddedPair> WithSimd for OnLanes<'_, P> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Self::Output {
        lane_loop::run::<F64Lanes<S>, PairSteps<P>>(set, self.chunk, self.adaptive)
    }
}
