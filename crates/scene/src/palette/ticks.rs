//! Round values along a bar of colours.

/// Labels of a bar at round values. If telling them apart would take too many digits, the labels
/// are differences from one value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BarLabels {
    /// The value that is subtracted from the others, if the labels are differences.
    pub from: Option<String>,
    /// The labels, without the unit, each with its place along the bar in thousandths.
    pub ticks: Vec<(u16, String)>,
}

/// Least distance of two labels, in thousandths of the bar.
const APART: u16 = 150;
/// Ratio of the last value to the first from which labels are 1, 2 or 5 times a power of ten.
const DECADES_FROM: f64 = 4.0;
/// Number of intervals into which round steps divide a narrow range, about.
const INTERVALS: f64 = 4.0;
/// Most significant digits of a label; beyond that, labels are differences.
const MOST_DIGITS: f64 = 6.0;
/// Share of a step by which rounding may move a value.
const ROUNDING: f64 = 1e-6;

/// Returns round labels of a bar whose values rise along it; `value` takes a share from 0 to 1.
pub(super) fn round_labels(value: impl Fn(f64) -> f64) -> BarLabels {
    let [first, last] = [value(0.0), value(1.0)];
    let place = |wanted: f64| (1000.0 * share_of(&value, wanted)).round() as u16;
    if first > 0.0 && last / first >= DECADES_FROM {
        let ticks = sparse(decades(first, last).map(|round| (place(round), text(round, 3))));
        return BarLabels { from: None, ticks };
    }
    let step = round_step((last - first) / INTERVALS);
    if step <= 0.0 || !step.is_finite() {
        return BarLabels { from: None, ticks: vec![(0, text(first, 6))] };
    }
    let digits = (first.abs().max(last.abs()) / step).log10().ceil() + 1.0;
    if digits > MOST_DIGITS {
        let from = (first / step).ceil() * step;
        let steps = (0..=5).map(|k| (k, from + f64::from(k) * step));
        let within = steps.take_while(|(_, wanted)| *wanted <= last);
        let label = |k: i32| match k {
            0 => "0".to_string(),
            k => format!("+{:.0e}", f64::from(k) * step).replace('-', "−"),
        };
        let ticks = sparse(within.map(|(k, wanted)| (place(wanted), label(k))));
        return BarLabels { from: Some(text(from, 13)), ticks };
    }
    let begin = (first / step - ROUNDING).ceil() as i64;
    let end = (last / step + ROUNDING).floor() as i64;
    let ticks = (begin..=end).map(|k| k as f64 * step);
    BarLabels {
        from: None,
        ticks: sparse(ticks.map(|round| (place(round), text(round, digits as i32)))),
    }
}

/// Returns the labels of a bar whose colours are equal steps between these values.
pub(super) fn edge_labels(edges: &[f64]) -> BarLabels {
    let steps = (edges.len() - 1) as f64;
    let place = |edge: usize| (1000.0 * edge as f64 / steps).round() as u16;
    let labels = edges.iter().enumerate().map(|(edge, value)| (place(edge), text(*value, 3)));
    BarLabels { from: None, ticks: sparse(labels) }
}

/// Returns 1, 5 and 2 times the powers of ten between two positive values, the roundest first.
fn decades(first: f64, last: f64) -> impl Iterator<Item = f64> {
    let exponents = first.log10().floor() as i32..=last.log10().ceil() as i32;
    let all = [1.0, 5.0, 2.0].into_iter().flat_map(move |mantissa| {
        exponents.clone().map(move |exponent| mantissa * 10f64.powi(exponent))
    });
    all.filter(move |round| (first..=last).contains(round))
}

/// Leaves out labels that lie too close to earlier ones, and sorts the rest by place.
fn sparse(labels: impl Iterator<Item = (u16, String)>) -> Vec<(u16, String)> {
    let mut kept: Vec<(u16, String)> = Vec::new();
    for (place, label) in labels {
        if kept.iter().all(|(other, _)| other.abs_diff(place) >= APART) {
            kept.push((place, label));
        }
    }
    kept.sort_unstable_by_key(|(place, _)| *place);
    kept
}

/// Returns the smallest of 1, 2, 5 and 10 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|s| *s >= step * (1.0 - ROUNDING))
        .unwrap_or(0.0)
}

/// Returns the share of a bar at which its rising values reach one.
fn share_of(value: &impl Fn(f64) -> f64, wanted: f64) -> f64 {
    let (mut below, mut above) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (below + above);
        *(if value(middle) < wanted { &mut below } else { &mut above }) = middle;
    }
    above
}

/// Formats a value to `count` significant digits.
pub(super) fn text(value: f64, count: i32) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let last = f64::from(count - 1) - value.abs().log10().floor();
    let decimals = last.clamp(0.0, 15.0) as usize;
    let unit = 10f64.powf(-last);
    let rounded = if last < 0.0 { (value / unit).round() * unit } else { value };
    let text = format!("{rounded:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(value: impl Fn(f64) -> f64) -> (Option<String>, String) {
        let BarLabels { from, ticks } = round_labels(value);
        assert!(ticks.windows(2).all(|pair| pair[1].0 - pair[0].0 >= APART), "{ticks:?}");
        (from, ticks.into_iter().map(|(_, label)| label).collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn values_are_short() {
        let cases =
            [(0.319, "0.319"), (30.0, "30"), (-1.5, "−1.5"), (12345.0, "12300"), (0.0, "0")];
        for (value, short) in cases {
            assert_eq!(text(value, 3), short);
        }
    }

    #[test]
    fn a_wide_range_has_round_values_in_their_places() {
        let home = |share: f64| 0.319 * (30.0f64 / 0.319).powf(share);
        assert_eq!(told(home), (None, "0.5 1 2 5 10 20".to_string()).to_owned());
        let BarLabels { ticks, .. } = round_labels(home);
        let (place, label) = &ticks[1];
        let secs = home(f64::from(*place) / 1000.0);
        assert!(label == "1" && (secs - 1.0).abs() < 0.01, "{label} at {secs}");
        assert_eq!(told(|share| 1e-3 * 1e6f64.powf(share)).1, "0.001 0.01 0.1 1 10 100 1000");
    }

    #[test]
    fn steps_are_labelled_where_they_begin_and_end() {
        let ticks = edge_labels(&[0.31927, 3.1927, 31.927, 319.27, 3192.7]).ticks;
        let wanted = [(0, "0.319"), (250, "3.19"), (500, "31.9"), (750, "319"), (1000, "3190")];
        assert_eq!(ticks, wanted.map(|(place, label)| (place, label.to_string())));
        let many: Vec<f64> = (1..=33).map(f64::from).collect();
        assert!(edge_labels(&many).ticks.len() < 8, "names do not cover each other");
    }

    #[test]
    fn values_of_a_narrow_view_are_told_apart() {
        assert_eq!(told(|share| 1.0 + 2.0 * share), (None, "1 1.5 2 2.5 3".to_string()));
        let (from, labels) = told(|share| 59.99 + 0.008 * share);
        assert_eq!((from, labels.as_str()), (None, "59.99 59.992 59.994 59.996 59.998"));
        let (from, labels) = told(|share| 60.0 + 4e-9 * share);
        assert_eq!(from, Some("60".to_string()));
        assert!(labels.starts_with("0 +1e−9 +2e−9"), "{labels}");
        assert_eq!(told(|share| -3.0 + 6.0 * share).1, "−2 0 2");
        assert_eq!(told(|_| 2.5).1, "2.5", "a bar with one value");
    }
}
