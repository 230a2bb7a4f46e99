//! Painted icons, and buttons that show one.

use egui::{
    Align2, Color32, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo,
    pos2, vec2,
};

/// A square button with a painted icon.
pub(super) struct IconButton {
    /// Name for screen readers.
    pub name: &'static str,
    /// Draws the icon.
    pub icon: fn(&Icon),
    /// Side in points.
    pub side: f32,
    /// True if the button has an effect now.
    pub enabled: bool,
    /// Whether the button is the chosen one of several; none if it is no choice.
    pub is_chosen: Option<bool>,
}

impl IconButton {
    /// Shows the button; hovering and the keyboard's focus give it a rim.
    pub(super) fn show(self, ui: &mut Ui) -> Response {
        let sense = if self.enabled { Sense::click() } else { Sense::hover() };
        let (rect, response) = ui.allocate_exact_size(vec2(self.side, self.side), sense);
        response.widget_info(|| match self.is_chosen {
            Some(chosen) => WidgetInfo::selected(Role::Button, self.enabled, chosen, self.name),
            None => WidgetInfo::labeled(Role::Button, self.enabled, self.name),
        });
        let chosen = self.is_chosen == Some(true);
        let visuals = match (self.enabled, chosen) {
            (true, true) => ui.visuals().widgets.active,
            (true, false) => *ui.style().interact(&response),
            (false, _) => ui.visuals().widgets.noninteractive,
        };
        if response.hovered() || response.has_focus() || chosen {
            let (fill, rim) = (visuals.weak_bg_fill, visuals.bg_stroke);
            ui.painter().rect(rect.shrink(1.0), 4.0, fill, rim, egui::StrokeKind::Inside);
        }
        let ink = visuals.fg_stroke.color.gamma_multiply(if self.enabled { 1.0 } else { 0.4 });
        (self.icon)(&Icon { painter: ui.painter().clone(), middle: rect.center(), ink });
        response
    }
}

/// The painter and the place of an icon, which reaches 7 points from its middle.
pub(super) struct Icon {
    painter: Painter,
    middle: Pos2,
    ink: Color32,
}

impl Icon {
    fn at(&self, x: f32, y: f32) -> Pos2 {
        self.middle + vec2(x, y)
    }

    fn line(&self, points: &[(f32, f32)]) {
        let points = points.iter().map(|(x, y)| self.at(*x, *y)).collect();
        self.painter.add(Shape::line(points, self.stroke()));
    }

    fn stroke(&self) -> Stroke {
        Stroke::new(1.6, self.ink)
    }

    pub(super) fn home(&self) {
        self.line(&[(-7.0, 0.0), (0.0, -6.5), (7.0, 0.0)]);
        self.line(&[(-5.0, -1.0), (-5.0, 6.0), (5.0, 6.0), (5.0, -1.0)]);
    }

    pub(super) fn back(&self) {
        self.line(&[(7.0, 0.0), (-6.0, 0.0)]);
        self.line(&[(-1.5, -5.0), (-6.5, 0.0), (-1.5, 5.0)]);
    }

    pub(super) fn forward(&self) {
        self.line(&[(-7.0, 0.0), (6.0, 0.0)]);
        self.line(&[(1.5, -5.0), (6.5, 0.0), (1.5, 5.0)]);
    }

    /// Draws four bands, from dark to light.
    pub(super) fn colours(&self) {
        let bands =
            [(0x3b, 0x1c, 0x70), (0xb0, 0x3a, 0x6e), (0xf0, 0x8a, 0x4b), (0xf6, 0xe0, 0x9a)];
        for (band, (r, g, b)) in bands.into_iter().enumerate() {
            let left = self.middle.x - 7.0 + 3.5 * band as f32;
            let band = Rect::from_min_size(pos2(left, self.middle.y - 6.0), vec2(3.5, 12.0));
            self.painter.rect_filled(band, 0.0, Color32::from_rgb(r, g, b));
        }
    }

    /// Draws frames within frames.
    pub(super) fn deeper(&self) {
        for half in [7.0, 4.2, 1.6] {
            self.line(&[
                (-half, -half),
                (half, -half),
                (half, half),
                (-half, half),
                (-half, -half),
            ]);
        }
    }

    /// Draws a double pendulum.
    pub(super) fn pendulum(&self) {
        self.line(&[(-2.0, -7.0), (2.5, -1.0), (-1.5, 5.0)]);
        self.painter.circle_filled(self.at(2.5, -1.0), 2.2, self.ink);
        self.painter.circle_filled(self.at(-1.5, 5.0), 2.6, self.ink);
    }

    pub(super) fn export(&self) {
        self.line(&[(0.0, -7.0), (0.0, 3.0)]);
        self.line(&[(-4.0, -0.5), (0.0, 3.5), (4.0, -0.5)]);
        self.line(&[(-7.0, 2.0), (-7.0, 6.5), (7.0, 6.5), (7.0, 2.0)]);
    }

    pub(super) fn help(&self) {
        let font = egui::FontId::proportional(17.0);
        self.painter.text(self.middle, Align2::CENTER_CENTER, "?", font, self.ink);
    }

    /// Draws a compass.
    pub(super) fn explore(&self) {
        self.painter.circle_stroke(self.middle, 7.5, self.stroke());
        self.line(&[(-2.0, -2.0), (3.5, -3.5), (2.0, 2.0), (-3.5, 3.5), (-2.0, -2.0)]);
    }

    /// Draws a piece of film.
    pub(super) fn film(&self) {
        self.line(&[(-7.0, -6.0), (7.0, -6.0), (7.0, 6.0), (-7.0, 6.0), (-7.0, -6.0)]);
        for x in [-4.5, 0.0, 4.5] {
            for y in [-3.6, 3.6] {
                self.painter.circle_filled(self.at(x, y), 1.1, self.ink);
            }
        }
    }

    /// Draws a flask.
    pub(super) fn lab(&self) {
        self.line(&[(-2.5, -7.0), (-2.5, -2.0), (-7.0, 7.0), (7.0, 7.0), (2.5, -2.0), (2.5, -7.0)]);
        self.line(&[(-4.0, -7.0), (4.0, -7.0)]);
        self.line(&[(-4.5, 2.5), (4.5, 2.5)]);
    }

    /// Draws three sliders.
    pub(super) fn settings(&self) {
        for (y, knob) in [(-5.0, 3.0), (0.0, -3.0), (5.0, 1.0)] {
            self.line(&[(-7.0, y), (7.0, y)]);
            self.painter.circle_filled(self.at(knob, y), 2.4, self.ink);
        }
    }
}
