//! The layout of the matrix equation: columns between brackets, in one size of type.

use std::ops::Range;
use std::sync::Arc;

use egui::{
    Align2, FontId, Galley, Painter, Pos2, Role, ScrollArea, Sense, Stroke, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};

use super::double_simulation::DoublePendulumSimulation;
use super::drawing::{LETTER, Tint};
use super::equation::{Filling, Moment, Term, terms, told};

/// Height of a line of text in points.
const LINE: f32 = 20.0;
/// Space between brackets and what they hold, in points.
const PAD: f32 = 8.0;
/// Space between the two rows of the equation, and between the two columns of M, in points.
const APART: f32 = 16.0;
/// The columns of M, α and τ, each with the space before its left bracket, where the sign of equality
/// stands.
const GROUPS: [(Range<usize>, f32); 3] = [(0..2, 0.0), (2..3, 8.0), (3..4, 32.0)];

/// The equation of a moment, laid out in one size of type.
pub(super) struct Sheet {
    told: String,
    /// The lines of every entry.
    entries: [[Vec<Arc<Galley>>; 4]; 2],
    /// Widths of the columns in points.
    columns: [f32; 4],
    /// Width and height in points.
    pub size: Vec2,
}

impl Sheet {
    /// Lays out the equation of a simulation's current moment. The sums of τ are broken into two
    /// lines if the equation would be wider than `width` without that.
    pub(super) fn new(ui: &Ui, width: f32, simulation: &DoublePendulumSimulation) -> Self {
        let whole = Sheet::laid_out(ui, simulation, false);
        if whole.size.x <= width { whole } else { Sheet::laid_out(ui, simulation, true) }
    }

    fn laid_out(ui: &Ui, simulation: &DoublePendulumSimulation, broken: bool) -> Self {
        let (build, state, tint) = (simulation.build, simulation.now(), Tint::of(ui));
        let pendulum = build.pendulum();
        let equation = pendulum.equation(&state);
        let moment = Moment { build, state, acceleration: pendulum.acceleration(&state) };
        let terms = terms(build.kind, &equation, moment.acceleration);
        let galleys = |filling, term: &Term| -> Vec<Arc<Galley>> {
            let lines = term.lines(filling, broken, &tint).into_iter();
            lines.map(|line| ui.painter().layout_job(line)).collect()
        };
        let entries = terms
            .each_ref()
            .map(|row| row.each_ref().map(|term| galleys(Filling::Numbers(&moment), term)));
        let columns = [0, 1, 2, 3].map(|column| {
            let rows = terms.iter().zip(&entries);
            let all = rows.flat_map(|(row, written)| {
                let widest = galleys(Filling::Widest(&moment), &row[column]);
                widest.into_iter().chain(written[column].iter().cloned())
            });
            all.map(|line| line.size().x.ceil()).fold(0.0, f32::max)
        });
        let gaps: f32 = GROUPS.iter().map(|(_, before)| before + 2.0 * PAD).sum();
        let height: f32 = entries.iter().map(row_height).sum();
        let size = vec2(columns.iter().sum::<f32>() + APART + gaps, height + APART + 2.0 * PAD);
        Sheet { told: told(&equation, moment.acceleration), entries, columns, size }
    }

    /// Shows the equation in the middle of `width` points; if it is wider, it can be scrolled.
    pub(super) fn show(&self, ui: &mut Ui, width: f32) {
        ScrollArea::horizontal().id_salt("equation").max_width(width).show(ui, |ui| {
            let size = vec2(self.size.x.max(width), self.size.y);
            let (response, painter) = ui.allocate_painter(size, Sense::hover());
            let told = || WidgetInfo::labeled(Role::Image, true, self.told.as_str());
            response.widget_info(told);
            let left = 0.5 * (size.x - self.size.x).floor();
            self.draw(&painter, response.rect.min + vec2(left, 0.0), &Tint::of(ui));
        });
    }

    fn draw(&self, painter: &Painter, corner: Pos2, tint: &Tint) {
        let mut x = corner.x;
        for (columns, before) in GROUPS {
            if before > PAD {
                let at = pos2(x + 0.5 * before, corner.y + 0.5 * self.size.y);
                let font = FontId::proportional(LETTER);
                painter.text(at, Align2::CENTER_CENTER, "=", font, tint.ink);
            }
            x += before;
            self.bracket(painter, pos2(x, corner.y), 4.0, tint);
            x += PAD;
            let last = columns.end - 1;
            for column in columns {
                self.column(painter, pos2(x, corner.y + PAD), column, tint);
                x += self.columns[column] + if column == last { PAD } else { APART };
            }
            self.bracket(painter, pos2(x, corner.y), -4.0, tint);
        }
    }

    /// Writes the two entries of a column, centred.
    fn column(&self, painter: &Painter, corner: Pos2, column: usize, tint: &Tint) {
        let (middle, mut top) = (corner.x + 0.5 * self.columns[column], corner.y);
        for row in &self.entries {
            let lines = &row[column];
            let mut y = top + 0.5 * (row_height(row) - lines.len() as f32 * LINE);
            for line in lines {
                let at = pos2(middle - 0.5 * line.size().x, y);
                painter.galley(at, Arc::clone(line), tint.ink);
                y += LINE;
            }
            top += row_height(row) + APART;
        }
    }

    /// Draws a bracket whose hooks point to the left or the right.
    fn bracket(&self, painter: &Painter, top: Pos2, hook: f32, tint: &Tint) {
        let bottom = top + vec2(0.0, self.size.y);
        let by = vec2(hook, 0.0);
        painter.line(vec![top + by, top, bottom, bottom + by], Stroke::new(1.5, tint.ink));
    }
}

fn row_height(row: &[Vec<Arc<Galley>>; 4]) -> f32 {
    LINE * row.iter().map(Vec::len).max().unwrap_or(0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::State;
    use flipmap_scene::Kind;

    /// Lays out the equation of a fast pendulum for a width.
    fn sheet(kind: Kind, width: f32) -> Sheet {
        let mut simulation = DoublePendulumSimulation::from([2.0, 2.6]);
        simulation.build.kind = kind;
        simulation.release(State { angle: [-2.6, -1.7], speed: [-12.25, -31.5] });
        let (ctx, mut sheet) = (egui::Context::default(), None);
        crate::typeface::install(&ctx);
        // Nothing draws the textures.
        ctx.run_ui(egui::RawInput::default(), |ui| {
            sheet = Some(Sheet::new(ui, width, &simulation));
        })
        .textures_delta
        .clear();
        sheet.unwrap()
    }

    #[test]
    fn every_line_fits_between_its_brackets_in_one_size_of_type() {
        for kind in [Kind::Points, Kind::Rods] {
            let [wide, narrow] = [900.0, 616.0].map(|width| sheet(kind, width));
            assert!(wide.size.x <= 900.0 && narrow.size.x <= 616.0, "{}", narrow.size);
            assert!(wide.size.y < narrow.size.y, "sums take two lines where there is no room");
            for sheet in [wide, narrow] {
                for (column, room) in (0..4).zip(sheet.columns) {
                    for line in sheet.entries.iter().flat_map(|row| &row[column]) {
                        assert!(line.size().x <= room, "{}", line.text());
                        let sizes = line.job.sections.iter().map(|part| part.format.font_id.size);
                        assert!(sizes.into_iter().all(|size| size == LETTER));
                    }
                }
            }
        }
    }
}
