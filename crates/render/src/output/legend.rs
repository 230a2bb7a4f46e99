//! A legend in the corner of a picture, which explains its colours, with units.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use super::paint::{blended, mixed};
use flipmap_scene::SceneError;
use flipmap_scene::palette::{
    AnswerColours, BarLabels, FAILED, Ground, LegendTitle, Rgb, Tint, rounded, tint_of,
};
use flipmap_scene::question::QuestionName;

/// The font of all words.
const FONT: &[u8] = epaint_default_fonts::HACK_REGULAR;
/// Smallest height of letters in pixels; in tall pictures it is `LETTER_SHARE` of the picture's
/// height.
const MIN_LETTER: f32 = 11.0;
const LETTER_SHARE: f32 = 1.0 / 50.0;
/// Length of the bar in letters.
const BAR_LETTERS: f32 = 34.0;
/// Share of the picture's colour that shows through the legend's background.
const SHINE: f32 = 0.3;
/// Colour of the words.
const INK: Rgb = [0xff; 3];

/// A legend, ready to be laid over a picture.
#[derive(Clone, Debug)]
pub struct Legend {
    /// Column and row of the upper left corner.
    corner: [u32; 2],
    size: [u32; 2],
    /// Colour of each pixel, and how much of the picture it covers, row by row.
    pixels: Vec<(Rgb, f32)>,
}

impl Legend {
    /// Creates the legend of the answers to a question, in the lower left corner of a picture of
    /// `size` pixels; refuses a picture with too little room.
    pub(crate) fn new(
        colours: &AnswerColours,
        ask: QuestionName,
        size: [u32; 2],
    ) -> Result<Self, SceneError> {
        let letter = (size[1] as f32 * LETTER_SHARE).max(MIN_LETTER).round();
        let mut sheet = Sheet::new(letter);
        if colours.is_square() {
            sheet.square(colours);
        } else {
            sheet.bar(colours, ask);
        }
        sheet.statuses(colours.ground(), ask);
        sheet.placed(size)
    }

    /// Lays the legend over a whole picture `width` pixels wide, three bytes a pixel, rows from the
    /// top.
    pub(crate) fn lay_over(&self, rgb: &mut [u8], width: u32) {
        for (row, bytes) in (0..).zip(rgb.chunks_mut(3 * width as usize)) {
            for (column, pixel) in (0..).zip(bytes.as_chunks_mut::<3>().0) {
                *pixel = rounded(self.over(tint_of(*pixel), column, row));
            }
        }
    }

    /// Returns the picture's colour at a pixel with the legend laid over it.
    pub(super) fn over(&self, tint: Tint, column: u32, row: u32) -> Tint {
        let [x, y] = [column.wrapping_sub(self.corner[0]), row.wrapping_sub(self.corner[1])];
        if x >= self.size[0] || y >= self.size[1] {
            return tint;
        }
        let (above, cover) = self.pixels[(y * self.size[0] + x) as usize];
        mixed(tint, tint_of(above), cover)
    }
}

/// Colour of the frames around colours that may be as dark as the legend.
const FRAME: Rgb = [0x90; 3];

/// The pixels of a legend while it is drawn; it grows downwards.
struct Sheet {
    letter: f32,
    width: u32,
    rows: Vec<Vec<(Rgb, f32)>>,
    /// Upper edge of the next element.
    next: f32,
}

impl Sheet {
    fn new(letter: f32) -> Self {
        let width = ((BAR_LETTERS + 4.0) * letter * 0.6).ceil() as u32;
        Sheet { letter, width, rows: Vec::new(), next: 0.6 * letter }
    }

    /// Returns the left edge of all elements.
    fn left(&self) -> f32 {
        1.2 * self.letter
    }

    fn length(&self) -> f32 {
        self.width as f32 - 2.0 * self.left()
    }

    fn pixel(&mut self, x: f32, y: f32) -> Option<&mut (Rgb, f32)> {
        if x < 0.0 || y < 0.0 || x >= self.width as f32 {
            return None;
        }
        let ground = ([0; 3], 1.0 - SHINE);
        while self.rows.len() <= y as usize {
            self.rows.push(vec![ground; self.width as usize]);
        }
        self.rows[y as usize].get_mut(x as usize)
    }

    /// Fills a rectangle. `colour` takes the place in it, from 0 to 1 along both axes, y up.
    fn fill(&mut self, corner: [f32; 2], size: [f32; 2], colour: impl Fn([f64; 2]) -> Rgb) {
        let [columns, rows] = size.map(|side| side.round() as u32);
        for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
            let share = |k: u32, of: u32| (f64::from(k) + 0.5) / f64::from(of);
            let colour = colour([share(x, columns), 1.0 - share(y, rows)]);
            let [x, y] = [corner[0] + x as f32, corner[1] + y as f32];
            if let Some(pixel) = self.pixel(x, y) {
                *pixel = (colour, 1.0);
            }
        }
    }

    /// Writes words with their middle, left or right edge at `x` (`align` 0.5, 0 or 1).
    fn write(&mut self, words: &str, x: f32, y: f32, align: f32) {
        let Ok(font) = FontRef::try_from_slice(FONT) else { return };
        let font = font.as_scaled(PxScale::from(self.letter));
        let length: f32 = words.chars().map(|c| font.h_advance(font.glyph_id(c))).sum();
        let mut at = x - align * length;
        for letter in words.chars() {
            let id = font.glyph_id(letter);
            let glyph: Glyph =
                id.with_scale_and_position(self.letter, point(at, y + font.ascent()));
            at += font.h_advance(id);
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|column, row, cover| {
                let (x, y) = (corner.x + column as f32, corner.y + row as f32);
                if let Some(pixel) = self.pixel(x, y) {
                    *pixel = (blended(pixel.0, INK, f64::from(cover)), pixel.1.max(cover));
                }
            });
        }
    }

    /// Draws the bar of a quantity with its name above and values below.
    fn bar(&mut self, colours: &AnswerColours, ask: QuestionName) {
        let (left, length, letter) = (self.left(), self.length(), self.letter);
        let top = (self.next + 1.4 * letter).round();
        self.fill([left.round(), top], [length, 1.2 * letter], |[x, _]| colours.colour_along(x));
        let below = top + 1.5 * letter;
        let LegendTitle { name, unit } = colours.title(ask);
        let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
        if let Some(labels) = colours.step_labels(f64::from(BAR_LETTERS)) {
            self.write(&format!("{name}{unit}"), left, self.next, 0.0);
            for (place, label) in labels {
                self.write(&label, left + length * place as f32, below, 0.5);
            }
        } else {
            let BarLabels { from, ticks } = colours.bar_labels();
            let from = from.map_or(String::new(), |from| format!(" − {from}"));
            self.write(&format!("{name}{from}{unit}"), left, self.next, 0.0);
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
                self.write(&label, left + length * share, below, align);
            }
        }
        self.next = top + 3.1 * letter;
    }

    /// Draws the square of two angles with its axes' names.
    fn square(&mut self, colours: &AnswerColours) {
        let (left, letter) = (self.left(), self.letter);
        let side = 9.0 * letter;
        let top = self.next.round();
        self.fill([left.round(), top], [side, side], |place| colours.colour_in_square(place));
        let beside = left + side + 0.8 * letter;
        self.write("across: θ1", beside, top, 0.0);
        self.write("up: θ2", beside, top + 1.4 * letter, 0.0);
        self.write("−π to π", beside, top + 2.8 * letter, 0.0);
        self.next = top + side + 0.7 * letter;
    }

    /// Draws the colours of pixels without an answer, each in a frame.
    fn statuses(&mut self, ground: Ground, ask: QuestionName) {
        let [_, without] = ask.kind().counted;
        let (letter, mut x) = (self.letter, self.left());
        let Ground { unflipped, forbidden, .. } = ground;
        for (colour, words) in [(unflipped, without), (forbidden, "forbidden"), (FAILED, "failed")]
        {
            let [left, top] = [x.round(), self.next.round()];
            self.fill([left, top], [letter, letter], |_| FRAME);
            self.fill([left + 1.0, top + 1.0], [letter - 2.0, letter - 2.0], |_| colour);
            x += 1.4 * letter;
            self.write(words, x, self.next - 0.1 * letter, 0.0);
            x += (words.chars().count() as f32 + 1.5) * 0.6 * letter;
        }
        self.next += 1.7 * letter;
    }

    /// Places the sheet in the lower left corner of a picture.
    fn placed(mut self, size: [u32; 2]) -> Result<Legend, SceneError> {
        self.pixel(0.0, self.next.ceil() - 1.0);
        let (width, height) = (self.width, self.rows.len() as u32);
        let margin = self.letter as u32;
        if width + margin > size[0] || height + margin > size[1] {
            let value = format!("set for a picture of {}x{}", size[0], size[1]);
            let range = "the legend needs a picture of at least 320x160 pixels";
            return Err(SceneError::new("legend", value, range));
        }
        let corner = [margin, size[1] - margin - height];
        let pixels = self.rows.into_iter().flatten().collect();
        Ok(Legend { corner, size: [width, height], pixels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::{PictureTable, QuestionSettings, Scene};

    fn legend(ask: QuestionName, size: [u32; 2]) -> Result<Legend, SceneError> {
        let question = QuestionSettings { ask, ..QuestionSettings::default() };
        let scene = Scene { question, ..Scene::default() };
        let colours = AnswerColours::new(&scene, &PictureTable::default())?;
        Legend::new(&colours, ask, size)
    }

    #[test]
    fn it_lies_in_the_corner_and_nowhere_else() {
        let size = [400, 300];
        let legend = legend(QuestionName::Flip, size).unwrap();
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
            let legend = legend(ask, [400, 300]).unwrap();
            let solid = legend.pixels.iter().filter(|(_, cover)| *cover == 1.0);
            solid.map(|(colour, _)| *colour).collect::<std::collections::HashSet<_>>().len()
        };
        assert!((100..400).contains(&colours_seen(QuestionName::Flip)));
        assert!(colours_seen(QuestionName::State) > 2000);
    }

    #[test]
    fn a_bar_of_counts_has_one_colour_for_each() {
        let rows = |ask| {
            let Legend { size, pixels, .. } = legend(ask, [400, 300]).unwrap();
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
        let refused = legend(QuestionName::Flip, [200, 200]).unwrap_err().to_string();
        assert!(refused.contains("`legend` is set for a picture of 200x200"), "{refused}");
        assert!(
            legend(QuestionName::State, [320, 160]).is_ok()
                && legend(QuestionName::Flip, [320, 160]).is_ok()
        );
    }
}
