//! The tasks of a report, done one after the other.

use super::backend::{self, BackendFilter};
use super::depth::{FilamentPlace, PLACES, Truths};
use super::hard::HardCase;
use super::measure::{Bench, refusal};
use super::questions::{QuestionTruths, measured_questions};
use super::windows::{self, Window};
use super::{
    Backend, HardRow, Machine, Refusal, Report, ReportError, StopTest, TestSet, Thoroughness, hard,
    motion, plan, targets,
};
use crate::engine::IntegratorConfig;
use crate::question::Ask;

/// A task of a session; its number is an index into the list of backends.
#[derive(Clone, Copy)]
enum Measurement {
    /// A row of a backend.
    Row(usize, IntegratorConfig),
    /// The accuracy `exact` on a backend.
    Exact(usize),
    /// The gain of specialised kernels on a backend.
    Specialising(usize, IntegratorConfig),
    /// Errors in angle and energy.
    Motion,
    /// A window on a backend.
    Window(usize, Window),
    /// A window of late flips on a backend.
    Late(usize, Window),
    /// A config at a deep place on a backend.
    Depth(usize, IntegratorConfig, FilamentPlace),
    /// A question by a config on a backend.
    Asked(usize, IntegratorConfig, Ask),
    /// A hard case on a backend.
    Hard(usize, HardCase),
}

/// A report in progress: its engines, starts and tasks.
pub struct Session {
    backends: Vec<Backend>,
    test_set: TestSet,
    care: Thoroughness,
    threads: Option<usize>,
    tasks: Vec<Measurement>,
    done: usize,
    truths: Truths,
    question_truths: QuestionTruths,
    report: Report,
}

impl Session {
    /// Starts the engines and obtains the gold standard's answers; nothing is timed yet.
    pub fn open(
        field: &BackendFilter,
        care: Thoroughness,
        stop: StopTest,
    ) -> Result<Self, ReportError> {
        let (backends, not_offered) = backend::discover(field, stop)?;
        let tasks = tasks(&backends, care.quick);
        let test_set = TestSet::home(care.sample, stop)?;
        let mut report = Report {
            machine: Machine::here(backends.iter().map(Backend::full_name).collect()),
            quick: care.quick,
            sample: test_set.sample.len(),
            complete: false,
            missing: tasks.iter().map(|task| name(task, &backends)).collect(),
            rows: Vec::new(),
            not_offered,
            specialising: Vec::new(),
            motion: Vec::new(),
            targets: Vec::new(),
            exact: Vec::new(),
            windows: Vec::new(),
            late: Vec::new(),
            depth: Vec::new(),
            questions: Vec::new(),
            hard: Vec::new(),
        };
        report.targets = targets::judge(&report);
        let threads = field.threads;
        let (truths, question_truths) = Default::default();
        let done = 0;
        Ok(Session {
            backends,
            test_set,
            care,
            threads,
            tasks,
            done,
            truths,
            question_truths,
            report,
        })
    }

    /// The results so far.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Number of tasks.
    pub fn len(&self) -> usize {
        self.tasks.len()
    }

    /// Returns true if there are no tasks.
    pub fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }

    /// Number of tasks done.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Name of the next task, or `None` when all are done.
    pub fn next_name(&self) -> Option<&str> {
        self.report.missing.first().map(String::as_str)
    }

    /// Does the next task and adds its results to the report. A task that is stopped adds nothing
    /// and stays the next one.
    pub fn advance(&mut self, stop: StopTest) -> Result<(), ReportError> {
        let Some(&task) = self.tasks.get(self.done) else { return Ok(()) };
        if let Err(error) = self.perform(task, stop) {
            let reason = refusal(&error).ok_or(error)?;
            self.refuse(task, reason);
        }
        self.done += 1;
        self.report.missing.remove(0);
        self.report.complete = self.report.missing.is_empty();
        self.report.targets = targets::judge(&self.report);
        Ok(())
    }

    fn perform(&mut self, task: Measurement, stop: StopTest) -> Result<(), ReportError> {
        // Some short tasks do not check this themselves.
        if stop() {
            return Err(ReportError::Stopped);
        }
        let Session { test_set, care, threads, backends, truths, question_truths, report, .. } =
            self;
        let bench = Bench { test_set, care, threads: *threads, stop };
        match task {
            Measurement::Row(index, config) => {
                report.rows.push(bench.row(&mut backends[index], config)?);
            }
            Measurement::Exact(index) => report.exact.push(bench.exact(&mut backends[index])?),
            Measurement::Specialising(index, config) => {
                report.specialising.extend(bench.specialising(&mut backends[index], config)?);
            }
            Measurement::Motion => report.motion = motion::errors(&plan::motions(), stop)?,
            Measurement::Window(index, window) => {
                report.windows.push(bench.window(&window, &mut backends[index])?);
            }
            Measurement::Late(index, window) => {
                report.late.push(bench.late(&window, &mut backends[index])?);
            }
            Measurement::Depth(index, config, place) => {
                let row = bench.depth(&place, config, &mut backends[index], truths)?;
                report.depth.push(row);
            }
            Measurement::Asked(index, config, ask) => {
                let backend = &mut backends[index];
                let row = bench.question(ask, config, backend, question_truths)?;
                report.questions.push(row);
            }
            Measurement::Hard(index, case) => {
                let backend = &mut backends[index];
                let name = backend.short_name();
                report.hard.push(HardRow::of(&case, name, backend.engine()));
            }
        }
        Ok(())
    }

    /// Records a refusal. Engines refuse a method in a precision whatever its setting, so one line
    /// covers all settings; a refused comparison of kernels needs no line of its own.
    fn refuse(&mut self, task: Measurement, reason: String) {
        let (index, what) = match task {
            Measurement::Specialising(..) | Measurement::Motion => return,
            Measurement::Row(index, config) => {
                (index, format!("{} in {}", config.method.name(), config.precision))
            }
            Measurement::Exact(index)
            | Measurement::Window(index, _)
            | Measurement::Late(index, _)
            | Measurement::Asked(index, ..)
            | Measurement::Hard(index, _) => (index, what(&task)),
            Measurement::Depth(index, config, _) => {
                (index, format!("deep zoom by {}", plan::words(&config)))
            }
        };
        let refusal = Refusal { engine: self.backends[index].short_name(), what, reason };
        if !self.report.not_offered.contains(&refusal) {
            self.report.not_offered.push(refusal);
        }
    }
}

/// Number of deep places in a quick report.
const QUICK_PLACES: usize = 6;

fn tasks(backends: &[Backend], quick: bool) -> Vec<Measurement> {
    let mut tasks = Vec::new();
    for (index, backend) in backends.iter().enumerate() {
        tasks
            .extend(plan::configs(quick).into_iter().map(|config| Measurement::Row(index, config)));
        tasks.push(Measurement::Exact(index));
        if let Backend::Gpu(_) = backend {
            let configs = plan::specialised(quick).iter();
            tasks.extend(configs.map(|config| Measurement::Specialising(index, *config)));
        }
    }
    tasks.push(Measurement::Motion);
    // The last backend is the processor, if it takes part.
    let last = backends.len() - 1;
    tasks.extend(windows::WINDOWS.map(|window| Measurement::Window(last, window)));
    tasks.extend(windows::LATE.map(|window| Measurement::Late(last, window)));
    for index in 0..backends.len() {
        // A quick report includes only the last backend, and nothing that takes minutes.
        if index == last || !quick {
            let places = &PLACES[..if quick { QUICK_PLACES } else { PLACES.len() }];
            let configs = plan::DEEP.into_iter();
            tasks.extend(configs.flat_map(|config| {
                places.iter().map(move |place| Measurement::Depth(index, config, *place))
            }));
        }
    }
    for index in 0..backends.len() {
        if index == last || !quick {
            let configs = plan::questions(quick);
            tasks.extend(configs.iter().flat_map(|config| {
                measured_questions().map(|ask| Measurement::Asked(index, *config, ask))
            }));
        }
    }
    for (index, backend) in backends.iter().enumerate() {
        let fits = |case: &HardCase| case.is_for(backend.kind());
        if index == last || !quick {
            let cases = hard::cases().into_iter().filter(fits);
            tasks.extend(cases.map(|case| Measurement::Hard(index, case)));
        }
    }
    tasks
}

fn name(task: &Measurement, backends: &[Backend]) -> String {
    match task {
        Measurement::Row(index, _)
        | Measurement::Exact(index)
        | Measurement::Specialising(index, _)
        | Measurement::Window(index, _)
        | Measurement::Late(index, _)
        | Measurement::Depth(index, ..)
        | Measurement::Asked(index, ..)
        | Measurement::Hard(index, _) => {
            format!("{}: {}", backends[*index].short_name(), what(task))
        }
        Measurement::Motion => what(task),
    }
}

/// Describes what a task measures, without the engine.
fn what(task: &Measurement) -> String {
    match task {
        Measurement::Row(_, config) => plan::words(config),
        Measurement::Exact(_) => "the accuracy exact".to_string(),
        Measurement::Specialising(_, config) => {
            format!("what specialising buys {}", plan::words(config))
        }
        Measurement::Motion => "errors in angle and energy".to_string(),
        Measurement::Window(_, window) => format!("the window {}", window.name),
        Measurement::Late(_, window) => format!("exact beside double-double, {}", window.name),
        Measurement::Depth(_, config, place) => {
            format!("{} at a width of {}", plan::words(config), place.width)
        }
        Measurement::Asked(_, config, ask) => {
            format!("the question {ask} by {}", plan::words(config))
        }
        Measurement::Hard(_, case) => format!("the hard case {}", case.name),
    }
}
