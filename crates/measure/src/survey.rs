//! A survey: the stages that are done, and those that are not.

use std::collections::BTreeMap;

use flipmap_render::Watch;
use flipmap_render::output::sha256;
use flipmap_render::tiles::Renderer;
use flipmap_scene::{Document, Scene};

use crate::findings::{Findings, findings};
use crate::order::{MeasureError, Statistic, SurveyOrder};
use crate::sampling::{Sampled, Stage};
use crate::{SurveyFolder, page};

/// Version whose samples are alike.
const VERSION: &str = concat!("2 of ", env!("CARGO_PKG_VERSION"));

/// A survey in progress.
pub struct Survey {
    order: SurveyOrder,
    folder: Option<SurveyFolder>,
    done: BTreeMap<String, Sampled>,
}

impl Survey {
    /// Begins a survey that is kept in memory only.
    pub fn new(order: SurveyOrder) -> Result<Self, MeasureError> {
        order.check()?;
        Ok(Survey { order, folder: None, done: BTreeMap::new() })
    }

    /// Begins a survey that keeps its stages in a folder, or goes on with the one that is kept there.
    pub fn within(order: SurveyOrder, folder: SurveyFolder) -> Result<Self, MeasureError> {
        let mut survey = Survey::new(order)?;
        survey.done = folder.read(&survey.key());
        let stages = Stage::all();
        survey.done.retain(|name, sampled| {
            stages.iter().any(|stage| stage.name() == *name && sampled.is_of(*stage))
        });
        survey.folder = Some(folder);
        Ok(survey)
    }

    /// What is measured.
    pub fn order(&self) -> &SurveyOrder {
        &self.order
    }

    /// The stages that the order needs.
    fn stages(&self) -> Vec<Stage> {
        stages_of(&self.order.scene, &self.order.of)
    }

    /// Number of starts that are known already, and of all.
    pub fn extent(&self) -> [u64; 2] {
        let stages = self.stages();
        let sum = |is_counted: &dyn Fn(&Stage) -> bool| {
            stages.iter().filter(|s| is_counted(s)).map(|s| s.size(&self.order)).sum()
        };
        [sum(&|stage| self.done.contains_key(&stage.name())), sum(&|_| true)]
    }

    /// Computes the stages that are missing. Each is kept as soon as it is complete, so that a survey
    /// that is stopped can go on.
    pub fn run(&mut self, renderer: &mut Renderer, watch: &dyn Watch) -> Result<(), MeasureError> {
        for stage in self.stages() {
            let name = stage.name();
            if self.done.contains_key(&name) {
                continue;
            }
            let [done, total] = self.extent();
            let keep_going = |k: u64, _| watch.keep_going(done + k.min(total - done), total);
            let sampled = stage.sample(&self.order, renderer, &keep_going)?;
            let sampled = sampled.ok_or(MeasureError::Stopped)?;
            if let Some(folder) = &self.folder {
                folder.keep(&self.key(), &name, &sampled)?;
            }
            self.done.insert(name, sampled);
        }
        Ok(())
    }

    /// Estimates what was ordered from the stages that are done.
    pub fn findings(&self) -> Findings {
        self.findings_of(self.order.of.clone())
    }

    /// Estimates everything whose stages are done.
    fn all_findings(&self) -> Findings {
        let is_done = |stage: &Stage| self.done.contains_key(&stage.name());
        let mut of = SurveyOrder::of(self.order.scene.clone()).of;
        of.retain(|one| {
            self.order.of.contains(one) || stages_of(&self.order.scene, &[*one]).iter().all(is_done)
        });
        self.findings_of(of)
    }

    fn findings_of(&self, of: Vec<Statistic>) -> Findings {
        let stages = stages_of(&self.order.scene, &of);
        let order = SurveyOrder { of, ..self.order.clone() };
        findings(&order, stages.iter().filter_map(|stage| self.done.get(&stage.name())))
    }

    /// Writes what was ordered, and what else the folder has the samples for, as files into the folder.
    pub fn write(&self) -> Result<(), MeasureError> {
        match &self.folder {
            Some(folder) => folder.write(&page::files(&self.order, &self.all_findings())?),
            None => Ok(()),
        }
    }

    /// A digest of all that decides the samples.
    fn key(&self) -> String {
        let SurveyOrder { scene, samples, seed, apart_secs, .. } = &self.order;
        let text = Document::default().with_scene(scene.clone()).text();
        sha256(format!("{VERSION}\n{text}\n{samples}\n{seed}\n{apart_secs:?}").as_bytes())
    }
}

/// The stages that some statistics of a scene need.
fn stages_of(scene: &Scene, of: &[Statistic]) -> Vec<Stage> {
    let is_needed =
        |stage: &Stage| stage.is_useful(scene) && of.iter().any(|one| one.needs(*stage));
    Stage::all().into_iter().filter(is_needed).collect()
}
