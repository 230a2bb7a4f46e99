//! Pictures of the map with their scene inside.

use std::io::Cursor;

use flipmap_render::output::{PngError, PngWriter};
use flipmap_scene::Document;

/// Reasons why a picture is not saved.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SaveError {
    #[error("the browser's picture cannot be read: {0}")]
    Foreign(#[from] png::DecodingError),
    #[error("the browser's picture has no colours of eight bits")]
    NotRgb,
    #[error(transparent)]
    Png(#[from] PngError),
}

/// Returns the picture of a browser's canvas, a PNG with or without transparency, as the PNG that the program
/// would write of a document.
pub(crate) fn with_scene(canvas: &[u8], document: &Document) -> Result<Vec<u8>, SaveError> {
    let mut reader = png::Decoder::new(Cursor::new(canvas)).read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or(SaveError::NotRgb)?];
    let info = reader.next_frame(&mut pixels)?;
    let [width, height] = [info.width, info.height];
    let rgb: Vec<u8> = match (info.color_type, info.bit_depth) {
        (png::ColorType::Rgb, png::BitDepth::Eight) => pixels,
        (png::ColorType::Rgba, png::BitDepth::Eight) => {
            let (rgba, _) = pixels.as_chunks::<4>();
            rgba.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
        }
        _ => return Err(SaveError::NotRgb),
    };
    let mut writer = PngWriter::new(Vec::new(), [width, height], document)?;
    writer.write(&rgb)?;
    Ok(writer.finish()?)
}
