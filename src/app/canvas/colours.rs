//! A picture's colours in the form that the card takes: a table over the logarithm of time, and the
//! linear light of outcomes without a time. They change with the palette, never with a sample.

use super::pipeline::{TABLE_ENTRIES, Uniforms};
use crate::scene::palette::{FAILED, FORBIDDEN, Rgb, Tones, UNFLIPPED, light};
use crate::scene::{Build, PictureTable, QuestionTable, SceneError};

/// Returns the uniforms, and the table's sRGB colours as four bytes each; `trust` hatches uncertain
/// pixels. Fails if the picture cannot be painted.
pub fn colours(
    picture: &PictureTable,
    build: &Build,
    question: &QuestionTable,
    trust: bool,
) -> Result<(Uniforms, Vec<u8>), SceneError> {
    let tones = Tones::new(picture, build.unit_secs(), question.budget.secs)?;
    let lookup = tones.lookup(TABLE_ENTRIES);
    let octaves = (lookup.last_secs / lookup.first_secs).log2();
    let uniforms = Uniforms {
        first_log2: lookup.first_secs.log2() as f32,
        entries_per_octave: ((TABLE_ENTRIES - 1) as f64 / octaves) as f32,
        budget_log2: question.budget.secs.log2() as f32,
        trust: u32::from(trust),
        unflipped: linear(UNFLIPPED),
        forbidden: linear(FORBIDDEN),
        failed: linear(FAILED),
    };
    let table = lookup.colours.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    Ok((uniforms, table))
}

fn linear(colour: Rgb) -> [f32; 4] {
    let [r, g, b] = colour.map(|channel| light(channel) as f32);
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Outcome;

    /// Index of the table entry that the shader takes for a time.
    fn entry(uniforms: &Uniforms, secs: f64) -> usize {
        let along = (secs as f32).log2() - uniforms.first_log2;
        let entry = (along * uniforms.entries_per_octave).round();
        entry.clamp(0.0, (TABLE_ENTRIES - 1) as f32) as usize
    }

    #[test]
    fn the_table_has_the_tones_of_its_times() {
        let (build, question) = (Build::default(), QuestionTable::default());
        let plain = PictureTable::default();
        let stretched =
            PictureTable { times: vec![0.5, 3.0, 4.0, 40.0], reverse: true, ..plain.clone() };
        for picture in [plain, stretched] {
            let tones = Tones::new(&picture, build.unit_secs(), question.budget.secs).unwrap();
            let (uniforms, table) = colours(&picture, &build, &question, false).unwrap();
            assert_eq!(table.len(), 4 * TABLE_ENTRIES);
            for secs in [1e-3, 0.31, 0.77, 2.0, 3.5, 17.0, 29.9, 30.0, 1e3] {
                let at = 4 * entry(&uniforms, secs);
                let expected = tones.colour(&Outcome::flipped(secs));
                for (shown, wanted) in table[at..at + 3].iter().zip(expected) {
                    assert!(shown.abs_diff(wanted) <= 4, "{secs}: {:?} {expected:?}", &table[at..]);
                }
            }
        }
    }

    #[test]
    fn a_picture_that_cannot_be_painted_is_refused() {
        let picture = PictureTable { palette: "rainbow".into(), ..PictureTable::default() };
        let refused = colours(&picture, &Build::default(), &QuestionTable::default(), true);
        assert!(refused.unwrap_err().to_string().contains("batlow"));
    }
}
