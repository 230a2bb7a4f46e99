//! The numbers of an upright picture's columns and rows, from which the device begins its starts.

use crate::gpu::pipeline::Kernel;
use crate::start::at_rest_at;
use crate::{IntegratorState, Job, Starts};
use flipmap_numbers::Dd;

/// The states of all columns and of all rows. The first column's state also gives the numbers that
/// all starts share.
pub(super) struct Axes {
    columns: Vec<IntegratorState>,
    rows: Vec<IntegratorState>,
    /// For each number of the device's state, the coordinate on which it depends and its places.
    numbers: Vec<(Along, [Option<usize>; 2])>,
}

/// The coordinate that a number of a state depends on.
#[derive(Clone, Copy, PartialEq)]
enum Along {
    Column,
    Row,
    Neither,
}

impl Axes {
    /// Returns the axes of a job whose starts are those of an upright picture, if its kernel can
    /// begin them. `places` are the places of the numbers of the device's state (see
    /// [`crate::start::places`]).
    pub(super) fn of(job: &Job, kernel: &Kernel, places: &[[Option<usize>; 2]]) -> Option<Self> {
        let Starts::Upright(upright) = &job.starts else { return None };
        kernel.begin.as_ref()?;
        let zero = Dd::new(0.0);
        let [columns, rows] = &upright.angles;
        let columns: Vec<_> = columns.iter().map(|angle| [*angle, zero]).collect();
        let rows: Vec<_> = rows.iter().map(|angle| [zero, *angle]).collect();
        let along = |name: &str| match name {
            name if name.contains('1') => Along::Column,
            name if name.contains('2') => Along::Row,
            _ => Along::Neither,
        };
        let names = kernel.design.state();
        Some(Axes {
            columns: at_rest_at(&job.config, &columns),
            rows: at_rest_at(&job.config, &rows),
            numbers: names.into_iter().map(along).zip(places.iter().copied()).collect(),
        })
    }

    /// Returns the states from which each number of the device's state is taken, and its places in
    /// them.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&[IntegratorState], [Option<usize>; 2])> {
        self.numbers.iter().map(|(along, places)| match along {
            Along::Column => (&self.columns[..], *places),
            Along::Row => (&self.rows[..], *places),
            Along::Neither => (&self.columns[..1], *places),
        })
    }

    /// Returns the number of values that are uploaded.
    pub(super) fn len(&self) -> usize {
        self.numbers().map(|(states, _)| states.len()).sum()
    }
}
