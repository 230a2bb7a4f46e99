//! The chapters on the questions other than the first flip.

use super::pages::{Block, Section, Table, brief, section, share, short};
use super::plot::{Plot, Series};
use super::{QuestionRow, Report, ReportError, plan};

const ABOUT: &str = "On the home map, against orbits of the gold standard in double-double. An error is infinite \
     where only one of answer and truth is there, or the bob is the wrong one.";

/// Returns the chapters on the questions, one for each question that has rows.
pub(super) fn questions(report: &Report) -> Result<Vec<Section>, ReportError> {
    let mut asked: Vec<&str> = report.questions.iter().map(|row| row.question).collect();
    asked.sort_unstable();
    asked.dedup();
    let chapter = |name: &str| {
        of_question(report.questions.iter().filter(|row| row.question == name).collect())
    };
    asked.into_iter().map(chapter).collect()
}

fn of_question(rows: Vec<&QuestionRow>) -> Result<Section, ReportError> {
    let QuestionRow { question, budget_secs, tolerance, .. } = rows[0];
    let about = format!(
        "Speed against error of the question {question}, {budget_secs} s. {ABOUT} Right is what lies \
         within {tolerance}."
    );
    let mut blocks = vec![Block::Text(about), Block::Table(table(&rows))];
    for rows in rows.chunk_by(|a, b| a.engine == b.engine) {
        let points = |value: fn(&QuestionRow) -> Option<f64>| {
            let point =
                move |row: &&QuestionRow| Some((row.config, (row.us_per_pixel, value(row)?)));
            Series::by_method(rows.iter().filter_map(point))
        };
        let plots = [
            ("share not right", points(|row| Some(1.0 - row.right))),
            ("median error", points(|row| row.median_error)),
        ];
        for (up, series) in plots {
            let caption = format!("{question}: {up} over time, {}", rows[0].engine);
            let svg = Plot { across: "µs per pixel", up, series }.svg()?;
            blocks.push(Block::Figure { caption, svg });
        }
    }
    Ok(section(&format!("The question {question}"), blocks))
}

fn table(rows: &[&QuestionRow]) -> Table {
    let head = ["engine", "method", "µs/pixel", "right", "median error", "p90 error", "compared"];
    let line = |row: &&QuestionRow| {
        vec![
            row.engine.clone(),
            plan::words(&row.config),
            short(row.us_per_pixel),
            share(Some(row.right)),
            brief(row.median_error),
            brief(row.p90_error),
            row.compared.to_string(),
        ]
    };
    Table::new("", &head, rows.iter().map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    #[test]
    fn each_question_has_a_table_and_curves_of_its_own() {
        let mut report = fixtures::report();
        let mut faster = report.questions[0].clone();
        (faster.config, faster.us_per_pixel, faster.right) = (plan::FAST, 2.0, 0.5);
        report.questions.push(faster);
        let mut other = report.questions[0].clone();
        other.question = "growth";
        report.questions.push(other);
        let chapters = questions(&report).unwrap();
        let titles: Vec<&str> = chapters.iter().map(|chapter| chapter.title.as_str()).collect();
        assert_eq!(titles, ["The question growth", "The question state"]);
        let Block::Table(table) = &chapters[1].blocks[1] else { panic!("a table") };
        assert!(
            table.rows.len() == 2 && table.rows.iter().all(|row| row.len() == table.head.len())
        );
        let Block::Figure { svg, .. } = &chapters[1].blocks[2] else { panic!("a figure") };
        assert!(
            svg.contains("dop853 f64") && svg.contains("dopri5 f32"),
            "one curve for each method"
        );
        report.questions.clear();
        assert!(questions(&report).unwrap().is_empty());
    }
}
