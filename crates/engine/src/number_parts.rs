//! Angles, vectors and times as the number types of the engines hold them, with their remainders.

use super::{IntegratorConfig, Precision};
use flipmap_numbers::{Angle, Dd, Scalar};

/// The unit vectors along the rods.
pub(super) fn vectors(config: &IntegratorConfig, angle: [Dd; 2]) -> [[Dd; 2]; 2] {
    match config.precision {
        Precision::Dd => angle.map(exact_unit_vector),
        _ => angle.map(unit_vector),
    }
}

/// A time as the number type holds it, and the remainder.
pub(super) fn time_parts(config: &IntegratorConfig, [high, low]: [f64; 2]) -> [f64; 2] {
    match config.precision {
        Precision::F64 | Precision::Dd => [high, low],
        Precision::F32 | Precision::Df32 => parts(Dd { hi: high, lo: low }, config.precision),
    }
}

/// `value` as the number type holds it, and the remainder.
pub(super) fn parts(value: Dd, precision: Precision) -> [f64; 2] {
    match precision {
        Precision::F64 => [value.hi, 0.0],
        Precision::Dd => [value.hi, value.lo],
        Precision::F32 | Precision::Df32 => {
            let high = f64::from(value.hi as f32);
            [high, f64::from(((value.hi - high) + value.lo) as f32)]
        }
    }
}

/// Cosine and sine to the precision of f64; exact at the top.
fn unit_vector(angle: Dd) -> [Dd; 2] {
    if angle.abs() == Dd::PI {
        return [Dd::new(-1.0), Dd::new(0.0)];
    }
    let (sin, cos) = angle.hi.sin_cos();
    [Dd::new(cos - sin * angle.lo), Dd::new(sin + cos * angle.lo)]
}

/// Cosine and sine to the precision of double-double; exact at the top.
fn exact_unit_vector(angle: Dd) -> [Dd; 2] {
    if angle.abs() == Dd::PI {
        return [Dd::new(-1.0), Dd::new(0.0)];
    }
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}
