//! Answers as a NumPy array: `.npy` version 1, little-endian f64, row 0 at the top, with the shape
//! (height, width) for one channel and (height, width, channels) for several; `+inf` for unflipped
//! and failed, `nan` for forbidden.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::ops::Range;

use crate::tiles::{Samples, number_of};
use flipmap_scene::PictureTable;

/// Writes rows of samples as they come.
pub struct NpyWriter<W: Write> {
    out: W,
    channels: Range<usize>,
}

impl<W: Write> NpyWriter<W> {
    /// Writes the header of an array that holds these channels of the question for each pixel.
    pub fn new(mut out: W, [width, height]: [u32; 2], channels: Range<usize>) -> io::Result<Self> {
        let shape = match channels.len() {
            1 => format!("({height}, {width})"),
            count => format!("({height}, {width}, {count})"),
        };
        out.write_all(&header("<f8", &shape))?;
        Ok(NpyWriter { out, channels })
    }

    /// Writes the next samples.
    pub fn write(&mut self, samples: &Samples) -> io::Result<()> {
        for index in 0..samples.len() {
            let status = samples.get(index).status;
            for &value in &samples.values(index)[self.channels.clone()] {
                self.out.write_all(&number_of(status, value).to_le_bytes())?;
            }
        }
        Ok(())
    }

    /// Returns the complete file.
    pub(crate) fn into_inner(self) -> W {
        self.out
    }
}

/// Returns the header of an array of a kind and shape in NumPy's words.
pub(super) fn header(kind: &str, shape: &str) -> Vec<u8> {
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic, version and length take 10 bytes; the whole header is padded to a multiple of 64.
    let padded = (10 + text.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((padded as u16).to_le_bytes());
    bytes.extend(format!("{text:<width$}\n", width = padded - 1).bytes());
    bytes
}

/// Largest number of channels of an array.
const MAX_CHANNELS: u32 = 64;

/// The numbers of an array: f64 or f32, in either order of their bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NpyNumbers {
    /// Number of bytes of each: 8 or 4.
    pub bytes: usize,
    /// True if the highest byte comes first.
    is_big_endian: bool,
}

impl NpyNumbers {
    fn of(descr: &str) -> Option<Self> {
        let (is_big_endian, bytes) = match descr.trim_matches(['\'', '"']) {
            "<f8" => (false, 8),
            ">f8" => (true, 8),
            "<f4" => (false, 4),
            ">f4" => (true, 4),
            _ => return None,
        };
        let quoted = descr.len() == 5 && descr.starts_with(['\'', '"']);
        quoted.then_some(NpyNumbers { bytes, is_big_endian })
    }

    /// Returns the numbers in some bytes.
    pub(super) fn read(self, bytes: &[u8]) -> Vec<f64> {
        let number = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            if self.is_big_endian {
                bytes.reverse();
            }
            match bytes[..] {
                [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
                [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
                _ => f64::NAN,
            }
        };
        bytes.chunks_exact(self.bytes).map(number).collect()
    }
}

/// Largest size of a header that is read.
const MAX_HEADER_BYTES: u64 = 1 << 20;

/// Reads width, height, number of channels and kind of numbers of an array from its header; the
/// error is a phrase. Only the keys and values that NumPy writes for such arrays are accepted: others
/// change what the numbers mean.
pub(super) fn npy_shape(
    file: &mut impl Read,
) -> Result<([u32; 2], usize, NpyNumbers), &'static str> {
    let cut = |_| "it ends within its header";
    let mut head = [0; 8];
    file.read_exact(&mut head).map_err(cut)?;
    // Versions 2 and 3, which NumPy writes for long headers, have a longer length.
    let mut length = [0; 4];
    let size = match head.strip_prefix(b"\x93NUMPY") {
        Some([1, 0]) => 2,
        Some([2 | 3, 0]) => 4,
        _ => return Err("it does not begin as .npy files of versions 1 to 3 do"),
    };
    file.read_exact(&mut length[..size]).map_err(cut)?;
    let mut text = Vec::new();
    let length = u64::from(u32::from_le_bytes(length)).min(MAX_HEADER_BYTES);
    match file.take(length).read_to_end(&mut text) {
        Ok(read) if read as u64 == length => {}
        _ => return Err("it ends within its header"),
    }
    let text = String::from_utf8(text).map_err(|_| "its header is no text")?;
    let header = dictionary(&text).ok_or("its header is no dictionary")?;
    let known = ["descr", "fortran_order", "shape"];
    if !header.keys().copied().eq(known) {
        return Err("its header has other keys than 'descr', 'fortran_order' and 'shape'");
    }
    let [descr, order, shape] = known.map(|key| header[key]);
    let numbers = NpyNumbers::of(descr).ok_or("its numbers are not f64 or f32 ('<f8' or '<f4')")?;
    if order != "False" {
        return Err("its columns follow one another instead of its rows ('fortran_order'): save \
             numpy.ascontiguousarray of it");
    }
    match axes(shape).as_deref() {
        Some([height, width]) => Ok(([*width, *height], 1, numbers)),
        Some([height, width, channels @ 1..=MAX_CHANNELS]) => {
            Ok(([*width, *height], *channels as usize, numbers))
        }
        _ => Err("its shape is not that of a picture of up to a million pixels along each side"),
    }
}

/// Reads the axes of a shape such as `(5, 7)`; `None` if the first two are not those of a picture.
fn axes(shape: &str) -> Option<Vec<u32>> {
    let inside = shape.strip_prefix('(')?.strip_suffix(')')?.trim();
    let inside = inside.strip_suffix(',').unwrap_or(inside);
    let axes: Option<Vec<u32>> = inside.split(',').map(|axis| axis.trim().parse().ok()).collect();
    let fits = |side: &u32| (1..=PictureTable::MAX_SIDE).contains(side);
    axes.filter(|axes| axes.iter().take(2).all(fits))
}

/// Reads the keys of a Python dictionary and the texts of their values; `None` if a key occurs
/// twice.
fn dictionary(text: &str) -> Option<BTreeMap<&str, &str>> {
    let mut rest = text.trim().strip_prefix('{')?.trim_start();
    let mut found = BTreeMap::new();
    while !rest.starts_with('}') {
        let (key, after) = split_value(rest)?;
        let (value, after) = split_value(after.trim_start().strip_prefix(':')?.trim_start())?;
        let key = key.strip_prefix(['\'', '"'])?.strip_suffix(['\'', '"'])?;
        if found.insert(key, value).is_some() {
            return None;
        }
        rest = after.trim_start();
        match rest.strip_prefix(',') {
            Some(after) => rest = after.trim_start(),
            None if rest.starts_with('}') => {}
            None => return None,
        }
    }
    (rest == "}").then_some(found)
}

/// Splits off the value at the beginning of a text: a string, a tuple or a word.
fn split_value(text: &str) -> Option<(&str, &str)> {
    let length = match text.chars().next()? {
        quote @ ('\'' | '"') => text[1..].find(quote)? + 2,
        '(' => text.find(')')? + 1,
        _ => text.find(|c: char| !c.is_ascii_alphanumeric())?,
    };
    (length > 0).then(|| text.split_at(length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::{Outcome, Status};

    #[test]
    fn the_header_is_that_of_numpy() {
        let bytes = NpyWriter::new(Vec::new(), [7, 5], 0..1).unwrap().into_inner();
        assert_eq!(bytes.len() % 64, 0);
        assert_eq!(&bytes[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let text = std::str::from_utf8(&bytes[10..]).unwrap();
        assert!(text.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (5, 7), }"));
        assert!(text.ends_with(" \n"));
    }

    #[test]
    fn headers_that_mean_something_else_are_refused() {
        let read = |text: &str| {
            let length = (text.len() as u16).to_le_bytes();
            let bytes = [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes()].concat();
            npy_shape(&mut &bytes[..])
        };
        let plain = |descr: &str, shape: &str| {
            read(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}  \n"))
        };
        let f64s = NpyNumbers { bytes: 8, is_big_endian: false };
        assert_eq!(plain("'<f8'", "(5, 7)"), Ok(([7, 5], 1, f64s)));
        assert_eq!(plain("\"<f8\"", "(5, 7, 2,)"), Ok(([7, 5], 2, f64s)));
        for (descr, bytes) in
            [("'<f4'", [0, 0, 192, 63].to_vec()), ("'>f8'", [63, 248, 0, 0, 0, 0, 0, 0].to_vec())]
        {
            let (_, _, numbers) = plain(descr, "(5, 7)").unwrap();
            assert_eq!(numbers.read(&bytes), [1.5], "{descr}");
        }
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 7)}";
        for version in [2, 3] {
            let length = (text.len() as u32).to_le_bytes();
            let bytes = [b"\x93NUMPY", &[version, 0][..], &length, text.as_bytes()].concat();
            assert_eq!(npy_shape(&mut &bytes[..]), Ok(([7, 5], 1, f64s)), "version {version}");
        }
        let spaced = "{ \"shape\":(1,1) ,'descr':'<f8','fortran_order':False}";
        assert_eq!(read(spaced), Ok(([1, 1], 1, f64s)));
        let structured = "[(\"'descr': '<f8'\", '<i8')]";
        for descr in ["'<f2'", "'|f8'", "'<i8'", structured, "'<f8", "<f8", "('<f8', (2,))"] {
            assert!(plain(descr, "(5, 7)").is_err(), "{descr}");
        }
        let many = "(2147483648, 2147483648, 4)";
        for shape in [
            many,
            "(5,)",
            "(0, 7)",
            "(5, 7, 65)",
            "(1, 1000001)",
            "(5, 7, 1, 1)",
            "(-5, 7)",
            "5, 7",
        ] {
            assert!(plain("'<f8'", shape).is_err(), "{shape}");
        }
        for other in ["", "{", "{}", "{'descr': '<f8'}", "{'descr' '<f8'}", "{é", "{'a': é}"] {
            assert!(read(other).is_err(), "{other}");
        }
        let twice = "{'descr': '<i8', 'descr': '<f8', 'fortran_order': False, 'shape': (5, 7)}";
        let more = "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 7), 'offset': 8}";
        let other = "{'descr': '<f8', 'fortran_order': True, 'shape': (5, 7)}";
        for text in [twice, more, other] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn statuses_become_the_documented_numbers() {
        let mut samples = Samples::unflipped(4);
        samples.set(0, Outcome::flipped(1.5));
        samples.set(2, Outcome::without_time(Status::Forbidden));
        samples.set(3, Outcome::without_time(Status::Failed));
        let mut writer = NpyWriter { out: Vec::new(), channels: 0..1 };
        writer.write(&samples).unwrap();
        let numbers: Vec<f64> =
            writer.out.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        assert_eq!(numbers[0], 1.5);
        assert!(numbers[1] == f64::INFINITY && numbers[2].is_nan() && numbers[3] == f64::INFINITY);
    }
}
