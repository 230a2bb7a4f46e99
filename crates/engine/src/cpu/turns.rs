//! Whole turns of the bobs, counted step by step where no bob is watched.

use super::lanes::Lanes;
use super::number::Number;
use flipmap_numbers::Real;
use flipmap_pendulum::phase::Phase;

/// Adds the turns that the steps from `before` to `after` complete, in lanes where `taken` is
/// negative. A bob passes the top where the change of sign of its `y` matches the sense in which it
/// turns (counterpart: `turns_between` in `shaders/adaptive.wgsl`). No step is as long as half a
/// turn.
#[inline(always)]
pub(super) fn count<N: Number>(
    turns: &mut [N::Leading; 2],
    [before, after]: [&Phase<N>; 2],
    taken: N::Leading,
) {
    for (bob, turns) in turns.iter_mut().enumerate() {
        let part = |phase: &Phase<N>| [phase[2 * bob].leading(), phase[2 * bob + 1].leading()];
        let ([x0, y0], [x1, y1]) = (part(before), part(after));
        let one = y0.lit(1.0);
        let falls = one.where_negative(y1) - one.where_negative(y0);
        let sine = x0 * y1 - y0 * x1;
        let over = falls.where_negative(-(falls * sine));
        *turns = *turns + over.where_negative(taken);
    }
}
