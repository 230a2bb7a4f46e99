//! Names colours in plain words, for texts that must be true for any palette.

use flipmap_scene::palette::{Rgb, hue_deg};

/// Upper ends of the hues with each name, in degrees, ascending.
const HUES: [(f64, &str); 9] = [
    (15.0, "red"),
    (45.0, "orange"),
    (70.0, "yellow"),
    (165.0, "green"),
    (195.0, "teal"),
    (252.0, "blue"),
    (290.0, "violet"),
    (345.0, "pink"),
    (360.0, "red"),
];
/// Difference between the largest and the smallest channel below which a colour looks grey.
const MIN_CHROMA: f64 = 24.0;

/// Returns a colour in one to three words, such as "dark blue".
pub(super) fn colour_words(rgb: Rgb) -> String {
    let [r, g, b] = rgb.map(f64::from);
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    let chroma = most - least;
    if most < 36.0 {
        return if most < 6.0 { "black" } else { "nearly black" }.to_string();
    }
    if chroma < MIN_CHROMA {
        let steps = [(90.0, "dark grey"), (170.0, "grey"), (242.0, "light grey")];
        let step = steps.into_iter().find(|(up_to, _)| most < *up_to);
        return step.map_or("white", |(_, words)| words).to_string();
    }
    let degrees = hue_deg([r, g, b]);
    let hue = HUES.into_iter().find(|(up_to, _)| degrees <= *up_to);
    let hue = hue.map_or("red", |(_, name)| name);
    let depth = match (most, least) {
        (most, _) if most < 140.0 => "dark ",
        (_, least) if least > 140.0 => "light ",
        _ => "",
    };
    format!("{depth}{hue}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::palette::{Ground, Palette};

    #[test]
    fn colours_have_the_names_that_people_give_them() {
        for (rgb, words) in [
            ([0, 0, 0], "black"),
            (Ground::DARK.unflipped, "nearly black"),
            (Ground::DARK.forbidden, "dark grey"),
            (Ground::DARK.curve, "light grey"),
            (Ground::LIGHT.unflipped, "white"),
            ([255, 0, 0], "red"),
            ([200, 0, 20], "red"),
            ([255, 255, 0], "yellow"),
            ([0, 158, 115], "green"),
            ([86, 180, 233], "blue"),
            ([255, 160, 190], "light pink"),
        ] {
            assert_eq!(colour_words(rgb), words, "{rgb:?}");
        }
        let iris = Palette::named("iris").unwrap();
        assert_eq!(
            [0.0, 0.6, 0.9].map(|x| colour_words(iris.colour(x))),
            ["dark blue", "pink", "orange"]
        );
        // Checks that every colour of every palette has a name.
        for name in Palette::names() {
            let palette = Palette::named(name).unwrap();
            assert!(
                (0..256).all(|k| !colour_words(palette.colour(f64::from(k) / 255.0)).is_empty())
            );
        }
    }
}
