//! Estimators of areas, fractal boundaries and survival, each with an interval.
//!
//! Nothing here knows what is measured: answers come in as class numbers and times, numbers go out as
//! [`Estimate`]s with 95 % confidence. Answers that nobody is sure of widen the intervals instead of
//! vanishing: each is counted once as it seems, once as the class that makes a number smallest and
//! once as the one that makes it largest.
//!
//! * [`scatter`] places scrambled low-discrepancy points in independent replicates;
//! * [`shares`] are the areas of classes, [`survival`] the share without an event against time;
//! * [`pairs`] is the uncertainty exponent of a boundary, [`boxes`] its box-counting dimension;
//! * [`entropy`] is the basin entropy, [`fat`] the exponent of a fat fractal, from the same boxes;
//! * [`wada`] tells whether three classes share one boundary;
//! * [`rates`] is the distribution of exponents of growth.
//!
//! ```
//! use flipmap_estimate::scatter::scattered;
//! use flipmap_estimate::shares::{ClassCounts, share};
//!
//! // The area of a quarter of a disc.
//! let is_inside = |[x, y]: [u32; 2]| f64::from(x).hypot(f64::from(y)) < 2f64.powi(32);
//! let count = |replicate| {
//!     let points = (0..4096).map(|index| scattered(1, replicate, index));
//!     let inside = points.filter(|point| is_inside(*point)).count() as u64;
//!     ClassCounts { sure: vec![inside, 4096 - inside], unsure: vec![0, 0] }
//! };
//! let replicates: Vec<ClassCounts> = (0..16).map(count).collect();
//! let area = share(&replicates, 0)?;
//! assert!(area.contains(std::f64::consts::FRAC_PI_4) && area.half_width() < 1e-3);
//! # Ok::<(), flipmap_estimate::EstimateError>(())
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod boxes;
pub mod entropy;
mod estimate;
pub mod fat;
mod line;
pub mod pairs;
pub mod rates;
pub mod scatter;
pub mod shares;
pub mod survival;
pub mod wada;

pub use estimate::Estimate;

/// Errors of an estimator.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EstimateError {
    /// There are too few samples for an interval.
    #[error("{have} {what} are too few for an interval; at least {need} are needed")]
    TooFew {
        /// What was counted, in the plural.
        what: &'static str,
        /// Number that there are.
        have: usize,
        /// Number that is needed.
        need: usize,
    },
    /// The points of a line do not lie on one.
    #[error("nowhere do three distances lie on a straight line, so there is no one exponent")]
    NotStraight,
    /// All samples belong to one class, which has no boundary.
    #[error("every sample belongs to the same class, so there is no boundary to measure")]
    OneClass,
    /// A method needs more classes than there are.
    #[error("there are {have} classes with a boundary; {need} are needed")]
    FewClasses {
        /// Number that there are.
        have: usize,
        /// Number that is needed.
        need: usize,
    },
}
