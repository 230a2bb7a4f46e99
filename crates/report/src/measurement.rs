//! The tasks of a report: what is measured on which engine, and the chapter that it belongs to.

use serde::Serialize;

use super::depth::{FilamentPlace, PLACES};
use super::films::{ShortZoom, ZOOMS};
use super::hard::{self, HardCase};
use super::questions::measured_questions;
use super::windows::{self, Window};
use super::{Backend, plan};
use flipmap_engine::{EngineKind, IntegratorConfig};
use flipmap_scene::question::QuestionName;

/// A part of a report that can be measured by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Chapter {
    /// Speed and errors of the methods on the home map.
    Methods,
    /// Windows beyond the home map, those of late flips among them.
    Windows,
    /// Deep zoom.
    Depth,
    /// Questions other than the first flip.
    Questions,
    /// Hard cases.
    Hard,
    /// The time of a long film.
    Films,
}

impl Chapter {
    /// Every chapter.
    pub const ALL: [Chapter; 6] = [
        Chapter::Methods,
        Chapter::Windows,
        Chapter::Depth,
        Chapter::Questions,
        Chapter::Hard,
        Chapter::Films,
    ];

    /// Name of the chapter on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Chapter::Methods => "methods",
            Chapter::Windows => "windows",
            Chapter::Depth => "depth",
            Chapter::Questions => "questions",
            Chapter::Hard => "hard",
            Chapter::Films => "films",
        }
    }

    /// Returns true if a quick report has the chapter.
    pub fn is_quick(self) -> bool {
        self != Chapter::Films
    }

    /// The chapter called `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|chapter| chapter.name() == name)
    }
}

/// A task of a session.
#[derive(Clone, Copy)]
pub(super) struct Measurement {
    /// Index into the list of backends.
    pub backend: usize,
    /// The subject that is measured on it.
    pub subject: Subject,
}

/// The subject of a measurement.
#[derive(Clone, Copy)]
pub(super) enum Subject {
    /// A config on the home map.
    Row(IntegratorConfig),
    /// The accuracy `exact`.
    Exact,
    /// The gain of specialised kernels.
    Specialising(IntegratorConfig),
    /// Errors in angle and energy, which need no engine.
    Motion,
    /// A window.
    Window(Window),
    /// A window of late flips.
    Late(Window),
    /// A config at a deep place.
    Depth(IntegratorConfig, FilamentPlace),
    /// A question by a config.
    Asked(IntegratorConfig, QuestionName),
    /// The samples of a short zoom.
    Zoom(ShortZoom),
    /// The frames of a film.
    Painting,
    /// A hard case.
    Hard(HardCase),
}

/// Number of deep places in a quick report.
const QUICK_PLACES: usize = 6;

impl Measurement {
    /// The tasks of a report, without those outside the chapters `only` unless that is empty.
    pub(super) fn all(backends: &[Backend], quick: bool, only: &[Chapter]) -> Vec<Self> {
        let mut tasks = Vec::new();
        for (index, backend) in backends.iter().enumerate() {
            let subjects = of_home(quick, backend.kind() == EngineKind::Gpu);
            tasks.extend(subjects.into_iter().map(|subject| (index, subject)));
        }
        // The last backend is the processor, if it takes part.
        let last = backends.len() - 1;
        tasks.push((last, Subject::Motion));
        tasks.extend(windows::WINDOWS.map(|window| (last, Subject::Window(window))));
        tasks.extend(windows::LATE.map(|window| (last, Subject::Late(window))));
        // A quick report includes only the last backend, and nothing that takes minutes.
        for index in if quick { last..last + 1 } else { 0..last + 1 } {
            let kind = backends[index].kind();
            let hard =
                hard::cases().into_iter().filter(|case| case.is_for(kind)).map(Subject::Hard);
            let subjects = of_depth(quick).chain(of_questions(quick)).chain(hard);
            tasks.extend(subjects.map(|subject| (index, subject)));
        }
        tasks.extend(ZOOMS.map(|zoom| (last, Subject::Zoom(zoom))));
        tasks.push((last, Subject::Painting));
        let asked = |chapter: Chapter| {
            (chapter.is_quick() || !quick) && (only.is_empty() || only.contains(&chapter))
        };
        let tasks = tasks.into_iter().filter(|(_, subject)| asked(subject.chapter()));
        let mut tasks: Vec<Self> =
            tasks.map(|(backend, subject)| Measurement { backend, subject }).collect();
        // Chapter by chapter, engine by engine.
        tasks.sort_by_key(|task| task.subject.chapter());
        tasks
    }

    /// Returns true if it compares answers with the gold standard's on the home map.
    pub(super) fn needs_truth(&self) -> bool {
        matches!(self.subject, Subject::Row(_) | Subject::Exact)
    }

    /// Describes the measurement with its engine.
    pub(super) fn name(&self, backends: &[Backend]) -> String {
        match self.subject {
            Subject::Motion => self.subject.words(),
            subject => format!("{}: {}", backends[self.backend].short_name(), subject.words()),
        }
    }
}

fn of_home(quick: bool, is_gpu: bool) -> Vec<Subject> {
    let mut subjects: Vec<Subject> = plan::configs(quick).into_iter().map(Subject::Row).collect();
    subjects.push(Subject::Exact);
    if is_gpu {
        subjects.extend(plan::specialised(quick).iter().copied().map(Subject::Specialising));
    }
    subjects
}

fn of_depth(quick: bool) -> impl Iterator<Item = Subject> {
    let places = &PLACES[..if quick { QUICK_PLACES } else { PLACES.len() }];
    let of_config = |config| places.iter().map(move |place| Subject::Depth(config, *place));
    plan::DEEP.into_iter().flat_map(of_config)
}

fn of_questions(quick: bool) -> impl Iterator<Item = Subject> {
    let of_config = |config| measured_questions().map(move |ask| Subject::Asked(config, ask));
    plan::questions(quick).into_iter().flat_map(of_config)
}

impl Subject {
    fn chapter(&self) -> Chapter {
        match self {
            Subject::Row(_) | Subject::Exact | Subject::Specialising(_) | Subject::Motion => {
                Chapter::Methods
            }
            Subject::Window(_) | Subject::Late(_) => Chapter::Windows,
            Subject::Depth(..) => Chapter::Depth,
            Subject::Asked(..) => Chapter::Questions,
            Subject::Zoom(_) | Subject::Painting => Chapter::Films,
            Subject::Hard(_) => Chapter::Hard,
        }
    }

    /// Describes the subject, without the engine.
    pub(super) fn words(&self) -> String {
        match self {
            Subject::Row(config) => plan::words(config),
            Subject::Exact => "the accuracy exact".to_string(),
            Subject::Specialising(config) => {
                format!("what specialising buys {}", plan::words(config))
            }
            Subject::Motion => "errors in angle and energy".to_string(),
            Subject::Window(window) => format!("the window {}", window.name),
            Subject::Late(window) => format!("exact beside double-double, {}", window.name),
            Subject::Depth(config, place) => {
                format!("{} at a width of {}", plan::words(config), place.width)
            }
            Subject::Asked(config, ask) => {
                format!("the question {ask} by {}", plan::words(config))
            }
            Subject::Zoom(zoom) => format!("a zoom from {:e} rad", zoom.width_rad),
            Subject::Painting => "the frames of a film".to_string(),
            Subject::Hard(case) => format!("the hard case {}", case.name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(quick: bool, only: &[Chapter]) -> Vec<String> {
        let backends = [Backend::processor(Some(1)).unwrap()];
        let tasks = Measurement::all(&backends, quick, only);
        tasks.iter().map(|task| task.name(&backends)).collect()
    }

    #[test]
    fn the_chapters_together_are_the_report_and_a_quick_one_is_a_part_of_it() {
        let all = names(false, &[]);
        let by_chapter: Vec<String> =
            Chapter::ALL.iter().flat_map(|chapter| names(false, &[*chapter])).collect();
        assert_eq!(all, by_chapter);
        let mut different = all.clone();
        different.sort();
        different.dedup();
        assert_eq!(different.len(), all.len(), "none twice");
        let quick = names(true, &[]);
        assert!(quick.iter().all(|name| all.contains(name)) && quick.len() < all.len());
        for chapter in Chapter::ALL {
            assert_eq!(names(true, &[chapter]).is_empty(), !chapter.is_quick(), "{chapter:?}");
            assert_eq!(Chapter::named(chapter.name()), Some(chapter));
        }
        assert_eq!(
            names(true, &[Chapter::Hard, Chapter::Windows]).len(),
            names(true, &[Chapter::Hard]).len() + names(true, &[Chapter::Windows]).len()
        );
        assert_eq!(Chapter::named("nothing"), None);
    }
}
