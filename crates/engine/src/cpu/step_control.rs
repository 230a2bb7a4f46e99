//! Step size control in lanes (see `flipmap_pendulum::control`).

use super::lanes::Lanes;
use flipmap_pendulum::control::{Control, GROW, SHRINK};

/// Excess of each lane's error over what is allowed at its time, in log₂ of squares: negative where
/// the step can be taken.
#[inline(always)]
pub(super) fn excess<L: Lanes>(control: &Control, time: L, error_squared: L) -> L {
    let lit = |value| time.lit(value);
    let limit = time.mul_add(lit(control.rise), lit(control.start));
    error_squared.rough_log2() - limit.min(lit(control.ceiling))
}

/// The factor from each lane's step to the next.
#[inline(always)]
pub(super) fn factor<L: Lanes>(control: &Control, excess: L) -> L {
    let lit = |value| excess.lit(value);
    let power = excess.mul_add(lit(control.exponent), lit(control.safety));
    let factor = power.max(lit(-8.0)).min(lit(8.0)).rough_exp2();
    factor.max(lit(SHRINK)).min(lit(GROW))
}
