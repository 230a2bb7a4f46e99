//! The pins as the history remembers them, without their flights.

use super::pins::{Badge, Pin, PinId, Pins};
use flipmap_screen::pin_start::PinStart;

/// What a pin is, without its flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PinMark {
    id: PinId,
    start: PinStart,
    badge: Badge,
}

impl Pins {
    /// Returns the marks of all pins.
    pub(crate) fn marks(&self) -> Vec<PinMark> {
        let mark = |pin: &Pin| PinMark { id: pin.id, start: pin.start, badge: pin.badge };
        self.iter().map(mark).collect()
    }

    /// Brings back pins as they were; a pendulum that no longer flies takes off again, and the clock
    /// goes on. Each new flight calls `wake` whenever there is more to show.
    pub(crate) fn restore(&mut self, marks: &[PinMark], wake: impl Fn() + Clone + Send + 'static) {
        let mut old = std::mem::take(&mut self.list);
        self.list = marks
            .iter()
            .map(|&PinMark { id, start, badge }| {
                let place = old.iter().position(|pin| pin.id == id);
                match place.map(|place| old.swap_remove(place)) {
                    Some(mut pin) if pin.start.launches == start.launches => {
                        pin.start = start;
                        pin
                    }
                    _ => self.launched(id, badge, start, wake.clone()),
                }
            })
            .collect();
        if self.selected().is_none() {
            self.selected = self.list.last().map(|pin| pin.id);
        }
        self.show();
    }
}
