//! Deep views across the edge of the forbidden region.

use super::*;

/// Finds by bisection the θ2 of the edge of the forbidden region for this θ1. Starts below it are
/// forbidden.
fn rim(theta1: &str, between: [&str; 2], rule: Rule) -> String {
    let is_forbidden = |theta2: Fixed<4>| {
        let pendulum: Pendulum<Fixed<4>> = Scene::default().build.pendulum_in();
        let angle = [Fixed::<4>::parse(theta1).unwrap(), theta2];
        let budget = Fixed::from_f64(1e-3);
        oracle::outcome(&pendulum, angle, rule, budget).status == Status::Forbidden
    };
    let [mut low, mut high] = between.map(|text| Fixed::<4>::parse(text).unwrap());
    assert!(is_forbidden(low) && !is_forbidden(high));
    for _ in 0..140 {
        let middle = (low + high).halved(1);
        *(if is_forbidden(middle) { &mut low } else { &mut high }) = middle;
    }
    high.resized::<8>().to_string()
}

#[test]
fn views_cut_by_the_energy_curve_are_right_in_every_way() {
    let size = [24, 18];
    let rims = [("1.2", ["1.2", "1.4"], Rule::Second), ("2.0", ["1.6", "1.8"], Rule::First)];
    for (theta1, between, rule) in rims {
        let theta2 = rim(theta1, between, rule);
        for width in ["1e-3", "1e-6", "1e-9", "1e-20"] {
            let mut scene = scene([theta1, &theta2], width);
            scene.question.rule = rule;
            scene.question.budget = Budget::secs(12.0);
            let by = |cells, mut engine: DepthEngine<'static>| {
                let work = Work::new(&scene, size, BALANCED, 4096).with_cells(cells);
                all_samples(work, size, &mut engine)
            };
            let cells = by(Cells::Always, engine().without_lines());
            let lines = by(Cells::Always, engine());
            let is_forbidden = |k: &usize| cells.get(*k).status == Status::Forbidden;
            let forbidden = (0..432).filter(is_forbidden).count();
            assert!((100..332).contains(&forbidden), "{forbidden} are forbidden at {width}");
            let mut ways = vec![lines];
            if width != "1e-20" {
                ways.push(by(Cells::Never, engine()));
            }
            for way in ways {
                let differs = |k: &usize| !is_right(&way.get(*k), &cells.get(*k));
                assert_eq!((0..432).filter(differs).count(), 0, "{rule:?} at {width}");
            }
            let pixels: Vec<usize> = (5..432).step_by(48).collect();
            let truth = truth::<4>(&scene, size, &pixels);
            assert_eq!(share_right(&cells, &pixels, &truth), 1.0, "{rule:?} at {width}");
        }
    }
}
