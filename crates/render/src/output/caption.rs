//! A caption in the lower right corner of a picture: a bar of round length, and the time that the
//! picture shows.

use super::inset::{Corner, INK, Inset, InsetDrawing};
use flipmap_numbers::number_text::{fixed, significant};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{PixelAxes, Scene, SceneError};

/// Number of letters in a row.
const LETTERS: f32 = 16.0;
/// The setting that asks for a caption, and what it needs.
const SETTING: (&str, &str) = ("caption", "the caption needs a picture of at least 160x64 pixels");

/// Creates the caption of a scene's picture of `size` pixels, whose flips are shown up to
/// `clock_secs` if it is a frame of a film with a clock. Refuses a picture with too little room.
pub(crate) fn caption(
    scene: &Scene,
    clock_secs: Option<f64>,
    size: [u32; 2],
) -> Result<Inset, SceneError> {
    let mut drawing = InsetDrawing::new(LETTERS, size);
    let (left, length, letter) = (drawing.left(), drawing.length(), drawing.letter);
    if let Some(secs) = clock_secs.or_else(|| state_secs(scene)) {
        drawing.write(&format!("t = {} s", fixed(secs, 2)), left, drawing.next, 0.0);
        drawing.next += 1.4 * letter;
    }
    if let Some((per_pixel, unit)) = scale(&PixelAxes::new(scene, size)) {
        let whole = round_down(per_pixel * f64::from(length));
        let words = format!("{} {unit}", significant(whole, 1));
        drawing.write(&words, left, drawing.next, 0.0);
        let top = (drawing.next + 1.5 * letter).round();
        let bar = (whole / per_pixel) as f32;
        drawing.fill([left.round(), top], [bar, (0.2 * letter).round().max(2.0)], |_| INK);
        drawing.next = top + 0.9 * letter;
    }
    drawing.placed(Corner::Right, size, SETTING)
}

/// Returns the moment of the states that a scene asks for, in s.
fn state_secs(scene: &Scene) -> Option<f64> {
    (scene.question.ask == QuestionName::State).then(|| scene.question.end_secs())
}

/// Returns the length of a pixel along the columns with its unit; none where a rotated view mixes
/// units.
fn scale(axes: &PixelAxes) -> Option<(f64, &'static str)> {
    let [along, across] = axes.axes.map(|axis| axis.unit());
    let is_one = axes.right[1] == 0.0 || along == across;
    is_one.then(|| (axes.right[0].hypot(axes.right[1]), along))
}

/// Returns the largest of 1, 2 and 5 times powers of ten that is at most `length`.
fn round_down(length: f64) -> f64 {
    let power = length.log10().floor();
    let mantissa = length / 10f64.powf(power);
    let round = [5.0, 2.0, 1.0].into_iter().find(|round| mantissa >= *round).unwrap_or(1.0);
    // Parsed, so that 2e-5 is the nearest number to it.
    format!("{round}e{power}").parse().unwrap_or(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::{Plane, QuestionSettings, View};

    #[test]
    fn bars_have_round_lengths() {
        for (length, round) in
            [(1.0, 1.0), (1.99, 1.0), (2.5e-7, 2e-7), (0.0999, 0.05), (7e30, 5e30)]
        {
            assert_eq!(round_down(length), round, "{length}");
        }
    }

    /// Returns the columns of the longest white run in any row of a caption.
    fn bar(inset: &Inset) -> usize {
        let rows = inset.pixels.chunks(inset.size[0] as usize);
        let white = |row: &[([u8; 3], f32)]| {
            row.split(|(colour, _)| *colour != INK).map(<[_]>::len).max().unwrap_or(0)
        };
        rows.map(white).max().unwrap_or(0)
    }

    #[test]
    fn the_bar_is_as_long_as_it_says_and_in_the_right_corner() {
        for (width, secs) in [("6.4", None), ("3e-40", Some(1.25))] {
            let view = View { width: width.into(), ..View::default() };
            let scene = Scene { view, ..Scene::default() };
            let inset = caption(&scene, secs, [640, 400]).unwrap();
            let per_pixel = width.parse::<f64>().unwrap() / 640.0;
            let length = bar(&inset) as f64 * per_pixel;
            assert!((length / round_down(length * 1.005) - 1.0).abs() < 0.03, "{length}");
            assert!(inset.corner[0] > 450 && inset.corner[1] > 300, "{:?}", inset.corner);
        }
    }

    #[test]
    fn a_caption_covers_no_legend() {
        let home = Scene::default();
        let legend = |width: u32| Inset {
            corner: [10, 100],
            size: [width, 80],
            pixels: vec![([0; 3], 1.0); (80 * width) as usize],
        };
        let alone = || caption(&home, None, [320, 200]).unwrap();
        assert_eq!(alone().clear_of(Some(&legend(60))).corner, alone().corner, "beside it");
        let above = alone().clear_of(Some(&legend(260)));
        assert_eq!(above.corner[0], alone().corner[0]);
        assert!(above.corner[1] + above.size[1] < 100, "{:?}", above.corner);
    }

    #[test]
    fn a_clock_has_a_row_of_its_own_and_small_pictures_no_room() {
        let home = Scene::default();
        let rows = |scene: &Scene, secs| caption(scene, secs, [640, 400]).unwrap().size[1];
        assert!(rows(&home, Some(3.0)) > rows(&home, None) + 10);
        let question = QuestionSettings { ask: QuestionName::State, ..QuestionSettings::default() };
        assert_eq!(rows(&Scene { question, ..home.clone() }, None), rows(&home, Some(3.0)));
        let refused = caption(&home, None, [100, 400]).unwrap_err().to_string();
        assert!(refused.contains("`caption` is set for a picture of 100x400"), "{refused}");
    }

    #[test]
    fn a_rotated_view_of_two_units_has_no_bar() {
        let plane = Plane { kind: "first".parse().unwrap(), ..Plane::default() };
        let view = View { rotate: 30.0, ..View::default() };
        let turned = Scene { plane: plane.clone(), view, ..Scene::default() };
        assert!(scale(&PixelAxes::new(&turned, [640, 400])).is_none());
        let upright = Scene { plane, ..Scene::default() };
        assert_eq!(scale(&PixelAxes::new(&upright, [640, 400])).unwrap().1, "rad");
    }
}
