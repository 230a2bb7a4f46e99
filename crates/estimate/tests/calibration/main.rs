//! Every estimator is tried on systems whose values are exact or published.

mod boundaries;
mod coverage;
mod mixtures;
mod systems;
