//! The view as numbers that can be read and typed: centre, width, turn and stretch.

use egui::{Grid, Key, TextEdit, Ui};

use super::field::plain;
use super::sentence::sentence;
use crate::action::{Action, Look};
use flipmap_scene::{Axis, View, in_rad};
use flipmap_screen::camera::Camera;

/// Texts that the user has typed but not yet gone to, in the order of the fields.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ViewForm {
    typed: Option<[String; 5]>,
}

impl ViewForm {
    /// Returns the texts in the fields: those typed, or those of the view that is shown.
    fn texts(&self, shown: &View) -> [String; 5] {
        self.typed.clone().unwrap_or_else(|| {
            let [x, y] = shown.center.clone();
            [x, y, shown.width.clone(), plain(shown.rotate), plain(shown.stretch)]
        })
    }
}

/// Returns in degrees an angle that is written in degrees or in parts of π; none without a unit.
fn degrees(text: &str) -> Option<f64> {
    let rad = in_rad(text);
    if rad == text.trim() { None } else { Some(rad.parse::<f64>().ok()?.to_degrees()) }
}

/// Reads the texts of the fields. Angles may be in degrees or in parts of π.
fn view_of(texts: &[String; 5], axes: [Axis; 2]) -> Result<View, String> {
    let number = |text: &str, name: &str| {
        text.trim().parse::<f64>().map_err(|_| format!("{name} is '{text}', which is not a number"))
    };
    let [x, y, width, rotate, stretch] = texts;
    let view = View {
        center: [axes[0].in_unit(x), axes[1].in_unit(y)],
        width: axes[0].in_unit(width),
        rotate: degrees(rotate).map_or_else(|| number(rotate, "Turn"), Ok)?,
        stretch: number(stretch, "Stretch")?,
        fit: false,
    };
    view.check(axes).map_err(|error| error.to_string())?;
    Ok(view)
}

/// Shows the fields; returns the view to go to once the user asks for it.
pub(crate) fn view_panel(
    ui: &mut Ui,
    form: &mut ViewForm,
    camera: &Camera,
    axes: [Axis; 2],
) -> Option<Action> {
    let shown = camera.view();
    let mut texts = form.texts(&shown);
    let [across, up] = axes.map(|axis| format!("{}, {}", axis.symbol(), axis.unit()));
    let width = format!("Width, {}", axes[0].unit());
    let names = [across, up, width, "Turn, degrees".to_string(), "Stretch".to_string()];
    let mut entered = false;
    Grid::new("view").num_columns(2).show(ui, |ui| {
        for (name, text) in names.iter().zip(&mut texts) {
            let label = ui.label(name);
            let field = ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY));
            let field = field.labelled_by(label.id);
            entered |= field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.end_row();
        }
    });
    if texts != form.texts(&shown) {
        form.typed = Some(texts.clone());
    }
    form.typed.as_ref()?;
    let view = view_of(&texts, axes);
    if let Err(error) = &view {
        ui.label(sentence(ui, error, ui.visuals().warn_fg_color));
    }
    let mut asked = false;
    ui.horizontal(|ui| {
        asked = ui.add_enabled(view.is_ok(), egui::Button::new("Go there")).clicked();
        if ui.button("Cancel").clicked() {
            form.typed = None;
        }
    });
    let view = view.ok().filter(|_| asked || entered)?;
    form.typed = None;
    let to = Camera::from_view(&view, camera.reach);
    // The centre has more digits than are shown.
    let center = if texts[..2] == shown.center { camera.center } else { to.center };
    Some(Action::Look(Look::To(Camera { center, ..to })))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Scalar;

    fn texts(all: [&str; 5]) -> [String; 5] {
        all.map(str::to_string)
    }

    #[test]
    fn typed_views_are_read_with_degrees_and_refused_in_words() {
        let axes = [Axis::Theta1, Axis::Theta2];
        let view = view_of(&texts(["90deg", "-0.5pi", "1e-3", "30", "2"]), axes).unwrap();
        assert!((view.center_rad()[0].to_f64() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert_eq!((view.width.as_str(), view.rotate, view.stretch), ("1e-3", 30.0, 2.0));
        for (text, turned) in [("45", 45.0), ("45deg", 45.0), ("-0.25pi", -45.0)] {
            let view = view_of(&texts(["0", "0", "1", text, "1"]), axes).unwrap();
            assert!((view.rotate - turned).abs() < 1e-12, "{text}");
        }
        for (wrong, words) in [
            (["x", "0", "1", "0", "1"], "`center` is 'x'"),
            (["0", "0", "0", "0", "1"], "`width` is '0'"),
            (["0", "0", "1", "turn", "1"], "Turn is 'turn'"),
            (["0", "0", "1", "0", "0"], "`stretch` is '0'"),
        ] {
            let error = view_of(&texts(wrong), axes).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        let speeds = [Axis::Omega1, Axis::Omega2];
        let error = view_of(&texts(["90deg", "0", "1", "0", "1"]), speeds).unwrap_err();
        assert!(error.contains("`center` is '90deg'") && error.contains("rad/s"), "{error}");
    }
}
