//! Answers with their places as NumPy's `.npz`: an array for each channel, the status, the trust, the
//! estimated error in s if flips are timed (NaN where nothing was checked), the coordinates, and the
//! scene.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::ops::Range;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::tiles::{Samples, number_of};
use flipmap_scene::{Document, PixelAxes};

/// Writes the arrays as samples come: each into a temporary file, and all into one at the end.
pub(super) struct NpzWriter<W: Write> {
    out: W,
    document: Document,
    axes: PixelAxes,
    channels: Range<usize>,
    arrays: Vec<Array>,
}

/// An array that grows.
struct Array {
    name: String,
    kind: &'static str,
    file: BufWriter<File>,
}

/// Kinds of numbers in NumPy's words.
const F64: &str = "<f8";
const F32: &str = "<f4";
const BYTE: &str = "|u1";

impl<W: Write> NpzWriter<W> {
    /// Begins a file with these channels of the document's question.
    pub(super) fn new(
        out: W,
        size: [u32; 2],
        document: &Document,
        channels: Range<usize>,
    ) -> io::Result<Self> {
        let array = |name: &str, kind| {
            let file = BufWriter::new(tempfile::tempfile()?);
            Ok(Array { name: name.to_string(), kind, file })
        };
        let known = &document.question.ask.kind().channels[channels.clone()];
        let values = known.iter().map(|channel| array(channel.name, F64));
        let codes = ["status", "trust"].into_iter().map(|name| array(name, BYTE));
        let error = document.question.ask.times_flips().then(|| array("error", F32));
        Ok(NpzWriter {
            out,
            axes: PixelAxes::new(&document.scene(), size),
            document: document.clone(),
            channels,
            arrays: values.chain(codes).chain(error).collect::<io::Result<_>>()?,
        })
    }

    /// Writes the next samples.
    pub(super) fn write(&mut self, samples: &Samples) -> io::Result<()> {
        let count = self.channels.len();
        for index in 0..samples.len() {
            let status = samples.get(index).status;
            let values = &samples.values(index)[self.channels.clone()];
            for (array, value) in self.arrays.iter_mut().zip(values) {
                array.file.write_all(&number_of(status, *value).to_le_bytes())?;
            }
            self.arrays[count].file.write_all(&[status as u8])?;
            self.arrays[count + 1].file.write_all(&[samples.trust(index) as u8])?;
            if let Some(error) = self.arrays.get_mut(count + 2) {
                error.file.write_all(&samples.error_secs(index).to_le_bytes())?;
            }
        }
        Ok(())
    }

    /// Completes the file and returns it.
    pub(super) fn finish(self) -> io::Result<W> {
        let [width, height] = self.axes.size;
        let mut zip = ZipWriter::new_stream(self.out);
        for array in self.arrays {
            let mut file = array.file.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.seek(SeekFrom::Start(0))?;
            begin(&mut zip, &array.name, array.kind, &format!("({height}, {width})"))?;
            io::copy(&mut file, &mut zip)?;
        }
        let names = self.axes.names_beside(&self.document.scene());
        for (axis, name) in names.iter().enumerate() {
            let (shape, places) = places(&self.axes, axis);
            let coordinate = |[column, row]: [u32; 2]| self.axes.coordinates(column, row)[axis];
            let offset = |[column, row]: [u32; 2]| self.axes.offset(column, row)[axis];
            numbers(&mut zip, name, &shape, places.clone().map(coordinate))?;
            numbers(&mut zip, &format!("{name}_from_center"), &shape, places.map(offset))?;
        }
        texts(&mut zip, "center", "(2,)", &self.axes.center)?;
        texts(&mut zip, "scene", "()", &[self.document.text()])?;
        zip.finish().map(zip::write::StreamWriter::into_inner).map_err(io::Error::from)
    }
}

/// Returns the shape of an axis, and the pixels that its values are taken from: those of the first
/// row or column, or all of them if the picture is rotated.
fn places(axes: &PixelAxes, axis: usize) -> (String, impl Iterator<Item = [u32; 2]> + Clone) {
    let [width, height] = axes.size;
    let (shape, columns, rows) = match (axes.is_upright(), axis) {
        (true, 0) => (format!("({width},)"), width, 1),
        (true, _) => (format!("({height},)"), 1, height),
        (false, _) => (format!("({height}, {width})"), width, height),
    };
    (shape, (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row])))
}

/// Begins an array.
fn begin(
    zip: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    kind: &str,
    shape: &str,
) -> io::Result<()> {
    // Without compression, NumPy can map the file; large files are those over 4 GiB.
    let options =
        SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
    zip.start_file(format!("{name}.npy"), options)?;
    zip.write_all(&super::npy::header(kind, shape))
}

fn numbers(
    zip: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    shape: &str,
    values: impl Iterator<Item = f64>,
) -> io::Result<()> {
    begin(zip, name, F64, shape)?;
    let mut out = BufWriter::new(zip);
    for value in values {
        out.write_all(&value.to_le_bytes())?;
    }
    out.flush()
}

/// Writes texts as an array of NumPy's strings: UCS-4, padded with zeros.
fn texts(
    zip: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    shape: &str,
    texts: &[String],
) -> io::Result<()> {
    let length = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    begin(zip, name, &format!("<U{length}"), shape)?;
    for text in texts {
        let letters = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(length);
        let bytes: Vec<u8> = letters.flat_map(u32::to_le_bytes).collect();
        zip.write_all(&bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::{Assurance, Trust};
    use flipmap_pendulum::{Outcome, Status};
    use std::collections::BTreeMap;
    use std::io::Read;

    #[test]
    fn coordinates_are_told_from_channels_of_the_same_name() {
        let mut document = Document::default();
        document.question.ask = flipmap_scene::question::QuestionName::State;
        let channels = document.question.ask.kind().channels.len();
        let npz = NpzWriter::new(Vec::new(), [1, 1], &document, 0..channels).unwrap();
        let zip = zip::ZipArchive::new(io::Cursor::new(npz.finish().unwrap())).unwrap();
        for name in ["theta1.npy", "theta1_at_start.npy", "theta2_at_start_from_center.npy"] {
            assert!(zip.file_names().any(|found| found == name), "{name}");
        }
    }

    #[test]
    fn arrays_say_what_and_where() {
        let mut document = Document::default();
        document.view.width = "2".into();
        let mut samples = Samples::unflipped(6);
        samples.set(0, Outcome::flipped(1.5));
        samples.assure(0, Assurance::new(Trust::Agreed, 2e-9));
        samples.set(5, Outcome::without_time(Status::Forbidden));
        let mut npz = NpzWriter::new(Vec::new(), [2, 3], &document, 0..1).unwrap();
        npz.write(&samples).unwrap();
        let bytes = npz.finish().unwrap();
        let mut zip = zip::ZipArchive::new(io::Cursor::new(bytes)).unwrap();
        let mut found = BTreeMap::new();
        for k in 0..zip.len() {
            let mut file = zip.by_index(k).unwrap();
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).unwrap();
            let begun = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
            let header = String::from_utf8(bytes[10..begun].to_vec()).unwrap();
            found.insert(file.name().to_string(), (header, bytes[begun..].to_vec()));
        }
        let names: Vec<&str> = found.keys().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "center.npy",
                "error.npy",
                "scene.npy",
                "status.npy",
                "theta1.npy",
                "theta1_from_center.npy",
                "theta2.npy",
                "theta2_from_center.npy",
                "time.npy",
                "trust.npy"
            ]
        );
        let numbers = |name: &str| -> Vec<f64> {
            found[name].1.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
        };
        assert!(found["time.npy"].0.contains("'shape': (3, 2)"));
        assert!(numbers("time.npy")[0] == 1.5 && numbers("time.npy")[5].is_nan());
        let errors = found["error.npy"].1.as_chunks().0;
        let errors: Vec<f32> = errors.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert!((errors[0] - 3.162e-9).abs() < 1e-11 && errors[1].is_nan(), "{errors:?}");
        assert_eq!(found["status.npy"].1, [1, 0, 0, 0, 0, 2]);
        assert_eq!(numbers("theta1.npy"), [-0.5, 0.5]);
        assert_eq!(numbers("theta2_from_center.npy"), [1.0, 0.0, -1.0]);
        let scene: String = found["scene.npy"]
            .1
            .as_chunks()
            .0
            .iter()
            .filter_map(|letter| char::from_u32(u32::from_le_bytes(*letter)))
            .collect();
        assert_eq!(Document::parse(&scene).unwrap(), document);
    }
}
