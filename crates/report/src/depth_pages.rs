//! The chapter on deep zoom.

use super::depth::{DepthWay, UsByWay};
use super::pages::{Block, Section, Table, brief, section, share, short};
use super::plot::{Plot, Series};
use super::{DepthRow, Report, ReportError, plan};

const ABOUT: &str = "One filament followed down. Of a picture of 384 × 384 pixels at each width, with a budget that \
     follows the depth, some are compared with pixels integrated one by one in fixed-point numbers of \
     57 to 115 digits. First is the time until that picture is there, its reference included; \
     steps, right-hand sides and time are those of a pixel of a picture of 128 × 128 once the \
     reference is known, cells followed as polynomials included. Beside it, the time if every \
     pixel is integrated directly from its release, and if no pixel is told by samples of a line.";

type Value = fn(&DepthRow) -> Option<f64>;

const PLOTS: [(&str, &str, Value); 3] = [
    ("Share of pixels not right within 1 ms, over the width", "share not right", |row| {
        row.errors.right_1ms.map(|right| 1.0 - right)
    }),
    ("Steps of a pixel, over the width", "steps", |row| Some(row.steps_per_pixel)),
    ("Time of a pixel, over the width", "µs per pixel", |row| Some(row.us_per_pixel)),
];

/// The chapters on deep zoom, one for each engine that has rows of it.
pub(super) fn depth(report: &Report) -> Result<Vec<Section>, ReportError> {
    let engines = report.depth.chunk_by(|a, b| a.engine == b.engine);
    engines.map(of_engine).collect()
}

fn of_engine(rows: &[DepthRow]) -> Result<Section, ReportError> {
    let mut blocks = vec![Block::Text(ABOUT.to_string()), Block::Table(table(rows))];
    for (caption, up, value) in PLOTS {
        let configs = rows.chunk_by(|a, b| a.config == b.config);
        let series = configs.map(|rows| Series {
            config: rows[0].config,
            way: None,
            points: rows.iter().filter_map(|row| Some((row.width_rad, value(row)?))).collect(),
        });
        let svg = Plot { across: "width of the view, rad", up, series: series.collect() }.svg()?;
        blocks.push(Block::Figure { caption: caption.to_string(), svg });
    }
    let series = ways(rows);
    if !series.is_empty() {
        let (across, up) = ("width of the view, rad", "µs per pixel");
        let svg = Plot { across, up, series }.svg()?;
        let caption = "Time of a pixel by way, over the width: directly from its release, through \
                       cells and strips alone, and with lines told by samples";
        blocks.push(Block::Figure { caption: caption.to_string(), svg });
    }
    Ok(section(&format!("Deep zoom: {}", rows[0].engine), blocks))
}

/// The times of a pixel by the way in which it was computed.
fn ways(rows: &[DepthRow]) -> Vec<Series> {
    let series = |way: DepthWay| {
        let times = rows.iter().filter_map(|row| Some((row, row.us_by_way.as_ref()?)));
        let point = |(row, times): (&DepthRow, &UsByWay)| Some((row.width_rad, times.of(way)?));
        let config = rows.iter().find(|row| row.us_by_way.is_some())?.config;
        Some(Series { config, way: Some(way), points: times.filter_map(point).collect() })
    };
    DepthWay::ALL.into_iter().filter_map(series).collect()
}

fn table(rows: &[DepthRow]) -> Table {
    let head = [
        "pixels by",
        "width",
        "budget, s",
        "digits",
        "first, s",
        "right",
        "wrong class",
        "p99 s",
        "steps",
        "RHS",
        "µs/pixel",
        "directly",
        "by cells",
        "compared",
    ];
    let way = |row: &DepthRow, way| {
        let us = row.us_by_way.as_ref().and_then(|times| times.of(way));
        us.map_or("–".to_string(), short)
    };
    let line = |row: &DepthRow| {
        vec![
            plan::words(&row.config),
            format!("{:.0e}", row.width_rad),
            format!("{:.0}", row.budget_secs),
            row.digits.to_string(),
            short(row.first_secs),
            share(row.errors.right_1ms),
            share(row.errors.wrong_class),
            brief(row.errors.p99),
            format!("{:.0}", row.steps_per_pixel),
            format!("{:.0}", row.rhs_per_pixel),
            short(row.us_per_pixel),
            way(row, DepthWay::Direct),
            way(row, DepthWay::Cells),
            row.errors.compared.to_string(),
        ]
    };
    Table::new("", &head, rows.iter().map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    #[test]
    fn every_place_has_a_line_and_every_plot_its_points() {
        let report = fixtures::report();
        let sections = depth(&report).unwrap();
        let [Block::Text(_), Block::Table(table), Block::Figure { svg, .. }, ..] =
            &sections[0].blocks[..]
        else {
            panic!("{:?}", sections[0].blocks);
        };
        assert_eq!((sections.len(), table.rows.len()), (1, 2));
        assert!(table.rows.iter().all(|row| row.len() == table.head.len()));
        // Two points and one in the legend.
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(depth(&Report { depth: Vec::new(), ..report }).unwrap().is_empty());
    }
}
