//! What a plan's shards have to compute.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::plan::digest;
use super::{Parts, Plan, PlanError, What};
use crate::engine::Recipe;
use crate::film::{Sheet, sheets};
use crate::scene::film::Film;
use crate::scene::lattice::Cell;
use crate::scene::{Document, Scene};
use crate::tiles::patches::{SAMPLES, canonical};

/// Patches that are dealt to one shard together.
const DEALT: usize = 64;

/// A plan with all that follows from it.
pub struct Task {
    /// The plan.
    pub plan: Plan,
    /// How it is computed.
    pub recipe: Recipe,
    /// Where its parts are.
    pub folder: PathBuf,
    /// What is wanted, and of what.
    pub work: Wanted,
}

/// What is to be computed.
pub enum Wanted {
    /// A still: its rows once for every number of samples a pixel.
    Still(Document, Vec<Pass>),
    /// A film: the patches of its sheets.
    Film(Film, Vec<Reel>),
}

/// The rows of a still with so many samples a pixel.
pub struct Pass {
    /// Samples a pixel along each axis.
    pub along: u32,
    /// Width and height in samples.
    pub size: [u32; 2],
    /// Rows to compute; mirror images of some may be the others.
    pub rows: u32,
    /// What decides its samples.
    pub of: String,
}

/// A sheet of a film.
pub struct Reel {
    /// Its frames and patches.
    pub sheet: Sheet,
    /// Patches to compute, in the order in which they are.
    pub cells: Vec<Cell>,
    /// What decides its samples.
    pub of: String,
}

/// Something to compute: of which pass or reel.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// Rows of a still.
    Rows(usize, Range<u32>),
    /// Patches of a film.
    Patches(usize, Vec<Cell>),
}

impl Task {
    /// Of a plan whose file is `path`; the parts lie beside it.
    pub fn new(plan: Plan, path: &Path) -> Result<Self, PlanError> {
        let recipe = plan.recipe()?;
        let how = format!("{recipe:?} {}", plan.verify);
        let work = match plan.what() {
            What::Still(document) => {
                let passes = passes(&document, plan.numbers, &how);
                Wanted::Still(document, passes)
            }
            What::Film(film) => {
                let reels = sheets(&film).into_iter().map(|sheet| reel(sheet, &how)).collect();
                Wanted::Film(film, reels)
            }
        };
        Ok(Task { plan, recipe, folder: path.with_extension("parts"), work })
    }

    /// The samples that are to be computed in all.
    pub fn samples(&self) -> u64 {
        match &self.work {
            Wanted::Still(_, passes) => {
                passes.iter().map(|pass| u64::from(pass.rows) * u64::from(pass.size[0])).sum()
            }
            Wanted::Film(_, reels) => {
                reels.iter().map(|reel| (reel.cells.len() * SAMPLES) as u64).sum()
            }
        }
    }

    /// What is missing of a shard, 1 the first.
    pub fn missing(&self, shard: u32, parts: &Parts) -> Vec<Piece> {
        match &self.work {
            Wanted::Still(_, passes) => (0..)
                .zip(passes)
                .flat_map(|(k, pass)| {
                    let rows = self.rows_of(shard, pass.rows);
                    let missing = parts.missing_rows(&pass.of, rows).into_iter();
                    missing.map(move |rows| Piece::Rows(k, rows))
                })
                .collect(),
            Wanted::Film(_, reels) => self.missing_patches(reels, shard, parts),
        }
    }

    /// Shards of which something is missing.
    pub fn missing_shards(&self, parts: &Parts) -> Vec<u32> {
        let shards = 1..=self.plan.shards;
        shards.filter(|shard| !self.missing(*shard, parts).is_empty()).collect()
    }

    /// A shard's rows: they follow one another.
    fn rows_of(&self, shard: u32, rows: u32) -> Range<u32> {
        let at =
            |shard: u32| (u64::from(rows) * u64::from(shard) / u64::from(self.plan.shards)) as u32;
        at(shard - 1)..at(shard)
    }

    /// A shard's patches: they are dealt like cards, since deep ones take longer.
    fn missing_patches(&self, reels: &[Reel], shard: u32, parts: &Parts) -> Vec<Piece> {
        let mut dealt = 0;
        let mut missing = Vec::new();
        for (k, reel) in reels.iter().enumerate() {
            let mut cells = Vec::new();
            for hand in reel.cells.chunks(DEALT) {
                if dealt % self.plan.shards == shard - 1 {
                    cells.extend(hand.iter().filter(|cell| !parts.has_patch(&reel.of, cell)));
                }
                dealt += 1;
            }
            if !cells.is_empty() {
                missing.push(Piece::Patches(k, cells));
            }
        }
        missing
    }
}

impl Piece {
    /// How many samples.
    pub fn samples(&self, task: &Task) -> u64 {
        match (self, &task.work) {
            (Piece::Rows(pass, rows), Wanted::Still(_, passes)) => {
                u64::from(rows.end - rows.start) * u64::from(passes[*pass].size[0])
            }
            (Piece::Patches(_, cells), _) => (cells.len() * SAMPLES) as u64,
            (Piece::Rows(..), Wanted::Film(..)) => 0,
        }
    }
}

/// The picture's pass, and if need be one of the numbers at the pixels' middles.
fn passes(document: &Document, numbers: bool, how: &str) -> Vec<Pass> {
    let scene = document.scene();
    let size = document.run.size.unwrap_or([1, 1]);
    let samples = document.picture.samples;
    let mut all = vec![samples];
    if numbers && samples > 1 {
        all.push(1);
    }
    let pass = |along: u32| {
        let size = size.map(|side| side * along);
        let rows = if scene.view.is_symmetric() { size[1].div_ceil(2) } else { size[1] };
        let of = digest(&format!("still {} {size:?} {how}", what_of(&scene)));
        Pass { along, size, rows, of }
    };
    all.into_iter().map(pass).collect()
}

fn reel(sheet: Sheet, how: &str) -> Reel {
    let mut cells = canonical(&sheet.patches);
    // Jobs hold patches of one level; a stable sort keeps neighbours together.
    cells.sort_by_key(|cell| cell.level);
    let of = digest(&format!("film {} {how}", what_of(&sheet.scene)));
    Reel { sheet, cells, of }
}

/// All of a scene that decides its samples.
fn what_of(scene: &Scene) -> String {
    let Scene { build, question, view } = scene;
    format!("{build:?} {} {} {view:?}", question.rule, question.budget.secs)
}
