//! The numbers of a pin: its start, flip time, the map's outcome, and the energy error.

use egui::{Grid, RichText, Ui};

use crate::pins::Pin;
use flipmap_engine::Trust;
use flipmap_numbers::number_text::{fixed, significant};
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::separation::reading_at;
use flipmap_pendulum::{Outcome, Status};
use flipmap_screen::flight::{Agreement, Flight, FlightEnding};

/// Shows when the pendulum flips, and a warning if the map says otherwise.
pub(super) fn headline(ui: &mut Ui, pin: &Pin) {
    let outcome = pin.flight.outcome();
    let words = match outcome {
        Some(outcome) if outcome.status == Status::Answered => {
            format!("Flips after {:.3} s", outcome.time.hi)
        }
        Some(outcome) if outcome.status == Status::Forbidden => {
            "Has too little energy to flip".into()
        }
        _ => format!("Flip: {}", flown_words(&pin.flight, outcome)),
    };
    ui.strong(words).on_hover_text(FLOWN);
    if let Some(apart) = agreement(pin).filter(|agreement| *agreement != Agreement::Same) {
        let words = format!("Map and gold standard {}", agreement_words(apart));
        ui.colored_label(ui.visuals().warn_fg_color, words).on_hover_text(BOTH);
    }
}

/// Shows the numbers as tables of names and values.
pub(super) fn facts(ui: &mut Ui, pin: &Pin) {
    Grid::new("start").num_columns(4).show(ui, |ui| {
        for (name, theta) in ["θ1", "θ2"].into_iter().zip(pin.start.angle) {
            let rad = theta.to_f64();
            ui.label(name).on_hover_text(format!("{name} = {theta} rad"));
            ui.label(format!("{} rad", fixed(rad, 6)));
            ui.label(format!("{} π", fixed(rad / std::f64::consts::PI, 6)));
            ui.label(format!("{}°", fixed(rad.to_degrees(), 4)));
            ui.end_row();
        }
    });
    let [thrown, _] = pin.start.launches;
    if !thrown.is_at_rest() {
        let [omega1, omega2] = thrown.speed.map(|speed| speed.hi);
        let words = format!("ω1 {} rad/s, ω2 {} rad/s", fixed(omega1, 6), fixed(omega2, 6));
        ui.label(words).on_hover_text("The speeds with which it is thrown");
    }
    Grid::new("facts").num_columns(2).show(ui, |ui| {
        let mut row = |name: &str, why: &str, value: RichText| {
            ui.label(name).on_hover_text(why);
            ui.label(value);
            ui.end_row();
        };
        let flight = &pin.flight;
        row("Flip, gold standard", FLOWN, flown_words(flight, flight.outcome()).into());
        row("Flip, on the map", TOLD, told_words(pin).into());
        // Agreement means nothing if the energy forbids a flip, because nothing was measured.
        let [own, beside] = [flight.outcome(), flight.ghost_outcome()];
        let is_forbidden = own.is_some_and(|outcome| outcome.status == Status::Forbidden);
        let agreement =
            agreement(pin).filter(|agreement| !is_forbidden || *agreement != Agreement::Same);
        if let Some(agreement) = agreement {
            let words = RichText::new(agreement_words(agreement));
            let same = agreement == Agreement::Same;
            row("Both", BOTH, if same { words } else { words.strong() });
        }
        if !is_forbidden || beside != own {
            row("Flip, one pixel away", BESIDE, flown_words(flight, beside).into());
        }
        row("Energy error", ENERGY, energy_words(pin).into());
        if let Some(words) = ending_words(flight) {
            row("Record", RECORD, words.into());
        }
    });
}

const FLOWN: &str = "When the pendulum drawn above flips, in numbers of 32 digits";
const TOLD: &str = "What the picture says about this pixel, and how well that was checked";
const BOTH: &str = "Whether the map and the gold standard agree";
const BESIDE: &str = "When the dashed pendulum flips";
const ENERGY: &str = "How far the energy has drifted by now, as a share of P + Q, the weights of \
                      the two angles; without friction it should not drift at all";
const RECORD: &str = "A long motion is kept only up to a number of steps";

/// Describes the gold standard's outcome of the pendulum or its ghost, or the flight's progress.
fn flown_words(flight: &Flight, outcome: Option<Outcome<Dd>>) -> String {
    let known_secs = round_secs(flight.record().end_secs());
    match (outcome, flight.record().ending) {
        (Some(outcome), _) => {
            let time = outcome.time.hi;
            outcome_words(&Outcome { status: outcome.status, time }, flight)
        }
        (None, None) => format!("flying, {known_secs} s so far"),
        (None, Some(_)) => format!("none in the first {known_secs} s"),
    }
}

/// Returns the agreement of the map with the gold standard; none until both are known.
fn agreement(pin: &Pin) -> Option<Agreement> {
    let (told, _) = pin.told?;
    Some(Agreement::of(&told, &pin.flight.outcome()?))
}

fn told_words(pin: &Pin) -> String {
    let Some((outcome, assurance)) = pin.told else { return "not computed yet".into() };
    let mut words = outcome_words(&outcome, &pin.flight);
    let trust = assurance.trust();
    if let (Status::Answered, Some(secs)) = (outcome.status, assurance.error_secs()) {
        words += &format!(" ± {} s", significant(secs, 1));
    }
    let known = Trust::ALL.into_iter().find(|(_, t)| *t == trust && trust != Trust::Unchecked);
    known.map_or(words.clone(), |(trust, _)| format!("{words}, {trust}"))
}

fn outcome_words(outcome: &Outcome, flight: &Flight) -> String {
    match outcome.status {
        Status::Answered => format!("{:.6} s", outcome.time),
        Status::Unflipped => {
            format!("none within {} s", round_secs(flight.question().budget_secs))
        }
        Status::Forbidden => "forbidden by its energy".into(),
        Status::Failed => "failed".into(),
    }
}

fn agreement_words(agreement: Agreement) -> String {
    match agreement {
        Agreement::Same => "agree within 1 ms".into(),
        Agreement::Apart(secs) if secs < 1.0 => format!("differ by {:.1} ms!", secs * 1e3),
        Agreement::Apart(secs) => format!("differ by {secs:.3} s!"),
        Agreement::OtherStatus => "differ!".into(),
    }
}

/// Describes the energy error relative to P + Q: the current one, and the worst so far.
fn energy_words(pin: &Pin) -> String {
    let readings = &pin.flight.record().readings;
    let secs = pin.shown_secs();
    let Some(now) = reading_at(readings, secs) else { return "not known yet".into() };
    let worst = readings
        .iter()
        .take_while(|reading| reading.secs <= secs)
        .fold(0.0, |worst: f64, reading| worst.max(reading.energy_error.abs()));
    format!("{}, at worst {}", significant(now.energy_error.abs(), 1), significant(worst, 1))
}

/// Describes where and why the record ends; none if it is complete or still growing.
fn ending_words(flight: &Flight) -> Option<String> {
    let end_secs = round_secs(flight.record().end_secs());
    match flight.record().ending? {
        FlightEnding::Complete => None,
        FlightEnding::Full => Some(format!("ends at {end_secs} s; no more is kept")),
        FlightEnding::NotFinite => Some(format!("ends at {end_secs} s; no number after it")),
        FlightEnding::BrokenOff => Some(format!("broke off at {end_secs} s; pin it again")),
    }
}

/// Formats seconds to four significant digits, without trailing zeros.
pub(super) fn round_secs(secs: f64) -> String {
    let digits = (3.0 - secs.abs().max(1e-12).log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{secs:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_short() {
        let words = [30.0, 0.0, 412.3456, 1e6, 0.001_234_56, 2.5].map(round_secs);
        assert_eq!(words, ["30", "0", "412.3", "1000000", "0.001235", "2.5"]);
    }

    #[test]
    fn differences_are_told_in_the_unit_that_fits() {
        assert_eq!(agreement_words(Agreement::Apart(0.0123)), "differ by 12.3 ms!");
        assert_eq!(agreement_words(Agreement::Apart(3.2)), "differ by 3.200 s!");
    }
}
