//! The ways in which pairs of f32 protect their rounding errors from the optimiser.
//!
//! Shader compilers reorder sums, so that the error of a rounded sum comes out as zero. An operand
//! that only the host knows stops them. Which way works depends on the adapter, and the self-check
//! finds it; `shaders/df32.wgsl` implements all of them.

/// A way in which pairs of f32 are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pairs {
    /// Sums are fused multiply-adds with a 1 from a buffer, and the error of a product is one
    /// fused multiply-add.
    Fused,
    /// Sums as in [`Pairs::Fused`], and products that split their factors, for adapters whose
    /// multiply-adds are not fused.
    Fenced,
    /// Sums and products whose errors are computed pass through an exclusive or with a 0 from a
    /// buffer.
    Results,
    /// Every rounded value passes through the exclusive or.
    #[default]
    Guarded,
}

impl Pairs {
    /// Every way, cheapest first.
    pub const ALL: [Pairs; 4] = [Pairs::Fused, Pairs::Fenced, Pairs::Results, Pairs::Guarded];

    /// Name of the way.
    pub fn name(self) -> &'static str {
        match self {
            Pairs::Fused => "fused multiply-adds",
            Pairs::Fenced => "fenced sums",
            Pairs::Results => "guarded results",
            Pairs::Guarded => "guarded sums",
        }
    }
}
