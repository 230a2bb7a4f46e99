//! A legend in the corner of a picture, which explains its colours, with units.

use super::inset::{Corner, Inset, InsetDrawing, LETTER_WIDTH};
use flipmap_scene::SceneError;
use flipmap_scene::palette::{AnswerColours, BarLabels, FAILED, Ground, LegendTitle, Rgb};
use flipmap_scene::question::QuestionName;

/// Length of the bar in letters.
const BAR_LETTERS: f32 = 34.0;
/// Colour of the frames around colours that may be as dark as the legend.
const FRAME: Rgb = [0x90; 3];
/// The setting that asks for a legend, and what it needs.
const SETTING: (&str, &str) = ("legend", "the legend needs a picture of at least 320x160 pixels");

/// Creates the legend of the answers to a question, in the lower left corner of a picture of `size`
/// pixels; refuses a picture with too little room.
pub(crate) fn legend(
    colours: &AnswerColours,
    ask: QuestionName,
    size: [u32; 2],
) -> Result<Inset, SceneError> {
    let mut drawing = InsetDrawing::new(BAR_LETTERS, size);
    if colours.is_square() {
        square(&mut drawing, colours);
    } else {
        bar(&mut drawing, colours, ask);
    }
    statuses(&mut drawing, colours.ground(), ask);
    drawing.placed(Corner::Left, size, SETTING)
}

/// Draws the bar of a quantity with its name above and values below.
fn bar(drawing: &mut InsetDrawing, colours: &AnswerColours, ask: QuestionName) {
    let (left, length, letter) = (drawing.left(), drawing.length(), drawing.letter);
    let top = (drawing.next + 1.4 * letter).round();
    drawing.fill([left.round(), top], [length, 1.2 * letter], |[x, _]| colours.colour_along(x));
    let below = top + 1.5 * letter;
    let LegendTitle { name, unit } = colours.title(ask);
    let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
    if let Some(labels) = colours.step_labels(f64::from(BAR_LETTERS)) {
        drawing.write(&format!("{name}{unit}"), left, drawing.next, 0.0);
        for (place, label) in labels {
            drawing.write(&label, left + length * place as f32, below, 0.5);
        }
    } else {
        let BarLabels { from, ticks } = colours.bar_labels();
        let from = from.map_or(String::new(), |from| format!(" − {from}"));
        drawing.write(&format!("{name}{from}{unit}"), left, drawing.next, 0.0);
        for (place, label) in ticks {
            let share = f32::from(place) / 1000.0;
            // The first and the last label stay over the bar.
            let align = if share < 0.04 {
                0.0
            } else if share > 0.96 {
                1.0
            } else {
                0.5
            };
            drawing.write(&label, left + length * share, below, align);
        }
    }
    drawing.next = top + 3.1 * letter;
}

/// Draws the square of two angles with its axes' names.
fn square(drawing: &mut InsetDrawing, colours: &AnswerColours) {
    let (left, letter) = (drawing.left(), drawing.letter);
    let side = 9.0 * letter;
    let top = drawing.next.round();
    drawing.fill([left.round(), top], [side, side], |place| colours.colour_in_square(place));
    let beside = left + side + 0.8 * letter;
    drawing.write("across: θ1", beside, top, 0.0);
    drawing.write("up: θ2", beside, top + 1.4 * letter, 0.0);
    drawing.write("−π to π", beside, top + 2.8 * letter, 0.0);
    drawing.next = top + side + 0.7 * letter;
}

/// Draws the colours of pixels without an answer, each in a frame.
fn statuses(drawing: &mut InsetDrawing, ground: Ground, ask: QuestionName) {
    let [_, without] = ask.kind().counted;
    let (letter, mut x) = (drawing.letter, drawing.left());
    let Ground { unflipped, forbidden, .. } = ground;
    for (colour, words) in [(unflipped, without), (forbidden, "forbidden"), (FAILED, "failed")] {
        let [left, top] = [x.round(), drawing.next.round()];
        drawing.fill([left, top], [letter, letter], |_| FRAME);
        drawing.fill([left + 1.0, top + 1.0], [letter - 2.0, letter - 2.0], |_| colour);
        x += 1.4 * letter;
        drawing.write(words, x, drawing.next - 0.1 * letter, 0.0);
        x += (words.chars().count() as f32 + 1.5) * LETTER_WIDTH * letter;
    }
    drawing.next += 1.7 * letter;
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::palette::Tint;
    use flipmap_scene::{PictureTable, QuestionSettings, Scene};

    fn legend_of(ask: QuestionName, size: [u32; 2]) -> Result<Inset, SceneError> {
        let question = QuestionSettings { ask, ..QuestionSettings::default() };
        let scene = Scene { question, ..Scene::default() };
        let colours = AnswerColours::new(&scene, &PictureTable::default())?;
        legend(&colours, ask, size)
    }

    #[test]
    fn it_lies_in_the_corner_and_nowhere_else() {
        let size = [400, 300];
        let legend = legend_of(QuestionName::Flip, size).unwrap();
        let ground = [10.0, 200.0, 30.0];
        let changed = |x, y| legend.over(ground, x, y) != ground;
        let pixels = (0..300).flat_map(|y| (0..400).map(move |x| (x, y)));
        let inside: Vec<_> = pixels.filter(|&(x, y)| changed(x, y)).collect();
        assert!(inside.iter().all(|&(x, y)| x < 300 && y > 180), "the lower left");
        assert!(inside.len() > 5000);
        // Grey as the letters' edges are, and no colour of the palette.
        let is_ink = |[r, g, b]: Tint| (r - b).abs() < 30.0 && (g - b).abs() < 30.0 && r > 120.0;
        let ink = inside.iter().filter(|&&(x, y)| is_ink(legend.over(ground, x, y))).count();
        assert!(ink > 150, "there are words: {ink}");
    }

    #[test]
    fn a_bar_runs_through_the_palette_and_two_angles_have_a_square() {
        let colours_seen = |ask| {
            let legend = legend_of(ask, [400, 300]).unwrap();
            let solid = legend.pixels.iter().filter(|(_, cover)| *cover == 1.0);
            solid.map(|(colour, _)| *colour).collect::<std::collections::HashSet<_>>().len()
        };
        assert!((100..400).contains(&colours_seen(QuestionName::Flip)));
        assert!(colours_seen(QuestionName::State) > 2000);
    }

    #[test]
    fn a_bar_of_counts_has_one_colour_for_each() {
        let rows = |ask| {
            let Inset { size, pixels, .. } = legend_of(ask, [400, 300]).unwrap();
            // Through the middle of the bar, without the margins beside it.
            let row = &pixels[(28 * size[0]) as usize..(29 * size[0]) as usize];
            let bar: Vec<_> = row.iter().filter(|(_, cover)| *cover == 1.0).collect();
            1 + bar.windows(2).filter(|pair| pair[0].0 != pair[1].0).count()
        };
        assert_eq!(rows(QuestionName::First), 2);
        // 0 to 38 passes in 30 s.
        assert_eq!(rows(QuestionName::Flips), 39);
        assert!(rows(QuestionName::Flip) > 100, "the test can fail");
    }

    #[test]
    fn a_picture_without_room_is_refused() {
        let refused = legend_of(QuestionName::Flip, [200, 200]).unwrap_err().to_string();
        assert!(refused.contains("`legend` is set for a picture of 200x200"), "{refused}");
        assert!(
            legend_of(QuestionName::State, [320, 160]).is_ok()
                && legend_of(QuestionName::Flip, [320, 160]).is_ok()
        );
    }
}
