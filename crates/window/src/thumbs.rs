//! Small pictures of the built-in places, and pictures as textures.

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use flipmap_assets::THUMBS;

/// Returns the picture of a built-in scene: its width and height, and three bytes per pixel.
pub(super) fn thumb(name: &str) -> Option<([u32; 2], Vec<u8>)> {
    let (_, jpeg) = THUMBS.iter().find(|(other, _)| *other == name)?;
    let image = image::load_from_memory_with_format(jpeg, image::ImageFormat::Jpeg).ok()?;
    let rgb = image.into_rgb8();
    Some(([rgb.width(), rgb.height()], rgb.into_raw()))
}

/// Returns a picture of three bytes per pixel as a texture of the window.
pub(super) fn loaded(
    ctx: &Context,
    name: impl Into<String>,
    size: [u32; 2],
    rgb: &[u8],
) -> TextureHandle {
    let image = ColorImage::from_rgb(size.map(|side| side as usize), rgb);
    ctx.load_texture(name, image, TextureOptions::LINEAR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::BUILT_IN;

    #[test]
    fn every_built_in_place_has_a_small_picture() {
        for place in BUILT_IN {
            let (size, rgb) = thumb(place.name).unwrap_or_else(|| panic!("{}", place.name));
            assert_eq!((size, rgb.len()), ([96, 72], 3 * 96 * 72), "{}", place.name);
            assert!(rgb.chunks(3).any(|pixel| pixel != &rgb[..3]), "{} is flat", place.name);
        }
        let bytes: usize = THUMBS.iter().map(|(_, jpeg)| jpeg.len()).sum();
        assert!(bytes < 200_000, "{bytes} bytes make every program larger");
    }
}
