//! A picture's colours in the form that the card takes: a table over the logarithm of time, and the
//! linear light of outcomes without a time. They change with the palette, never with a sample. The
//! answers to other questions are painted here instead.

use super::pipeline::{TABLE_ENTRIES, Uniforms};
use super::sample::WordKind;
use crate::scene::palette::{AnswerColours, FAILED, Rgb, Tones, light};
use crate::scene::{PictureTable, Scene, SceneError};

/// A picture's colours in the form that the card takes.
#[derive(Clone, Debug, PartialEq)]
pub struct CardColours {
    /// The values shared by all samples.
    pub uniforms: Uniforms,
    /// The colour table's sRGB colours, four bytes each.
    pub table: Vec<u8>,
    /// Content of the words of samples.
    pub words: WordKind,
}

/// Most of the palette between two entries of the table: half a colour, which no eye sees.
const MOST_APART: f64 = 1.0 / 512.0;
/// Least octaves of a table, whose entries are as many steps of the card's logarithms.
const LEAST_OCTAVES: f64 = TABLE_ENTRIES as f64 / (1 << 17) as f64;

/// Returns the colours of a scene's picture; `trust` hatches uncertain pixels, and flips after
/// `until_secs` are not shown. Fails if the picture cannot be painted.
pub fn colours(
    picture: &PictureTable,
    scene: &Scene,
    until_secs: f64,
    trust: bool,
) -> Result<CardColours, SceneError> {
    let question = &scene.question;
    let tones = Tones::new(picture, scene.build.unit_secs(), question.budget.secs)?;
    let lookup = tones.lookup(TABLE_ENTRIES);
    let octaves = (lookup.last_secs / lookup.first_secs).log2();
    let is_time = question.ask.is_time();
    let in_table = is_time && octaves > LEAST_OCTAVES && lookup.most_apart <= MOST_APART;
    let words = if in_table {
        WordKind::Times
    } else {
        let until_secs = if is_time { until_secs } else { f64::INFINITY };
        WordKind::Colours { colours: Box::new(AnswerColours::new(scene, picture)?), until_secs }
    };
    let uniforms = Uniforms {
        first_log2: lookup.first_secs.log2() as f32,
        entries_per_octave: ((TABLE_ENTRIES - 1) as f64 / octaves) as f32,
        budget_log2: until_secs.log2() as f32,
        trust: u32::from(trust),
        coloured: u32::from(words != WordKind::Times),
        padding: [0; 3],
        unflipped: linear(tones.ground().unflipped),
        forbidden: linear(tones.ground().forbidden),
        failed: linear(FAILED),
    };
    let table = lookup.colours.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    Ok(CardColours { uniforms, table, words })
}

fn linear(colour: Rgb) -> [f32; 4] {
    let [r, g, b] = colour.map(|channel| light(channel) as f32);
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Outcome;
    use crate::scene::Scale;

    /// Index of the table entry that the shader takes for a time.
    fn entry(uniforms: &Uniforms, secs: f64) -> usize {
        let along = (secs as f32).log2() - uniforms.first_log2;
        let entry = (along * uniforms.entries_per_octave).round();
        entry.clamp(0.0, (TABLE_ENTRIES - 1) as f32) as usize
    }

    #[test]
    fn the_table_has_the_tones_of_its_times() {
        let scene = Scene::default();
        let plain = PictureTable::default();
        let stretched =
            PictureTable { times: vec![0.5, 3.0, 40.0], reverse: true, ..plain.clone() };
        for picture in [plain, stretched] {
            let budget_secs = scene.question.budget.secs;
            let tones = Tones::new(&picture, scene.build.unit_secs(), budget_secs).unwrap();
            let CardColours { uniforms, table, words } =
                colours(&picture, &scene, budget_secs, false).unwrap();
            assert_eq!((words, uniforms.coloured), (WordKind::Times, 0));
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
    fn colours_finer_than_the_table_are_painted_here() {
        let times =
            |times: &[f64]| PictureTable { times: times.to_vec(), ..PictureTable::default() };
        let steps = PictureTable { scale: Scale::Steps, ..times(&[1.0, 2.0, 9.0]) };
        for (picture, in_table) in [
            (times(&[0.5, 20.0]), true),
            (times(&[0.5, 10.0, 10.1, 20.0]), false),
            (times(&[10.0, 10.001]), false),
            (steps, false),
        ] {
            let words = colours(&picture, &Scene::default(), 30.0, false).unwrap().words;
            assert_eq!(words == WordKind::Times, in_table, "{picture:?}");
        }
    }

    #[test]
    fn a_picture_that_cannot_be_painted_is_refused() {
        let picture = PictureTable { palette: "rainbow".into(), ..PictureTable::default() };
        let refused = colours(&picture, &Scene::default(), 30.0, true);
        assert!(refused.unwrap_err().to_string().contains("batlow"));
    }
}
