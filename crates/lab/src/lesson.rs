//! The lesson: at every figure a class predicts, observes, and then reveals the answer.

use egui::{Button, Frame, RichText, Ui};

use super::drawing::Tint;
use super::predictions::{Prediction, predictions};
use super::set_up::PREFIX;
use super::{Figure, FigureRequest, Lab};

/// The state of the lesson.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lesson {
    /// True if the lesson is shown beside the figures.
    pub is_on: bool,
    /// The figure that is asked about, and the index of the question.
    figure: Option<Figure>,
    question: usize,
    /// Index of the choice that the class has committed to.
    choice: Option<usize>,
    /// True once the answer is shown.
    is_revealed: bool,
}

impl Lesson {
    /// Returns true if a class has made its choice and the answer is still hidden.
    pub fn awaits_reveal(&self) -> bool {
        self.is_on && self.choice.is_some() && !self.is_revealed
    }

    /// Returns true while the answer must not be seen anywhere.
    pub fn hides_answer(&self) -> bool {
        self.is_on && !self.is_revealed
    }

    /// Returns true if a class has not made its choice.
    pub fn awaits_choice(&self) -> bool {
        self.is_on && self.choice.is_none()
    }

    /// Shows the answer.
    pub fn reveal(&mut self) {
        self.is_revealed = true;
    }

    /// Returns the lesson with a question that nobody has answered.
    fn asking(figure: Figure, question: usize) -> Self {
        Lesson { is_on: true, figure: Some(figure), question, ..Lesson::default() }
    }
}

/// What a class did with a card.
enum Answer {
    Choose(usize),
    Reveal,
    Ask(usize),
    Request(FigureRequest),
}

impl Lab {
    /// Begins the lesson with the first figure, or ends it.
    pub fn set_lesson(&mut self, is_on: bool) {
        self.lesson = Lesson { is_on, ..Lesson::default() };
    }

    /// Asks a question about the figure that is shown: opens it as the question begins, and pauses it.
    fn ask(&mut self, question: usize) {
        self.lesson = Lesson::asking(self.figure, question);
        let prediction = &predictions(self.figure)[question];
        open_for(self, prediction);
        self.playing.paused |= prediction.set_up.is_some();
    }

    /// Shows the question of the figure that is shown. A choice lets the figure run.
    pub fn lesson_card(&mut self, ui: &mut Ui) -> Option<FigureRequest> {
        let figure = self.figure;
        if self.lesson.figure != Some(figure) {
            self.ask(0);
        }
        let prediction = &predictions(figure)[self.lesson.question];
        match card(ui, figure, &self.lesson, prediction)? {
            Answer::Choose(choice) => {
                self.lesson.choice = Some(choice);
                self.playing.paused = false;
            }
            Answer::Reveal => self.lesson.reveal(),
            Answer::Ask(question) => self.ask(question),
            Answer::Request(request) => {
                if request == FigureRequest::EndLesson {
                    self.lesson = Lesson::default();
                }
                return Some(request);
            }
        }
        None
    }
}

/// Opens the figure that is shown as a question begins.
pub(super) fn open_for(lab: &mut Lab, prediction: &Prediction) {
    if let Some(words) = prediction.set_up {
        let line = format!("{PREFIX}{};{words}", lab.figure.name());
        let opened = lab.open_set_up(&line);
        debug_assert_eq!(opened, Ok(()), "{line}");
    }
}

/// Shows a question with its choices, then what to observe, then the answer.
fn card(ui: &mut Ui, figure: Figure, lesson: &Lesson, prediction: &Prediction) -> Option<Answer> {
    let mut answer = None;
    Frame::group(ui.style()).show(ui, |ui| {
        let (place, count) = (figure as usize + 1, predictions(figure).len());
        let question = lesson.question + 1;
        ui.weak(format!("Figure {place} of 7, question {question} of {count}"));
        ui.label(RichText::new(prediction.ask).heading().strong());
        for (k, choice) in prediction.choices.into_iter().enumerate() {
            if choice_button(ui, k, choice, lesson, prediction).clicked() && !lesson.is_revealed {
                answer = Some(Answer::Choose(k));
            }
        }
        match lesson.choice {
            None => {
                ui.label("Predict: commit to one, then watch.");
            }
            Some(_) if !lesson.is_revealed => {
                ui.label(RichText::new(format!("Observe: {}", prediction.observe)).italics());
                if ui.button("Reveal").on_hover_text("Space").clicked() {
                    answer = Some(Answer::Reveal);
                }
            }
            Some(choice) => {
                let words = if choice == prediction.right { "Right." } else { "Not so." };
                ui.label(RichText::new(format!("{words} {}", prediction.why)));
            }
        }
        ui.separator();
        answer = steps(ui, figure, lesson).or(answer.take());
    });
    ui.add_space(8.0);
    answer
}

/// Shows a choice; once the answer is revealed, with a word and in its colour.
fn choice_button(
    ui: &mut Ui,
    k: usize,
    choice: &str,
    lesson: &Lesson,
    prediction: &Prediction,
) -> egui::Response {
    let letter = ["A", "B", "C"][k];
    let [wrong, _, right, _] = Tint::of(ui).parts;
    let is_chosen = lesson.choice == Some(k);
    let mut words = RichText::new(format!("{letter}  {choice}"));
    if lesson.is_revealed && k == prediction.right {
        words = RichText::new(format!("{letter}  {choice} (right)")).color(right).strong();
    } else if lesson.is_revealed && is_chosen {
        words = RichText::new(format!("{letter}  {choice} (not so)")).color(wrong);
    }
    ui.add(Button::selectable(is_chosen && !lesson.is_revealed, words).wrap())
}

/// Shows the ways on and back.
fn steps(ui: &mut Ui, figure: Figure, lesson: &Lesson) -> Option<Answer> {
    let mut answer = None;
    let count = predictions(figure).len();
    ui.horizontal_wrapped(|ui| {
        let show =
            |by| figure.beside(by).map(|figure| Answer::Request(FigureRequest::Show(figure)));
        let back = match lesson.question {
            0 => show(-1),
            question => Some(Answer::Ask(question - 1)),
        };
        let next = match lesson.question + 1 {
            question if question < count => Some(Answer::Ask(question)),
            _ => show(1),
        };
        for (name, step) in [("Back", back), ("Next", next)] {
            if let Some(step) = step
                && ui.button(name).clicked()
            {
                answer = Some(step);
            }
        }
        if ui.button("End the lesson").clicked() {
            answer = Some(Answer::Request(FigureRequest::EndLesson));
        }
    });
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_asks_two_or_three_questions_that_have_an_answer() {
        let mut asked = std::collections::BTreeSet::new();
        for figure in Figure::all() {
            let questions = predictions(figure);
            assert!((2..=3).contains(&questions.len()), "{figure:?}");
            for question in questions {
                assert!(question.right < question.choices.len(), "{question:?}");
                assert!(asked.insert(question.ask), "{question:?}");
                assert!(question.ask.len() < 100 && question.why.len() < 360, "{question:?}");
                let words =
                    question.set_up.map(|words| format!("{PREFIX}{};{words}", figure.name()));
                assert_eq!(words.is_some(), figure != Figure::Map, "{question:?}");
                let opened = words.map_or(Ok(()), |line| Lab::new(figure).open_set_up(&line));
                assert_eq!(opened, Ok(()), "{question:?}");
            }
        }
        let right: Vec<usize> =
            Figure::all().flat_map(predictions).map(|question| question.right).collect();
        let count = |place: usize| right.iter().filter(|right| **right == place).count();
        assert!((0..3).all(|place| count(place) >= 3), "no letter is never right: {right:?}");
    }

    #[test]
    fn the_answer_is_hidden_until_a_choice_was_made() {
        let mut lesson = Lesson { is_on: true, ..Lesson::default() };
        assert!(!lesson.awaits_reveal(), "nothing was predicted");
        lesson.choice = Some(2);
        assert!(lesson.awaits_reveal());
        lesson.reveal();
        assert!(!lesson.awaits_reveal());
        lesson = Lesson::asking(Figure::Ghost, 1);
        assert_eq!((lesson.choice, lesson.is_revealed), (None, false));
    }
}
