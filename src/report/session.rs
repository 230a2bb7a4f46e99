//! The work of a report, one task after the other.

use super::contender::{self, Field};
use super::measure::{Bench, refusal};
use super::{
    Contender, Ground, Machine, Refusal, Report, ReportError, StopTest, Thoroughness, motion, plan,
    targets,
};
use crate::engine::Recipe;

/// Something to be measured, in a list of such.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Task {
    /// A row of the contender with this number.
    Row(usize, Recipe),
    /// What specialising buys on it.
    Specialising(usize, Recipe),
    /// Errors in angle and energy.
    Motion,
}

/// Engines, starts and tasks.
pub struct Session {
    contenders: Vec<Contender>,
    ground: Ground,
    care: Thoroughness,
    tasks: Vec<Task>,
    done: usize,
    report: Report,
}

impl Session {
    /// Starts the engines and asks the gold standard; nothing is timed yet.
    pub fn open(field: &Field, care: Thoroughness, stop: StopTest) -> Result<Self, ReportError> {
        let (contenders, not_offered) = contender::muster(field, stop)?;
        let tasks = tasks(&contenders, care.quick);
        let ground = Ground::home(care.sample, stop)?;
        let report = Report {
            machine: Machine::here(contenders.iter().map(Contender::full_name).collect()),
            quick: care.quick,
            sample: ground.sample.len(),
            complete: false,
            missing: tasks.iter().map(|task| name(task, &contenders)).collect(),
            rows: Vec::new(),
            not_offered,
            specialising: Vec::new(),
            motion: Vec::new(),
            targets: targets::judge(&[]),
            sections: Vec::new(),
        };
        Ok(Session { contenders, ground, care, tasks, done: 0, report })
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
        self.report.targets = targets::judge(&self.report.rows);
        Ok(())
    }

    fn perform(&mut self, task: Task, stop: StopTest) -> Result<(), ReportError> {
        let bench = Bench { ground: &self.ground, care: &self.care, stop };
        match task {
            Task::Row(index, recipe) => {
                self.report.rows.push(bench.row(&mut self.contenders[index], recipe)?);
            }
            Task::Specialising(index, recipe) => {
                let gain = bench.specialising(&mut self.contenders[index], recipe)?;
                self.report.specialising.extend(gain);
            }
            Task::Motion => self.report.motion = motion::errors(&plan::motions(), stop)?,
        }
        Ok(())
    }

    /// Engines refuse a method in a precision whatever its setting: one line for all of them.
    fn refuse(&mut self, task: Task, reason: String) {
        let Task::Row(index, recipe) = task else { return };
        let what = format!("{} in {}", recipe.method.name(), recipe.precision);
        let refusal = Refusal { engine: self.contenders[index].short_name(), what, reason };
        if !self.report.not_offered.contains(&refusal) {
            self.report.not_offered.push(refusal);
        }
    }
}

fn tasks(contenders: &[Contender], quick: bool) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (index, contender) in contenders.iter().enumerate() {
        tasks.extend(plan::recipes(quick).into_iter().map(|recipe| Task::Row(index, recipe)));
        if let Contender::Gpu(_) = contender {
            let recipes = plan::specialised(quick).iter();
            tasks.extend(recipes.map(|recipe| Task::Specialising(index, *recipe)));
        }
    }
    tasks.push(Task::Motion);
    tasks
}

fn name(task: &Task, contenders: &[Contender]) -> String {
    match task {
        Task::Row(index, recipe) => {
            format!("{}: {}", contenders[*index].short_name(), plan::words(recipe))
        }
        Task::Specialising(index, recipe) => format!(
            "{}: what specialising buys {}",
            contenders[*index].short_name(),
            plan::words(recipe)
        ),
        Task::Motion => "errors in angle and energy".to_string(),
    }
}
