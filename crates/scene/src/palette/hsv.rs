//! Hue, saturation and value: for the names of colours, and as gradient files have them, each in
//! [0, 1].

/// Returns the hue of a colour in degrees, with red at 0 and green at 120; its channels may have any
/// scale. A grey has the hue 0.
pub fn hue_deg([r, g, b]: [f64; 3]) -> f64 {
    let most = r.max(g).max(b);
    let chroma = most - r.min(g).min(b);
    if chroma <= 0.0 {
        return 0.0;
    }
    let sixth = if most == r {
        ((g - b) / chroma).rem_euclid(6.0)
    } else if most == g {
        (b - r) / chroma + 2.0
    } else {
        (r - g) / chroma + 4.0
    };
    60.0 * sixth
}

/// Returns hue, saturation and value of a colour.
pub(super) fn hsv_of(rgb: [f64; 3]) -> [f64; 3] {
    let [most, least] = [f64::max, f64::min].map(|pick| pick(pick(rgb[0], rgb[1]), rgb[2]));
    let saturation = if most > least { (most - least) / most } else { 0.0 };
    [hue_deg(rgb) / 360.0, saturation, most]
}

/// Returns the colour of a hue, which may lie outside [0, 1], a saturation and a value.
pub(super) fn rgb_of([hue, saturation, value]: [f64; 3]) -> [f64; 3] {
    [5.0, 3.0, 1.0].map(|shift| {
        let k = (shift + 6.0 * hue).rem_euclid(6.0);
        value - value * saturation * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        for colour in [[1.0, 0.0, 0.0], [0.2, 0.4, 0.6], [0.9, 0.3, 0.5], [0.25; 3]] {
            let back = rgb_of(hsv_of(colour));
            let error = (0..3).map(|i| (back[i] - colour[i]).abs()).fold(0.0, f64::max);
            assert!(error < 1e-12, "{colour:?} {back:?}");
        }
        assert_eq!(hsv_of([0.0, 0.0, 1.0]), [2.0 / 3.0, 1.0, 1.0]);
    }
}
