//! Pointer gestures on the canvas as actions. Points are measured from its middle, y down.

use glam::DVec2;

use super::action::{Action, Look};

/// Pointer input on the canvas since the last frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gesture {
    /// Position of the pointer, if it is over the canvas.
    pub pointer: Option<DVec2>,
    /// Distance dragged with the primary button.
    pub dragged: DVec2,
    /// Point where the drag began, while it lasts.
    pub drag_began: Option<DVec2>,
    /// True if a drag ended.
    pub released: bool,
    /// Point of the last click on the canvas in this frame, if there was one.
    pub clicked: Option<DVec2>,
    /// Point of an earlier click in the same frame: a slow frame has several.
    pub clicked_before: Option<DVec2>,
    /// True if the last click is the second of a double click.
    pub double_clicked: bool,
    /// True if Shift is held.
    pub shift: bool,
    /// True if the drag turns the map: with Alt held, or with the secondary button.
    pub turning: bool,
    /// True if the drag moves the light of the relief: with Ctrl held, while there is a relief.
    pub lights: bool,
    /// True if the wheel stretches the map: with Alt held.
    pub stretching: bool,
    /// Notches that the wheel has turned, positive away from the user.
    pub notches: f64,
    /// Magnification by a pinch, or by Ctrl and the wheel.
    pub pinch: f64,
}

/// Number of wheel notches that double the magnification.
const NOTCHES_FOR_TWICE: f64 = 3.0;

impl Gesture {
    /// Returns the actions of the gesture; `drawing` is the rectangle being drawn so far.
    pub(crate) fn actions(&self, drawing: Option<[DVec2; 2]>) -> Vec<Action> {
        let mut actions = vec![Action::Hover(self.pointer)];
        let about = self.pointer.unwrap_or(DVec2::ZERO);
        let factor = self.pinch.max(f64::MIN_POSITIVE) * (self.notches / NOTCHES_FOR_TWICE).exp2();
        if factor != 1.0 && self.stretching {
            actions.push(Action::Look(Look::Stretch(factor)));
        } else if factor != 1.0 {
            actions.push(Action::Wheel(factor, about));
        }
        actions.extend(self.drag(drawing));
        actions.extend(self.clicks());
        actions
    }

    /// Returns the actions of clicks: each pins, but the second of a double click zooms, and takes
    /// back the pin of the first if an earlier frame has set it.
    fn clicks(&self) -> Vec<Action> {
        let factor = if self.shift { 0.5 } else { 2.0 };
        match (self.clicked, self.clicked_before) {
            (Some(about), before) if self.double_clicked => {
                let unpin = before.is_none().then_some(Action::Unpin);
                unpin.into_iter().chain([Action::Look(Look::Zoom { factor, about })]).collect()
            }
            (last, before) => before.into_iter().chain(last).map(Action::Pin).collect(),
        }
    }

    /// Returns the actions of a drag, which moves the map or its light or, begun with Shift, draws a
    /// rectangle.
    fn drag(&self, drawing: Option<[DVec2; 2]>) -> Vec<Action> {
        match (self.drag_began, drawing) {
            (_, Some([began, to])) if self.released => {
                let corners = [began, self.pointer.unwrap_or(to)];
                vec![Action::Drawing(None), Action::Look(Look::Box(corners))]
            }
            (began, None) if self.lights => {
                let drags = began.is_some() || self.released;
                let light = self.pointer.filter(|_| drags).map(Action::Light);
                light
                    .into_iter()
                    .chain(self.released.then_some(Action::Look(Look::Release)))
                    .collect()
            }
            (Some(_), None) if self.turning && self.dragged != DVec2::ZERO => {
                let to = self.pointer.unwrap_or_default();
                vec![Action::Look(Look::Turn([to - self.dragged, to]))]
            }
            (_, None) if self.turning && self.released => vec![Action::Look(Look::Release)],
            (_, None) if self.turning => Vec::new(),
            (_, None) if self.released => {
                vec![Action::Look(Look::Drag(self.dragged)), Action::Look(Look::Release)]
            }
            (Some(began), Some(_)) => {
                let to = self.pointer.unwrap_or(began);
                vec![Action::Drawing(Some([began, to]))]
            }
            (Some(began), None) if self.shift => vec![Action::Drawing(Some([began, began]))],
            (Some(_), None) if self.dragged != DVec2::ZERO => {
                vec![Action::Look(Look::Drag(self.dragged))]
            }
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: DVec2 = DVec2::new(10.0, 20.0);

    fn looks(gesture: Gesture, drawing: Option<[DVec2; 2]>) -> Vec<Action> {
        gesture.actions(drawing).split_off(1)
    }

    fn still() -> Gesture {
        Gesture { pointer: Some(HERE), pinch: 1.0, ..Gesture::default() }
    }

    #[test]
    fn nothing_is_nothing() {
        assert_eq!(still().actions(None), [Action::Hover(Some(HERE))]);
    }

    #[test]
    fn wheel_and_pinch_zoom_about_the_pointer() {
        let wheel = looks(Gesture { notches: 3.0, ..still() }, None);
        assert_eq!(wheel, [Action::Wheel(2.0, HERE)]);
        let pinch = looks(Gesture { pinch: 0.5, ..still() }, None);
        assert_eq!(pinch, [Action::Wheel(0.5, HERE)]);
    }

    #[test]
    fn a_turning_drag_turns_and_alt_with_the_wheel_stretches() {
        let by = DVec2::new(3.0, -1.0);
        let drag = Gesture { dragged: by, drag_began: Some(DVec2::ZERO), turning: true, ..still() };
        assert_eq!(looks(drag, None), [Action::Look(Look::Turn([HERE - by, HERE]))]);
        let shifted = Gesture { shift: true, ..drag };
        assert_eq!(looks(shifted, None), looks(drag, None), "no rectangle");
        let released = Gesture { released: true, drag_began: None, dragged: DVec2::ZERO, ..drag };
        assert_eq!(looks(released, None), [Action::Look(Look::Release)]);
        let wheel = Gesture { notches: 3.0, stretching: true, ..still() };
        assert_eq!(looks(wheel, None), [Action::Look(Look::Stretch(2.0))]);
    }

    #[test]
    fn the_light_comes_from_where_it_is_dragged() {
        let drag = Gesture {
            dragged: DVec2::new(3.0, -1.0),
            drag_began: Some(DVec2::ZERO),
            lights: true,
            ..still()
        };
        assert_eq!(looks(drag, None), [Action::Light(HERE)], "and the map stays");
        let released = Gesture { released: true, drag_began: None, ..drag };
        assert_eq!(looks(released, None), [Action::Light(HERE), Action::Look(Look::Release)]);
        assert_eq!(looks(Gesture { lights: true, ..still() }, None), [], "only while it drags");
        let corners = [DVec2::ZERO, HERE];
        assert_eq!(looks(drag, Some(corners)), [Action::Drawing(Some(corners))]);
    }

    #[test]
    fn a_click_pins_and_a_second_zooms_instead() {
        assert_eq!(looks(Gesture { clicked: Some(HERE), ..still() }, None), [Action::Pin(HERE)]);
        let moved_on = Gesture { pointer: Some(DVec2::ZERO), clicked: Some(HERE), ..still() };
        assert_eq!(looks(moved_on, None), [Action::Pin(HERE)], "where it was clicked");
        let twice = Gesture { clicked: Some(HERE), double_clicked: true, ..still() };
        let zoom = |factor| Action::Look(Look::Zoom { factor, about: HERE });
        assert_eq!(looks(twice, None), [Action::Unpin, zoom(2.0)]);
        let out = Gesture { shift: true, ..twice };
        assert_eq!(looks(out, None), [Action::Unpin, zoom(0.5)]);
    }

    #[test]
    fn two_clicks_in_one_frame_zoom_and_leave_older_pins_alone() {
        let there = DVec2::new(-50.0, 4.0);
        let twice = Gesture { clicked: Some(HERE), clicked_before: Some(HERE), ..still() };
        let zoom = Action::Look(Look::Zoom { factor: 2.0, about: HERE });
        assert_eq!(looks(Gesture { double_clicked: true, ..twice }, None), [zoom]);
        let apart = Gesture { clicked_before: Some(there), ..twice };
        assert_eq!(looks(apart, None), [Action::Pin(there), Action::Pin(HERE)]);
    }

    #[test]
    fn dragging_moves_and_with_shift_draws_a_box() {
        let by = DVec2::new(3.0, -1.0);
        let drag = Gesture { dragged: by, drag_began: Some(DVec2::ZERO), ..still() };
        assert_eq!(looks(drag, None), [Action::Look(Look::Drag(by))]);
        let began = Gesture { shift: true, ..drag };
        assert_eq!(looks(began, None), [Action::Drawing(Some([DVec2::ZERO; 2]))]);
        let corners = [DVec2::ZERO, HERE];
        assert_eq!(looks(drag, Some([DVec2::ZERO; 2])), [Action::Drawing(Some(corners))]);
        let released = Gesture { released: true, drag_began: None, ..drag };
        let ended = [Action::Drawing(None), Action::Look(Look::Box(corners))];
        assert_eq!(looks(released, Some([DVec2::ZERO; 2])), ended, "to where it is let go");
        let away = Gesture { pointer: None, ..released };
        assert_eq!(looks(away, Some(corners)), ended);
        let ended = [Action::Look(Look::Drag(by)), Action::Look(Look::Release)];
        assert_eq!(looks(released, None), ended, "the last of it counts too");
    }
}
