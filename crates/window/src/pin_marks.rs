//! The pins as the history remembers them, without their flights.

use super::flight::{Flight, Trail};
use super::pin_start::PinStart;
use super::pins::{Badge, Pin, PinId, Pins};

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

    /// Brings back pins as they were; pendulums that no longer fly are released at the clock's
    /// zero. Each new flight calls `wake` whenever there is more to show.
    pub(crate) fn restore(&mut self, marks: &[PinMark], wake: impl Fn() + Clone + Send + 'static) {
        let mut old = std::mem::take(&mut self.list);
        self.list = marks
            .iter()
            .map(|&PinMark { id, start, badge }| {
                let place = old.iter().position(|pin| pin.id == id);
                match place.map(|place| old.swap_remove(place)) {
                    Some(pin) if pin.start.launches == start.launches => Pin { start, ..pin },
                    _ => {
                        let flight = Flight::launch(self.question, start.launches, wake.clone());
                        let trail = Trail::new(&self.build.pendulum());
                        Pin { id, start, badge, told: None, flight, trail, shown_secs: 0.0 }
                    }
                }
            })
            .collect();
        if self.selected().is_none() {
            self.selected = self.list.last().map(|pin| pin.id);
        }
        self.show();
    }
}
