//! The second opinion on answers that start maps or first moments gave: some starts are integrated
//! directly ([`super::direct`]) and their answers compared.

/// The result of integrating some starts of a view directly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Opinion {
    /// Number of starts that were integrated directly.
    pub asked: usize,
    /// Number of those whose answers were wrong and not marked.
    pub contradicted: usize,
}

impl Opinion {
    /// A warning, if any answer was contradicted.
    pub fn warning(&self) -> Option<String> {
        (self.contradicted > 0).then(|| {
            format!(
                "{} of {} pixels that were integrated directly contradict the picture: all pixels are \
                 marked as uncertain; please report this view",
                self.contradicted, self.asked
            )
        })
    }
}
