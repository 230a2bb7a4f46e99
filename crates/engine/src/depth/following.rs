//! Progress in following the middle of a deep cell, to report while the user waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A time and a budget, shared by the thread that follows and those that report.
#[derive(Clone, Debug, Default)]
pub struct Following(Arc<AtomicU64>);

impl Following {
    /// Records the time that has been reached and the budget, both in s.
    pub(crate) fn set(&self, secs: f64, budget_secs: f64) {
        let [secs, budget_secs] =
            [secs, budget_secs].map(|secs| u64::from((secs as f32).to_bits()));
        self.0.store((budget_secs << 32) | secs, Ordering::Relaxed);
    }

    /// Records that nothing is being followed.
    pub(crate) fn clear(&self) {
        self.0.store(0, Ordering::Relaxed);
    }

    /// The last recorded time and the budget in s, while something is being followed.
    pub fn secs(&self) -> Option<[f32; 2]> {
        let both = self.0.load(Ordering::Relaxed);
        (both != 0).then(|| [both as u32, (both >> 32) as u32].map(f32::from_bits))
    }

    /// The progress in words.
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
