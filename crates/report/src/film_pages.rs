//! The chapter on films.

use super::films::are_measured;
use super::pages::{Block, Section, Table, section, share, short};
use super::{LongFilm, Report, ZoomRow};

const ABOUT: &str = "A film of 60 s, 60 frames a second, 1920 × 1080 with one sample a pixel, that zooms from home \
     to 6e-61 rad. It is not made: short zooms from some widths are sampled, of which each stands for \
     the octaves around it, and 24 frames are painted and encoded.";

/// The chapter on the time of a long film, or `None` if nothing of it was measured.
pub(super) fn films(report: &Report) -> Option<Section> {
    if !are_measured(report) {
        return None;
    }
    let mut blocks = vec![Block::Text(ABOUT.to_string()), Block::Table(table(&report.zooms))];
    blocks.extend(frames(report).map(Block::Text));
    blocks.extend(estimate(report).map(Block::Text));
    Some(section("Films", blocks))
}

fn table(zooms: &[ZoomRow]) -> Table {
    let head = ["engine", "width", "samples", "seconds", "µs/sample"];
    let line = |row: &ZoomRow| {
        vec![
            row.engine.clone(),
            format!("{:.0e}", row.width_rad),
            row.samples.to_string(),
            short(row.secs),
            short(1e6 * row.secs / row.samples as f64),
        ]
    };
    Table::new("", &head, zooms.iter().map(line).collect())
}

fn frames(report: &Report) -> Option<String> {
    let painting = report.painting.as_ref()?;
    let each = painting.secs / f64::from(painting.frames);
    Some(format!("A frame takes {} s to paint and encode.", short(each)))
}

fn estimate(report: &Report) -> Option<String> {
    let film = LongFilm::of(report)?;
    let samples = report.painting.as_ref()?.film_samples as f64 / 1e6;
    Some(format!(
        "The whole film: {samples:.0} million samples in {:.0} s, and frames in {:.0} s, {} of all; \
         together {:.0} minutes.",
        film.sampling_secs,
        film.painting_secs,
        share(Some(film.painting_secs / film.secs())),
        film.secs() / 60.0
    ))
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    #[test]
    fn the_whole_film_is_estimated_once_everything_was_measured() {
        let mut report = fixtures::report();
        let chapter = films(&report).unwrap();
        let [_, Block::Table(table), _, Block::Text(estimate)] = &chapter.blocks[..] else {
            panic!("{:?}", chapter.blocks);
        };
        assert!(table.rows.iter().all(|row| row.len() == table.head.len()));
        assert!(estimate.contains("together 15 minutes"), "{estimate}");
        report.painting = None;
        assert_eq!(films(&report).unwrap().blocks.len(), 2);
        report.zooms.clear();
        assert!(films(&report).is_none());
    }
}
