//! From a chunk's configuration to the loop that is compiled for it.

use pulp::{Simd, WithSimd};

use super::adaptive::PairSteps;
use super::extremum::Search;
use super::growth::{SlopeScales, WithTangents};
use super::lane_scheduler::{Chunk, ChunkResult};
use super::lanes::{F32Lanes, F64Lanes, Lanes};
use super::number::{Compensated, Number, Two};
use super::pair::Midpoints;
use super::rk4::Rk4Steps;
use super::stepper::LaneStepper;
use super::taylor::TaylorSteps;
use super::taylor_pair::TaylorPair;
use super::{fixed, gather_loop, lane_loop};
use crate::pace::{Adaptive, Pace, Steps};
use crate::{Method, Precision};
use flipmap_numbers::Dd;
use flipmap_numbers::dual::Narrow;
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::control::Control;
use flipmap_pendulum::embedded::{EmbeddedPair, WithPair};
use flipmap_pendulum::series::{ORDER_DD, ORDER_F64};
use flipmap_scene::question::Needs;

/// A chunk to be run in the widest lanes.
pub(super) struct ChunkInFlight<'a> {
    pub chunk: &'a Chunk<'a>,
}

impl WithSimd for ChunkInFlight<'_> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Self::Output {
        if self.chunk.keep.ends.are_carried() {
            return self.gathered(set);
        }
        match self.chunk.pace {
            Pace::Fixed(steps) => self.fixed(set, steps),
            Pace::Adaptive(pace) => self.adaptive(set, pace),
        }
    }
}

impl ChunkInFlight<'_> {
    #[inline(always)]
    fn fixed<S: Simd>(self, set: S, steps: Steps) -> Option<ChunkResult> {
        let Chunk { question, config, .. } = *self.chunk;
        macro_rules! lanes {
            ($lanes:ident) => {
                match steps.turning(question, config.precision) {
                    Turning::Small(2) => fixed::run::<$lanes<S>, 2>(set, self.chunk, steps),
                    Turning::Small(4) => fixed::run::<$lanes<S>, 4>(set, self.chunk, steps),
                    Turning::Small(6) => fixed::run::<$lanes<S>, 6>(set, self.chunk, steps),
                    _ => fixed::run::<$lanes<S>, 0>(set, self.chunk, steps),
                }
            };
        }
        match config.precision {
            Precision::F32 => lanes!(F32Lanes),
            Precision::Df32 | Precision::F64 | Precision::Dd => lanes!(F64Lanes),
        }
    }

    /// Follows what the pendulums gather along their way.
    #[inline(always)]
    fn gathered<S: Simd>(self, set: S) -> Option<ChunkResult> {
        const N: usize = ORDER_F64 + 1;
        const M: usize = ORDER_DD + 1;
        let chunk = self.chunk;
        let Pace::Adaptive(Adaptive { control, .. }) = chunk.pace else {
            return match chunk.config.precision {
                Precision::F32 => gather::<F32Lanes<S>, Rk4Steps>(set, chunk, ()),
                Precision::Df32 | Precision::F64 | Precision::Dd => {
                    gather::<F64Lanes<S>, Rk4Steps>(set, chunk, ())
                }
            };
        };
        match (chunk.config.method, chunk.config.precision) {
            (Method::Taylor { tolerance }, Precision::Dd) => {
                let control = Control::new(tolerance, TaylorPair::<M>::ORDER).steady();
                gather::<Two<F64Lanes<S>>, PairSteps<TaylorPair<M>>>(set, chunk, control)
            }
            (Method::Taylor { tolerance }, _) => {
                let control = Control::new(tolerance, TaylorPair::<N>::ORDER).steady();
                gather::<F64Lanes<S>, PairSteps<TaylorPair<N>>>(set, chunk, control)
            }
            (Method::Extrapolation { .. }, _) => {
                gather::<Two<F64Lanes<S>>, PairSteps<Midpoints>>(set, chunk, control)
            }
            (Method::Embedded { pair, .. }, _) => pair.run(Gathered { set, chunk, control }),
            (Method::Rk4 { .. }, _) => unreachable!("its steps are fixed"),
        }
    }

    #[inline(always)]
    fn adaptive<S: Simd>(self, set: S, pace: Adaptive) -> Option<ChunkResult> {
        let chunk = self.chunk;
        match (chunk.config.method, chunk.config.precision) {
            (Method::Taylor { .. }, Precision::Dd) => {
                type Steps = TaylorSteps<Dd, { ORDER_DD + 1 }>;
                lane_loop::run::<Two<F64Lanes<S>>, Steps>(set, chunk, pace)
            }
            (Method::Taylor { .. }, _) => {
                type Steps = TaylorSteps<f64, { ORDER_F64 + 1 }>;
                lane_loop::run::<F64Lanes<S>, Steps>(set, chunk, pace)
            }
            (Method::Extrapolation { .. }, _) => {
                lane_loop::run::<Two<F64Lanes<S>>, PairSteps<Midpoints>>(set, chunk, pace)
            }
            (Method::Embedded { pair, .. }, _) => pair.run(Passes { set, chunk, pace }),
            (Method::Rk4 { .. }, _) => unreachable!("its steps are fixed"),
        }
    }
}

/// Passes of the top by a pair.
struct Passes<'a, S> {
    set: S,
    chunk: &'a Chunk<'a>,
    pace: Adaptive,
}

impl<S: Simd> WithPair for Passes<'_, S> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with<P: EmbeddedPair>(self) -> Self::Output {
        let Passes { set, chunk, pace } = self;
        match chunk.config.precision {
            Precision::F32 => {
                lane_loop::run::<Compensated<F32Lanes<S>>, PairSteps<P>>(set, chunk, pace)
            }
            Precision::Df32 | Precision::F64 | Precision::Dd => {
                lane_loop::run::<F64Lanes<S>, PairSteps<P>>(set, chunk, pace)
            }
        }
    }
}

/// What pendulums gather, by a pair.
struct Gathered<'a, S> {
    set: S,
    chunk: &'a Chunk<'a>,
    control: Control,
}

impl<S: Simd> WithPair for Gathered<'_, S> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with<P: EmbeddedPair>(self) -> Self::Output {
        let Gathered { set, chunk, control } = self;
        match chunk.config.precision {
            Precision::F32 => gather::<F32Lanes<S>, PairSteps<P>>(set, chunk, control),
            Precision::Df32 | Precision::F64 | Precision::Dd => {
                gather::<F64Lanes<S>, PairSteps<P>>(set, chunk, control)
            }
        }
    }
}

/// Runs the observer of what the chunk keeps, in steps of `M`.
#[inline(always)]
fn gather<N, M>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    control: <M as LaneStepper<N>>::Control,
) -> Option<ChunkResult>
where
    N: Number + Narrow<N::Leading>,
    M: LaneStepper<N> + LaneStepper<WithTangents<N>, Control = <M as LaneStepper<N>>::Control>,
{
    match chunk.keep.ends {
        Needs::Growth => {
            gather_loop::run::<WithTangents<N>, M, SlopeScales>(set, chunk, control, ())
        }
        Needs::Extremum(extremum) => {
            gather_loop::run::<N, M, Search<N>>(set, chunk, control, extremum)
        }
        Needs::Outcome | Needs::End => unreachable!("nothing is gathered for these ends"),
    }
}
