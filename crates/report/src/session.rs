//! The tasks of a report, done one after the other.

use super::backend::{self, BackendFilter};
use super::depth::Truths;
use super::measure::{Bench, refusal};
use super::measurement::{Chapter, Measurement, Subject};
use super::questions::QuestionTruths;
use super::{
    Backend, HardRow, Machine, Refusal, Report, ReportError, StopTest, TestSet, Thoroughness,
    claims, motion, plan,
};

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
    /// Starts the engines and obtains the gold standard's answers; nothing is timed yet. Measures the
    /// chapters `only`, or all if that is empty.
    pub fn open(
        field: &BackendFilter,
        care: Thoroughness,
        only: &[Chapter],
        stop: StopTest,
    ) -> Result<Self, ReportError> {
        let (backends, not_offered) = backend::discover(field, stop)?;
        let tasks = Measurement::all(&backends, care.quick, only);
        let sample = if tasks.iter().any(Measurement::needs_truth) { care.sample } else { 0 };
        let test_set = TestSet::home(sample, stop)?;
        let report = Report {
            machine: Machine::here(backends.iter().map(Backend::full_name).collect()),
            quick: care.quick,
            only: only.to_vec(),
            sample: test_set.sample.len(),
            missing: tasks.iter().map(|task| task.name(&backends)).collect(),
            not_offered,
            ..Report::default()
        };
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
        self.report.claims = claims::claims(&self.report);
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
        let backend = &mut backends[task.backend];
        match task.subject {
            Subject::Row(config) => report.rows.push(bench.row(backend, config)?),
            Subject::Exact => report.exact.push(bench.exact(backend)?),
            Subject::Specialising(config) => {
                report.specialising.extend(bench.specialising(backend, config)?);
            }
            Subject::Motion => report.motion = motion::errors(&plan::motions(), stop)?,
            Subject::Window(window) => report.windows.push(bench.window(&window, backend)?),
            Subject::Late(window) => report.late.push(bench.late(&window, backend)?),
            Subject::Depth(config, place) => {
                report.depth.push(bench.depth(&place, config, backend, truths)?);
            }
            Subject::Asked(config, ask) => {
                report.questions.push(bench.question(ask, config, backend, question_truths)?);
            }
            Subject::Zoom(zoom) => report.zooms.push(bench.zoom(&zoom, backend)?),
            Subject::Painting => report.painting = Some(bench.painting(backend)?),
            Subject::Hard(case) => {
                let name = backend.short_name();
                report.hard.push(HardRow::of(&case, name, backend.engine()));
            }
        }
        Ok(())
    }

    /// Records a refusal. Engines refuse a method in a precision whatever its setting, so one line
    /// covers all settings; a refused comparison of kernels needs no line of its own.
    fn refuse(&mut self, task: Measurement, reason: String) {
        let what = match task.subject {
            Subject::Specialising(_) | Subject::Motion => return,
            Subject::Row(config) => format!("{} in {}", config.method.name(), config.precision),
            Subject::Depth(config, _) => format!("deep zoom by {}", plan::words(&config)),
            Subject::Zoom(_) | Subject::Painting => "films".to_string(),
            subject => subject.words(),
        };
        let engine = self.backends[task.backend].short_name();
        let refusal = Refusal { engine, what, reason };
        if !self.report.not_offered.contains(&refusal) {
            self.report.not_offered.push(refusal);
        }
    }
}
