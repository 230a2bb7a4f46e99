//! The map in the middle of the window: its drawing, and the pointer's actions on it.

use egui::{Align2, Color32, CornerRadius, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo};
use glam::DVec2;

use super::action::Action;
use super::energy_curve;
use super::gesture::Gesture;
use super::map_callback::MapCallback;
use super::overlay::{self, PlacedLabel, position};
use super::state::AppState;
use super::{pin_drag, pin_paths};
use flipmap_numbers::Exact;
use flipmap_numbers::number_text::significant;
use flipmap_pendulum::Rule;
use flipmap_scene::PendulumSpec;
use flipmap_scene::palette::Ground;
use flipmap_screen::canvas::pipeline::MapFrame;
use flipmap_screen::captions::{place_words, words_of};
use flipmap_screen::hover::Answer;

/// The sample of the map under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hovered {
    /// Place of the sample on the lattice.
    pub place: [Exact; 2],
    /// Known answer; none while only coarser samples are known.
    pub answer: Option<Answer>,
}

/// Shows the map with the energy curve of a pendulum and a rule, and returns the user's actions on
/// the map.
pub(crate) fn map(
    ui: &mut Ui,
    state: &AppState,
    mut frame: MapFrame,
    hovered: Option<Hovered>,
    curve: Option<(PendulumSpec, Rule)>,
) -> Vec<Action> {
    let rect = ui.available_rect_before_wrap();
    frame.size_px = size_px(rect, ui.ctx().pixels_per_point());
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    let name = spoken(state, hovered);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let gesture = Gesture { lights: is_lighting(ui, state), ..gesture(ui, rect, &response) };
    let painter = ui.painter_at(rect);
    painter.add(egui_wgpu::Callback::new_paint_callback(rect, MapCallback(frame)));
    draw_layers(&painter, rect, state, curve);
    pin_paths::draw(&painter, rect, state);
    draw_pins(&painter, rect, state);
    if let Some([a, b]) = state.drawing {
        let rect = Rect::from_two_pos(position(rect, a), position(rect, b));
        for (width, colour) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
            painter.rect_stroke(
                rect,
                CornerRadius::ZERO,
                Stroke::new(width, colour),
                StrokeKind::Middle,
            );
        }
    }
    if let (Some(pointer), Some(hovered), false) = (state.pointer, hovered, state.dragging) {
        caption(&painter, rect, state, (pointer, &hovered)).draw(&painter);
    }
    leave_focus(&response);
    if response.has_focus() {
        let stroke = ui.visuals().selection.stroke;
        painter.rect_stroke(rect, CornerRadius::ZERO, stroke, StrokeKind::Inside);
    }
    pin_drag::actions(&gesture, state).unwrap_or_else(|| gesture.actions(state.drawing))
}

/// Returns the size in physical pixels of a part of the window, with its edges rounded to whole
/// pixels.
fn size_px(rect: Rect, pixels_per_point: f32) -> [u32; 2] {
    let edge = |at: f32| (at * pixels_per_point).round();
    let [min, max] = [rect.min, rect.max].map(|corner| [edge(corner.x), edge(corner.y)]);
    [0, 1].map(|i| (max[i] - min[i]).max(0.0) as u32)
}

/// Reads the gesture of the pointer, in points from the middle of the canvas.
fn gesture(ui: &Ui, rect: Rect, response: &egui::Response) -> Gesture {
    let from_middle = |at: egui::Pos2| {
        let by = at - rect.center();
        DVec2::new(f64::from(by.x), f64::from(by.y))
    };
    let over = response.hovered() || response.dragged();
    use egui::PointerButton::{Primary, Secondary};
    let by_secondary = response.dragged_by(Secondary) || response.drag_stopped_by(Secondary);
    let dragged = response.dragged_by(Primary) || response.dragged_by(Secondary);
    let drag = dragged_points(ui, response, dragged);
    // Responses read the input themselves, which must not happen while it is locked below.
    let (is_clicked, double_clicked) = (response.clicked(), response.double_clicked());
    let released = response.drag_stopped();
    ui.input(|input| {
        let pointer = input.pointer.latest_pos().filter(|_| over).map(from_middle);
        // A click by the keyboard has no place of its own.
        let mut clicks = releases(input).map(from_middle).rev();
        let clicked = is_clicked.then(|| clicks.next().or(pointer).unwrap_or_default());
        Gesture {
            pointer,
            dragged: DVec2::new(f64::from(drag.x), f64::from(drag.y)),
            drag_began: input.pointer.press_origin().filter(|_| dragged).map(from_middle),
            released,
            clicked,
            clicked_before: clicks.next().filter(|_| is_clicked),
            double_clicked,
            shift: input.modifiers.shift,
            turning: by_secondary || input.modifiers.alt,
            lights: false,
            stretching: input.modifiers.alt,
            notches: if over { notches(input) } else { 0.0 },
            pinch: if over { pinch(input) } else { 1.0 },
        }
    })
}

/// Returns where the primary button was released in this frame, the newest last.
fn releases(input: &egui::InputState) -> impl DoubleEndedIterator<Item = egui::Pos2> {
    input.events.iter().filter_map(|event| match event {
        egui::Event::PointerButton {
            pos,
            button: egui::PointerButton::Primary,
            pressed: false,
            ..
        } => Some(*pos),
        _ => None,
    })
}

/// Returns true if a drag moves the light instead of the map: with Ctrl held, while the map has a
/// relief.
fn is_lighting(ui: &Ui, state: &AppState) -> bool {
    let has_relief = state.picture.relief > 0.0 && state.picture.paints_times(state.question.ask);
    has_relief && ui.input(|input| input.modifiers.command)
}

/// Returns how far the pointer has dragged since the last frame. The first frame of a drag covers
/// the whole way since the press and the last one the way up to the release, or the map would lag
/// behind.
fn dragged_points(ui: &Ui, response: &egui::Response, dragged: bool) -> egui::Vec2 {
    if response.drag_started() {
        return response.total_drag_delta().filter(|_| dragged).unwrap_or_default();
    }
    ui.input(|input| {
        let before = input.pointer.latest_pos().map(|latest| latest - input.pointer.delta());
        let released = input.events.iter().rev().find_map(|event| match event {
            egui::Event::PointerButton { pos, pressed: false, .. } => Some(*pos),
            _ => None,
        });
        match (released, before) {
            _ if dragged => input.pointer.delta(),
            (Some(at), Some(before)) if response.drag_stopped() => at - before,
            _ => egui::Vec2::ZERO,
        }
    })
}

/// Points of touchpad scrolling that equal one notch of a wheel.
const POINTS_A_NOTCH: f32 = 50.0;

/// Returns the notches of the wheel since the last frame. On some systems egui reports Ctrl and the
/// wheel as a pinch, on others as a wheel; here the wheel always counts, with any key held.
fn notches(input: &egui::InputState) -> f64 {
    let of = |event: &egui::Event| match event {
        egui::Event::MouseWheel { unit, delta, modifiers, .. } => {
            // Shift turns the wheel sideways on some systems.
            let by = if modifiers.shift && delta.y == 0.0 { delta.x } else { delta.y };
            f64::from(match unit {
                egui::MouseWheelUnit::Point => by / POINTS_A_NOTCH,
                egui::MouseWheelUnit::Line => by,
                egui::MouseWheelUnit::Page => 10.0 * by,
            })
        }
        _ => 0.0,
    };
    input.events.iter().map(of).sum()
}

/// Returns the magnification by fingers on a touchpad or a touch screen.
fn pinch(input: &egui::InputState) -> f64 {
    let touch = input.multi_touch().map(|touch| f64::from(touch.zoom_delta));
    let of = |event: &egui::Event| match event {
        egui::Event::Zoom(factor) => f64::from(*factor),
        _ => 1.0,
    };
    touch.unwrap_or_else(|| input.events.iter().map(of).product())
}

fn draw_layers(
    painter: &egui::Painter,
    rect: Rect,
    state: &AppState,
    curve: Option<(PendulumSpec, Rule)>,
) {
    let screen = state.screen();
    if state.layers.borders {
        overlay::draw_tiles(painter, rect, &screen);
    }
    if state.layers.grid {
        overlay::draw_grid(painter, rect, &screen, state.plane.axes());
    }
    if !state.plane.is_at_rest() {
        overlay::draw_axes(painter, rect, state.plane.axes());
    }
    if let Some((build, rule)) = curve {
        let lines = energy_curve::energy_curve(&screen, &build, rule);
        let ground = Ground::of(&state.picture).unwrap_or(Ground::LIGHT);
        energy_curve::draw_curve(painter, rect, &lines, ground.curve);
    }
}

/// Draws a ring with a letter for every pin in view, on every copy of the torus.
fn draw_pins(painter: &egui::Painter, rect: Rect, state: &AppState) {
    let screen = state.screen();
    let copies = pin_paths::copies(&screen);
    for pin in state.pins.iter() {
        let Some(place) = pin.start.place else { continue };
        let offset = screen.camera.offset_of(place);
        for point in copies.iter().map(|copy| screen.point_of(offset + *copy)) {
            if !point.is_finite() || (point.abs() * 2.0).cmpgt(state.canvas).any() {
                continue;
            }
            let at = position(rect, point);
            painter.circle_stroke(at, 6.0, Stroke::new(4.0, Color32::BLACK));
            painter.circle_stroke(at, 6.0, Stroke::new(2.0, pin.badge.colour()));
            let name = pin.badge.letter().to_string();
            overlay::label(painter, at + egui::vec2(9.0, -9.0), Align2::LEFT_BOTTOM, &name);
        }
    }
}

/// Returns the caption of a sample beside the pointer, or above it if there is no room below.
pub(crate) fn caption(
    painter: &egui::Painter,
    rect: Rect,
    state: &AppState,
    (pointer, hovered): (DVec2, &Hovered),
) -> PlacedLabel {
    let words = words_of((hovered.place, hovered.answer), &state.scene(), state.screen().level());
    let at = position(rect, pointer);
    if at.y > rect.bottom() - 60.0 {
        overlay::placed(painter, at + egui::vec2(14.0, -14.0), Align2::LEFT_BOTTOM, &words)
    } else {
        overlay::placed(painter, at + egui::vec2(14.0, 14.0), Align2::LEFT_TOP, &words)
    }
}

/// Takes the keyboard's focus off the map when it is pressed: the pointer shows where it is.
fn leave_focus(response: &egui::Response) {
    if response.is_pointer_button_down_on() || response.clicked_by(egui::PointerButton::Primary) {
        response.surrender_focus();
    }
}

/// Returns the description of the map for screen readers.
fn spoken(state: &AppState, hovered: Option<Hovered>) -> String {
    let (scene, camera) = (state.scene(), state.camera);
    let level = state.screen().level();
    let here = hovered.map(|at| words_of((at.place, at.answer), &scene, level));
    let here = here.unwrap_or_default();
    let place = place_words(&scene, camera.reach.coordinates(camera.center), 4);
    let [across, _] = scene.plane.axes();
    let width = significant(camera.width(), 4);
    format!("Map around {place}, {width} {} wide. {here}", across.unit())
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Event, Key, Modifiers, PointerButton, RawInput, pos2, vec2};

    #[test]
    fn the_keyboard_focuses_the_map_and_a_click_does_not() {
        let ctx = egui::Context::default();
        let frame = |events: Vec<Event>| {
            let screen_rect = Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 100.0)));
            let raw = RawInput { screen_rect, events, ..RawInput::default() };
            let mut focused = false;
            // Nothing draws the textures.
            ctx.run_ui(raw, |ui| {
                let response = ui.allocate_rect(ui.max_rect(), Sense::click_and_drag());
                leave_focus(&response);
                focused = response.has_focus();
            })
            .textures_delta
            .clear();
            focused
        };
        let tab = Event::Key {
            key: Key::Tab,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        let pos = pos2(50.0, 50.0);
        let button = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        frame(Vec::new());
        frame(vec![tab]);
        assert!(frame(Vec::new()), "by the Tab key");
        frame(vec![Event::PointerMoved(pos), button(true), button(false)]);
        assert!(!frame(Vec::new()), "a click takes it away");
        frame(vec![button(true)]);
        frame(vec![button(false)]);
        assert!(!frame(Vec::new()));
    }
}
