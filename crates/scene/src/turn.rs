//! Places along one axis of the torus of starts.

use std::fmt;
use std::ops::{Add, Sub};
use std::sync::OnceLock;

use flipmap_numbers::{Exact, Fixed, Scalar};

/// A place along one axis of the torus, in turns: 0 at θ = −π, 1 one turn further. The type differs
/// from [`Exact`] so that turns and radians cannot be mixed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Turn(Fixed<8>);

impl Turn {
    /// The place of θ = −π.
    pub const ZERO: Turn = Turn(Fixed::ZERO);

    /// Returns the place at this number of turns.
    pub fn from_f64(turns: f64) -> Self {
        Turn(Fixed::from_f64(turns))
    }

    /// Returns the place whose [`Fixed`] number has these limbs, as read from a file.
    pub fn from_limbs(limbs: [u64; 8]) -> Self {
        Turn(Fixed::from_limbs(limbs))
    }

    /// Returns the limbs of the place's number, to be stored in a file.
    pub fn limbs(self) -> [u64; 8] {
        self.0.limbs()
    }

    /// Returns the number of turns, rounded to f64.
    pub fn to_f64(self) -> f64 {
        self.0.to_f64()
    }

    /// Returns the place of an angle in rad.
    pub fn from_theta(theta: Exact) -> Self {
        static PER_TURN: OnceLock<Exact> = OnceLock::new();
        let per_turn = *PER_TURN.get_or_init(|| one() / Exact::pi().doubled(1));
        Turn(one().halved(1) + theta * per_turn)
    }

    /// Returns the angle of the place in rad, exactly odd about the middle of the torus.
    pub fn to_theta(self) -> Exact {
        let from_middle = self.0 - one().halved(1);
        let theta = from_middle.abs() * Exact::pi().doubled(1);
        if from_middle.is_negative() { -theta } else { theta }
    }

    /// Returns the side of the cells of a level.
    pub fn side(level: u32) -> Self {
        Turn(one().halved(level))
    }

    /// Rounds the place down to a multiple of the side of the level's cells.
    pub(crate) fn floor(self, level: u32) -> Self {
        Turn(self.0.without_lowest(Fixed::<8>::BITS - level))
    }

    /// Returns the place without whole turns, in [0, 1).
    pub fn wrapped(self) -> Self {
        self - self.floor(0)
    }

    /// Multiplies a distance by `factor`.
    pub fn times(self, factor: f64) -> Self {
        Turn(self.0 * Fixed::from_f64(factor))
    }
}

fn one() -> Fixed<8> {
    Fixed::from_f64(1.0)
}

impl Add for Turn {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Turn(self.0 + other.0)
    }
}

impl Sub for Turn {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Turn(self.0 - other.0)
    }
}

// Parts on disk are named by digests of this text, which must remain that of the number alone.
impl fmt::Debug for Turn {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.fmt(f)
    }
}
