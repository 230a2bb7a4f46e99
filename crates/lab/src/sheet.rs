//! The lesson as a sheet to print: pictures of the figures and the questions with space for
//! answers, and the answers on a page of their own.

use std::io::Cursor;

use base64::{Engine, prelude::BASE64_STANDARD};
use egui::Theme;
use image::{ImageFormat, RgbImage};
use minijinja::{Environment, UndefinedBehavior, Value, context};

use super::home::HomeMap;
use super::lesson::open_for;
use super::predictions::{Prediction, predictions};
use super::still::{Still, StillPainter};
use super::{Figure, Lab};
use flipmap_assets::LESSON_SHEET;
use flipmap_engine::EngineError;

/// Width and height of the figures' pictures in pixels.
const SIZE: [u32; 2] = [880, 520];

/// Returns the sheet as a page of HTML that needs no other file. The figures are as their first
/// question opens them, so that no picture gives an answer away.
pub fn sheet(map: &HomeMap) -> Result<String, EngineError> {
    let mut painter = StillPainter::new(SIZE, Theme::Light)?;
    let mut figures = Vec::new();
    for figure in Figure::all() {
        let picture = match figure {
            Figure::Map => {
                let rgb = map.image.pixels.iter().flat_map(|pixel| pixel.to_array()[..3].to_vec());
                Still { size: map.image.size.map(|side| side as u32), rgb: rgb.collect() }
            }
            _ => picture(&mut painter, figure)?,
        };
        let questions: Vec<Value> = predictions(figure).iter().map(question).collect();
        let picture = BASE64_STANDARD.encode(png(picture)?);
        figures.push(context! { title => figure.title(), picture, questions });
    }
    let mut pages = Environment::new();
    pages.set_undefined_behavior(UndefinedBehavior::Strict);
    let page = pages.render_named_str("sheet.html", LESSON_SHEET, context! { figures });
    page.map_err(|error| EngineError::Unsupported(error.to_string()))
}

fn picture(painter: &mut StillPainter, figure: Figure) -> Result<Still, EngineError> {
    let mut lab = Lab::new(figure);
    open_for(&mut lab, &predictions(figure)[0]);
    painter.paint(|ui| lab.show_alone(ui))
}

fn question(prediction: &Prediction) -> Value {
    let Prediction { ask, choices, right, observe, why, .. } = *prediction;
    context! { ask, choices => choices.to_vec(), right => choices[right], observe, why }
}

/// Encodes a picture as a PNG file.
fn png(still: Still) -> Result<Vec<u8>, EngineError> {
    let [width, height] = still.size;
    let mut file = Cursor::new(Vec::new());
    let picture = RgbImage::from_raw(width, height, still.rgb);
    let written = picture.map(|picture| picture.write_to(&mut file, ImageFormat::Png));
    match written {
        Some(Ok(())) => Ok(file.into_inner()),
        Some(Err(error)) => Err(EngineError::Unsupported(error.to_string())),
        None => unreachable!("a still has three bytes for each of its pixels"),
    }
}
