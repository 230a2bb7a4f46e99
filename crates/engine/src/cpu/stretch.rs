//! Hot loops as functions of their own.
//!
//! The program is built for any processor of its kind; only loops over lanes are compiled for the
//! instruction set that is found at run time. Each such loop is one function, called from code that
//! is not compiled for that set, so that the compiler cannot inline it into another function. A
//! function that holds nothing but its loop keeps the loop's numbers in registers, and aligns those
//! that do not fit there. When all methods were one function, each step read its constants from a
//! stack that was aligned by chance, mostly across two cache lines.

use pulp::{Simd, WithSimd};

use super::lanes::Lanes;

/// A loop over lanes of `L`. The call is always inlined into the function made for it.
pub(super) trait Stretch<L: Lanes> {
    /// The loop's result.
    type Output;

    /// Runs the loop.
    fn run(self, set: L::Set) -> Self::Output;
}

/// The result of steps that stop when a budget ends or a watched bob may have been at the top.
pub(super) struct StretchEnd {
    /// Number of steps taken.
    pub taken: u32,
    /// True if a step must be searched for passes of the top, lane by lane.
    pub is_suspect: bool,
}

/// Runs a loop in a function of its own, compiled for the instruction set. The caller must be a
/// function that is never inlined.
#[inline(always)]
pub(super) fn vectorized<L: Lanes, T: Stretch<L>>(set: L::Set, stretch: T) -> T::Output {
    set.vectorize(Function::<L, T> { set, stretch })
}

struct Function<L: Lanes, T> {
    set: L::Set,
    stretch: T,
}

impl<L: Lanes, T: Stretch<L>> WithSimd for Function<L, T> {
    type Output = T::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> T::Output {
        std::hint::black_box(&mut CacheLine(0));
        self.stretch.run(self.set)
    }
}

/// A local value that makes the compiler align the function's stack. Without one it may learn too
/// late that registers have to be kept on the stack, and most of them then lie across two cache lines.
#[repr(align(64))]
struct CacheLine(#[expect(dead_code, reason = "only its place on the stack matters")] u8);
