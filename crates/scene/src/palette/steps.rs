//! Whole numbers along a legend's bar. Each has a step of one colour, and as many have labels as
//! fit.

/// The whole numbers along a bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WholeNumbers {
    first: i64,
    last: i64,
    /// True at an end whose colour also serves the numbers beyond it.
    open: [bool; 2],
}

/// Least gap between two labels, in letters.
const GAP: f64 = 0.5;

impl WholeNumbers {
    /// The numbers of the two bobs.
    pub(super) const BOBS: Self = WholeNumbers { first: 1, last: 2, open: [false; 2] };

    /// Returns counts in a range that is open above, and open below if `first` is negative.
    pub(super) fn counts(first: i64, last: i64) -> Self {
        WholeNumbers { first, last, open: [first < 0, true] }
    }

    /// Returns the number at a share of the bar, from 0 to 1.
    pub(super) fn at(&self, share: f64) -> i64 {
        let step = (share * self.steps()).floor() as i64;
        self.first + step.clamp(0, self.last - self.first)
    }

    /// Returns the places (0 to 1) and labels of numbers on a bar `letters` letters long: all
    /// numbers if they fit, or else the ends and round numbers between them.
    pub(super) fn labels(&self, letters: f64) -> Vec<(f64, String)> {
        let round = (0..18).flat_map(|power| [1, 2, 5].map(|m| m * 10i64.pow(power)));
        let few = round.filter(|step| self.steps() / *step as f64 <= letters);
        let mut each = few.map(|step| self.placed(&self.every(step), letters));
        each.find(|labels| fit(labels, letters)).unwrap_or_default()
    }

    fn steps(&self) -> f64 {
        (self.last - self.first + 1) as f64
    }

    /// Returns both ends, and the multiples of `step` that are at least `step` away from them.
    fn every(&self, step: i64) -> Vec<i64> {
        let WholeNumbers { first, last, .. } = *self;
        let multiples = (first.div_euclid(step)..=last.div_euclid(step)).map(|k| k * step);
        let between = multiples.filter(|k| k - first >= step && last - k >= step);
        [first].into_iter().chain(between).chain([last]).collect()
    }

    /// Places each label in the middle of its step, or further in if it would extend beyond the
    /// bar.
    fn placed(&self, numbers: &[i64], letters: f64) -> Vec<(f64, String)> {
        let place = |&number: &i64| {
            let text = self.label(number);
            let half = (length(&text) / letters / 2.0).min(0.5);
            let middle = ((number - self.first) as f64 + 0.5) / self.steps();
            (middle.clamp(half, 1.0 - half), text)
        };
        numbers.iter().map(place).collect()
    }

    fn label(&self, number: i64) -> String {
        let sign = match self.open {
            [true, _] if number == self.first => "≤",
            [_, true] if number == self.last => "≥",
            _ => "",
        };
        format!("{sign}{number}").replace('-', "−")
    }
}

fn length(text: &str) -> f64 {
    text.chars().count() as f64
}

fn fit(labels: &[(f64, String)], letters: f64) -> bool {
    labels.windows(2).all(|pair| {
        let [(left, before), (right, after)] = pair else { return true };
        (right - left) * letters >= (length(before) + length(after)) / 2.0 + GAP
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(numbers: WholeNumbers) -> String {
        numbers.labels(34.0).into_iter().map(|(_, text)| text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn all_numbers_are_labelled_or_round_ones() {
        let counts = WholeNumbers::counts;
        assert_eq!(words(WholeNumbers::BOBS), "1 2");
        assert_eq!(words(counts(0, 3)), "0 1 2 ≥3");
        assert_eq!(words(counts(-5, 5)), "≤−5 −4 −3 −2 −1 0 1 2 3 4 ≥5");
        assert_eq!(words(counts(0, 38)), "0 5 10 15 20 25 30 ≥38");
        assert_eq!(words(counts(0, 1_252_868)), "0 500000 ≥1252868");
        let places: Vec<f64> = counts(0, 3).labels(34.0).into_iter().map(|(at, _)| at).collect();
        assert_eq!(places, [0.125, 0.375, 0.625, 0.875]);
    }

    #[test]
    fn every_number_has_an_equal_step() {
        let turns = WholeNumbers::counts(-1, 2);
        let along: Vec<i64> = (0..=8).map(|k| turns.at(f64::from(k) / 8.0)).collect();
        assert_eq!(along, [-1, -1, 0, 0, 1, 1, 2, 2, 2]);
    }
}
