//! The caption at the pointer: where a sample starts, and what becomes of its pendulum.

use super::hover::Answer;
use super::reach::Reach;
use flipmap_engine::Trust;
use flipmap_numbers::number_text::fixed;
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::Status;
use flipmap_scene::lattice::pitch_rad;
use flipmap_scene::question::{Channel, ChannelScale};
use flipmap_scene::{PlaneKind, Scene};

/// Describes the sample of a level at a place: its coordinates on the scene's plane and its answer,
/// if it is known.
pub fn words_of(
    (place, answer): ([Exact; 2], Option<Answer>),
    scene: &Scene,
    level: u32,
) -> String {
    let reach = Reach::of(scene);
    // Enough digits to tell neighbouring samples apart.
    let pitch = pitch_rad(level) * reach.units();
    let digits = (1.0 - pitch.log10()).ceil().max(2.0) as usize;
    let place = place_words(scene, reach.coordinates(place), digits);
    let fate = answer.map_or("being computed".to_string(), |answer| told(scene, &answer));
    // More than two numbers get a line of their own.
    let between = if scene.question.ask.kind().channels.len() > 2 { "\n" } else { " · " };
    format!("{place}{between}{fate}")
}

/// Formats the coordinates of a point of a scene's plane with their units.
pub fn place_words(scene: &Scene, coordinates: [Exact; 2], digits: usize) -> String {
    let axes = scene.plane.axes();
    let [x, y] = [0, 1].map(|i| {
        let value = coordinates[i];
        let value = if axes[i].wraps() { value.wrapped() } else { value };
        format!("{} {}", axes[i].symbol(), plain(value, digits))
    });
    let [across, up] = axes.map(|axis| axis.unit());
    if across == up { format!("{x}, {y} {up}") } else { format!("{x} {across}, {y} {up}") }
}

/// Formats a coordinate with `digits` decimals, in f64 if that has enough, because it is quicker.
fn plain(value: Exact, digits: usize) -> String {
    if digits < 15 { format!("{:.digits$}", value.to_f64()) } else { value.decimal(digits) }
}

/// Describes an answer.
fn told(scene: &Scene, answer: &Answer) -> String {
    let question = &scene.question;
    let kind = question.ask.kind();
    let doubt = if answer.assurance.trust() == Trust::Uncertain { ", uncertain" } else { "" };
    match answer.status {
        Status::Answered if question.ask.is_time() => match question.count {
            1 => format!("flips after {:.4} s{doubt}", answer.values[0]),
            count => format!("flip {count} after {:.4} s{doubt}", answer.values[0]),
        },
        Status::Answered => {
            let values = kind.channels.iter().zip(answer.values);
            values
                .map(|(channel, value)| value_words(channel, value))
                .collect::<Vec<_>>()
                .join(", ")
                + doubt
        }
        Status::Unflipped if question.ask.is_time() => match question.count {
            1 => format!("does not flip within the budget{doubt}"),
            count => format!("flips fewer than {count} times within the budget{doubt}"),
        },
        Status::Unflipped => format!("{} within the budget{doubt}", kind.counted[1]),
        Status::Forbidden if scene.plane.kind == PlaneKind::Section => {
            "no start here, or too little energy to flip".to_string()
        }
        Status::Forbidden => "can never flip: too little energy".to_string(),
        Status::Failed => "could not be integrated".to_string(),
    }
}

/// Formats a channel's name, value and unit; whole numbers have no decimals.
fn value_words(Channel { name, unit, right, scale }: &Channel, value: f64) -> String {
    let is_whole = *right == 0.0 && !matches!(scale, ChannelScale::Times);
    let value = fixed(value, if is_whole { 0 } else { 4 });
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    format!("{name} {value}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::question::{MAX_CHANNELS, QuestionName};
    use flipmap_scene::{Plane, QuestionSettings};

    fn answer(status: Status, first: &[f64], trust: Trust) -> Option<Answer> {
        let mut values = [0.0; MAX_CHANNELS];
        values[..first.len()].copy_from_slice(first);
        Some(Answer { status, values, assurance: trust.into() })
    }

    #[test]
    fn words_tell_the_fate_and_enough_digits() {
        let place = [-1.66, 0.1].map(Exact::from_f64);
        let home = Scene::default();
        let words = |answer, level| words_of((place, answer), &home, level);
        let flipped = answer(Status::Answered, &[3.21], Trust::Uncertain);
        assert_eq!(
            words(flipped, 4),
            "θ1 -1.6600, θ2 0.1000 rad · flips after 3.2100 s, uncertain"
        );
        let forbidden = answer(Status::Forbidden, &[], Trust::Unchecked);
        assert!(words(forbidden, 0).contains("never"));
        assert!(words(None, 60).contains("being computed") && words(None, 60).len() > 50);
    }

    #[test]
    fn other_questions_and_planes_have_their_own_words() {
        let question = QuestionSettings { ask: QuestionName::First, ..QuestionSettings::default() };
        let plane = Plane { kind: "first".parse().unwrap(), ..Plane::default() };
        let scene = Scene { question, plane, ..Scene::default() };
        let reach = Reach::of(&scene);
        let place = reach.place([7.0, -12.5].map(Exact::from_f64));
        let words = |answer| words_of((place, answer), &scene, 5);
        let first = answer(Status::Answered, &[2.0, 1.5], Trust::Agreed);
        // 7 rad is 7 − 2π.
        assert_eq!(words(first), "θ1 0.717 rad, ω1 -12.500 rad/s · bob 2, time 1.5000 s");
        let none = answer(Status::Unflipped, &[], Trust::Agreed);
        assert!(words(none).ends_with("unflipped within the budget"), "{}", words(none));
    }
}
