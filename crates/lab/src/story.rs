//! The story: the seven figures in the lesson's order, each with a question and its answer.

use egui::{Frame, RichText, Ui};

use super::{Figure, FigureRequest};

/// A card that is shown beside a figure.
struct Card {
    /// The question that the figure answers.
    question: &'static str,
    /// The answer, in paragraphs.
    answer: [&'static str; 2],
    /// Something to try.
    attempt: &'static str,
}

/// The cards in the order of the figures.
const CARDS: [Card; 7] = [
    Card {
        question: "How much must be said about a pendulum to know its future?",
        answer: [
            "Two numbers: its angle, and how fast the angle changes. Together they are a point of \
             the phase plot below, and the equation of motion says where each point goes next. \
             Nothing else is remembered.",
            "The mass is missing in that equation. It makes the bob heavier and harder to move to \
             the same degree, and cancels.",
        ],
        attempt: "Let go close to the top: the point creeps along the dashed line between \
                  swinging and going round.",
    },
    Card {
        question: "What is lost if sin θ is taken for θ?",
        answer: [
            "For small swings almost nothing: the period is 2π√(r/g) whatever the amplitude, and \
             clocks rely on it.",
            "Wide swings take longer, without limit towards the top, where the pull fades. The \
             exact period is the small one divided by a mean of 1 and cos(θ0/2), the \
             arithmetic-geometric mean, which a few roots give to all digits.",
        ],
        attempt: "Let go at 10°, at 90° and at 170°, and count how long the ghost keeps step.",
    },
    Card {
        question: "What changes when a second pendulum hangs below the first?",
        answer: [
            "The lower one swings from a pivot that is itself thrown about, and pulls back at it. \
             Four numbers now make a state: two angles and two speeds.",
            "Energy wanders between the two without a rhythm. Small swings are still the sum of \
             two simple ones; for wide swings nobody has a formula, and only following them step \
             by step tells what comes.",
        ],
        attempt: "Drag both arcs to small angles, then to wide ones, and watch the path.",
    },
    Card {
        question: "Why can M always be inverted?",
        answer: [
            "The equation M α = τ gives the accelerations only if M has an inverse. Half of \
             ω · M ω is the kinetic energy. It is above zero whenever anything moves, so M sends \
             no direction to zero, which is all an inverse needs.",
            "The determinant shows it in numbers. It is least where the rods are in line, and for \
             two bobs it is even there m1 m2 l1² l2², never zero while both have mass.",
        ],
        attempt: "Make m1 as small as it goes and bring the rods in line: det M shrinks, and stays \
                  above its bound.",
    },
    Card {
        question: "What does symplectic mean, and why does its warranty end here?",
        answer: [
            "The true motion moves every patch of phase space, angles against momenta, without \
             changing its area. A step that does so too is called symplectic. It is all but exact \
             for a slightly different pendulum with an energy of its own, so its energy error \
             sways and does not drift.",
            "Semi-implicit Euler is such a step where the kinetic energy does not depend on the \
             angles. Here it does, through cos(θ1 − θ2), and speeds are not momenta: the promise \
             no longer covers it. RK4 never promised anything; its error is merely tiny.",
        ],
        attempt: "Make Δt larger and see which energy runs away first.",
    },
    Card {
        question: "What is the horizon?",
        answer: [
            "Pendulums that start a hair apart separate by the same factor in every second, a \
             straight line on the logarithmic scale. Its slope λ says when a forecast fails: after \
             ln(tolerance / precision) / λ seconds. That is the horizon.",
            "Precision enters as a logarithm. A start known a thousand times better buys the same \
             few seconds each time, so the weather of this pendulum stays unknown beyond.",
        ],
        attempt: "Make the nudge a thousand times smaller: the fan opens only a little later.",
    },
    Card {
        question: "Why is a third of the map free?",
        answer: [
            "To flip, the second bob has to pass upright over its pivot. The cheapest such pose \
             has the first rod hanging. A start with less energy than that pose never gets there, \
             because energy is conserved: no step need be computed.",
            "For two equal bobs these are 30.64 % of all starts, for equal bars 24.39 %. All others \
             have to be tried, one by one, and between quick and late flips there is detail at \
             every depth.",
        ],
        attempt: "Zoom to the border of the dark lens, and press D to go deeper.",
    },
];

/// Shows the card of a figure, and returns a request if the user goes on, goes back or ends the
/// story.
pub fn card(ui: &mut Ui, figure: Figure) -> Option<FigureRequest> {
    let Card { question, answer, attempt } = &CARDS[figure as usize];
    let mut asked = None;
    Frame::group(ui.style()).show(ui, |ui| {
        ui.label(RichText::new(*question).heading().strong());
        for paragraph in answer {
            ui.label(*paragraph);
        }
        ui.label(RichText::new(format!("Try: {attempt}")).italics());
        ui.horizontal_wrapped(|ui| {
            let [back, next] = [-1, 1].map(|by| figure.beside(by));
            if let Some(back) = back
                && ui.button("Back").on_hover_text("Page Up").clicked()
            {
                asked = Some(FigureRequest::Show(back));
            }
            if let Some(next) = next
                && ui.button("Next").on_hover_text("Page Down").clicked()
            {
                asked = Some(FigureRequest::Show(next));
            }
            if ui.button("End the story").clicked() {
                asked = Some(FigureRequest::EndStory);
            }
            ui.label(format!("{} of {}", figure as usize + 1, CARDS.len()));
        });
    });
    ui.add_space(8.0);
    asked
}
