//! The colour space Oklab (Ottosson, *A perceptual color space for image processing*, 2020), in which
//! equal distances look about equally large.

use super::{Tint, channel_of};

/// A colour as lightness, from 0 to 1, and two opponent channels.
pub(super) type Oklab = [f64; 3];

/// Converts Oklab to linear light, which lies outside 0 to 1 where sRGB has no such colour.
pub(super) fn light_of_oklab([lightness, a, b]: Oklab) -> [f64; 3] {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// Converts Oklab to sRGB, and clips colours outside its gamut.
pub(super) fn from_oklab(colour: Oklab) -> Tint {
    light_of_oklab(colour).map(channel_of)
}
