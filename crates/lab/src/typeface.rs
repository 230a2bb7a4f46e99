//! The faces that the window and the laboratory's stills write in.

use std::sync::Arc;

use egui::{Context, FontData, FontDefinitions, FontFamily};

/// Makes a context write Greek letters in a face whose π is no п and whose α is no a. All other
/// letters are egui's own.
pub fn install(ctx: &Context) {
    ctx.set_fonts(faces());
}

fn faces() -> FontDefinitions {
    let mut faces = FontDefinitions::default();
    let greek = FontData::from_static(flipmap_assets::GREEK_FACE);
    faces.font_data.insert("greek".to_string(), Arc::new(greek));
    faces.families.entry(FontFamily::Proportional).or_default().insert(0, "greek".to_string());
    faces
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use egui::FontId;

    use super::*;

    /// Calls `look` with a context that has drawn a frame in the window's faces.
    fn with_faces(look: impl Fn(&Context)) {
        let ctx = Context::default();
        install(&ctx);
        // Nothing draws the textures.
        ctx.run_ui(egui::RawInput::default(), |ui| look(ui.ctx())).textures_delta.clear();
    }

    #[test]
    fn greek_has_a_face_of_its_own_and_lines_keep_their_height() {
        with_faces(|ctx| {
            ctx.fonts_mut(|fonts| {
                let mut size = |text: &str| {
                    let font = FontId::proportional(100.0);
                    fonts.layout_no_wrap(text.to_string(), font, egui::Color32::WHITE).size()
                };
                assert_eq!(size("πα").y, size("pa").y, "both stand on one baseline");
                assert_eq!(size("00").x, size("19").x, "figures have one width");
                let omega = size("ω").x;
                assert!(omega < 80.0, "{omega} is the width of another face's ω");
            });
        });
    }

    /// Every sign that the sources of the window and the laboratory contain.
    fn signs() -> BTreeSet<char> {
        let mut signs = BTreeSet::new();
        let mut folders = vec![
            Path::new(env!("CARGO_MANIFEST_DIR")).join("src"),
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../window/src"),
        ];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if entry.is_dir() {
                    folders.push(entry);
                    continue;
                }
                let text = std::fs::read_to_string(entry).unwrap();
                let spoken = text.lines().filter(|line| !line.trim_start().starts_with("//"));
                signs.extend(spoken.flat_map(str::chars).filter(|sign| !sign.is_ascii()));
            }
        }
        signs
    }

    #[test]
    fn every_sign_that_is_written_has_a_shape() {
        let signs = signs();
        assert!(signs.contains(&'π') && signs.contains(&'⁻'), "{signs:?}");
        with_faces(|ctx| {
            ctx.fonts_mut(|fonts| {
                for font in [FontId::proportional(14.0), FontId::monospace(14.0)] {
                    let missing: Vec<_> =
                        signs.iter().filter(|sign| !fonts.has_glyph(&font, **sign)).collect();
                    assert!(missing.is_empty(), "{font:?} lacks {missing:?}");
                }
            });
        });
    }
}
