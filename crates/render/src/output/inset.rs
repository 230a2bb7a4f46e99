//! Drawings laid over a picture: a dark, translucent panel in a lower corner, with words and bars.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use super::paint::{blended, mixed};
use flipmap_scene::SceneError;
use flipmap_scene::palette::{Rgb, Tint, rounded, tint_of};

/// The font of all words.
const FONT: &[u8] = epaint_default_fonts::HACK_REGULAR;
/// Smallest height of letters in pixels; in tall pictures it is `LETTER_SHARE` of the picture's
/// height.
const MIN_LETTER: f32 = 11.0;
const LETTER_SHARE: f32 = 1.0 / 50.0;
/// Width of a letter in heights of one.
pub(super) const LETTER_WIDTH: f32 = 0.6;
/// Share of the picture's colour that shows through an inset.
const SHINE: f32 = 0.3;
/// Colour of the words.
pub(super) const INK: Rgb = [0xff; 3];

/// A lower corner of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corner {
    Left,
    Right,
}

/// Rows between two insets one above the other.
const GAP: u32 = 4;

/// A finished drawing, ready to be laid over a picture.
#[derive(Clone, Debug)]
pub(crate) struct Inset {
    /// Column and row of the upper left corner.
    pub(super) corner: [u32; 2],
    pub(super) size: [u32; 2],
    /// Colour of each pixel, and how much of the picture it covers, row by row.
    pub(super) pixels: Vec<(Rgb, f32)>,
}

impl Inset {
    /// Returns the inset where it covers no other: above it if they lie in the same columns.
    #[must_use]
    pub(crate) fn clear_of(self, other: Option<&Inset>) -> Self {
        let overlaps = |other: &&Inset| {
            let right = |inset: &Inset| inset.corner[0] + inset.size[0];
            self.corner[0] < right(other) && other.corner[0] < right(&self)
        };
        let Some(below) = other.filter(overlaps) else { return self };
        let y = below.corner[1].saturating_sub(GAP + self.size[1]);
        Inset { corner: [self.corner[0], y], ..self }
    }

    /// Lays the inset over a whole picture `width` pixels wide, three bytes a pixel, rows from the
    /// top.
    pub(crate) fn lay_over(&self, rgb: &mut [u8], width: u32) {
        for (row, bytes) in (0..).zip(rgb.chunks_mut(3 * width as usize)) {
            for (column, pixel) in (0..).zip(bytes.as_chunks_mut::<3>().0) {
                *pixel = rounded(self.over(tint_of(*pixel), column, row));
            }
        }
    }

    /// Returns the picture's colour at a pixel with the inset laid over it.
    pub(super) fn over(&self, tint: Tint, column: u32, row: u32) -> Tint {
        let [x, y] = [column.wrapping_sub(self.corner[0]), row.wrapping_sub(self.corner[1])];
        if x >= self.size[0] || y >= self.size[1] {
            return tint;
        }
        let (above, cover) = self.pixels[(y * self.size[0] + x) as usize];
        mixed(tint, tint_of(above), cover)
    }
}

/// The pixels of an inset while it is drawn; it grows downwards.
pub(super) struct InsetDrawing {
    /// Height of letters in pixels.
    pub letter: f32,
    width: u32,
    rows: Vec<Vec<(Rgb, f32)>>,
    /// Upper edge of the next element.
    pub next: f32,
}

impl InsetDrawing {
    /// Creates a drawing with room for so many letters in a row, in a picture of `size` pixels.
    pub(super) fn new(letters: f32, size: [u32; 2]) -> Self {
        let letter = (size[1] as f32 * LETTER_SHARE).max(MIN_LETTER).round();
        let width = ((letters + 4.0) * letter * LETTER_WIDTH).ceil() as u32;
        InsetDrawing { letter, width, rows: Vec::new(), next: 0.6 * letter }
    }

    /// Returns the left edge of all elements.
    pub(super) fn left(&self) -> f32 {
        1.2 * self.letter
    }

    /// Returns the width between the edges of elements.
    pub(super) fn length(&self) -> f32 {
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
    pub(super) fn fill(
        &mut self,
        corner: [f32; 2],
        size: [f32; 2],
        colour: impl Fn([f64; 2]) -> Rgb,
    ) {
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
    pub(super) fn write(&mut self, words: &str, x: f32, y: f32, align: f32) {
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

    /// Places the drawing in a corner of a picture; refuses a picture without room, in the words of the
    /// `setting` that asked for it.
    pub(super) fn placed(
        mut self,
        corner: Corner,
        size: [u32; 2],
        (setting, range): (&'static str, &'static str),
    ) -> Result<Inset, SceneError> {
        self.pixel(0.0, self.next.ceil() - 1.0);
        let (width, height) = (self.width, self.rows.len() as u32);
        let margin = self.letter as u32;
        if width + margin > size[0] || height + margin > size[1] {
            let value = format!("set for a picture of {}x{}", size[0], size[1]);
            return Err(SceneError::new(setting, value, range));
        }
        let x = match corner {
            Corner::Left => margin,
            Corner::Right => size[0] - margin - width,
        };
        let pixels = self.rows.into_iter().flatten().collect();
        Ok(Inset { corner: [x, size[1] - margin - height], size: [width, height], pixels })
    }
}
