//! A picture's colours in the form that the card takes: a table over the times, and the linear
//! light of outcomes without a time. They depend on the palette but not on the samples. Answers
//! that are not times are painted by the processor instead.

use super::pipeline::{TABLE_ENTRIES, Uniforms};
use super::sample::{HEIGHT_STEPS, LOG_BIAS, LOG_STEPS, WordKind};
use flipmap_scene::palette::{AnswerColours, FAILED, Lookup, Relief, Rgb, Tones, light};
use flipmap_scene::{PictureTable, Scene, SceneError};

/// A picture's colours in the form that the card takes.
#[derive(Clone, Debug, PartialEq)]
pub struct CardColours {
    /// The values shared by all samples.
    pub(crate) uniforms: Uniforms,
    /// The colour table's sRGB colours, four bytes each.
    pub(crate) table: Vec<u8>,
    /// Content of the words of samples.
    pub(crate) words: WordKind,
}

/// Largest share of the palette between two entries of the table: an eighth of the step between two
/// of its 256 colours, which differ by at most a few parts in 255.
const MAX_ENTRY_GAP: f64 = 1.0 / 2048.0;
/// Least number of octaves of a table, whose entries are then 2⁻¹⁷ octaves apart, close to the
/// resolution of logarithms in f32 on the card.
const MIN_OCTAVES: f64 = TABLE_ENTRIES as f64 / (1 << 17) as f64;

/// The colours of a table, and the mapping from words to its entries.
struct Table {
    words: WordKind,
    colours: Vec<Rgb>,
    /// The value of a word whose number is 0, and the value of one step of the number.
    value: [f64; 2],
    /// The value of the first entry, and entries per unit.
    entries: [f64; 2],
    /// The value after which answers are not shown.
    until: f64,
}

/// Returns the colours of a scene's picture while they glide: those of `shown`, whose times are
/// moving towards the picture's. `trust` hatches uncertain pixels, and flips after `until_secs` are
/// not shown. Fails if the picture cannot be painted.
pub fn gliding_colours(
    picture: &PictureTable,
    shown: &PictureTable,
    scene: &Scene,
    until_secs: f64,
    trust: bool,
) -> Result<CardColours, SceneError> {
    let answers = AnswerColours::new(scene, picture)?;
    let shown = AnswerColours::new(scene, shown)?;
    let ground = answers.ground();
    let relief = Relief::of(picture).filter(|_| answers.times().is_some());
    let table = match (answers.times(), shown.times()) {
        (Some((channel, tones)), Some((_, shown))) => {
            let until_secs = if scene.question.ask.is_time() { until_secs } else { f64::INFINITY };
            let is_flat = relief.is_none() && channel == 0;
            let is_fine = || shown == tones || table_of_times(tones, until_secs).is_some();
            let table = if is_flat { table_of_times(shown, until_secs) } else { None };
            let table = table.filter(|_| is_fine());
            table.unwrap_or_else(|| table_of_heights(channel, tones, shown, until_secs))
        }
        _ => Table {
            words: WordKind::Colours(Box::new(answers)),
            colours: vec![[0; 3]; TABLE_ENTRIES],
            value: [0.0, 1.0],
            entries: [0.0, 1.0],
            until: f64::INFINITY,
        },
    };
    let toward = relief.map_or([0.0; 3], |relief| relief.toward);
    let uniforms = Uniforms {
        value_bias: table.value[0] as f32,
        value_step: table.value[1] as f32,
        first_value: table.entries[0] as f32,
        entries_per_unit: table.entries[1] as f32,
        until_value: table.until as f32,
        trust: u32::from(trust),
        coloured: u32::from(matches!(table.words, WordKind::Colours(_))),
        relief: relief.map_or(0.0, |relief| relief.strength),
        unflipped: linear(ground.unflipped),
        forbidden: linear(ground.forbidden),
        failed: linear(FAILED),
        // `MapRenderer::frame` fills in the width in pixels.
        toward: [toward[0], toward[1], toward[2], 0.0],
    };
    let bytes = table.colours.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    Ok(CardColours { uniforms, table: bytes, words: table.words })
}

/// Returns the table over the logarithm of time, whose words are the same for every scale; none if
/// it is too coarse for the colours.
fn table_of_times(tones: &Tones, until_secs: f64) -> Option<Table> {
    let Lookup { first_secs, last_secs, colours, max_gap } = tones.lookup(TABLE_ENTRIES);
    let octaves = (last_secs / first_secs).log2();
    let per_octave = (TABLE_ENTRIES - 1) as f64 / octaves;
    (octaves > MIN_OCTAVES && max_gap <= MAX_ENTRY_GAP).then_some(Table {
        words: WordKind::Times,
        colours,
        value: [-LOG_BIAS, 1.0 / LOG_STEPS],
        entries: [first_secs.log2(), per_octave],
        until: until_secs.log2(),
    })
}

/// Returns the table over the heights of times on the scale of `tones`.
fn table_of_heights(channel: usize, tones: &Tones, shown: &Tones, until_secs: f64) -> Table {
    let scale = tones.scale();
    let [_, last_secs] = scale.range_secs();
    Table {
        words: WordKind::Heights(channel, scale.clone()),
        colours: shown.over(scale, TABLE_ENTRIES),
        value: [0.0, 1.0 / HEIGHT_STEPS],
        entries: [0.0, (TABLE_ENTRIES - 1) as f64],
        // All times after the scale's last one have its height.
        until: if until_secs < last_secs { scale.height(until_secs) } else { f64::INFINITY },
    }
}

fn linear(colour: Rgb) -> [f32; 4] {
    let [r, g, b] = colour.map(|channel| light(channel) as f32);
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Outcome;
    use flipmap_render::tiles::Samples;
    use flipmap_scene::Scale;

    /// Index of the table entry that the shader takes for a time.
    fn entry(colours: &CardColours, secs: f64) -> usize {
        let mut samples = Samples::unflipped(1);
        samples.set(0, Outcome::flipped(secs));
        let (word, uniforms) = (colours.words.words(&samples)[0], &colours.uniforms);
        let value = (word >> 5) as f32 * uniforms.value_step + uniforms.value_bias;
        let entry = ((value - uniforms.first_value) * uniforms.entries_per_unit).round();
        entry.clamp(0.0, (TABLE_ENTRIES - 1) as f32) as usize
    }

    #[test]
    fn the_table_has_the_tones_of_its_times() {
        let scene = Scene::default();
        let plain = PictureTable::default();
        let times = |times: &[f64]| PictureTable { times: times.to_vec(), ..plain.clone() };
        let stretched = PictureTable { reverse: true, ..times(&[0.5, 3.0, 40.0]) };
        let lit = PictureTable { relief: 0.5, ..plain.clone() };
        let close = times(&[10.0, 10.001, 10.01]);
        for (picture, flat) in [(&plain, true), (&stretched, true), (&lit, false), (&close, false)]
        {
            let budget_secs = scene.question.budget.secs;
            let tones = Tones::new(picture, scene.build.unit_secs(), budget_secs).unwrap();
            let card = gliding_colours(picture, picture, &scene, budget_secs, false).unwrap();
            assert_eq!(card.words == WordKind::Times, flat, "{picture:?}");
            assert_eq!((card.table.len(), card.uniforms.coloured), (4 * TABLE_ENTRIES, 0));
            let [first, last] = tones.range_secs();
            for share in 0..=40 {
                let secs = first * (last / first).powf(f64::from(share) / 40.0);
                let at = 4 * entry(&card, secs);
                let expected = tones.colour(&Outcome::flipped(secs));
                for (shown, wanted) in card.table[at..at + 3].iter().zip(expected) {
                    assert!(shown.abs_diff(wanted) <= 1, "{secs}: {expected:?}");
                }
            }
        }
    }

    #[test]
    fn colours_finer_than_the_table_have_words_of_their_own() {
        let times =
            |times: &[f64]| PictureTable { times: times.to_vec(), ..PictureTable::default() };
        let steps = PictureTable { scale: Scale::Steps, ..times(&[1.0, 2.0, 9.0]) };
        for (picture, in_table) in [
            (times(&[0.5, 20.0]), true),
            (times(&[0.5, 10.0, 10.1, 20.0]), false),
            (times(&[10.0, 10.001]), false),
            (steps, false),
        ] {
            let words =
                gliding_colours(&picture, &picture, &Scene::default(), 30.0, false).unwrap().words;
            assert_eq!(words == WordKind::Times, in_table, "{picture:?}");
        }
    }

    #[test]
    fn an_offset_changes_the_table_alone() {
        let scene = Scene::default();
        for times in [vec![0.5, 20.0], vec![10.0, 10.001]] {
            let picture = PictureTable { times, palette: "romao".into(), ..Default::default() };
            let moved = PictureTable { offset: 0.3, ..picture.clone() };
            let [a, b] = [&picture, &moved]
                .map(|picture| gliding_colours(picture, picture, &scene, 30.0, false).unwrap());
            assert!(a.words == b.words && a.uniforms == b.uniforms && a.table != b.table);
        }
    }

    #[test]
    fn a_picture_that_cannot_be_painted_is_refused() {
        let picture = PictureTable { palette: "rainbow".into(), ..PictureTable::default() };
        let refused = gliding_colours(&picture, &picture, &Scene::default(), 30.0, true);
        assert!(refused.unwrap_err().to_string().contains("batlow"));
    }
}
