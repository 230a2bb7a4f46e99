//! Samples as an OpenEXR image with the channels `time` (s; `+inf` for unflipped and failed, `nan`
//! for forbidden), `status` (0 unflipped, 1 flipped, 2 forbidden, 3 failed) and `uncertain` (0 or
//! 1), all f32, row 0 at the top.

use std::io::{self, Cursor, Write};

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes};
use exr::prelude::{SmallVec, Text, WritableImage};

use super::npy::number_of;
use crate::engine::Trust;
use crate::scene::Document;
use crate::tiles::Samples;

/// Collects samples and writes them at the end: the format's offsets come first.
pub struct ExrWriter<W: Write> {
    out: W,
    size: [u32; 2],
    text: String,
    /// Time, status, uncertain.
    channels: [Vec<f32>; 3],
}

impl<W: Write> ExrWriter<W> {
    /// Begins a `size` image that carries `document`.
    pub fn new(out: W, size: [u32; 2], document: &Document) -> Self {
        ExrWriter { out, size, text: document.text(), channels: Default::default() }
    }

    /// Takes the next samples.
    pub fn write(&mut self, samples: &Samples) {
        let [times, statuses, uncertain] = &mut self.channels;
        for (index, outcome) in samples.iter().enumerate() {
            times.push(number_of(outcome) as f32);
            statuses.push(f32::from(outcome.status as u8));
            uncertain.push(f32::from(u8::from(samples.trust(index) == Trust::Uncertain)));
        }
    }

    /// Writes the image and gives the file back.
    pub fn finish(mut self) -> io::Result<W> {
        let [times, statuses, uncertain] = self.channels;
        let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> =
            [("time", times), ("status", statuses), ("uncertain", uncertain)]
                .into_iter()
                .map(|(name, values)| AnyChannel::new(name, FlatSamples::F32(values)))
                .collect();
        let mut attributes = LayerAttributes::named("flipmap");
        attributes.comments = Some(Text::from(self.text.as_str()));
        let size = self.size.map(|side| side as usize);
        let layer = Layer::new(
            (size[0], size[1]),
            attributes,
            Encoding::SMALL_LOSSLESS,
            AnyChannels::sort(channels),
        );
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(io::Error::other)?;
        self.out.write_all(bytes.get_ref())?;
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Outcome, Status};
    use exr::prelude::{ReadChannels, ReadLayers, read};

    #[test]
    fn the_channels_hold_what_the_samples_do() {
        let mut samples = Samples::unflipped(6);
        samples.set(0, Outcome::flipped(1.5));
        samples.set(4, Outcome::without_time(Status::Forbidden));
        samples.set_trust(0, Trust::Settled);
        samples.set_trust(5, Trust::Uncertain);
        let mut writer = ExrWriter::new(Vec::new(), [3, 2], &Document::default());
        writer.write(&samples);
        let bytes = writer.finish().unwrap();
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap();
        let layer = &image.layer_data;
        assert_eq!((layer.size.0, layer.size.1), (3, 2));
        let channel = |name: &str| -> Vec<f32> {
            let found = layer.channel_data.list.iter().find(|channel| channel.name.eq(name));
            found.unwrap().sample_data.values_as_f32().collect()
        };
        let times = channel("time");
        assert_eq!((times[0], times[1]), (1.5, f32::INFINITY));
        assert!(times[4].is_nan());
        assert_eq!(channel("status"), [1.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
        assert_eq!(channel("uncertain"), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let text = layer.attributes.comments.as_ref().unwrap().to_string();
        assert!(text.contains("[view]"), "{text}");
    }
}
