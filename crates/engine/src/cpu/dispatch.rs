//! From a chunk's configuration to the loop that is compiled for it.

use pulp::{Simd, WithSimd};

use super::adaptive::PairSteps;
use super::lane_scheduler::{Chunk, ChunkResult};
use super::lanes::{F32Lanes, F64Lanes};
use super::number::{Compensated, Two};
use super::pair::Midpoints;
use super::taylor::TaylorSteps;
use super::taylor_pair::TaylorPair;
use super::{extremum, fixed, growing, lane_loop, tangents};
use crate::pace::{Adaptive, Pace, Steps};
use crate::{Method, Precision, WantedEnds};
use flipmap_numbers::Dd;
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::embedded::{EmbeddedPair, Pair, WithPair};
use flipmap_pendulum::extremum::Extremum;
use flipmap_pendulum::series::{ORDER_DD, ORDER_F64};

/// A chunk to be run in the widest lanes.
pub(super) struct ChunkInFlight<'a> {
    pub chunk: &'a Chunk<'a>,
}

impl WithSimd for ChunkInFlight<'_> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Self::Output {
        if self.chunk.keep.ends.are_carried() && self.is_taylor() {
            return self.in_taylor_steps();
        }
        match self.chunk.keep.ends {
            WantedEnds::Growth => return self.growth(set),
            WantedEnds::Extremum(extremum) => {
                return self.paired().run(Extreme { chunk: self.chunk, extremum });
            }
            WantedEnds::None | WantedEnds::Plain => {}
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

    fn is_taylor(&self) -> bool {
        self.chunk.config.method.is_series()
    }

    /// Computes growth or extremes in Taylor steps of the same tolerance at all times.
    fn in_taylor_steps(self) -> Option<ChunkResult> {
        const N: usize = ORDER_F64 + 1;
        const M: usize = ORDER_DD + 1;
        let is_dd = self.chunk.config.precision == Precision::Dd;
        let order = if is_dd { TaylorPair::<M>::ORDER } else { TaylorPair::<N>::ORDER };
        let pace = self.chunk.pace.steady(self.chunk.config.method, order);
        let chunk = Chunk { pace, ..*self.chunk };
        match (chunk.keep.ends, is_dd) {
            (WantedEnds::Extremum(extremum), false) => {
                extremum::run::<f64, TaylorPair<N>>(&chunk, extremum)
            }
            (WantedEnds::Extremum(extremum), true) => {
                extremum::run::<Dd, TaylorPair<M>>(&chunk, extremum)
            }
            (_, false) => growing::run::<f64, TaylorPair<N>>(&chunk),
            (_, true) => growing::run::<Dd, TaylorPair<M>>(&chunk),
        }
    }

    /// The growth, by the pair of the method or in fixed steps.
    #[inline(always)]
    fn growth<S: Simd>(self, set: S) -> Option<ChunkResult> {
        match self.chunk.config.method {
            Method::Extrapolation { .. } => {
                tangents::run::<Two<F64Lanes<S>>, Midpoints>(set, self.chunk)
            }
            Method::Rk4 { .. } | Method::Embedded { .. } | Method::Taylor { .. } => {
                self.paired().run(Growth { set, chunk: self.chunk })
            }
        }
    }

    /// The pair by which adaptive steps are taken; fixed steps use none, so any will do.
    fn paired(&self) -> Pair {
        match self.chunk.config.method {
            Method::Embedded { pair, .. } => pair,
            Method::Rk4 { .. } => Pair::Dop853,
            Method::Taylor { .. } | Method::Extrapolation { .. } => {
                unreachable!("these have steps of their own, or are refused with the job")
            }
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
            (Method::Rk4 { .. } | Method::Embedded { .. }, _) => {
                self.paired().run(Passes { set, chunk, pace })
            }
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

/// The growth of nudges by a pair.
struct Growth<'a, S> {
    set: S,
    chunk: &'a Chunk<'a>,
}

impl<S: Simd> WithPair for Growth<'_, S> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with<P: EmbeddedPair>(self) -> Self::Output {
        match self.chunk.config.precision {
            Precision::F32 => tangents::run::<F32Lanes<S>, P>(self.set, self.chunk),
            Precision::Df32 | Precision::F64 | Precision::Dd => {
                tangents::run::<F64Lanes<S>, P>(self.set, self.chunk)
            }
        }
    }
}

/// Extremes by a pair.
struct Extreme<'a> {
    chunk: &'a Chunk<'a>,
    extremum: Extremum,
}

impl WithPair for Extreme<'_> {
    type Output = Option<ChunkResult>;

    fn with<P: EmbeddedPair>(self) -> Self::Output {
        let Extreme { chunk, extremum } = self;
        match chunk.config.precision {
            Precision::F32 => extremum::run::<f32, P>(chunk, extremum),
            Precision::Df32 | Precision::F64 | Precision::Dd => {
                extremum::run::<f64, P>(chunk, extremum)
            }
        }
    }
}
