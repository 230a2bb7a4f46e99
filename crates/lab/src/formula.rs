//! Formulas as in a printed book: fractions, roots, subscripts and matrices, laid out as boxes on a
//! baseline and scaled as a whole.

use std::sync::Arc;

use egui::text::{LayoutJob, TextFormat};
use egui::{
    Color32, FontId, Galley, Painter, Pos2, Response, Role, ScrollArea, Sense, Shape, Stroke, Ui,
    Vec2, WidgetInfo, pos2, vec2,
};

/// A formula, or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Formula {
    /// Letters, figures and signs in one colour.
    Text { text: String, colour: Color32, is_slanted: bool },
    /// Parts beside one another.
    Row(Vec<Formula>),
    /// A base with a part below or above the line at its right.
    Scripts { base: Box<Formula>, below: Option<Box<Formula>>, above: Option<Box<Formula>> },
    /// A part above another, with a bar between them.
    Fraction(Box<Formula>, Box<Formula>),
    /// The square root of a part.
    Root(Box<Formula>),
    /// A part between parentheses or brackets of its height.
    Fenced(Fence, Box<Formula>),
    /// Rows of entries in columns.
    Matrix(Vec<Vec<Formula>>),
    /// Lines below one another, each centred.
    Lines(Vec<Formula>),
    /// A part in the middle of the room that another would take, so that nothing moves when
    /// numbers change.
    Within { room: Box<Formula>, shown: Box<Formula> },
}

/// What stands on both sides of a fenced part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fence {
    /// Parentheses.
    Round,
    /// Square brackets.
    Square,
}

impl Formula {
    /// Creates upright text.
    pub(crate) fn text(text: impl Into<String>, colour: Color32) -> Self {
        Formula::Text { text: text.into(), colour, is_slanted: false }
    }

    /// Creates a slanted letter, as variables are printed, with an index below the line if it has
    /// one.
    pub(crate) fn variable(letter: &str, index: Option<&str>, colour: Color32) -> Self {
        // Greek letters have no slanted face.
        let is_slanted = letter.is_ascii();
        let base = Formula::Text { text: letter.to_string(), colour, is_slanted };
        match index {
            None => base,
            Some(index) => base.with_index(Formula::text(index, colour)),
        }
    }

    fn with_index(self, index: Formula) -> Self {
        Formula::Scripts { base: Box::new(self), below: Some(Box::new(index)), above: None }
    }

    /// Returns the formula with an exponent, above its index if it has one.
    pub(crate) fn with_exponent(self, exponent: &str, colour: Color32) -> Self {
        let above = Some(Box::new(Formula::text(exponent, colour)));
        match self {
            Formula::Scripts { base, below, above: None } => {
                Formula::Scripts { base, below, above }
            }
            base => Formula::Scripts { base: Box::new(base), below: None, above },
        }
    }

    /// Creates a fraction.
    pub(crate) fn over(self, below: Formula) -> Self {
        Formula::Fraction(Box::new(self), Box::new(below))
    }

    /// Creates a part between fences.
    pub(crate) fn fenced(self, fence: Fence) -> Self {
        Formula::Fenced(fence, Box::new(self))
    }

    /// Shows the formula in the middle of `width` points, in letters of `size` points or smaller
    /// ones if it would be too wide; if it does not fit in the smallest, it can be scrolled. `told`
    /// is its description for a screen reader.
    pub(crate) fn show(&self, ui: &mut Ui, width: f32, size: f32, told: &str) -> Response {
        let laid = self.fitted(ui.painter(), width, size, ui.visuals().text_color());
        let scroll = ScrollArea::horizontal().id_salt(told).max_width(width);
        let shown = scroll.show(ui, |ui| {
            let area = vec2(laid.width.max(width), laid.height());
            let (response, painter) = ui.allocate_painter(area, Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told));
            let left = response.rect.left() + 0.5 * (area.x - laid.width).floor();
            laid.draw(&painter, pos2(left, response.rect.top()));
            response
        });
        shown.inner
    }

    /// Lays out the formula in letters of `size` points, or in the largest smaller ones in which it
    /// is at most `width` points wide.
    pub(crate) fn fitted(
        &self,
        painter: &Painter,
        width: f32,
        size: f32,
        ink: Color32,
    ) -> LaidFormula {
        let laid_in = |size: f32| Typesetter { painter, ink }.laid(self, size);
        let whole = laid_in(size);
        if whole.width <= width {
            return whole;
        }
        // Half points, because every size of type has pictures of its own.
        let fitting = (2.0 * size * width / whole.width).floor() / 2.0;
        let mut fitting = fitting.max(LEAST_LETTER);
        let mut laid = laid_in(fitting);
        while laid.width > width && fitting > LEAST_LETTER {
            fitting -= 0.5;
            laid = laid_in(fitting);
        }
        laid
    }
}

/// Size of the smallest letters of a formula that is scaled down, in points.
const LEAST_LETTER: f32 = 5.5;
/// Size of scripts relative to what they stand at.
const SCRIPT: f32 = 0.68;
/// Size of the parts of a fraction relative to what it stands in.
const PART: f32 = 0.85;
/// Height of letters above the baseline, relative to their size.
const ABOVE: f32 = 0.76;
/// Depth of letters below the baseline, likewise.
const BELOW: f32 = 0.24;
/// Height of the middle of a minus sign, at which fractions and matrices are centred, likewise.
const AXIS: f32 = 0.28;

/// A formula in its final place: boxes and lines relative to its upper left corner.
#[derive(Clone, Debug, Default)]
pub(crate) struct LaidFormula {
    /// Width in points.
    pub width: f32,
    /// Height above the baseline and depth below it, in points.
    pub above: f32,
    pub below: f32,
    /// Letters, from the left end of the baseline.
    letters: Vec<(Vec2, Arc<Galley>, Color32)>,
    /// Lines, likewise, with their widths.
    lines: Vec<(Vec<Vec2>, Stroke)>,
}

impl LaidFormula {
    /// Returns the height in points.
    pub(crate) fn height(&self) -> f32 {
        self.above + self.below
    }

    /// Draws the formula with its upper left corner at a point.
    pub(crate) fn draw(&self, painter: &Painter, corner: Pos2) {
        let origin = corner + vec2(0.0, self.above);
        for (by, galley, colour) in &self.letters {
            painter.galley(origin + *by, Arc::clone(galley), *colour);
        }
        for (places, stroke) in &self.lines {
            let points = places.iter().map(|by| origin + *by).collect();
            painter.add(Shape::line(points, *stroke));
        }
    }

    /// Adds a part that begins `by` from the left end of the baseline.
    fn put(&mut self, part: LaidFormula, by: Vec2) {
        self.width = self.width.max(by.x + part.width);
        self.above = self.above.max(part.above - by.y);
        self.below = self.below.max(part.below + by.y);
        let letters = part.letters.into_iter();
        self.letters.extend(letters.map(|(at, galley, colour)| (at + by, galley, colour)));
        let lines = part.lines.into_iter();
        self.lines.extend(lines.map(|(places, stroke)| {
            (places.into_iter().map(|place| place + by).collect(), stroke)
        }));
    }

    fn line(&mut self, places: Vec<Vec2>, stroke: Stroke) {
        self.lines.push((places, stroke));
    }
}

/// Lays out formulas.
struct Typesetter<'a> {
    painter: &'a Painter,
    /// Colour of bars and fences.
    ink: Color32,
}

impl Typesetter<'_> {
    /// Lays out a formula in letters of `size` points.
    fn laid(&self, formula: &Formula, size: f32) -> LaidFormula {
        match formula {
            Formula::Text { text, colour, is_slanted } => {
                self.text(text, *colour, *is_slanted, size)
            }
            Formula::Row(parts) => self.row(parts, size),
            Formula::Scripts { base, below, above } => {
                self.scripts(base, below.as_deref(), above.as_deref(), size)
            }
            Formula::Fraction(above, below) => self.fraction(above, below, size),
            Formula::Root(inner) => self.root(inner, size),
            Formula::Fenced(fence, inner) => self.fenced(*fence, inner, size),
            Formula::Matrix(rows) => self.matrix(rows, size),
            Formula::Lines(lines) => {
                let rows: Vec<_> = lines.iter().map(|line| vec![line.clone()]).collect();
                self.grid(&rows, size, vec2(0.0, 0.3 * size))
            }
            Formula::Within { room, shown } => {
                let (room, shown) = (self.laid(room, size), self.laid(shown, size));
                let width = room.width.max(shown.width);
                let by = vec2(0.5 * (width - shown.width), 0.0);
                let mut laid = LaidFormula { width, ..LaidFormula::default() };
                (laid.above, laid.below) = (room.above, room.below);
                laid.put(shown, by);
                laid
            }
        }
    }

    fn stroke(&self, size: f32) -> Stroke {
        Stroke::new((size / 11.0).max(1.0), self.ink)
    }

    fn text(&self, text: &str, colour: Color32, italics: bool, size: f32) -> LaidFormula {
        let font_id = FontId::proportional(size);
        let format = TextFormat { italics, ..TextFormat::simple(font_id, colour) };
        let mut job = LayoutJob::default();
        job.append(text, 0.0, format);
        let galley = self.painter.layout_job(job);
        let row = galley.rows.first();
        let baseline = row
            .and_then(|row| Some(row.pos.y + row.row.glyphs.first()?.pos.y))
            .unwrap_or(ABOVE * size);
        // A slanted letter leans over its right end.
        let width = galley.size().x + if italics { 0.06 * size } else { 0.0 };
        let letters = vec![(vec2(0.0, -baseline), galley, colour)];
        let (above, below) = (ABOVE * size, BELOW * size);
        LaidFormula { width, above, below, letters, lines: Vec::new() }
    }

    fn row(&self, parts: &[Formula], size: f32) -> LaidFormula {
        let mut laid = LaidFormula::default();
        for part in parts {
            let by = vec2(laid.width, 0.0);
            laid.put(self.laid(part, size), by);
        }
        laid
    }

    fn scripts(
        &self,
        base: &Formula,
        below: Option<&Formula>,
        above: Option<&Formula>,
        size: f32,
    ) -> LaidFormula {
        let mut laid = self.laid(base, size);
        let right = laid.width + 0.04 * size;
        // Scripts of a high base move with its edges.
        let up = (laid.above - 0.36 * size).max(0.4 * size);
        let down = (laid.below - 0.1 * size).max(0.16 * size);
        for (script, by) in [(below, down), (above, -up)] {
            if let Some(script) = script {
                laid.put(self.laid(script, SCRIPT * size), vec2(right, by));
            }
        }
        laid.width += 0.04 * size;
        laid
    }

    fn fraction(&self, above: &Formula, below: &Formula, size: f32) -> LaidFormula {
        let [above, below] = [above, below].map(|part| self.laid(part, PART * size));
        let (gap, rim) = (0.12 * size, 0.1 * size);
        let width = above.width.max(below.width) + 2.0 * rim;
        let axis = -AXIS * size;
        let mut laid = LaidFormula { width: width + 2.0 * rim, ..LaidFormula::default() };
        let bar = [rim, rim + width].map(|x| vec2(x, axis));
        laid.line(bar.to_vec(), self.stroke(size));
        let middle = |part: &LaidFormula| rim + 0.5 * (width - part.width);
        let (over, under) = (middle(&above), middle(&below));
        let (up, down) = (axis - gap - above.below, axis + gap + below.above);
        laid.put(above, vec2(over, up));
        laid.put(below, vec2(under, down));
        laid
    }

    fn root(&self, inner: &Formula, size: f32) -> LaidFormula {
        let inner = self.laid(inner, size);
        let (hook, gap) = (0.65 * size, 0.1 * size);
        let (top, bottom) = (-inner.above - gap, inner.below);
        let width = hook + inner.width + gap;
        let mut laid = LaidFormula { above: gap - top, ..LaidFormula::default() };
        let sign = vec![
            vec2(0.1 * size, 0.5 * (top + bottom)),
            vec2(0.25 * size, 0.5 * (top + bottom) - 0.06 * size),
            vec2(0.42 * size, bottom),
            vec2(0.6 * size, top),
            vec2(width, top),
        ];
        laid.line(sign, self.stroke(size));
        laid.put(inner, vec2(hook, 0.0));
        laid.width = width;
        laid
    }

    fn fenced(&self, fence: Fence, inner: &Formula, size: f32) -> LaidFormula {
        let inner = self.laid(inner, size);
        let wide = 0.28 * size;
        let (top, bottom) = (-inner.above - 0.06 * size, inner.below + 0.06 * size);
        let right = 2.0 * wide + inner.width;
        let mut laid = LaidFormula { above: -top, below: bottom, ..LaidFormula::default() };
        for (edge, hook) in [(0.35 * wide, 0.5 * wide), (right - 0.35 * wide, -0.5 * wide)] {
            let places = match fence {
                Fence::Square => vec![
                    vec2(edge + hook, top),
                    vec2(edge, top),
                    vec2(edge, bottom),
                    vec2(edge + hook, bottom),
                ],
                Fence::Round => (0..=12)
                    .map(|k| {
                        let along = k as f32 / 12.0;
                        let bow = (2.0 * along - 1.0).powi(2);
                        vec2(edge + hook * bow, top + along * (bottom - top))
                    })
                    .collect(),
            };
            laid.line(places, self.stroke(size));
        }
        laid.put(inner, vec2(wide, 0.0));
        laid.width = right;
        laid
    }

    fn matrix(&self, rows: &[Vec<Formula>], size: f32) -> LaidFormula {
        self.grid(rows, size, vec2(1.2 * size, 0.9 * size))
    }

    /// Lays out rows of entries, each centred in its column, with `apart` between them; the middle
    /// of the grid is at the height of a minus sign.
    fn grid(&self, rows: &[Vec<Formula>], size: f32, apart: Vec2) -> LaidFormula {
        let laid: Vec<Vec<LaidFormula>> =
            rows.iter().map(|row| row.iter().map(|part| self.laid(part, size)).collect()).collect();
        let columns = laid.iter().map(Vec::len).max().unwrap_or(0);
        let widest = |column: usize| {
            let entries = laid.iter().filter_map(|row| row.get(column));
            entries.map(|entry| entry.width).fold(0.0, f32::max)
        };
        let widths: Vec<f32> = (0..columns).map(widest).collect();
        let most = |row: &[LaidFormula], side: fn(&LaidFormula) -> f32| {
            row.iter().map(side).fold(0.0, f32::max)
        };
        let heights: Vec<[f32; 2]> = laid
            .iter()
            .map(|row| [most(row, |entry| entry.above), most(row, |entry| entry.below)])
            .collect();
        let height =
            heights.iter().flatten().sum::<f32>() + apart.y * rows.len().saturating_sub(1) as f32;
        let mut grid = LaidFormula::default();
        let mut top = -AXIS * size - 0.5 * height;
        for (row, [above, below]) in laid.into_iter().zip(heights) {
            let mut left = 0.0;
            for (entry, width) in row.into_iter().zip(&widths) {
                let by = vec2(left + 0.5 * (width - entry.width), top + above);
                grid.put(entry, by);
                left += width + apart.x;
            }
            top += above + below + apart.y;
        }
        grid.width = widths.iter().sum::<f32>() + apart.x * columns.saturating_sub(1) as f32;
        grid
    }
}
