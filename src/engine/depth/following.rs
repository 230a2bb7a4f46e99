//! How far the middle of a deep cell has been followed, for people who wait for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Shared by what follows and what tells of it.
#[derive(Clone, Debug, Default)]
pub struct Following(Arc<AtomicU64>);

impl Following {
    /// It has come to a time, of at most so many seconds.
    pub fn set(&self, secs: f64, budget_secs: f64) {
        let [secs, budget_secs] =
            [secs, budget_secs].map(|secs| u64::from((secs as f32).to_bits()));
        self.0.store((budget_secs << 32) | secs, Ordering::Relaxed);
    }

    /// Nothing is being followed.
    pub fn clear(&self) {
        self.0.store(0, Ordering::Relaxed);
    }

    /// The last time told and the budget, s, while something is being followed.
    pub fn secs(&self) -> Option<[f32; 2]> {
        let both = self.0.load(Ordering::Relaxed);
        (both != 0).then(|| [both as u32, (both >> 32) as u32].map(f32::from_bits))
    }

    /// The same in words.
    pub fn words(&self) -> Option<String> {
        let [secs, budget_secs] = self.secs()?;
        Some(format!("following the middle in many digits: {secs:.0} of {budget_secs:.0} s"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_tells_of_the_last_time() {
        let following = Following::default();
        assert_eq!(following.words(), None);
        following.clone().set(12.25, 70.0);
        assert_eq!(following.secs(), Some([12.25, 70.0]));
        assert!(following.words().unwrap().ends_with("12 of 70 s"));
        following.clear();
        assert_eq!(following.secs(), None);
    }
}
