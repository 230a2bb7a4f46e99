//! The descent from a view to ever smaller ones that still have structure.
//!
//! Where neighbours flip at different times, and late, there is more to see below: deep down,
//! neighbours that flip early all flip at the same time. Each step computes a small picture, goes
//! to the liveliest place near a preferred point, and enlarges it. It looks ahead: a view is chosen
//! only if its own small picture offers a next place, so no descent ends in an edge between two
//! colours. Each view is turned and stretched so that its bands lie along a side and spread apart.

use super::bands::Bands;
use super::preview::preview;
use super::{Samples, Work};
use flipmap_engine::{Engine, EngineError, IntegratorConfig};
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::{Budget, Scene};

/// Side in pixels of the small pictures.
const SIDE: u32 = 32;
/// Ratio of the width of a view to that of the next one, √10: two steps are a decade.
const FACTOR: f64 = 3.162_277_660_168_379_5;
/// Distance in pixels along each axis up to which neighbours are compared.
const AROUND: i32 = 2;
/// Distance in pixels along each axis from the middle of the next view to its border.
const NEXT_VIEW: i32 = 5;
/// Largest difference between two flip times that is counted in full, in natural units of time.
const ENOUGH_UNITS: f64 = 3.0;
/// Mean difference, in natural units of time, at or below which a place has no structure.
const MIN_UNITS: f64 = 0.05;
/// Smallest number of distinct times in a next view that shows more than an edge or two.
const SEVERAL: usize = 4;
/// Number of distinct times in a next view beyond which more make no difference.
const MANY: usize = 12;
/// Distance from the preferred point, in pixels, at which a place counts for half: at the first
/// step, which follows a pointer, and at later ones, which stay near the filament.
const NEAR: [f64; 2] = [3.0, 8.0];
/// Number of places of a picture whose next views are examined before the descent ends.
const MAX_TRIES: usize = 4;
/// Smallest distance in pixels between two of those places.
const APART: f64 = 4.0;
/// Share of the budget before which deep neighbours flip at the same time.
const LATE: f64 = 0.4;

/// A descent from each view to the next deeper one.
pub struct Descent {
    /// The current view, neither turned nor stretched.
    scene: Scene,
    /// Angle in degrees by which the last view was turned, and its stretch.
    turned: [f64; 2],
    config: IntegratorConfig,
    /// Samples of the view's small picture, once they are known.
    samples: Option<Samples>,
    /// Preferred point of the next step, in pixels from the middle.
    wish: [f64; 2],
    /// Distance from that point, in pixels, at which a place counts for half.
    near: f64,
}

/// The result of a step of a descent.
#[derive(Clone, Debug, PartialEq)]
pub enum DescentStep {
    /// The next view, around a place that has structure.
    Scene(Box<Scene>),
    /// The end of the descent: no structure was found, or the next view would be too small.
    End,
    /// The step was stopped because `keep_going` returned false.
    Stopped,
}

impl Descent {
    /// Begins at a checked scene; `wish` is the preferred point, measured from the middle in widths
    /// of the view. The budget follows the depth.
    pub fn new(mut scene: Scene, config: IntegratorConfig, wish: [f64; 2]) -> Self {
        scene.question.budget =
            Budget { auto: true, ..scene.question.budget }.for_view(&scene.build, &scene.view);
        let turned = [scene.view.rotate, scene.view.stretch];
        (scene.view.rotate, scene.view.stretch) = (0.0, 1.0);
        let side = f64::from(SIDE);
        // A tall window has more above and below than the picture, which is square.
        let wish = wish.map(|part| (part * side).clamp(-side / 2.0, side / 2.0));
        Descent { scene, turned, config, samples: None, wish, near: NEAR[0] }
    }

    /// Returns the next view, which is smaller by half a decade; calls `keep_going` now and then.
    pub fn next(
        &mut self,
        engine: &mut dyn Engine,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<DescentStep, EngineError> {
        let samples = match self.samples.take() {
            Some(samples) => Some(samples),
            None => self.picture(&self.scene, engine, keep_going)?,
        };
        let Some(samples) = samples else { return Ok(DescentStep::Stopped) };
        for offset in self.lively_places(&self.scene, &samples) {
            let Some(scene) = self.enlarged(offset) else { break };
            let Some(samples) = self.picture(&scene, engine, keep_going)? else {
                return Ok(DescentStep::Stopped);
            };
            (self.wish, self.near) = ([0.0; 2], NEAR[1]);
            if !self.lively_places(&scene, &samples).is_empty() {
                let opened = self.opened(&scene, &samples);
                (self.samples, self.scene) = (Some(samples), scene);
                return Ok(DescentStep::Scene(Box::new(opened)));
            }
        }
        Ok(DescentStep::End)
    }

    /// Computes the small picture of a scene; returns `None` once `keep_going` returns false.
    fn picture(
        &self,
        scene: &Scene,
        engine: &mut dyn Engine,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<Option<Samples>, EngineError> {
        let mut work = Work::new(scene, [SIDE; 2], self.config, (SIDE * SIDE) as usize);
        preview(&mut work, [SIDE; 2], engine, &|_| keep_going())
    }

    /// Returns the scene around a place, in pixels from the middle; `None` if its view is too
    /// small.
    fn enlarged(&self, offset: [f64; 2]) -> Option<Scene> {
        let mut scene = self.scene.clone();
        let width = scene.view.width_rad().to_f64();
        let pixel = width / f64::from(SIDE);
        let center = scene.view.center_rad();
        let by = offset.map(|by| Exact::from_f64(by * pixel));
        let width = width / FACTOR;
        if width < flipmap_scene::MIN_WIDTH {
            return None;
        }
        // Twelve digits below the width tell the pixels of any screen apart.
        let digits = (12.0 - width.log10()).ceil().max(12.0) as usize;
        let Scene { build, question, view, .. } = &mut scene;
        view.center = [0, 1].map(|i| (center[i] + by[i]).wrapped().decimal(digits));
        view.width = format!("{width:.3e}");
        view.fit = false;
        question.budget = question.budget.for_view(build, view);
        Some(scene)
    }

    /// Returns a scene turned and stretched so that the bands of its picture spread apart.
    fn opened(&mut self, scene: &Scene, samples: &Samples) -> Scene {
        let bands = Bands::of(&flips_units(scene, samples), SIDE as usize);
        let [rotate_deg, stretch] = bands.opened(self.turned);
        // Without whole turns, the angle stays in the range of views.
        self.turned = [rotate_deg % 360.0, stretch];
        let mut opened = scene.clone();
        [opened.view.rotate, opened.view.stretch] = self.turned;
        opened
    }

    /// Returns offsets from the middle, in pixels, of places of a scene's picture that differ from
    /// their neighbours and whose next views have several distinct times, the best first: those
    /// that differ most and lie near the preferred point.
    fn lively_places(&self, scene: &Scene, samples: &Samples) -> Vec<[f64; 2]> {
        let picture = SmallPicture::new(scene, samples);
        let side = SIDE as i32;
        let inside = AROUND..side - AROUND;
        let mut scored = Vec::new();
        for (y, x) in inside.clone().flat_map(|y| inside.clone().map(move |x| (y, x))) {
            let liveliness = picture.liveliness([x, y]);
            if liveliness <= MIN_UNITS {
                continue;
            }
            let distinct = picture.distinct_times([x, y]);
            if distinct < SEVERAL {
                continue;
            }
            let from_middle =
                [x, side - 1 - y].map(|at| f64::from(at) + 0.5 - f64::from(SIDE) / 2.0);
            let far = distance(from_middle, self.wish) / self.near;
            let score = liveliness * distinct.min(MANY) as f64 / (1.0 + far * far);
            scored.push((score, from_middle));
        }
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut places: Vec<[f64; 2]> = Vec::new();
        for (_, place) in scored {
            if places.len() < MAX_TRIES && places.iter().all(|p| distance(*p, place) >= APART) {
                places.push(place);
            }
        }
        places
    }
}

/// Returns the flip times of a scene's pixels in natural units; `None` for a pixel without one.
fn flips_units(scene: &Scene, samples: &Samples) -> Vec<Option<f64>> {
    let unit_secs = scene.build.unit_secs();
    let flip =
        |outcome: Outcome| (outcome.status == Status::Answered).then_some(outcome.time / unit_secs);
    (0..samples.len()).map(|k| flip(samples.get(k))).collect()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The late flips of a small picture, in natural units of time; `None` for a pixel without one.
struct SmallPicture {
    late_units: Vec<Option<f64>>,
}

impl SmallPicture {
    fn new(scene: &Scene, samples: &Samples) -> Self {
        let from_units = LATE * scene.question.budget.secs / scene.build.unit_secs();
        let late = |flip: Option<f64>| flip.filter(|flip_units| *flip_units > from_units);
        SmallPicture { late_units: flips_units(scene, samples).into_iter().map(late).collect() }
    }

    /// Returns the late flips within `reach` pixels along each axis, as far as the picture reaches.
    fn around(&self, [x, y]: [i32; 2], reach: i32) -> impl Iterator<Item = f64> {
        let side = SIDE as i32;
        let within = move |at: i32| (at - reach).max(0)..(at + reach + 1).min(side);
        let places = within(y).flat_map(move |y| within(x).map(move |x| (y * side + x) as usize));
        places.filter_map(|place| self.late_units[place])
    }

    /// Returns the mean difference of a pixel's flip time from those of its neighbours. Pairs of
    /// which one does not flip, or flips early, count as zero.
    fn liveliness(&self, at: [i32; 2]) -> f64 {
        let Some(here) = self.around(at, 0).next() else { return 0.0 };
        let sum: f64 =
            self.around(at, AROUND).map(|there| (there - here).abs().min(ENOUGH_UNITS)).sum();
        sum / f64::from((2 * AROUND + 1).pow(2))
    }

    /// Returns the number of distinct times in the next view around a pixel: one on each side of an
    /// edge, many where filaments lie side by side.
    fn distinct_times(&self, at: [i32; 2]) -> usize {
        let mut times: Vec<f64> = self.around(at, NEXT_VIEW).collect();
        times.sort_by(f64::total_cmp);
        let gaps = times.windows(2).filter(|pair| pair[1] - pair[0] > MIN_UNITS).count();
        gaps + usize::from(!times.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::EngineKind;
    use flipmap_engine::choice::{Chosen, EngineRequest, choose};
    use flipmap_scene::BuiltIn;

    /// Returns a picture of the home scene with a time in s for each pixel.
    fn picture(time: impl Fn(u32, u32) -> f64) -> Samples {
        let mut samples = Samples::unanswered((SIDE * SIDE) as usize, 1);
        for (x, y) in (0..SIDE).flat_map(|x| (0..SIDE).map(move |y| (x, y))) {
            samples.set((y * SIDE + x) as usize, Outcome::flipped(time(x, y)));
        }
        samples
    }

    fn processor() -> Chosen {
        let kind = Some(EngineKind::Cpu);
        choose(&EngineRequest { kind, ..EngineRequest::default() }, &|_| ()).unwrap()
    }

    #[test]
    fn an_edge_between_two_colours_leads_nowhere_and_filaments_do() {
        let home = BuiltIn::home().document().scene();
        let descent = Descent::new(home, processor().config, [0.0; 2]);
        let places = |samples: &Samples| descent.lively_places(&descent.scene, samples);
        let edge = picture(|x, y| if x + y / 3 < 20 { 14.0 } else { 21.0 });
        assert_eq!(places(&edge), Vec::<[f64; 2]>::new());
        let filaments = picture(|x, y| 13.0 + f64::from((x * x + 3 * y) % 13));
        let found = places(&filaments);
        assert_eq!(found.len(), MAX_TRIES);
        assert!(distance(found[0], [0.0; 2]) < NEAR[0], "the middle is the wish: {found:?}");
        assert!((1..MAX_TRIES).all(|k| distance(found[0], found[k]) >= APART));
    }

    #[test]
    fn the_bands_of_a_deep_view_lie_along_its_sides() {
        let mut chosen = processor();
        let home = BuiltIn::home().document().scene();
        let mut turned = home.clone();
        turned.view.rotate = 30.0;
        let mut descent = Descent::new(turned, chosen.config, [0.2, 0.12]);
        let (mut apart_deg, mut width) = (Vec::new(), 1.0);
        while width > 1e-6 {
            let step = descent.next(chosen.engine.as_mut(), &|| true).unwrap();
            let DescentStep::Scene(mut scene) = step else { panic!("{step:?}") };
            assert!((0.5..=2.0).contains(&scene.view.stretch) && scene.view.stretch != 1.0);
            width = scene.view.width_rad().to_f64();
            // The bands of the view as it is turned, but for the stretching.
            scene.view.stretch = 1.0;
            let samples = descent.picture(&scene, chosen.engine.as_mut(), &|| true).unwrap();
            let bands = Bands::of(&flips_units(&scene, &samples.unwrap()), SIDE as usize);
            apart_deg.push((bands.along_deg + 45.0).rem_euclid(90.0) - 45.0);
        }
        // From home they lay 40 degrees from the sides.
        let deepest = &apart_deg[apart_deg.len() - 5..];
        assert!(deepest.iter().all(|apart| apart.abs() < 12.0), "{apart_deg:?}");
    }

    #[test]
    fn the_first_step_from_home_goes_to_the_pointer() {
        let mut chosen = processor();
        let home = BuiltIn::home().document().scene();
        let width = home.view.width_rad().to_f64();
        // The filaments nearest to the last point lie further from it.
        for (wish, within) in [([0.2, 0.12], 0.12), ([-0.2, 0.12], 0.12), ([0.05, -0.2], 0.2)] {
            let mut descent = Descent::new(home.clone(), chosen.config, wish);
            let step = descent.next(chosen.engine.as_mut(), &|| true).unwrap();
            let DescentStep::Scene(scene) = step else { panic!("{step:?}") };
            let by = [0, 1].map(|i| {
                (scene.view.center_rad()[i] - home.view.center_rad()[i]).wrapped().to_f64() / width
            });
            assert!(distance(by, wish) < within, "{by:?} for {wish:?}");
        }
    }
}
