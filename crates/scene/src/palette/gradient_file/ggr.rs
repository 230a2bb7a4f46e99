//! GIMP's gradients: segments between two colours, each with a middle and a way from one to the
//! other (GIMP's documentation of the format, "GIMP gradient file format").

use std::f64::consts::{FRAC_PI_2, PI};

use super::super::Rgb;
use super::super::gradient::{Stop, colour_at};
use super::super::hsv::{hsv_of, rgb_of};
use super::{GradientFileError, bad_line, lines};

/// A segment from one place to the next.
struct Segment {
    left: f64,
    middle: f64,
    right: f64,
    from: [f64; 3],
    to: [f64; 3],
    blend: u32,
    colouring: u32,
}

/// Number of steps of a segment that is not straight.
const STEPS: u32 = 64;
const WANTED: &str = "a segment: left, middle, right, two colours of four numbers from 0 to 1, and \
                      the two types 0 to 5 and 0 to 2";

/// Reads a gradient.
pub(super) fn read(text: &str) -> Result<Vec<Stop>, GradientFileError> {
    let mut rest = lines(text, &["Name:"]);
    if rest.next().is_none_or(|(_, first)| first != "GIMP Gradient") {
        return Err(GradientFileError::Format("does not begin with 'GIMP Gradient'"));
    }
    let announced = rest.next().and_then(|(_, text)| text.parse::<usize>().ok());
    let announced =
        announced.ok_or(GradientFileError::Format("does not say how many segments it has"))?;
    let mut stops: Vec<Stop> = Vec::new();
    let mut found = 0;
    for line in rest {
        let begun = stops.last().map_or(0.0, |stop| stop.place);
        let segment = Segment::read(line.1).filter(|segment| segment.left >= begun - NEAR);
        let segment = segment.ok_or_else(|| bad_line(line, WANTED))?;
        for stop in segment.stops() {
            if stops.last() != Some(&stop) {
                stops.push(Stop { place: stop.place.max(begun), ..stop });
            }
        }
        found += 1;
    }
    if found != announced {
        return Err(GradientFileError::Count { of_what: "segments", announced, found });
    }
    Ok(stops)
}

/// Distance by which rounding in the file may let segments overlap.
const NEAR: f64 = 1e-5;

impl Segment {
    fn read(line: &str) -> Option<Segment> {
        let numbers: Option<Vec<f64>> =
            line.split_whitespace().map(|word| word.parse().ok()).collect();
        let numbers = numbers.filter(|numbers| numbers.len() >= 13)?;
        let [left, middle, right, r0, g0, b0, _, r1, g1, b1, _, blend, colouring] =
            *numbers.first_chunk()?;
        let all_shares = numbers[..11].iter().all(|share| (-NEAR..=1.0 + NEAR).contains(share));
        let known = (0.0..=5.0).contains(&blend) && (0.0..=2.0).contains(&colouring);
        let rises = left <= middle && middle <= right;
        (all_shares && known && rises).then_some(Segment {
            left,
            middle,
            right,
            from: [r0, g0, b0],
            to: [r1, g1, b1],
            blend: blend as u32,
            colouring: colouring as u32,
        })
    }

    /// Returns the stops of the segment: three if it is straight, two if its middle is half-way.
    fn stops(&self) -> Vec<Stop> {
        let stop = |share: f64| {
            let place = self.left + share * (self.right - self.left);
            Stop { place: place.clamp(0.0, 1.0), colour: self.colour(share) }
        };
        if self.blend != 0 || self.colouring != 0 {
            return (0..=STEPS).map(|k| stop(f64::from(k) / f64::from(STEPS))).collect();
        }
        let middle = self.middle_share();
        let ends = vec![stop(0.0), stop(1.0)];
        let middle_stop = stop(middle);
        if colour_at(&ends_of_unit(&ends), middle) == middle_stop.colour {
            ends
        } else {
            vec![ends[0], middle_stop, ends[1]]
        }
    }

    fn middle_share(&self) -> f64 {
        let width = self.right - self.left;
        if width > 0.0 { (self.middle - self.left) / width } else { 0.5 }
    }

    fn colour(&self, share: f64) -> Rgb {
        let share = self.blended(share);
        let mixed = |from: f64, to: f64| from + (to - from) * share;
        let byte = |channel: f64| (255.0 * channel).round().clamp(0.0, 255.0) as u8;
        if self.colouring == 0 {
            return [0, 1, 2].map(|i| byte(mixed(self.from[i], self.to[i])));
        }
        let (from, mut to) = (hsv_of(self.from), hsv_of(self.to));
        if self.colouring == 1 && to[0] < from[0] {
            to[0] += 1.0;
        } else if self.colouring == 2 && to[0] > from[0] {
            to[0] -= 1.0;
        }
        rgb_of([0, 1, 2].map(|i| mixed(from[i], to[i]))).map(byte)
    }

    /// Returns the share of the second colour at a share of the way.
    fn blended(&self, share: f64) -> f64 {
        let middle = self.middle_share().clamp(1e-9, 1.0 - 1e-9);
        let straight = if share <= middle {
            0.5 * share / middle
        } else {
            0.5 + 0.5 * (share - middle) / (1.0 - middle)
        };
        match self.blend {
            1 => share.powf(0.5f64.ln() / middle.ln()),
            2 => ((PI * straight - FRAC_PI_2).sin() + 1.0) / 2.0,
            3 => (1.0 - (straight - 1.0).powi(2)).sqrt(),
            4 => 1.0 - (1.0 - straight * straight).sqrt(),
            5 => f64::from(straight >= 0.5),
            _ => straight,
        }
    }
}

/// Returns two stops as if they lay at 0 and 1.
fn ends_of_unit(ends: &[Stop]) -> [Stop; 2] {
    [Stop { place: 0.0, ..ends[0] }, Stop { place: 1.0, ..ends[1] }]
}
