//! The files of the results: JSON, curves as CSV and SVG, and one HTML page.

use flipmap_scene::Document;
use minijinja::{Environment, context};

use crate::curves::curves;
use crate::findings::Findings;
use crate::folder::RESULTS;
use crate::order::{MeasureError, SurveyOrder};
use crate::plots::svg;
use crate::table::{rows, shown};

/// The page's template.
const PAGE: &str = include_str!("page.html");

/// Returns the names and texts of all files.
pub(crate) fn files(
    order: &SurveyOrder,
    findings: &Findings,
) -> Result<Vec<(String, String)>, MeasureError> {
    let failed = |error: &dyn std::fmt::Display| MeasureError::Page(error.to_string());
    let scene = Document::default().with_scene(order.scene.clone()).text();
    let json = serde_json::json!({
        "flipmap": env!("CARGO_PKG_VERSION"),
        "scene": scene,
        "samples": order.samples,
        "seed": order.seed,
        "apart_secs": order.apart_secs,
        "findings": findings,
    });
    let json = serde_json::to_string_pretty(&json).map_err(|error| failed(&error))?;
    let mut files = vec![(RESULTS.to_string(), json + "\n")];
    let mut plots = Vec::new();
    for curve in curves(findings) {
        let plot = svg(&curve)?;
        files.push((format!("{}.csv", curve.name), curve.csv()));
        files.push((format!("{}.svg", curve.name), plot.clone()));
        plots.push(context! { title => curve.title, svg => plot, csv => curve.csv() });
    }
    let line = |row: &crate::table::Row| {
        let [value, low, high] = shown(&row.number);
        context! { statistic => row.statistic, what => row.what.clone(), value, low, high, remark => row.remark.clone() }
    };
    let lines: Vec<minijinja::Value> = rows(findings).iter().map(line).collect();
    let missing =
        findings.missing.iter().map(|one| context! { what => one.what, why => one.why.clone() });
    let missing: Vec<minijinja::Value> = missing.collect();
    let page = Environment::new().render_named_str(
        "page.html",
        PAGE,
        context! {
            version => env!("CARGO_PKG_VERSION"), scene, lines, plots,
            samples => order.samples, seed => order.seed, missing,
        },
    );
    files.push(("measure.html".to_string(), page.map_err(|error| failed(&error))?));
    Ok(files)
}
