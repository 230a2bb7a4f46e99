//! Coarser tiles stand in for those that are not known yet.

use super::*;

needs_adapter! {
    checks:
    a_coarser_tile_stands_in_smoothly
    a_few_samples_that_fill_the_view_keep_their_colours
}

mod checks {
    use super::*;

    /// The light of the four samples around a point of a tile, interpolated by distance.
    fn mixed(explorer: &mut Explorer, tones: &Tones, cell: Cell, at: [f64; 2]) -> Rgb {
        let (known, mirrored) = explorer.known(cell).expect("a tile that was computed");
        let last = f64::from(SIDE - 1);
        let [x, y] = at.map(|samples| (samples - 0.5).clamp(0.0, last));
        let mut sum = [0.0; 3];
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (column, row) = ((x.floor() + dx).min(last), (y.floor() + dy).min(last));
            let weight = (1.0 - (x - x.floor() - dx).abs()) * (1.0 - (y - y.floor() - dy).abs());
            let place = (row * f64::from(SIDE) + column) as usize;
            let place = if mirrored { known.samples.len() - 1 - place } else { place };
            let colour = tones.colour(&known.samples.get(place));
            (0..3).for_each(|i| sum[i] += weight * light(colour[i]));
        }
        sum.map(encoded)
    }

    pub(crate) fn a_coarser_tile_stands_in_smoothly() {
        let (coarse, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&coarse, &scene);
        let fine = screen(middle(), LEVEL + 2);
        let picture = &pictures()[1];
        let tones = Tones::new(picture, scene.build.unit_secs(), 60.0).unwrap();
        let grid = grid(&fine, &scene);
        let mut truth = Vec::new();
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
            let angle = grid.angle_from_pixel(x, y);
            let angle = angle.map(Exact::from_dd);
            let cell = Cell::around(angle, LEVEL);
            let place = |i: usize| (angle[i] - cell.center()[i]).to_f64() / pitch_rad(LEVEL);
            let half = f64::from(SIDE / 2);
            truth.push(mixed(&mut explorer, &tones, cell, [half + place(0), half - place(1)]));
        }
        let paint = Paint { picture, scene: &scene, trust: false };
        let pixels = Studio::new(PLAIN).draw(&fine, &mut explorer, &paint);
        assert!(wrong(&pixels, &truth) <= 0.001, "{}", wrong(&pixels, &truth));
        // The stand-in differs from the samples that it replaces.
        assert!(wrong(&pixels, &painted(&fine, &scene, picture)) > 0.01);
    }

    /// The colour of the sample of a tile that is nearest to a start.
    fn nearest(explorer: &mut Explorer, tones: &Tones, angle: [Exact; 2]) -> Rgb {
        let cell = Cell::around(angle, LEVEL);
        let (known, mirrored) = explorer.known(cell).expect("a tile that was computed");
        let [column, row] = cell.sample_at(angle);
        let place = (row * SIDE + column) as usize;
        let place = if mirrored { known.samples.len() - 1 - place } else { place };
        tones.colour(&known.samples.get(place))
    }

    pub(crate) fn a_few_samples_that_fill_the_view_keep_their_colours() {
        let (coarse, scene) = (screen(middle(), LEVEL), scene(60.0));
        let mut explorer = explored(&coarse, &scene);
        let picture = &pictures()[1];
        let tones = Tones::new(picture, scene.build.unit_secs(), 60.0).unwrap();
        // Four samples meet in the middle of the view, of which each fills a quarter.
        let across = |fine: &Screen| [-100.0, 100.0].map(|x| fine.angle_at(DVec2::new(x, 50.0)));
        let differ = |explorer: &mut Explorer, fine: &Screen| {
            let [one, other] = across(fine).map(|angle| nearest(explorer, &tones, angle));
            one.iter().zip(other).any(|(a, b)| a.abs_diff(b) > 40)
        };
        let pitch = Exact::from_f64(pitch_rad(LEVEL));
        let views = (-60..60).map(|k| {
            let [theta1, theta2] = middle();
            screen([theta1 + pitch * Exact::from_f64(f64::from(k)), theta2], LEVEL + 10)
        });
        let fine = views.into_iter().find(|fine| differ(&mut explorer, fine)).expect("an edge");
        let points = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
        let point = |[x, y]: [u32; 2]| DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        let half = DVec2::from(SIZE.map(f64::from)) / 2.0;
        let angles = points.map(|at| fine.angle_at(point(at) - half));
        let truth: Vec<Rgb> = angles.map(|at| nearest(&mut explorer, &tones, at)).collect();
        let paint = Paint { picture, scene: &scene, trust: false };
        let pixels = Studio::new(PLAIN).draw(&fine, &mut explorer, &paint);
        let mixed = beyond(1, &pixels, &truth);
        assert!(mixed < 0.15, "{mixed} of the view is mixed");
    }
}
