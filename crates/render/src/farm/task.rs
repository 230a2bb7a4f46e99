//! The work of a plan, and its division among shards.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{PartForm, PartForms, Parts, Plan, PlanError, PlannedOutput};
use crate::film::{FrameGroup, frame_groups};
use crate::output::sha256;
use crate::tiles::moments::Moments;
use crate::tiles::patches::{PATCH_SAMPLES, PATCH_SIDE, canonical};
use flipmap_engine::IntegratorConfig;
use flipmap_scene::film::{Film, FilmKind, Shot};
use flipmap_scene::lattice::Cell;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Document, PendulumSpec, QuestionSettings, Sampling, Scene, View};

/// Largest number of patches in a hand; each hand is dealt to one shard.
const DEALT: usize = 256;
/// Number of hands for every shard; hands are made smaller if there would be fewer.
const HANDS: usize = 8;

/// A plan with everything that follows from it.
pub struct Task {
    /// The plan.
    pub plan: Plan,
    /// The integrator config.
    pub config: IntegratorConfig,
    /// Folder of the parts.
    pub folder: PathBuf,
    /// The work, with the still or film that it is for.
    pub work: TaskKind,
}

/// The work to be done.
pub enum TaskKind {
    /// A still: its rows, once for every number of samples per pixel.
    Still(Box<Document>, Vec<StillPass>),
    /// A film of first flips: the patches of its groups.
    Film(Film, Vec<FrameGroupTask>),
    /// A film of other answers: the rows of each frame, which is a still of its own.
    Frames(Film, Vec<FrameTask>),
}

/// The rows of a still at one number of samples per pixel.
pub struct StillPass {
    /// Places of the samples in their pixels.
    pub sampling: Sampling,
    /// Width and height in samples.
    pub size: [u32; 2],
    /// Number of rows to compute; any others are mirror images of these.
    pub rows: u32,
    /// Digest of everything that decides its samples.
    pub of: String,
}

/// A frame with its work.
pub struct FrameTask {
    /// The scene and the moment that it shows.
    pub shot: Shot,
    /// The rows of the frame.
    pub pass: StillPass,
}

/// A group of a film's frames with its work.
pub struct FrameGroupTask {
    /// The frames and patches of the group.
    pub group: FrameGroup,
    /// Patches to compute, in this order; groups with equal views share them.
    pub cells: Arc<[Cell]>,
    /// Digests of everything that decides the samples, one for each of the group's scenes.
    of: Vec<String>,
}

/// A piece of work, with the index of its pass or group.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkPiece {
    /// Rows of a still, or of a frame.
    Rows(usize, Range<u32>),
    /// The same rows of several frames, whose pendulums go on from each to the next.
    Motion(Vec<usize>, Range<u32>),
    /// Patches of a film.
    Patches(usize, Vec<Cell>),
}

impl Task {
    /// Creates the task of a plan whose file is `path`; the parts lie beside that file.
    pub fn new(plan: Plan, path: &Path) -> Result<Self, PlanError> {
        let config = plan.config()?;
        let IntegratorConfig { method, precision } = config;
        // Another version may compute different last digits. `Recipe` is what the configuration was
        // called when the first parts were written.
        let config_text = format!("Recipe {{ method: {method:?}, precision: {precision:?} }}");
        let how = format!("{config_text} {} {}", plan.verify, env!("CARGO_PKG_VERSION"));
        let work = match plan.what() {
            PlannedOutput::Still(document) => {
                let passes = passes(&document, plan.numbers, &how);
                TaskKind::Still(document, passes)
            }
            PlannedOutput::Film(film) if film.kind() != FilmKind::Flips => {
                let frames = frames(&film, &how);
                TaskKind::Frames(film, frames)
            }
            PlannedOutput::Film(film) => {
                let groups = tasks(frame_groups(&film), &how);
                TaskKind::Film(film, groups)
            }
        };
        Ok(Task { plan, config, folder: path.with_extension("parts"), work })
    }

    /// Returns the number of samples to be computed in all.
    pub fn samples(&self) -> u64 {
        match &self.work {
            TaskKind::Still(_, passes) => passes.iter().map(StillPass::samples).sum(),
            TaskKind::Film(_, groups) => {
                groups.iter().map(|group| (group.cells.len() * PATCH_SAMPLES) as u64).sum()
            }
            TaskKind::Frames(_, frames) => frames.iter().map(|frame| frame.pass.samples()).sum(),
        }
    }

    /// Returns the forms of the samples, by digest.
    pub fn forms(&self) -> PartForms {
        match &self.work {
            TaskKind::Still(document, passes) => {
                passes.iter().map(|pass| pass.form(document.question.ask)).collect()
            }
            TaskKind::Frames(_, frames) => {
                let form = |frame: &FrameTask| frame.pass.form(frame.shot.scene.question.ask);
                frames.iter().map(form).collect()
            }
            TaskKind::Film(_, groups) => {
                let digests = groups.iter().flat_map(|group| group.of.iter().cloned());
                digests.map(|of| (of, PartForm::Patches)).collect()
            }
        }
    }

    /// Returns the missing pieces of a shard; shards are counted from 1.
    pub fn missing(&self, shard: u32, parts: &Parts) -> Vec<WorkPiece> {
        match &self.work {
            TaskKind::Still(_, passes) => (0..)
                .zip(passes)
                .flat_map(|(k, pass)| {
                    let rows = self.rows_of(shard, pass.rows);
                    let missing = parts.missing_rows(&pass.of, rows).into_iter();
                    missing.map(move |rows| WorkPiece::Rows(k, rows))
                })
                .collect(),
            TaskKind::Film(_, groups) => self.missing_patches(groups, shard, parts),
            TaskKind::Frames(film, frames) => self.missing_frames(film, frames, shard, parts),
        }
    }

    /// Returns the scene and the pass of a piece that consists of rows; `None` for other pieces.
    pub fn still(&self, piece: &WorkPiece) -> Option<(Scene, &StillPass)> {
        match (piece, &self.work) {
            (WorkPiece::Rows(pass, _), TaskKind::Still(document, passes)) => {
                Some((document.scene(), &passes[*pass]))
            }
            (WorkPiece::Rows(frame, _), TaskKind::Frames(_, frames)) => {
                let FrameTask { shot, pass } = &frames[*frame];
                Some((shot.scene.clone(), pass))
            }
            _ => None,
        }
    }

    /// Returns the shards of which something is missing.
    pub fn missing_shards(&self, parts: &Parts) -> Vec<u32> {
        let shards = 1..=self.plan.shards;
        shards.filter(|shard| !self.missing(*shard, parts).is_empty()).collect()
    }

    /// Returns the rows of a shard, which are consecutive.
    fn rows_of(&self, shard: u32, rows: u32) -> Range<u32> {
        let at =
            |shard: u32| (u64::from(rows) * u64::from(shard) / u64::from(self.plan.shards)) as u32;
        at(shard - 1)..at(shard)
    }

    /// Returns the missing rows of a shard. A shard has the same rows in each frame, so it follows
    /// its pendulums through the whole film.
    fn missing_frames(
        &self,
        film: &Film,
        frames: &[FrameTask],
        shard: u32,
        parts: &Parts,
    ) -> Vec<WorkPiece> {
        let goes_on = Moments::can_make(film, self.plan.verify, &self.config);
        let (mut pieces, mut waiting) = (Vec::new(), Vec::new());
        for (k, frame) in frames.iter().enumerate() {
            let found = parts.missing_rows(&frame.pass.of, self.rows_of(shard, frame.pass.rows));
            if goes_on && !found.is_empty() {
                waiting.push(k);
            } else {
                pieces.extend(found.into_iter().map(|rows| WorkPiece::Rows(k, rows)));
            }
        }
        if let Some(&first) = waiting.first() {
            let rows = self.rows_of(shard, frames[first].pass.rows);
            pieces.push(WorkPiece::Motion(waiting, rows));
        }
        pieces
    }

    /// Returns the missing patches of a shard. Patches are dealt like cards, since deep ones take
    /// longer.
    fn missing_patches(
        &self,
        groups: &[FrameGroupTask],
        shard: u32,
        parts: &Parts,
    ) -> Vec<WorkPiece> {
        let cells: usize = groups.iter().map(|group| group.cells.len()).sum();
        let hand = (cells / (HANDS * self.plan.shards as usize)).clamp(1, DEALT);
        let mut dealt = 0;
        let mut missing = Vec::new();
        for (k, group) in groups.iter().enumerate() {
            let mut cells = Vec::new();
            for dealt_cells in group.cells.chunks(hand) {
                if dealt % self.plan.shards == shard - 1 {
                    cells.extend(
                        dealt_cells.iter().filter(|cell| !parts.has_patch(group.of(cell), cell)),
                    );
                }
                dealt += 1;
            }
            // A piece has one budget; the cells are in the order of their levels.
            let alike = cells.chunk_by(|a, b| group.of(a) == group.of(b));
            missing.extend(alike.map(|cells| WorkPiece::Patches(k, cells.to_vec())));
        }
        missing
    }
}

impl FrameGroupTask {
    /// Returns the digest of everything that decides the samples of one of the group's patches.
    pub(crate) fn of(&self, cell: &Cell) -> &str {
        &self.of[self.group.scene_index(cell)]
    }
}

impl StillPass {
    /// Width and height of the picture in pixels.
    pub fn pixels(&self) -> [u32; 2] {
        match self.sampling {
            Sampling::Corners => self.size.map(|side| side - 1),
            Sampling::Square(along) => self.size.map(|side| side / along),
        }
    }

    /// Number of samples to compute.
    fn samples(&self) -> u64 {
        u64::from(self.rows) * u64::from(self.size[0])
    }

    /// Returns the digest of the pass, and the form of the samples that answer a question.
    fn form(&self, ask: QuestionName) -> (String, PartForm) {
        let channels = ask.kind().channels.len();
        (self.of.clone(), PartForm::Rows { width: self.size[0], rows: self.rows, channels })
    }
}

impl WorkPiece {
    /// Number of samples in the piece.
    pub fn samples(&self, task: &Task) -> u64 {
        match (self, &task.work) {
            (WorkPiece::Rows(_, rows), _) => {
                let width = task.still(self).map_or(0, |(_, pass)| pass.size[0]);
                rows.len() as u64 * u64::from(width)
            }
            (WorkPiece::Patches(_, cells), _) => (cells.len() * PATCH_SAMPLES) as u64,
            (WorkPiece::Motion(moved, rows), TaskKind::Frames(_, frames)) => {
                let width = moved.first().map_or(0, |frame| frames[*frame].pass.size[0]);
                (moved.len() * rows.len()) as u64 * u64::from(width)
            }
            (WorkPiece::Motion(..), _) => 0,
        }
    }
}

/// Returns the picture's pass and, if necessary, a pass over the pixels' middles.
fn passes(document: &Document, numbers: bool, how: &str) -> Vec<StillPass> {
    let scene = document.scene();
    let size = document.run.size.unwrap_or([1, 1]);
    let samples = document.picture.samples;
    let mut all = vec![samples];
    // The middles decide which corners contribute to the picture.
    if samples == Sampling::Corners || numbers && samples != Sampling::SINGLE {
        all.push(Sampling::SINGLE);
    }
    all.into_iter().map(|sampling| pass(&scene, size, sampling, how)).collect()
}

/// Returns the pass of a picture of `size` pixels with this sampling.
fn pass(scene: &Scene, size: [u32; 2], sampling: Sampling, how: &str) -> StillPass {
    let size = sampling.grid_size(size);
    let rows = if scene.is_symmetric() { size[1].div_ceil(2) } else { size[1] };
    let place = if sampling == Sampling::Corners { "corners " } else { "" };
    let of = sha256(format!("still {place}{} {size:?} {how}", what_of(scene)).as_bytes());
    StillPass { sampling, size, rows, of }
}

/// Returns the work for a film whose frames are stills.
fn frames(film: &Film, how: &str) -> Vec<FrameTask> {
    let sampling = Sampling::Square(film.keys[0].scene.picture.samples.along());
    let frame = |frame| {
        let shot = film.shot(frame);
        let pass = pass(&shot.scene, film.size, sampling, how);
        FrameTask { shot, pass }
    };
    (0..film.frames).map(frame).collect()
}

/// Returns the work for the groups of a film.
fn tasks(groups: Vec<FrameGroup>, how: &str) -> Vec<FrameGroupTask> {
    let mut tasks: Vec<FrameGroupTask> = Vec::new();
    for group in groups {
        let cells = match tasks.last() {
            Some(before) if Arc::ptr_eq(&before.group.patches, &group.patches) => {
                before.cells.clone()
            }
            _ => {
                let mut cells = canonical(&group.patches);
                // A job holds patches of one level; a stable sort keeps neighbours together.
                cells.sort_by_key(|cell| cell.level);
                cells.into()
            }
        };
        let digest =
            |scene| sha256(format!("film {PATCH_SIDE} {} {how}", what_of(&scene)).as_bytes());
        let of = group.scenes().map(digest).collect();
        tasks.push(FrameGroupTask { group, cells, of });
    }
    tasks
}

/// Returns the text of everything in a scene that decides its samples. Settings added after the
/// first release appear only if they differ from their defaults, so older parts are still found.
fn what_of(scene: &Scene) -> String {
    let Scene { build, question, view, plane } = scene;
    let PendulumSpec { kind, masses, lengths, gravity, friction } = build;
    let build = format!(
        "Build {{ kind: {kind:?}, masses: {masses:?}, lengths: {lengths:?}, gravity: {gravity:?} }}"
    );
    let View { center, width, rotate, stretch, fit: _ } = view;
    let view = format!(
        "View {{ center: {center:?}, width: {width:?}, rotate: {rotate:?}, stretch: {stretch:?} }}"
    );
    let plain = format!("{build} {} {} {view}", question.rule, question.budget.secs);
    if scene.is_flip_from_rest() && !scene.build.has_friction() {
        return plain;
    }
    let QuestionSettings { ask, at, count, .. } = question;
    format!("{plain} {friction:?} {ask} {at:?} {count} {plane:?}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::mock::MockEngine;
    use flipmap_engine::{Method, Precision};
    use flipmap_numbers::Decimal;
    use flipmap_scene::keys::{Easing, Key};

    const CONFIG: IntegratorConfig =
        IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };

    #[test]
    fn what_a_scene_computes_names_newer_settings_only_where_they_are_used() {
        let home = Scene::default();
        let old = "Build { kind: Points, masses: [1.0, 1.0], lengths: [1.0, 1.0], gravity: 9.81 } \
                   second 30 View { center: [\"0\", \"0\"], width: \"6.283185307179586\", \
                   rotate: 0.0, stretch: 1.0 }";
        assert_eq!(what_of(&home), old);
        let changes: [fn(&mut Scene); 5] = [
            |scene| scene.build.friction[1] = Decimal::from(0.1),
            |scene| scene.question.ask = QuestionName::State,
            |scene| scene.question.count = 2,
            |scene| scene.plane.origin[3] = "1".to_string(),
            |scene| scene.plane.kind = "speeds".parse().unwrap(),
        ];
        let mut all = vec![old.to_string()];
        for change in changes {
            let mut scene = home.clone();
            change(&mut scene);
            all.push(what_of(&scene));
        }
        all.sort();
        all.dedup();
        assert_eq!(all.len(), 6);
    }

    fn task(what: PlannedOutput, shards: u32) -> Task {
        let plan = Plan::new(what, shards, (&MockEngine::default(), CONFIG, false), true);
        Task::new(plan, Path::new("plan.toml")).unwrap()
    }

    fn still(size: [u32; 2], samples: u32) -> PlannedOutput {
        sampled(size, Sampling::Square(samples))
    }

    fn sampled(size: [u32; 2], samples: Sampling) -> PlannedOutput {
        let mut document = Document::default();
        document.run.size = Some(size);
        document.picture.samples = samples;
        PlannedOutput::Still(Box::new(document))
    }

    fn film(change: fn(&mut Document)) -> PlannedOutput {
        let key = |secs, change: fn(&mut Document)| {
            let mut scene = Document::default();
            scene.picture.samples = Sampling::Square(2);
            change(&mut scene);
            Key { secs, easing: Easing::Linear, clock: None, scene }
        };
        let keys = vec![key(0.0, |_| ()), key(1.0, change)];
        PlannedOutput::Film(Film { size: [64, 64], frames: 5, fps: 5.0, keys })
    }

    #[test]
    fn shards_are_all_of_a_still_once() {
        for (size, samples) in [([7, 5], 1), ([40, 31], 2)] {
            let task = task(still(size, samples), 3);
            let parts = Parts::default();
            let mut rows: Vec<(usize, u32)> = (1..=3)
                .flat_map(|shard| task.missing(shard, &parts))
                .flat_map(|piece| match piece {
                    WorkPiece::Rows(pass, rows) => {
                        rows.map(move |row| (pass, row)).collect::<Vec<_>>()
                    }
                    _ => panic!("a still has rows"),
                })
                .collect();
            rows.sort_unstable();
            let height = |pass: usize| if pass == 0 { size[1] * samples } else { size[1] };
            let passes = if samples > 1 { 2 } else { 1 };
            // The home map is its own image: half of the rows and the middle one are computed.
            let all: Vec<(usize, u32)> = (0..passes)
                .flat_map(|pass| (0..height(pass).div_ceil(2)).map(move |row| (pass, row)))
                .collect();
            assert_eq!(rows, all);
        }
    }

    #[test]
    fn a_still_with_corners_has_a_pass_for_them_and_one_for_the_middles() {
        let task = task(sampled([8, 5], Sampling::Corners), 2);
        let TaskKind::Still(_, passes) = &task.work else { panic!("a still") };
        let sizes: Vec<_> = passes.iter().map(|pass| (pass.size, pass.rows)).collect();
        assert_eq!(sizes, [([9, 6], 3), ([8, 5], 3)]);
        assert!(passes.iter().all(|pass| pass.pixels() == [8, 5]));
    }

    #[test]
    fn shards_are_all_of_a_film_once() {
        let zoom: fn(&mut Document) = |scene| scene.view.width = "0.01".into();
        let masses: fn(&mut Document) = |scene| scene.pendulum.masses[1] = Decimal::from(3.0);
        for (change, groups) in [(zoom, 1), (masses, 5)] {
            let task = task(film(change), 3);
            let parts = Parts::default();
            let mut dealt: Vec<(usize, Cell)> = (1..=3)
                .flat_map(|shard| task.missing(shard, &parts))
                .flat_map(|piece| match piece {
                    WorkPiece::Patches(group, cells) => {
                        cells.into_iter().map(|cell| (group, cell)).collect::<Vec<_>>()
                    }
                    _ => panic!("a film has patches"),
                })
                .collect();
            let count = dealt.len();
            dealt.sort_unstable();
            dealt.dedup();
            assert_eq!(dealt.len(), count, "none twice");
            assert_eq!((count * PATCH_SAMPLES) as u64, task.samples());
            let TaskKind::Film(_, found) = &task.work else { panic!("a film") };
            assert_eq!(found.len(), groups);
            assert!(found.windows(2).all(|two| Arc::ptr_eq(&two[0].cells, &two[1].cells)));
        }
    }

    #[test]
    fn what_decides_samples_has_a_name_of_its_own() {
        let name = |what: PlannedOutput| match task(what, 1).work {
            TaskKind::Still(_, passes) => passes[0].of.clone(),
            TaskKind::Film(_, groups) => groups[0].of[0].clone(),
            TaskKind::Frames(..) => panic!("a film of flips"),
        };
        let home = name(still([8, 8], 1));
        assert_ne!(home, name(still([8, 9], 1)));
        let corners = name(sampled([7, 7], Sampling::Corners));
        assert_ne!(home, corners, "as many samples, but others");
        let PlannedOutput::Still(mut painted) = still([8, 8], 1) else { panic!("a still") };
        painted.picture.palette = "viridis".to_string();
        assert_eq!(home, name(PlannedOutput::Still(painted.clone())), "colours decide no samples");
        painted.question.budget.secs = 31.0;
        assert_ne!(home, name(PlannedOutput::Still(painted)));
    }
}
