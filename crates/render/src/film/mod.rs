//! Films: frames painted from samples that were computed beforehand.
//!
//! Frames are not computed one by one. The camera's path determines how finely each place must be
//! sampled, and each place is sampled once, as finely as the closest frame needs: in patches, cells
//! of the lattice with 16 × 16 samples each ([`crate::tiles::patches`]). Along one axis of a zoom:
//!
//! ```text
//! frames    ├─────────────────────────────┤
//!                           ├─────┤
//!                               ├─┤
//! patches  ├───────┼───────┼───┼─┼─┼───────┤    fine where some frame comes near
//!
//! keys ─▶ shots ─▶ patches ─▶ samples ─▶ Mip ─▶ FramePainter ─▶ Frames, or ffmpeg's Encoder
//! ```
//!
//! The [`Mip`] holds the colours of the patches and, averaged over 2 × 2 samples per level, those
//! of every cell above them up to the whole torus; the [`FramePainter`] paints each frame from it.
//!
//! - A zoom costs as many samples as a few frames per octave, however many frames it has.
//! - A place has the same samples in every frame, so no pixel flickers between two frames.
//! - Changing the colours or the shown times ([`FlipWindow`]) computes nothing again. Another
//!   pendulum is another [`FrameGroup`] with samples of its own.
//! - Samples have the largest budget of the frames that look at any level up to the next finer one
//!   ([`level_budgets`]), so the wide views of a zoom do not pay for the budget of its last view.
//! - A level shows only flips within its own budget, even in the middle of its frames, where finer
//!   patches know later ones ([`FrameGroup::shown`]); later flips fade in with the next level. If
//!   the camera stays, each frame hides flips after its own budget.
//! - Only one of a patch and its mirror image is computed.

mod colours;
pub mod ffmpeg;
mod frames;
mod layer;
mod lit_frame;
mod mip;
mod paint;
mod recipe;
mod sink;

pub use colours::{Colours, check_insets, settle_colours};

pub(crate) use colours::{FlipWindow, film_caption, film_legend, tones};
pub(crate) use frames::FrameError;
pub use frames::Frames;
pub(crate) use mip::Mip;
pub use mip::{Light, Looks};
pub(crate) use paint::{FramePainter, WAITING};
pub(crate) use recipe::FramePixels;
pub use recipe::{FilmRecipe, FilmRenderError, check_film, samples_of};

use std::sync::Arc;

use self::mip::LOOKS;
use crate::tiles::patches::{Sight, patches};
use flipmap_scene::film::{Film, Shot};
use flipmap_scene::lattice::Cell;
use flipmap_scene::{Scene, View};

/// The frames of one pendulum, and the patches from which they are painted.
#[derive(Clone, Debug)]
pub struct FrameGroup {
    /// The pendulum and the question; neither the view nor the budget matters.
    scene: Scene,
    /// Levels at which the budget of patches changes, each with its budget in s.
    budgets: Vec<(u32, f64)>,
    /// The range from the first frame to the one after the last.
    pub frames: std::ops::Range<u32>,
    /// Patches in depth-first order of quarters of quarters; shared by groups with equal views.
    pub patches: Arc<[Cell]>,
}

/// Number of equal steps from 0 s to a film's largest budget; the levels' budgets are rounded up to
/// them.
const BUDGETS: f64 = 64.0;

impl FrameGroup {
    /// Returns the scenes whose patches are computed, one for each budget; their views do not
    /// matter.
    pub(crate) fn scenes(&self) -> impl Iterator<Item = Scene> {
        self.budgets.iter().map(|(_, secs)| {
            let mut scene = self.scene.clone();
            scene.question.budget.secs = *secs;
            scene
        })
    }

    /// Returns the index in [`Self::scenes`] of the scene for a patch: that of the next finer
    /// level, which may show the patch, too.
    pub(crate) fn scene_index(&self, patch: &Cell) -> usize {
        self.budget_index(patch.level + 1)
    }

    /// Returns the flips of a patch that each level shows, at most `shown`: the next finer level
    /// first, then the patch's own, then the levels above.
    pub(crate) fn shown(&self, patch: &Cell, shown: FlipWindow) -> [FlipWindow; LOOKS] {
        let budget = |level: u32| self.budgets[self.budget_index(level)].1;
        std::array::from_fn(|k| shown.within(budget((patch.level + 1).saturating_sub(k as u32))))
    }

    fn budget_index(&self, level: u32) -> usize {
        self.budgets.partition_point(|(first, _)| *first <= level).saturating_sub(1)
    }
}

/// Returns the groups of a film, one for each run of frames with the same pendulum.
pub(crate) fn frame_groups(film: &Film) -> Vec<FrameGroup> {
    let samples = film.keys[0].scene.picture.samples.along();
    let shots: Vec<Shot> = (0..film.frames).map(|frame| film.shot(frame)).collect();
    let mut groups: Vec<FrameGroup> = Vec::new();
    let (mut looked, mut levels): (Vec<&View>, Vec<u32>) = Default::default();
    for same in shots.chunk_by(|a, b| a.scene.build == b.scene.build) {
        let shots = different_views(same);
        let views: Vec<&View> = shots.iter().map(|shot| &shot.scene.view).collect();
        let found = match groups.last() {
            Some(before) if looked == views => before.patches.clone(),
            _ => {
                let sight = |shot: &&Shot| Sight::new(&shot.scene, film.size, samples);
                let sights: Vec<Sight> = shots.iter().map(sight).collect();
                levels = sights.iter().map(Sight::level).collect();
                patches(&sights).into()
            }
        };
        looked = views;
        let budgets = level_budgets(film, &levels, same);
        let scene = Scene { view: View::default(), ..same[0].scene.clone() };
        let first = groups.last().map_or(0, |before| before.frames.end);
        let frames = first..first + same.len() as u32;
        groups.push(FrameGroup { scene, budgets, frames, patches: found });
    }
    groups
}

/// Returns the levels at which the budget changes, each with its budget in s: the largest of the
/// shots that look at that level or a coarser one, in steps of a 64th of the film's largest.
/// `levels` has one level for each run of shots with the same view.
fn level_budgets(film: &Film, levels: &[u32], shots: &[Shot]) -> Vec<(u32, f64)> {
    let most = film.budget_secs();
    let step = most / BUDGETS;
    let in_steps = |shot: &Shot| (shot.scene.question.budget.secs / step).ceil() * step;
    let largest = |run: &[Shot]| run.iter().map(in_steps).fold(0.0, f64::max).min(most);
    let runs = shots.chunk_by(|a, b| a.scene.view == b.scene.view);
    let mut looks: Vec<(u32, f64)> = levels.iter().copied().zip(runs.map(largest)).collect();
    looks.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut budgets: Vec<(u32, f64)> = Vec::new();
    for (level, secs) in looks {
        if budgets.last().is_none_or(|(_, before)| secs > *before) {
            budgets.push((level, secs));
        }
    }
    budgets
}

/// Returns the shots whose view differs from that of the shot before.
fn different_views(shots: &[Shot]) -> Vec<&Shot> {
    let moved = |two: &&[Shot]| two[0].scene.view != two[1].scene.view;
    shots.first().into_iter().chain(shots.windows(2).filter(moved).map(|two| &two[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::Samples;
    use crate::tiles::patches::PATCH_SAMPLES;
    use flipmap_pendulum::{Outcome, Status};
    use flipmap_scene::keys::{Easing, Key};
    use flipmap_scene::palette::{Ground, Tones};
    use flipmap_scene::{Budget, Document, PictureTable};

    fn key(secs: f64, width: &str, budget: f64) -> Key {
        let mut scene = Document::default();
        scene.view.width = width.to_string();
        scene.question.budget = Budget::secs(budget);
        Key { secs, easing: Easing::Linear, clock: None, scene }
    }

    fn budgets(keys: Vec<Key>) -> Vec<f64> {
        let film = Film { size: [64, 48], frames: 21, fps: 10.0, keys };
        let [group] = &frame_groups(&film)[..] else { panic!("one pendulum") };
        let all: Vec<f64> = group.scenes().map(|scene| scene.question.budget.secs).collect();
        let of = |cell: &Cell| all[group.scene_index(cell)];
        let mut found: Vec<(u32, f64)> = group.patches.iter().map(|c| (c.level, of(c))).collect();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        found.dedup();
        found.into_iter().map(|(_, secs)| secs).collect()
    }

    #[test]
    fn finer_levels_have_longer_budgets_whichever_way_the_camera_goes() {
        let there = vec![key(0.0, "6", 30.0), key(1.0, "1e-6", 60.0)];
        let back = vec![key(0.0, "1e-6", 60.0), key(1.0, "6", 30.0)];
        for keys in [there, back] {
            let secs = budgets(keys);
            assert!(secs.is_sorted() && secs.len() > 15, "{secs:?}");
            assert!(secs[0] < 33.0 && secs.last() == Some(&60.0), "{secs:?}");
        }
        let far = budgets(vec![key(0.0, "1e-6", 30.0), key(1.0, "6", 60.0)]);
        assert!(far.iter().all(|secs| *secs == 60.0), "a wide view's time is never cut: {far:?}");
        // A camera that waits at its last view while the budget grows.
        let waits = vec![key(0.0, "6", 30.0), key(1.0, "1e-3", 30.0), key(2.0, "1e-3", 60.0)];
        assert_eq!(budgets(waits).last(), Some(&60.0));
        let stays = budgets(vec![key(0.0, "6", 10.0), key(1.0, "6", 30.0)]);
        assert_eq!(stays, [30.0]);
    }

    /// Builds the mip of a film in which every start flips at `secs`.
    fn mip_of_flips_at(secs: f64, group: &FrameGroup, shown: FlipWindow) -> Mip {
        let tones = Tones::new(&PictureTable::default(), 0.3, 60.0).unwrap();
        let mut samples = Samples::unflipped(PATCH_SAMPLES);
        let flip = Outcome { status: Status::Answered, time: secs };
        (0..PATCH_SAMPLES).for_each(|k| samples.set(k, flip));
        let colours = Colours::new(tones, false);
        let mut patches = group.patches.iter();
        let mut looks = || {
            let patch = patches.next().expect("a patch");
            Ok::<Looks, std::io::Error>(colours.looks(&samples, &group.shown(patch, shown)))
        };
        let folder = tempfile::tempdir().unwrap();
        Mip::build(&group.patches, false, folder.path(), &mut looks).unwrap()
    }

    #[test]
    fn a_frame_shows_flips_within_one_budget_in_its_middle_too() {
        let keys = vec![key(0.0, "6", 30.0), key(1.0, "1e-6", 60.0)];
        let film = Film { size: [64, 48], frames: 41, fps: 10.0, keys };
        let [group] = &frame_groups(&film)[..] else { panic!("one pendulum") };
        let shown = FlipWindow::of(&film, &film.shot(0));
        let mut mip = mip_of_flips_at(45.0, group, shown);
        let picture = PictureTable { curve: false, ..PictureTable::default() };
        let mut painter = FramePainter::new(film.size, &picture);
        let frames: Vec<[u8; 3]> = (0..film.frames)
            .map(|frame| {
                let rgb = painter.paint(&film.shot(frame), &mut mip).unwrap();
                let pixels = rgb.as_chunks::<3>().0;
                assert!(pixels.iter().all(|pixel| *pixel == pixels[0]), "frame {frame}");
                pixels[0]
            })
            .collect();
        let unflipped = Ground::of(&picture).unwrap().unflipped;
        let first_lit = frames.iter().position(|rgb| *rgb != unflipped).unwrap();
        let budget = film.shot(first_lit as u32).scene.question.budget.secs;
        assert!((42.0..46.0).contains(&budget), "{budget} s in frame {first_lit}");
        let fading = frames.windows(2).filter(|two| two[0] != two[1]).count();
        assert!(fading >= 2, "the flip comes gradually: {frames:?}");
    }
}
