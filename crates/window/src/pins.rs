//! The pixels that the user has pinned: each has its own flight, and all share one clock.

use egui::Color32;

use flipmap_engine::{Assurance, EventSpec};
use flipmap_pendulum::Outcome;
use flipmap_scene::{PendulumSpec, Scene};
use flipmap_screen::flight::{Flight, Playback, Trail};
use flipmap_screen::pin_start::PinStart;

/// Largest number of pins at once.
pub(crate) const MAX_PINS: usize = 8;

/// Okabe and Ito's colours, which colour-blind people can tell apart, with grey for their black.
const COLOURS: [Color32; MAX_PINS] = [
    Color32::from_rgb(0xe6, 0x9f, 0x00),
    Color32::from_rgb(0x56, 0xb4, 0xe9),
    Color32::from_rgb(0x00, 0x9e, 0x73),
    Color32::from_rgb(0xf0, 0xe4, 0x42),
    Color32::from_rgb(0x00, 0x72, 0xb2),
    Color32::from_rgb(0xd5, 0x5e, 0x00),
    Color32::from_rgb(0xcc, 0x79, 0xa7),
    Color32::from_rgb(0x99, 0x99, 0x99),
];

/// The identifier of a pin, never reused while the window is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PinId(u64);

/// The mark of a pin on the map and in the panel: a letter and a colour, never a colour alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Badge(usize);

impl Badge {
    /// Returns the letter, A to H.
    pub(crate) fn letter(self) -> char {
        char::from(b'A' + self.0 as u8)
    }

    /// Returns the colour that goes with the letter.
    pub(crate) fn colour(self) -> Color32 {
        COLOURS[self.0]
    }
}

/// A pinned pixel.
#[derive(Debug)]
pub struct Pin {
    /// Identifier of the pin.
    pub id: PinId,
    /// Starts of its pendulum and of the one beside it.
    pub start: PinStart,
    /// Mark of the pin.
    pub badge: Badge,
    /// Outcome and its assurance that the map shows, once they are known.
    pub told: Option<(Outcome, Assurance)>,
    /// Flight of its pendulum.
    pub flight: Flight,
    /// Recent path of its pendulum.
    pub trail: Trail,
    shown_secs: f64,
}

impl Pin {
    /// Returns the moment shown, in s: that of the clock, limited to what is known of the flight.
    pub fn shown_secs(&self) -> f64 {
        self.shown_secs
    }

    fn show(&mut self, secs: f64) {
        let record = self.flight.record();
        self.shown_secs = secs.min(record.end_secs());
        self.trail.follow(&record.own.motion, self.shown_secs);
    }
}

/// The error that all pins are in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("all {MAX_PINS} pins are in use; remove one to pin another pixel")]
pub struct NoPinLeft;

/// An action of the user on a pin, or on the clock of all pins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PinAction {
    /// Shows the pin.
    Select(PinId),
    /// Removes the pin from the map.
    Remove(PinId),
    /// Resumes the flights.
    Play,
    /// Pauses the flights.
    Pause,
    /// Releases all pendulums again.
    Restart,
    /// Goes to this many seconds after the release.
    Scrub(f64),
    /// Sets the speed of the clock in simulated seconds per second.
    Speed(f64),
}

/// All pins, and the physics that their flights follow.
#[derive(Debug)]
pub struct Pins {
    build: PendulumSpec,
    question: EventSpec,
    pub(super) list: Vec<Pin>,
    clock: Playback,
    pub(super) selected: Option<PinId>,
    /// Pin that the last click on the map made.
    pub clicked: Option<PinId>,
    /// Pin that is being dragged.
    pub held: Option<PinId>,
    next_id: u64,
}

impl Pins {
    /// Creates an empty list, for the pendulum and question of a checked scene.
    pub fn new(scene: &Scene) -> Self {
        Pins {
            build: scene.build,
            question: EventSpec::from(scene),
            list: Vec::new(),
            clock: Playback::default(),
            selected: None,
            clicked: None,
            held: None,
            next_id: 0,
        }
    }

    /// Returns the specification of the pendulum.
    pub(crate) fn build(&self) -> &PendulumSpec {
        &self.build
    }

    /// Returns the pins in the order in which they were set.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Pin> {
        self.list.iter()
    }

    /// Returns true if there are no pins.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Returns the selected pin, which is the one shown.
    pub fn selected(&self) -> Option<&Pin> {
        self.list.iter().find(|pin| Some(pin.id) == self.selected)
    }

    /// Returns the pin with an identifier.
    pub fn get(&self, id: PinId) -> Option<&Pin> {
        self.list.iter().find(|pin| pin.id == id)
    }

    /// Returns the clock that all flights share.
    pub fn clock(&self) -> &Playback {
        &self.clock
    }

    /// Returns true if the pendulums are flying, so that the window has to be redrawn.
    pub(crate) fn is_playing(&self) -> bool {
        !self.list.is_empty() && self.clock.is_playing()
    }

    /// Pins a pixel, releases its pendulum together with all others and selects the pin. The
    /// flight's thread calls `wake` whenever there is more to show.
    pub fn add(
        &mut self,
        start: PinStart,
        told: Option<(Outcome, Assurance)>,
        wake: impl Fn() + Send + 'static,
    ) -> Result<PinId, NoPinLeft> {
        let free = |&slot: &usize| self.list.iter().all(|pin| pin.badge != Badge(slot));
        let badge = Badge((0..MAX_PINS).find(free).ok_or(NoPinLeft)?);
        let id = PinId(self.next_id);
        self.next_id += 1;
        let pin = self.launched(id, badge, start, wake);
        self.list.push(Pin { told, ..pin });
        self.selected = Some(id);
        self.clock.restart();
        self.show();
        Ok(id)
    }

    /// Returns a pin whose pendulum takes off; the flight's thread calls `wake` whenever there is more
    /// to show.
    pub(super) fn launched(
        &self,
        id: PinId,
        badge: Badge,
        start: PinStart,
        wake: impl Fn() + Send + 'static,
    ) -> Pin {
        let flight = Flight::launch(self.question, start.launches, wake);
        let trail = Trail::new(&self.build.pendulum());
        Pin { id, start, badge, told: None, flight, trail, shown_secs: 0.0 }
    }

    /// Moves a pin to another start, releases its pendulum together with all others and selects the
    /// pin; the flight's thread calls `wake` whenever there is more to show.
    pub fn set_start(
        &mut self,
        id: PinId,
        start: PinStart,
        told: Option<(Outcome, Assurance)>,
        wake: impl Fn() + Send + 'static,
    ) {
        let (question, trail) = (self.question, Trail::new(&self.build.pendulum()));
        let Some(pin) = self.get_mut(id) else { return };
        pin.flight = Flight::launch(question, start.launches, wake);
        (pin.start, pin.told, pin.trail) = (start, told, trail);
        self.selected = Some(id);
        self.clock.restart();
        self.show();
    }

    /// Sets the outcome that the map shows for a pin's pixel.
    pub fn tell(&mut self, id: PinId, told: (Outcome, Assurance)) {
        if let Some(pin) = self.get_mut(id) {
            pin.told = Some(told);
        }
    }

    /// Takes what the flights have computed and advances the clock by a frame.
    pub fn advance(&mut self, elapsed_secs: f64) {
        self.list.iter_mut().for_each(|pin| {
            pin.flight.receive();
        });
        if let Some((known_secs, complete)) = self.known() {
            self.clock.advance(elapsed_secs, known_secs, complete);
        }
        self.show();
    }

    /// Returns the time in s up to which the clock may advance, and true if all flights are
    /// complete: then it is the end of the longest flight, otherwise the time up to which all
    /// incomplete flights are known. Returns `None` if there are no pins.
    fn known(&self) -> Option<(f64, bool)> {
        let ends = |complete: bool| {
            let records = self.list.iter().map(|pin| pin.flight.record());
            let of_kind = records.filter(move |record| record.ending.is_some() == complete);
            of_kind.map(|record| record.end_secs())
        };
        let under_way = ends(false).min_by(f64::total_cmp).map(|secs| (secs, false));
        under_way.or_else(|| Some((ends(true).max_by(f64::total_cmp)?, true)))
    }

    /// Brings every pin to the moment of the clock.
    pub(super) fn show(&mut self) {
        let secs = self.clock.time_secs();
        self.list.iter_mut().for_each(|pin| pin.show(secs));
    }

    /// Does what the user asked for; ignores a pin that no longer exists.
    pub fn apply(&mut self, action: PinAction) {
        match action {
            PinAction::Select(id) => self.select(id),
            PinAction::Remove(id) => self.remove(id),
            PinAction::Play => {
                let end = self.known().filter(|(_, complete)| *complete);
                self.clock.play(end.map_or(f64::INFINITY, |(secs, _)| secs));
            }
            PinAction::Pause => self.clock.pause(),
            PinAction::Restart => self.clock.restart(),
            PinAction::Scrub(secs) => self.clock.scrub(secs),
            PinAction::Speed(speed) => self.clock.set_speed(speed),
        }
        self.show();
    }

    /// Removes the pin that the last click made.
    pub(crate) fn remove_clicked(&mut self) {
        if let Some(id) = self.clicked.take() {
            self.remove(id);
        }
    }

    /// Follows a change of the scene: if the pendulum or the question has changed, relaunches all
    /// flights and forgets the outcomes that the map showed for the pins.
    pub(crate) fn relaunch(&mut self, scene: &Scene, wake: impl Fn() + Clone + Send + 'static) {
        let question = EventSpec::from(scene);
        self.build = scene.build;
        if question == self.question {
            return;
        }
        self.question = question;
        for pin in &mut self.list {
            pin.flight = Flight::launch(question, pin.start.launches, wake.clone());
            pin.trail = Trail::new(&scene.build.pendulum());
            pin.told = None;
        }
    }

    /// Takes all pins off the map, because another plane is shown; they keep flying.
    pub(crate) fn leave_plane(&mut self) {
        for pin in &mut self.list {
            pin.start.place = None;
        }
    }

    fn get_mut(&mut self, id: PinId) -> Option<&mut Pin> {
        self.list.iter_mut().find(|pin| pin.id == id)
    }

    fn select(&mut self, id: PinId) {
        if self.get(id).is_some() {
            self.selected = Some(id);
        }
    }

    /// Removes a pin. If it was selected, selects the one that takes its place, or else the last.
    fn remove(&mut self, id: PinId) {
        let Some(place) = self.list.iter().position(|pin| pin.id == id) else { return };
        self.list.remove(place);
        if self.selected == Some(id) {
            let next = self.list.get(place).or(self.list.last());
            self.selected = next.map(|pin| pin.id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::Trust;
    use flipmap_numbers::Decimal;
    use flipmap_numbers::Scalar;

    fn place(theta1: f64) -> PinStart {
        PinStart::at_rest([theta1, theta1 + 0.01].map(|theta1| [theta1, 1.4].map(Scalar::from_f64)))
    }

    fn with_pins(count: usize) -> (Pins, Vec<PinId>) {
        let mut pins = Pins::new(&Scene::default());
        let ids = (0..count).map(|i| pins.add(place(2.0 + i as f64 / 10.0), None, || ()).unwrap());
        let ids = ids.collect();
        (pins, ids)
    }

    fn wait(pins: &mut Pins) {
        while pins.iter().any(|pin| pin.flight.record().ending.is_none()) {
            pins.advance(0.0);
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }

    #[test]
    fn there_are_eight_each_with_its_own_letter_and_colour() {
        let (mut pins, ids) = with_pins(MAX_PINS);
        let letters: String = pins.iter().map(|pin| pin.badge.letter()).collect();
        assert_eq!(letters, "ABCDEFGH");
        let colours: std::collections::HashSet<_> = pins.iter().map(|p| p.badge.colour()).collect();
        assert_eq!(colours.len(), MAX_PINS);
        assert_eq!(pins.add(place(1.0), None, || ()), Err(NoPinLeft));
        assert_eq!(pins.iter().len(), MAX_PINS);
        pins.apply(PinAction::Remove(ids[2]));
        let again = pins.add(place(1.0), None, || ()).unwrap();
        assert_eq!(pins.get(again).unwrap().badge.letter(), 'C', "a letter becomes free again");
        assert!(!ids.contains(&again));
    }

    #[test]
    fn the_newest_is_selected_and_a_removed_one_gives_way_to_its_neighbour() {
        let (mut pins, ids) = with_pins(3);
        let selected = |pins: &Pins| pins.selected().map(|pin| pin.id);
        assert_eq!(selected(&pins), Some(ids[2]));
        pins.apply(PinAction::Select(ids[1]));
        pins.apply(PinAction::Remove(ids[0]));
        assert_eq!(selected(&pins), Some(ids[1]));
        pins.apply(PinAction::Remove(ids[1]));
        assert_eq!(selected(&pins), Some(ids[2]));
        pins.apply(PinAction::Select(ids[0]));
        assert_eq!(selected(&pins), Some(ids[2]), "one that is gone cannot be selected");
        pins.apply(PinAction::Remove(ids[2]));
        assert!(selected(&pins).is_none() && pins.is_empty());
    }

    #[test]
    fn all_fly_by_one_clock() {
        let (mut pins, ids) = with_pins(2);
        wait(&mut pins);
        let times = |pins: &Pins| [0, 1].map(|i| pins.get(ids[i]).unwrap().shown_secs());
        pins.apply(PinAction::Speed(2.0));
        pins.advance(1.5);
        assert_eq!(times(&pins), [3.0, 3.0]);
        assert!(pins.iter().all(|pin| pin.trail.points().count() > 250), "each leaves a trail");
        pins.apply(PinAction::Pause);
        pins.advance(1.5);
        pins.apply(PinAction::Select(ids[0]));
        assert_eq!((times(&pins), pins.is_playing()), ([3.0, 3.0], false));
        pins.apply(PinAction::Scrub(29.0));
        pins.apply(PinAction::Play);
        pins.advance(2.0);
        assert_eq!((times(&pins), pins.is_playing()), ([30.0, 30.0], false));
        pins.apply(PinAction::Play);
        pins.advance(0.25);
        assert_eq!(times(&pins), [0.5, 0.5], "from the release after the end");
        pins.add(place(1.0), None, || ()).unwrap();
        assert_eq!((times(&pins), pins.is_playing()), ([0.0, 0.0], true), "all are let go again");
        pins.apply(PinAction::Remove(ids[0]));
        pins.apply(PinAction::Remove(ids[1]));
        pins.apply(PinAction::Remove(pins.selected().unwrap().id));
        assert!(!pins.is_playing(), "nothing flies");
    }

    #[test]
    fn other_physics_fly_anew_and_another_view_does_not() {
        let (mut pins, ids) = with_pins(1);
        wait(&mut pins);
        let flip = |pins: &Pins| pins.selected().unwrap().flight.outcome().unwrap();
        let earth = flip(&pins);
        pins.tell(ids[0], (Outcome::flipped(earth.time.hi), Trust::Agreed.into()));
        pins.apply(PinAction::Scrub(2.0));
        let view = flipmap_scene::View { width: "1".into(), ..flipmap_scene::View::default() };
        pins.relaunch(&Scene { view, ..Scene::default() }, || ());
        assert!(pins.selected().unwrap().told.is_some());

        let build = PendulumSpec { gravity: Decimal::from(9.81 * 4.0), ..PendulumSpec::default() };
        pins.relaunch(&Scene { build, ..Scene::default() }, || ());
        assert!(pins.selected().unwrap().told.is_none());
        wait(&mut pins);
        // Four times the gravity is the same motion at twice the speed.
        assert!((flip(&pins).time.hi * 2.0 - earth.time.hi).abs() < 1e-9);
        assert_eq!(pins.clock().time_secs(), 2.0);
    }
}
