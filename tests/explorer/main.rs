//! The window's scheduler without a window: what is computed in which order, that nothing is lost
//! or done twice whatever a person does, and that what comes out is what the engine answered.

mod common;
mod ledger;
mod order;
mod random;
mod reuse;
