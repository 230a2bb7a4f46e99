//! The files that accompany the tiles in a pyramid's folder.

use std::io;

use minijinja::{Environment, UndefinedBehavior, context};

use super::TILE_SIDE;
use flipmap_assets::PYRAMID_PAGE;
use flipmap_numbers::Scalar;
use flipmap_scene::Document;

/// Returns the text of `map.dzi`: the sizes of the picture and of its tiles.
pub(super) fn image([width, height]: [u32; 2]) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <Image xmlns=\"http://schemas.microsoft.com/deepzoom/2008\" Format=\"png\" Overlap=\"0\" \
         TileSize=\"{TILE_SIDE}\">\n  <Size Width=\"{width}\" Height=\"{height}\"/>\n</Image>\n"
    )
}

/// Returns the text of `index.html`: the viewer of a `size` picture of `document`.
pub(super) fn page([width, height]: [u32; 2], document: &Document) -> io::Result<String> {
    let view = &document.scene().view;
    let center = view.center_rad().map(|theta| scientific(theta.to_f64()));
    let mut pages = Environment::new();
    pages.set_undefined_behavior(UndefinedBehavior::Strict);
    pages
        .render_named_str(
            "index.html",
            PYRAMID_PAGE,
            context! {
                width, height, center,
                side => TILE_SIDE,
                pixel_rad => scientific(view.width_rad().hi / f64::from(width)),
                rotate => scientific(view.rotate),
                stretch => scientific(view.stretch),
                scene => document.text(),
            },
        )
        .map_err(io::Error::other)
}

/// Formats a number, however small, so that scripts can read it.
fn scientific(number: f64) -> String {
    format!("{number:e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_knows_where_it_is_and_needs_no_other() {
        let mut document = Document::default();
        document.view.center = ["-1.66".to_string(), "0.1".to_string()];
        document.view.width = "4.096e-18".to_string();
        let page = page([4096, 30_000], &document).unwrap();
        for words in ["4096", "30000", "-1.66e0", "1e-1", "1e-21", "width = &quot;4.096e-18&quot;"]
        {
            assert!(page.contains(words), "{words}");
        }
        for absent in ["{{", "{%", "http:", "https:", "fetch(", "src=", "href="] {
            assert!(!page.contains(absent), "{absent}");
        }
    }

    #[test]
    fn other_viewers_are_told_the_size() {
        let text = image([7, 5]);
        for words in ["Width=\"7\" Height=\"5\"", "TileSize=\"256\"", "Overlap=\"0\""] {
            assert!(text.contains(words), "{words}");
        }
    }
}
