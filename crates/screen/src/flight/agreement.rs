//! The comparison of the map's outcome with the flight's for one pixel.

use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};

/// Largest difference of flip times, in seconds, at which they count as the same.
pub(crate) const TOLERATED_SECS: f64 = 1e-3;

/// The result of comparing two outcomes of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Agreement {
    /// Equal statuses, and flip times within [`TOLERATED_SECS`].
    Same,
    /// Two flips at times that differ by this many seconds.
    Apart(f64),
    /// Different statuses.
    OtherStatus,
}

impl Agreement {
    /// Compares the map's outcome with that of the gold standard.
    pub fn of(told: &Outcome, flown: &Outcome<Dd>) -> Self {
        if told.status != flown.status {
            return Agreement::OtherStatus;
        }
        let apart_secs = (Dd::new(told.time) - flown.time).hi.abs();
        if told.status == Status::Answered && apart_secs > TOLERATED_SECS {
            Agreement::Apart(apart_secs)
        } else {
            Agreement::Same
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_millisecond_is_the_same_and_more_is_not() {
        let flown = Outcome::flipped(Dd::new(2.0));
        let told = |secs| Agreement::of(&Outcome::flipped(secs), &flown);
        assert_eq!(
            (told(2.0), told(2.0009), told(1.9991)),
            (Agreement::Same, Agreement::Same, Agreement::Same)
        );
        let Agreement::Apart(by_secs) = told(2.0125) else { panic!("12.5 ms are seen") };
        assert!((by_secs - 0.0125).abs() < 1e-12);
    }

    #[test]
    fn another_status_is_never_the_same() {
        let none = |status| Outcome::without_time(status);
        let unflipped = Outcome::<Dd>::without_time(Status::Unflipped);
        assert_eq!(Agreement::of(&none(Status::Unflipped), &unflipped), Agreement::Same);
        for told in [none(Status::Failed), none(Status::Forbidden), Outcome::flipped(2.0)] {
            assert_eq!(Agreement::of(&told, &unflipped), Agreement::OtherStatus);
        }
    }
}
