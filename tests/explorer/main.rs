//! The window's scheduler without a window: it computes cells in the right order, loses nothing and
//! does nothing twice whatever the user does, and shows exactly what the engine answered.

mod common;
mod finer;
mod ledger;
mod order;
mod planes;
mod random;
mod reuse;
