//! Pins that are dragged over the map: their pendulums and flips follow at once.

use glam::DVec2;

use super::action::Action;
use super::gesture::Gesture;
use super::model::AppModel;
use super::pin_paths;
use super::pins::PinId;
use super::state::AppState;
use flipmap_screen::pin_start::PinStart;

/// Distance in points from the middle of a pin's ring within which it is taken hold of.
const REACH: f64 = 10.0;

/// Returns the actions of a gesture that drags a pin; none if it does not.
pub(crate) fn actions(gesture: &Gesture, state: &AppState) -> Option<Vec<Action>> {
    let hover = Action::Hover(gesture.pointer);
    if state.pins.held.is_some() {
        let pointer = gesture.pointer.filter(|_| gesture.dragged != DVec2::ZERO);
        let moved = pointer.map(Action::MovePin);
        let dropped = gesture.drag_began.is_none().then_some(Action::HoldPin(None));
        return Some([Some(hover), moved, dropped].into_iter().flatten().collect());
    }
    let is_plain = !(gesture.shift || gesture.turning || gesture.lights);
    let began = gesture.drag_began.filter(|_| is_plain && state.drawing.is_none())?;
    let pin = pin_at(state, began)?;
    Some(vec![hover, Action::HoldPin(Some(pin))])
}

/// Returns the pin whose ring is drawn at a point.
fn pin_at(state: &AppState, point: DVec2) -> Option<PinId> {
    let screen = state.screen();
    let copies = pin_paths::copies(&screen);
    let distance = |pin: &super::pins::Pin| {
        let offset = screen.camera.offset_of(pin.start.place?);
        let places = copies.iter().map(|copy| screen.point_of(offset + *copy).distance(point));
        places.min_by(f64::total_cmp).filter(|distance| *distance <= REACH)
    };
    let near = state.pins.iter().filter_map(|pin| Some((pin.id, distance(pin)?)));
    near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(id, _)| id)
}

impl AppModel {
    /// Moves the pin that is held to a point of the map, and lets its pendulum go from there.
    pub(super) fn move_pin(&mut self, point: DVec2) {
        let places = self.state.pixel_at(point);
        let start = PinStart::on_plane(&self.state.scene(), self.state.camera.reach, places);
        let (Some(start), Some(id)) = (start, self.state.pins.held) else { return };
        let told = self.state.told_at(&mut self.compute.explorer, places[0]);
        let wake = self.waker();
        self.state.pins.set_start(id, start, told, wake);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::tests::state;

    #[test]
    fn a_drag_that_begins_on_a_ring_holds_its_pin_and_any_other_does_not() {
        let mut state = state();
        let here = DVec2::new(120.0, -40.0);
        let start = PinStart::at_rest(state.pixel_at(here));
        let id = state.pins.add(start, None, || ()).unwrap();
        let drag = |began: DVec2, shift| Gesture {
            pointer: Some(began),
            drag_began: Some(began),
            dragged: DVec2::ONE,
            shift,
            ..Gesture::default()
        };
        let near = here + DVec2::new(5.0, 5.0);
        let held = actions(&drag(near, false), &state).unwrap();
        assert_eq!(held[1], Action::HoldPin(Some(id)));
        assert_eq!(actions(&drag(near, true), &state), None, "Shift draws a rectangle");
        assert_eq!(actions(&drag(here + 3.0 * REACH, false), &state), None);
        state.pins.held = Some(id);
        let to = DVec2::new(-300.0, 10.0);
        let moved = actions(&drag(to, false), &state).unwrap();
        assert_eq!(moved, [Action::Hover(Some(to)), Action::MovePin(to)]);
        let over = Gesture { pointer: Some(to), ..Gesture::default() };
        assert_eq!(actions(&over, &state).unwrap()[1], Action::HoldPin(None));
    }

    #[test]
    fn a_moved_pin_flies_from_its_new_start() {
        let mut state = state();
        let [a, b] = [DVec2::new(50.0, 0.0), DVec2::new(90.0, 30.0)].map(|at| state.pixel_at(at));
        let id = state.pins.add(PinStart::at_rest(a), None, || ()).unwrap();
        state.pins.set_start(id, PinStart::at_rest(b), None, || ());
        let pin = state.pins.get(id).unwrap();
        assert_eq!(pin.start.place, Some(b[0]));
        assert_eq!((state.pins.iter().len(), pin.shown_secs()), (1, 0.0));
    }
}
