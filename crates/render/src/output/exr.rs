//! Samples as an OpenEXR image with the channels of the question (such as `time` in s; `+inf` for
//! unflipped and failed, `nan` for forbidden), `height` if the question asks for a time (the
//! natural logarithm of the time, or of the budget where there is no time, so it is finite
//! everywhere), `status` (0 unflipped, 1 flipped or answered, 2 forbidden, 3 failed), `uncertain`
//! (0 or 1), and `error` if flips are timed (the estimated error in s, `nan` where nothing was
//! checked), all f32, row 0 at the top. The attribute `axes` says in JSON where the pixels lie.

use std::io::{self, Seek, SeekFrom, Write};
use std::slice::from_ref;

use exr::block::{BlockIndex, UncompressedBlock};
use exr::meta::attribute::AttributeValue;
use exr::meta::header::{Header, LayerAttributes};
use exr::meta::{BlockDescription, MetaData, magic_number};
use exr::prelude::{ChannelDescription, Compression, Error, LineOrder, SampleType, Text, Vec2};

use crate::tiles::Samples;
use crate::tiles::number_of;
use flipmap_engine::Trust;
use flipmap_pendulum::Status;
use flipmap_scene::{Document, PixelAxes, QuestionSettings};

/// Contents of a channel of the file.
#[derive(Clone, Copy)]
enum Column {
    /// A channel of the question, by its index.
    Value(usize),
    /// The natural logarithm of the time. The field, that of the budget, is its upper limit, and
    /// its value where there is no time.
    Height(f32),
    Status,
    Uncertain,
    Error,
}

/// Returns the channels of a question's image in the order of the file, which is alphabetical.
fn columns_of(question: &QuestionSettings) -> Vec<(&'static str, Column)> {
    let ask = question.ask;
    let channels = ask.kind().channels.iter().enumerate();
    let mut columns: Vec<_> = channels.map(|(k, it)| (it.name, Column::Value(k))).collect();
    if ask.is_time() {
        columns.push(("height", Column::Height(question.budget.secs.ln() as f32)));
    }
    if ask.times_flips() {
        columns.push(("error", Column::Error));
    }
    columns.extend([("status", Column::Status), ("uncertain", Column::Uncertain)]);
    columns.sort_unstable_by_key(|(name, _)| *name);
    columns
}

/// Longest row in pixels that is compressed together with others, sixteen at a time. Longer rows
/// exceed the compressor's window, so joining them would only cost memory.
const SHORT_ROW: u32 = 1 << 14;

/// Writes blocks of rows as the samples come, and at the end the table of the blocks' offsets.
pub(crate) struct ExrWriter<W: Write + Seek> {
    out: W,
    header: Header,
    /// File offset of the table of the blocks' offsets.
    table_at: u64,
    /// File offsets of the blocks written so far.
    places: Vec<u64>,
    /// File offset of the next block.
    end: u64,
    /// Rows of the next block; within each row, channel after channel.
    block: Vec<u8>,
    /// The channels of the row that is being filled.
    row: Vec<(Column, Vec<f32>)>,
    /// Number of rows that are filled.
    rows: usize,
}

impl<W: Write + Seek> ExrWriter<W> {
    /// Begins a `size` image that carries `document`, at the start of a file.
    pub(crate) fn new(mut out: W, size: [u32; 2], document: &Document) -> io::Result<Self> {
        let header = header(size, document);
        let mut bytes = Vec::new();
        begin(&mut bytes, &header).map_err(cause)?;
        let table_at = bytes.len() as u64;
        // Room for the table, until its contents are known.
        bytes.resize(bytes.len() + size_of::<u64>() * header.chunk_count, 0);
        out.write_all(&bytes)?;
        Ok(ExrWriter {
            out,
            header,
            table_at,
            places: Vec::new(),
            end: bytes.len() as u64,
            block: Vec::new(),
            row: columns_of(&document.question)
                .into_iter()
                .map(|(_, column)| (column, Vec::new()))
                .collect(),
            rows: 0,
        })
    }

    /// Writes the next samples.
    pub(crate) fn write(&mut self, samples: &Samples) -> io::Result<()> {
        let width = self.header.layer_size.width();
        for index in 0..samples.len() {
            let (status, values) = (samples.get(index).status, samples.values(index));
            for (column, row) in &mut self.row {
                row.push(match *column {
                    Column::Value(channel) => number_of(status, values[channel]) as f32,
                    Column::Height(most) => match status {
                        Status::Answered => (values[0].ln() as f32).min(most),
                        _ => most,
                    },
                    Column::Status => f32::from(status as u8),
                    Column::Uncertain => f32::from(samples.trust(index) == Trust::Uncertain),
                    Column::Error => samples.error_secs(index),
                });
            }
            if self.row[0].1.len() == width {
                self.end_row()?;
            }
        }
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
        for (_, channel) in &mut self.row {
            self.block.extend_from_slice(bytemuck::cast_slice(channel));
            channel.clear();
        }
        self.rows += 1;
        let rows_a_block = self.header.compression.scan_lines_per_block();
        let is_full = self.rows.is_multiple_of(rows_a_block);
        if is_full || self.rows == self.header.layer_size.height() {
            self.end_block()
        } else {
            Ok(())
        }
    }

    fn end_block(&mut self) -> io::Result<()> {
        let data = std::mem::take(&mut self.block);
        let width = self.header.layer_size.width();
        let rows = data.len() / (width * self.header.channels.bytes_per_pixel);
        let index = BlockIndex {
            layer: 0,
            pixel_position: Vec2(0, self.rows - rows),
            pixel_size: Vec2(width, rows),
            level: Vec2(0, 0),
        };
        let block = UncompressedBlock { index, data };
        let chunk = block.compress_to_chunk(from_ref(&self.header)).map_err(cause)?;
        let mut bytes = Vec::new();
        chunk.write(&mut bytes, 1).map_err(cause)?;
        self.out.write_all(&bytes)?;
        self.places.push(self.end);
        self.end += bytes.len() as u64;
        Ok(())
    }

    /// Completes the image and returns the file.
    pub(crate) fn finish(mut self) -> io::Result<W> {
        let height = self.header.layer_size.height();
        if self.rows < height {
            let text = format!("only {} of {height} rows have come", self.rows);
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, text));
        }
        let table: Vec<u8> = self.places.iter().flat_map(|place| place.to_le_bytes()).collect();
        self.out.seek(SeekFrom::Start(self.table_at))?;
        self.out.write_all(&table)?;
        self.out.seek(SeekFrom::Start(self.end))?;
        Ok(self.out)
    }
}

/// Returns the header of an image: its channels and how they are encoded.
fn header(size: [u32; 2], document: &Document) -> Header {
    let columns = columns_of(&document.question);
    let channels =
        columns.iter().map(|(name, _)| ChannelDescription::named(*name, SampleType::F32));
    let compression = if size[0] <= SHORT_ROW { Compression::ZIP16 } else { Compression::ZIP1 };
    let attributes = attributes(size, document);
    let [width, height] = size.map(|side| side as usize);
    Header::new(Text::from("flipmap"), (width, height), channels.collect())
        .with_encoding(compression, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes)
}

/// Returns what the image says of itself: its scene, and where its pixels lie.
fn attributes(size: [u32; 2], document: &Document) -> LayerAttributes {
    let mut attributes = LayerAttributes::named("flipmap");
    attributes.comments = Some(Text::from(document.text().as_str()));
    // One attribute: the library writes several in any order.
    let axes = Text::from(PixelAxes::new(&document.scene(), size).json().as_str());
    attributes.other.insert(Text::from("axes"), AttributeValue::Text(axes));
    attributes
}

/// Writes everything that precedes the table of the blocks' offsets.
fn begin(bytes: &mut Vec<u8>, header: &Header) -> exr::error::UnitResult {
    let requirements = MetaData::validate(from_ref(header), true)?;
    magic_number::write(bytes)?;
    requirements.write(bytes)?;
    Header::write_all(from_ref(header), bytes, false)
}

/// Converts an error of the encoder. The encoder only writes to memory, so it never meets an I/O
/// error.
fn cause(error: Error) -> io::Error {
    io::Error::other(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{AnyChannel, AnyChannels, Blocks, Encoding, FlatImage, FlatSamples};
    use exr::prelude::{Image, Layer, ReadChannels, ReadLayers, SmallVec, WritableImage, read};
    use flipmap_engine::Assurance;
    use flipmap_pendulum::Outcome;
    use std::io::Cursor;

    /// Samples of every kind, no two rows alike.
    fn samples(count: usize) -> Samples {
        let mut samples = Samples::unflipped(count);
        for index in 0..count {
            match index % 7 {
                0 | 3 => samples.set(index, Outcome::flipped(1.5 + index as f64)),
                4 => samples.set(index, Outcome::without_time(Status::Forbidden)),
                5 => samples.assure(index, Assurance::new(Trust::Uncertain, 0.02)),
                _ => {}
            }
        }
        samples
    }

    /// Returns the file of an image that is written `part` samples at a time.
    fn written(size: [u32; 2], samples: &Samples, part: usize) -> Vec<u8> {
        let out = Cursor::new(Vec::new());
        let mut writer = ExrWriter::new(out, size, &Document::default()).unwrap();
        for first in (0..samples.len()).step_by(part) {
            writer.write(&samples.part(first..samples.len().min(first + part))).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    fn image(bytes: Vec<u8>) -> FlatImage {
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .unwrap()
    }

    fn channel(image: &FlatImage, name: &str) -> Vec<f32> {
        let mut list = image.layer_data[0].channel_data.list.iter();
        let found = list.find(|channel| channel.name.eq(name)).unwrap();
        found.sample_data.values_as_f32().collect()
    }

    /// Returns the same image from the library's own writer, which needs all of it at once.
    fn by_the_library(size: [u32; 2], samples: &Samples, compression: Compression) -> Vec<u8> {
        let values = |value: &dyn Fn(usize) -> f32| (0..samples.len()).map(value).collect();
        let most = (Document::default().question.budget.secs as f32).ln();
        let height = |outcome: Outcome| match outcome.status {
            Status::Answered => (outcome.time.ln() as f32).min(most),
            _ => most,
        };
        let channels: [Vec<f32>; 5] = [
            values(&|index| samples.error_secs(index)),
            values(&|index| height(samples.get(index))),
            values(&|index| f32::from(samples.get(index).status as u8)),
            values(&|index| number_of(samples.get(index).status, samples.get(index).time) as f32),
            values(&|index| f32::from(u8::from(samples.trust(index) == Trust::Uncertain))),
        ];
        let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> =
            ["error", "height", "status", "time", "uncertain"]
                .into_iter()
                .zip(channels)
                .map(|(name, values)| AnyChannel::new(name, FlatSamples::F32(values)))
                .collect();
        let attributes = attributes(size, &Document::default());
        let line_order = LineOrder::Increasing;
        let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order };
        let [width, height] = size.map(|side| side as usize);
        let layer = Layer::new((width, height), attributes, encoding, AnyChannels::sort(channels));
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn the_channels_hold_what_the_samples_do() {
        let image = image(written([3, 2], &samples(6), 6));
        let layer = &image.layer_data[0];
        assert_eq!((layer.size.0, layer.size.1), (3, 2));
        let times = channel(&image, "time");
        assert_eq!((times[0], times[1]), (1.5, f32::INFINITY));
        assert!(times[4].is_nan());
        let heights = channel(&image, "height");
        assert_eq!([heights[0], heights[1]], [1.5f32.ln(), 30f32.ln()]);
        assert!(heights.iter().all(|height| height.is_finite()));
        assert_eq!(channel(&image, "status"), [1.0, 0.0, 0.0, 1.0, 2.0, 0.0]);
        assert_eq!(channel(&image, "uncertain"), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let errors = channel(&image, "error");
        assert!(errors[0].is_nan() && (errors[5] - 0.0316).abs() < 1e-4, "{errors:?}");
        let text = layer.attributes.comments.as_ref().unwrap().to_string();
        assert!(text.contains("[view]"), "{text}");
        let axes = format!("{:?}", layer.attributes.other[&Text::from("axes")]);
        assert!(axes.contains("per_column"), "{axes}");
    }

    #[test]
    fn many_blocks_are_the_library_s_own_bytes_however_the_samples_come() {
        let sizes = [
            ([5, 1], Compression::ZIP16),
            ([9, 16], Compression::ZIP16),
            ([50, 37], Compression::ZIP16),
            ([SHORT_ROW + 1, 3], Compression::ZIP1),
        ];
        for (size, compression) in sizes {
            let samples = samples(size[0] as usize * size[1] as usize);
            let bytes = written(size, &samples, 2 * size[0] as usize);
            assert!(bytes == by_the_library(size, &samples, compression), "{size:?}");
            assert!(bytes == written(size, &samples, 13), "{size:?}");
        }
        let (last, image) = (50 * 37 - 1, image(written([50, 37], &samples(50 * 37), 50)));
        assert_eq!(channel(&image, "time")[last - 1], 1.5 + (last - 1) as f32);
    }

    #[test]
    fn no_more_than_a_block_is_held() {
        let size = [40, 1000];
        let out = Cursor::new(Vec::new());
        let mut writer = ExrWriter::new(out, size, &Document::default()).unwrap();
        for _ in 0..size[1] {
            writer.write(&samples(40)).unwrap();
            assert!(writer.block.capacity() <= 2 * 16 * 40 * 20, "{}", writer.block.capacity());
        }
        writer.finish().unwrap();
    }

    #[test]
    fn an_image_without_all_its_rows_is_none() {
        let out = Cursor::new(Vec::new());
        let mut writer = ExrWriter::new(out, [4, 3], &Document::default()).unwrap();
        writer.write(&samples(8)).unwrap();
        let error = writer.finish().err().unwrap().to_string();
        assert_eq!(error, "only 2 of 3 rows have come");
    }
}
