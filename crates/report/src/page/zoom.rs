//! The chapters on deep zoom, on questions other than the first flip, and on films.

use super::plot::{Plot, Point, Series};
use super::{Block, Table, brief, fold, share, short, text};
use crate::depth::DepthWay;
use crate::plan::words;
use crate::{DepthRow, LongFilm, QuestionRow, Report};

const ABOUT_DEPTH: &str = "One filament followed down. Of a picture of 384 × 384 pixels at each width, with a budget that \
     follows the depth, some are compared with pixels integrated one by one in fixed-point numbers of \
     57 to 115 digits. First is the time until that picture is there, its reference included; \
     steps, right-hand sides and time are those of a pixel of a picture of 128 × 128 once the \
     reference is known, cells followed as polynomials included. Beside it, the time if every \
     pixel is integrated directly from its release, and if no pixel is told by samples of a line.";

type Value<T> = fn(&T) -> Option<f64>;

const DEPTH_PLOTS: [(&str, &str, Value<DepthRow>); 3] = [
    ("Share of pixels not right within 1 ms, over the width", "share not right", |row| {
        row.errors.right_1ms.map(|right| 1.0 - right)
    }),
    ("Steps of a pixel, over the width", "steps", |row| Some(row.steps_per_pixel)),
    ("Time of a pixel, over the width", "µs per pixel", |row| Some(row.us_per_pixel)),
];

const WIDTH: &str = "width of the view, rad";

/// The chapter on deep zoom.
pub(super) fn depth(report: &Report) -> Option<Block> {
    let mut blocks = vec![text(ABOUT_DEPTH)];
    for (caption, up, value) in DEPTH_PLOTS {
        let point = |row: &DepthRow| -> Option<Point> {
            Some((row.engine.clone(), row.config, [row.width_rad, value(row)?]))
        };
        let series = Series::by_method(report.depth.iter().filter_map(point));
        blocks.push(Block::Plot(caption.to_string(), Plot { across: WIDTH, up, series }));
    }
    for rows in report.depth.chunk_by(|a, b| a.engine == b.engine) {
        let caption = format!(
            "{}: time of a pixel by way, over the width: directly from its release, through \
             cells and strips alone, and with lines told by samples",
            rows[0].engine
        );
        let plot = Plot { across: WIDTH, up: "µs per pixel", series: ways(rows) };
        blocks.extend([Block::Plot(caption, plot), depth_table(rows)]);
    }
    fold("Deep zoom", blocks)
}

/// The times of a pixel by the way in which it was computed.
fn ways(rows: &[DepthRow]) -> Vec<Series> {
    let series = |(colour, way): (usize, DepthWay)| {
        let time = |row: &DepthRow| Some([row.width_rad, row.us_by_way.as_ref()?.of(way)?]);
        let first = rows.iter().find(|row| row.us_by_way.is_some())?;
        Some(Series {
            colour: (colour, way.name()),
            precision: first.config.precision,
            engine: first.engine.clone(),
            points: rows.iter().filter_map(time).collect(),
            name: "",
        })
    };
    [0, 3, 2].into_iter().zip(DepthWay::ALL).filter_map(series).collect()
}

fn depth_table(rows: &[DepthRow]) -> Block {
    fn way(row: &DepthRow, way: DepthWay) -> String {
        let us = row.us_by_way.as_ref().and_then(|times| times.of(way));
        us.map_or("–".to_string(), short)
    }
    Table::of(
        rows,
        &[
            ("pixels by", |row| words(&row.config)),
            ("width", |row| format!("{:.0e}", row.width_rad)),
            ("budget, s", |row| format!("{:.0}", row.budget_secs)),
            ("digits", |row| row.digits.to_string()),
            ("first, s", |row| short(row.first_secs)),
            ("right", |row| share(row.errors.right_1ms)),
            ("wrong class", |row| share(row.errors.wrong_class)),
            ("p99 s", |row| brief(row.errors.p99)),
            ("steps", |row| format!("{:.0}", row.steps_per_pixel)),
            ("RHS", |row| format!("{:.0}", row.rhs_per_pixel)),
            ("µs/pixel", |row| short(row.us_per_pixel)),
            ("directly", |row| way(row, DepthWay::Direct)),
            ("by cells", |row| way(row, DepthWay::Cells)),
            ("compared", |row| row.errors.compared.to_string()),
        ],
    )
    .named(&rows[0].engine)
}

const ABOUT_QUESTIONS: &str = "Speed against error on the home map, against orbits of the gold standard in double-double. An \
     error is infinite where only one of answer and truth is there, or the bob is the wrong one.";

/// The chapter on the questions other than the first flip.
pub(super) fn questions(report: &Report) -> Option<Block> {
    let mut rows = report.questions.clone();
    rows.sort_by_key(|row| row.question);
    let chapters = rows.chunk_by(|a, b| a.question == b.question).filter_map(of_question);
    fold("Other questions", [text(ABOUT_QUESTIONS)].into_iter().chain(chapters).collect())
}

const QUESTION_PLOTS: [(&str, Value<QuestionRow>); 2] =
    [("share not right", |row| Some(1.0 - row.right)), ("median error", |row| row.median_error)];

fn of_question(rows: &[QuestionRow]) -> Option<Block> {
    let QuestionRow { question, budget_secs, tolerance, .. } = rows[0];
    let table = Table::of(
        rows,
        &[
            ("engine", |row| row.engine.clone()),
            ("method", |row| words(&row.config)),
            ("µs/pixel", |row| short(row.us_per_pixel)),
            ("right", |row| share(Some(row.right))),
            ("median error", |row| brief(row.median_error)),
            ("p90 error", |row| brief(row.p90_error)),
            ("compared", |row| row.compared.to_string()),
        ],
    );
    let plots = QUESTION_PLOTS.map(|(up, value)| {
        let point = |row: &QuestionRow| -> Option<Point> {
            Some((row.engine.clone(), row.config, [row.us_per_pixel, value(row)?]))
        };
        let series = Series::by_method(rows.iter().filter_map(point));
        let caption = format!("{question}: {up} over time");
        Block::Plot(caption, Plot { across: "µs per pixel", up, series })
    });
    let caption = format!("{budget_secs} s; right is what lies within {tolerance}");
    let blocks = [table.named(&caption)].into_iter().chain(plots).collect();
    fold(&format!("The question {question}"), blocks)
}

const ABOUT_FILM: &str = "A film of 60 s, 60 frames a second, 1920 × 1080 with one sample a pixel, that zooms from home \
     to 6e-61 rad. It is not made: short zooms from some widths are sampled, of which each stands for \
     the octaves around it, and 24 frames are painted and encoded.";

/// The chapter on the time of a long film.
pub(super) fn films(report: &Report) -> Option<Block> {
    let zooms = Table::of(
        &report.zooms,
        &[
            ("engine", |row| row.engine.clone()),
            ("width", |row| format!("{:.0e}", row.width_rad)),
            ("samples", |row| row.samples.to_string()),
            ("seconds", |row| short(row.secs)),
            ("µs/sample", |row| short(1e6 * row.secs / row.samples as f64)),
        ],
    );
    let painting = Table::of(
        &report.painting,
        &[
            ("samples of the film, in millions", |row| {
                format!("{:.0}", row.film_samples as f64 / 1e6)
            }),
            ("a frame takes to paint and encode, s", |row| short(row.secs / f64::from(row.frames))),
        ],
    );
    let mut blocks = vec![text(ABOUT_FILM), Block::Table(zooms), Block::Table(painting)];
    blocks.extend(LongFilm::of(report).map(|film| {
        Block::Text(format!(
            "The whole film: samples in {:.0} s, and frames in {:.0} s, {} of all; together {:.0} \
             minutes.",
            film.sampling_secs,
            film.painting_secs,
            share(Some(film.painting_secs / film.secs())),
            film.secs() / 60.0
        ))
    }));
    fold("Films", blocks)
}

#[cfg(test)]
mod tests {
    use super::super::markdown;
    use crate::{fixtures, plan};

    #[test]
    fn each_question_has_a_fold_and_a_curve_for_each_method() {
        let mut report = fixtures::report();
        let mut other = report.questions[0].clone();
        (other.config, other.right) = (plan::FAST, 0.5);
        report.questions.push(other.clone());
        other.question = "growth";
        report.questions.push(other);
        let page = super::super::html(&report);
        let [growth, state] =
            ["growth", "state"].map(|name| page.find(&format!("The question {name}")));
        assert!(growth.unwrap() < state.unwrap());
        let of_state = page[state.unwrap()..].split("</details>").next().unwrap();
        assert!(of_state.matches("<polyline").count() == 4 && of_state.contains("dopri5"));
    }

    #[test]
    fn the_whole_film_is_estimated_once_everything_was_measured() {
        let mut report = fixtures::report();
        assert!(markdown(&report).contains("together 15 minutes"));
        report.painting = None;
        let part = markdown(&report);
        assert!(!part.contains("The whole film") && part.contains("<summary>Films"));
    }
}
