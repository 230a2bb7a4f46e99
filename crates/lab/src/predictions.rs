//! The lesson's questions: what a class predicts before it watches a figure.

use super::Figure;

/// A question with choices, of which a class picks one before it watches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction {
    /// The question.
    pub ask: &'static str,
    /// The choices.
    pub choices: [&'static str; 3],
    /// Index of the right choice.
    pub right: usize,
    /// What to watch.
    pub observe: &'static str,
    /// Why the right choice is right.
    pub why: &'static str,
    /// The words of the set-up with which the figure opens for this question; all others have their
    /// defaults. None for the map, which stays where it is.
    pub set_up: Option<&'static str>,
}

/// Returns a figure's questions, in order.
pub(super) fn predictions(figure: Figure) -> &'static [Prediction] {
    match figure {
        Figure::Single => &SINGLE,
        Figure::Ghost => &GHOST,
        Figure::Double => &DOUBLE,
        Figure::Machine => &MACHINE,
        Figure::Integrators => &INTEGRATORS,
        Figure::Twenty => &TWENTY,
        Figure::Map => &MAP,
    }
}

const SINGLE: [Prediction; 3] = [
    Prediction {
        ask: "The bob is made four times as heavy. How long does a swing to and fro take?",
        choices: ["It takes longer.", "It takes as long as before.", "It takes less time."],
        right: 1,
        observe: "Move the slider of the mass while it swings, and keep an eye on the rhythm.",
        why: "Gravity pulls four times as hard at a bob that is four times as hard to move. The \
              mass stands on both sides of the equation and cancels.",
        set_up: Some("start=0.9"),
    },
    Prediction {
        ask: "Besides r and g, how many numbers must be known now to know its whole future?",
        choices: ["One: the angle.", "Two: the angle and its speed.", "All of its past."],
        right: 1,
        observe: "Follow the point in the phase plot. Does it ever leave one place in two \
                  directions?",
        why: "The equation gives the acceleration from the angle, so angle and speed say where the \
              point goes next. Nothing else is remembered.",
        set_up: Some("start=2.0"),
    },
    Prediction {
        ask: "The rod is made four times as long. How long does a small swing take?",
        choices: ["As long as before.", "Twice as long.", "Four times as long."],
        right: 1,
        observe: "Count the swings in ten seconds, move the slider of the rod, and count again.",
        why: "The acceleration is −(g/r) sin θ, and a rate per second squared that is a quarter \
              makes times twice as long: small swings take 2π√(r/g).",
        set_up: Some("start=0.3"),
    },
];

const GHOST: [Prediction; 3] = [
    Prediction {
        ask: "Both are let go at 2 rad. The ghost obeys α = −(g/r) θ. Which is back first?",
        choices: ["The ghost.", "The real pendulum.", "Both at once."],
        right: 0,
        observe: "Watch who leads after one swing, and after two.",
        why: "sin θ is less than θ, so far out the real pull is weaker than the ghost's, and wide \
              swings take longer. The ghost takes 2π√(r/g) whatever its amplitude.",
        set_up: Some("start=2.0"),
    },
    Prediction {
        ask: "At 10°, after how many swings is the ghost ahead by a tenth of a swing?",
        choices: ["About 5.", "About 50.", "Never."],
        right: 1,
        observe: "Compare the two periods on the right: by what part do they differ?",
        why: "The exact period is longer by about θ0²/16, for 10° by a 525th. After 52 swings that \
              is a tenth of a swing. A clock swinging that far would lose 165 s a day, so clocks swing \
              narrowly and evenly.",
        set_up: Some("start=0.174533"),
    },
    Prediction {
        ask: "Period over 2π√(r/g), drawn for the Moon, where g is a sixth: how does the curve change?",
        choices: ["It stays as it is.", "It becomes higher.", "It becomes lower."],
        right: 0,
        observe: "Move the slider of gravity to 1.62. Which of the numbers change, and does \
                  the curve?",
        why: "g only sets the unit of time: both periods become about √6 times as long. Their ratio, \
              1 over the agm of 1 and cos(θ0/2), depends on the amplitude alone, and grows without \
              limit towards the top, where the pull fades and the bob creeps.",
        set_up: Some("start=2.6"),
    },
];

const DOUBLE: [Prediction; 3] = [
    Prediction {
        ask: "Two bobs in a plane have four coordinates. How many are free here?",
        choices: ["Four.", "Three.", "Two."],
        right: 2,
        observe: "Drag either bob. What can be chosen, and what do the rods decide?",
        why: "Each rod takes one away by keeping its length. Two angles are left, and a Lagrangian, \
              kinetic minus potential energy in these two, gives their equations. The forces in \
              the rods never appear.",
        set_up: Some("start=0.8,1.4"),
    },
    Prediction {
        ask: "Equal bobs on equal rods are let go at 0.1 and 0.1414 rad. What will they do?",
        choices: [
            "Hand the energy to and fro.",
            "Swing together in one rhythm.",
            "Become chaotic soon.",
        ],
        right: 1,
        observe: "Do both pass the vertical at the same moment, again and again?",
        why: "For small angles there are two normal modes. This is the slow one, with the square of \
              its rate (2 − √2) g/l; any other small swing is a sum of the two.",
        set_up: Some("start=0.1,0.14142"),
    },
    Prediction {
        ask: "In which pose is the cross term m2 l1 l2 cos(θ1 − θ2) ω1 ω2 zero at any speeds?",
        choices: [
            "With the rods in line.",
            "With the rods at a right angle.",
            "With both bobs at the same height.",
        ],
        right: 1,
        observe: "Choose 'cross term' for Up, and pause where it passes zero with both in motion.",
        why: "The second bob's speed is the sum of two, one across each rod. Where the rods are at \
              a right angle so are the two, and squares of such sums have no cross term. In line, \
              the cosine is 1 or −1.",
        set_up: Some("start=1.6,0.0"),
    },
];

const MACHINE: [Prediction; 2] = [
    Prediction {
        ask: "M α = τ has to be solved for α. When does that fail, because det M = 0?",
        choices: ["With the rods in line.", "With both at rest.", "Never."],
        right: 2,
        observe: "Watch det M beside its bound, for as long as you like.",
        why: "ω · M ω is twice the kinetic energy, which is above zero whenever anything moves. So \
              M sends no direction to zero. In numbers: for point bobs det M is at least m1 m2 l1² l2².",
        set_up: Some("start=2.0,2.6"),
    },
    Prediction {
        ask: "In which pose is det M least?",
        choices: ["With the rods in line.", "With the rods at a right angle.", "It is constant."],
        right: 0,
        observe: "Pause, drag the second bob once round the first, and read det M.",
        why: "The product of the diagonal is fixed, and the square of m2 l1 l2 cos Δ is taken from \
              it. That is most where the rods are in line, folded or stretched.",
        set_up: Some("start=2.0,0.9"),
    },
];

const INTEGRATORS: [Prediction; 3] = [
    Prediction {
        ask: "Three methods, one step of 10 ms. Which one gains energy fastest?",
        choices: ["Explicit Euler.", "Semi-implicit Euler.", "RK4."],
        right: 0,
        observe: "Follow the three curves of the energy error.",
        why: "Explicit Euler moves along the tangent, which leaves every closed orbit outwards: a \
              small oscillation's energy is multiplied by 1 + Δt² ω² in each step.",
        set_up: Some("start=1.2,0.9"),
    },
    Prediction {
        ask: "The step is halved. What is left of RK4's error after one second?",
        choices: ["A half.", "A quarter.", "A sixteenth."],
        right: 2,
        observe: "In the lower chart, for one power of ten in Δt, by how many does each error change?",
        why: "The error of a method of order p shrinks with the p-th power of the step. RK4 is of \
              order 4, both Eulers of order 1, and the slopes show it.",
        set_up: Some("start=1.2,0.9"),
    },
    Prediction {
        ask: "Semi-implicit Euler is called symplectic. Does that promise hold here?",
        choices: ["Yes, for every step.", "Yes, for short steps.", "No, whatever the step."],
        right: 2,
        observe: "Make Δt larger and see whether its energy stays in a band.",
        why: "A symplectic step keeps areas of angles against momenta and, if short, an energy close \
              to the true one for very long. This one does so where the kinetic energy does not \
              depend on the angles. Here it does, and speeds are not momenta: no such promise.",
        set_up: Some("start=1.2,0.9"),
    },
];

const TWENTY: [Prediction; 3] = [
    Prediction {
        ask: "Twenty pendulums a ten-millionth of a radian apart. How will they part?",
        choices: ["At a steady pace.", "By the same factor every second.", "All of a sudden."],
        right: 1,
        observe: "Which line do the separations follow on the logarithmic scale?",
        why: "A straight line there means e^(λt). It looks sudden on the stage only because the eye \
              sees nothing of the first five decades.",
        set_up: Some("start=2.2,2.5"),
    },
    Prediction {
        ask: "The nudge is made a thousand times smaller. How much later does the fan open?",
        choices: ["A thousand times later.", "Ten times as late.", "A few seconds later."],
        right: 2,
        observe: "Make the nudge 1e-10 rad, restart, and take the time.",
        why: "About ln 1000 / λ seconds, whatever the nudge was before. Precision enters as a \
              logarithm, so each further thousand buys about the same few seconds.",
        set_up: Some("start=2.2,2.5"),
    },
    Prediction {
        ask: "A start is known to 1e-7 rad. For how long is a forecast good to 0.1 rad?",
        choices: ["About 2 s.", "About 15 s.", "About a minute."],
        right: 1,
        observe: "Let it run, read 1/λ, and work out ln(tolerance / precision) / λ: the row 'horizon'.",
        why: "The error grows from 1e-7 to 0.1, by a million, in ln(10⁶)/λ seconds, 14 to 17 \
              here, as λ is an average over the run. That is the horizon; beyond it this pendulum \
              is weather.",
        set_up: Some("start=2.2,2.5"),
    },
];

const MAP: [Prediction; 2] = [
    Prediction {
        ask: "For which part of all starts does energy alone forbid the second bob to flip?",
        choices: ["None.", "About a tenth.", "About a third."],
        right: 2,
        observe: "Look at the dark grey part, where nothing was integrated.",
        why: "To flip, the second bob has to pass upright over its pivot, at the least with the \
              first rod hanging. A start below that energy never gets there: 2 cos θ1 + cos θ2 > 1 \
              for equal bobs, 30.64 % of all.",
        set_up: None,
    },
    Prediction {
        ask: "Two pendulums start one pixel apart among the filaments. Do they flip together?",
        choices: ["Always.", "Within a tenth of a second.", "Often seconds apart."],
        right: 2,
        observe: "Zoom in there, click a pixel, and fly its pendulum beside the ghost of the next.",
        why: "Between them the separation is multiplied by e every second or so. A finer picture \
              only shows finer filaments: that is what makes the map a fractal.",
        set_up: None,
    },
];
