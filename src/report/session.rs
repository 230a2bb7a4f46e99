//! The work of a report, one task after the other.

use super::contender::{self, Field};
use super::depth::{PLACES, Place, Truths};
use super::hard::Case;
use super::measure::{Bench, refusal};
use super::windows::{self, Window};
use super::{
    Contender, Ground, HardRow, Machine, Refusal, Report, ReportError, StopTest, Thoroughness,
    hard, motion, plan, targets,
};
use crate::engine::Recipe;

/// Something to be measured, in a list of such; numbers are places in the lists of contenders,
/// windows and cases.
#[derive(Clone, Copy)]
enum Task {
    /// A row of a contender.
    Row(usize, Recipe),
    /// The accuracy `exact` on it.
    Exact(usize),
    /// What specialising buys on it.
    Specialising(usize, Recipe),
    /// Errors in angle and energy.
    Motion,
    /// A window on a contender.
    Window(usize, Window),
    /// A late one.
    Late(usize, Window),
    /// A recipe at a deep place.
    Depth(usize, Recipe, Place),
    /// A hard case on a contender.
    Hard(usize, Case),
}

/// Engines, starts and tasks.
pub struct Session {
    contenders: Vec<Contender>,
    ground: Ground,
    care: Thoroughness,
    threads: Option<usize>,
    tasks: Vec<Task>,
    done: usize,
    truths: Truths,
    report: Report,
}

impl Session {
    /// Starts the engines and asks the gold standard; nothing is timed yet.
    pub fn open(field: &Field, care: Thoroughness, stop: StopTest) -> Result<Self, ReportError> {
        let (contenders, not_offered) = contender::muster(field, stop)?;
        let tasks = tasks(&contenders, care.quick);
        let ground = Ground::home(care.sample, stop)?;
        let mut report = Report {
            machine: Machine::here(contenders.iter().map(Contender::full_name).collect()),
            quick: care.quick,
            sample: ground.sample.len(),
            complete: false,
            missing: tasks.iter().map(|task| name(task, &contenders)).collect(),
            rows: Vec::new(),
            not_offered,
            specialising: Vec::new(),
            motion: Vec::new(),
            targets: Vec::new(),
            exact: Vec::new(),
            windows: Vec::new(),
            late: Vec::new(),
            depth: Vec::new(),
            hard: Vec::new(),
        };
        report.targets = targets::judge(&report);
        let threads = field.threads;
        let truths = Truths::default();
        Ok(Session { contenders, ground, care, threads, tasks, done: 0, truths, report })
    }

    /// What is known so far.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// How many tasks there are.
    pub fn len(&self) -> usize {
        self.tasks.len()
    }

    /// Whether there is nothing to do.
    pub fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }

    /// How many are done.
    pub fn done(&self) -> usize {
        self.done
    }

    /// What comes next.
    pub fn next_name(&self) -> Option<&str> {
        self.report.missing.first().map(String::as_str)
    }

    /// Does the next task; afterwards the report says so. Stopped, it is as if never begun.
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

    fn perform(&mut self, task: Task, stop: StopTest) -> Result<(), ReportError> {
        // Some tasks, short ones, do not look themselves.
        if stop() {
            return Err(ReportError::Stopped);
        }
        let Session { ground, care, threads, contenders, truths, report, .. } = self;
        let bench = Bench { ground, care, threads: *threads, stop };
        match task {
            Task::Row(index, recipe) => {
                report.rows.push(bench.row(&mut contenders[index], recipe)?);
            }
            Task::Exact(index) => report.exact.push(bench.exact(&mut contenders[index])?),
            Task::Specialising(index, recipe) => {
                report.specialising.extend(bench.specialising(&mut contenders[index], recipe)?);
            }
            Task::Motion => report.motion = motion::errors(&plan::motions(), stop)?,
            Task::Window(index, window) => {
                report.windows.push(bench.window(&window, &mut contenders[index])?);
            }
            Task::Late(index, window) => {
                report.late.push(bench.late(&window, &mut contenders[index])?);
            }
            Task::Depth(index, recipe, place) => {
                let row = bench.depth(&place, recipe, &mut contenders[index], truths)?;
                report.depth.push(row);
            }
            Task::Hard(index, case) => {
                let contender = &mut contenders[index];
                let name = contender.short_name();
                report.hard.push(HardRow::of(&case, name, contender.engine()));
            }
        }
        Ok(())
    }

    /// Engines refuse a method in a precision whatever its setting: one line for all of them.
    /// What specialising buys goes without saying then.
    fn refuse(&mut self, task: Task, reason: String) {
        let (index, what) = match task {
            Task::Specialising(..) | Task::Motion => return,
            Task::Row(index, recipe) => {
                (index, format!("{} in {}", recipe.method.name(), recipe.precision))
            }
            Task::Exact(index)
            | Task::Window(index, _)
            | Task::Late(index, _)
            | Task::Hard(index, _) => (index, what(&task)),
            Task::Depth(index, recipe, _) => {
                (index, format!("deep zoom by {}", plan::words(&recipe)))
            }
        };
        let refusal = Refusal { engine: self.contenders[index].short_name(), what, reason };
        if !self.report.not_offered.contains(&refusal) {
            self.report.not_offered.push(refusal);
        }
    }
}

/// Deep places in a quick report.
const QUICK_PLACES: usize = 5;

fn tasks(contenders: &[Contender], quick: bool) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (index, contender) in contenders.iter().enumerate() {
        tasks.extend(plan::recipes(quick).into_iter().map(|recipe| Task::Row(index, recipe)));
        tasks.push(Task::Exact(index));
        if let Contender::Gpu(_) = contender {
            let recipes = plan::specialised(quick).iter();
            tasks.extend(recipes.map(|recipe| Task::Specialising(index, *recipe)));
        }
    }
    tasks.push(Task::Motion);
    // The processor, if it takes part.
    let last = contenders.len() - 1;
    tasks.extend(windows::WINDOWS.map(|window| Task::Window(last, window)));
    tasks.extend(windows::LATE.map(|window| Task::Late(last, window)));
    for index in 0..contenders.len() {
        // In a quick report only the processor, and nothing that takes minutes.
        if index == last || !quick {
            let places = &PLACES[..if quick { QUICK_PLACES } else { PLACES.len() }];
            let recipes = plan::DEEP.into_iter();
            tasks.extend(recipes.flat_map(|recipe| {
                places.iter().map(move |place| Task::Depth(index, recipe, *place))
            }));
        }
    }
    for (index, contender) in contenders.iter().enumerate() {
        let fits = |case: &Case| case.is_for(contender.name());
        if index == last || !quick {
            let cases = hard::cases().into_iter().filter(fits);
            tasks.extend(cases.map(|case| Task::Hard(index, case)));
        }
    }
    tasks
}

fn name(task: &Task, contenders: &[Contender]) -> String {
    match task {
        Task::Row(index, _)
        | Task::Exact(index)
        | Task::Specialising(index, _)
        | Task::Window(index, _)
        | Task::Late(index, _)
        | Task::Depth(index, ..)
        | Task::Hard(index, _) => format!("{}: {}", contenders[*index].short_name(), what(task)),
        Task::Motion => what(task),
    }
}

/// What a task measures, whoever is asked.
fn what(task: &Task) -> String {
    match task {
        Task::Row(_, recipe) => plan::words(recipe),
        Task::Exact(_) => "the accuracy exact".to_string(),
        Task::Specialising(_, recipe) => format!("what specialising buys {}", plan::words(recipe)),
        Task::Motion => "errors in angle and energy".to_string(),
        Task::Window(_, window) => format!("the window {}", window.name),
        Task::Late(_, window) => format!("exact beside double-double, {}", window.name),
        Task::Depth(_, recipe, place) => {
            format!("{} at a width of {}", plan::words(recipe), place.width)
        }
        Task::Hard(_, case) => format!("the hard case {}", case.name),
    }
}
