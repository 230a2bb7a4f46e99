//! The known samples of the view, for a small picture of it.

use glam::DVec2;

use super::state::AppState;
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::output::Picture;
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_scene::palette::AnswerColours;
use flipmap_screen::camera::Screen;
use flipmap_screen::hover::Answer;
use flipmap_screen::samples_in_view::best_answer;

/// Width and height of a bookmark's picture in pixels.
const THUMBNAIL: [u32; 2] = [192, 144];

/// Returns the known flip times of the samples in view at the screen's level.
pub(crate) fn known_times(screen: &Screen, explorer: &mut Explorer) -> Vec<f64> {
    let mut times = Vec::new();
    for placed in screen.region().cells(screen.level(), MAX_CELLS) {
        if let Some((known, _)) = explorer.known(placed.cell) {
            let flipped = |outcome: &Outcome| outcome.status == Status::Answered;
            times.extend(known.samples.iter().filter(flipped).map(|outcome| outcome.time));
        }
    }
    times
}

/// Returns what is shown as a small picture; it is grey if the question cannot be painted.
pub(crate) fn picture(state: &AppState, explorer: &mut Explorer) -> Picture {
    let document = state.document();
    let colours = AnswerColours::new(&document.scene(), &document.picture).ok();
    let rgb = colours.map(|colours| thumbnail(&state.screen(), explorer, &colours));
    let [width, height] = THUMBNAIL;
    let rgb = rgb.unwrap_or_else(|| vec![0x80; (3 * width * height) as usize]);
    Picture { document, size: THUMBNAIL, rgb }
}

/// Renders the view as a small picture, three bytes per pixel; unknown pixels are grey.
fn thumbnail(screen: &Screen, explorer: &mut Explorer, colours: &AnswerColours) -> Vec<u8> {
    const UNKNOWN: [u8; 3] = [0x80; 3];
    let [width, height] = THUMBNAIL;
    // The thumbnail shows the middle of the view, cropped to its own shape.
    let scale = (screen.size / DVec2::new(f64::from(width), f64::from(height))).min_element();
    let mut bytes = Vec::with_capacity((3 * width * height) as usize);
    for row in 0..height {
        for column in 0..width {
            let x = f64::from(column) + 0.5 - f64::from(width) / 2.0;
            let y = f64::from(row) + 0.5 - f64::from(height) / 2.0;
            let answer = best_answer(screen, explorer, DVec2::new(x, y) * scale);
            let colour = |answer: Answer| colours.colour(answer.status, &answer.values);
            bytes.extend(answer.map_or(UNKNOWN, colour));
        }
    }
    bytes
}
