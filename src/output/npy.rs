//! Answers as a NumPy array: `.npy` version 1, little-endian f64, row 0 at the top, with the shape
//! (height, width) for one channel and (height, width, channels) for several; `+inf` for unflipped
//! and failed, `nan` for forbidden.

use std::io::{self, Write};
use std::ops::Range;

use crate::physics::Status;
use crate::tiles::Samples;

/// Writes rows of samples as they come.
pub struct NpyWriter<W: Write> {
    out: W,
    channels: Range<usize>,
}

impl<W: Write> NpyWriter<W> {
    /// Writes the header of an array of `size` pixels that holds these channels of the question.
    pub fn new(mut out: W, [width, height]: [u32; 2], channels: Range<usize>) -> io::Result<Self> {
        let shape = match channels.len() {
            1 => format!("({height}, {width})"),
            count => format!("({height}, {width}, {count})"),
        };
        let shape = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        // Magic, version and length take 10 bytes; the whole header is padded to a multiple of 64.
        let padded = (10 + shape.len() + 1).next_multiple_of(64) - 10;
        out.write_all(b"\x93NUMPY\x01\x00")?;
        out.write_all(&(padded as u16).to_le_bytes())?;
        writeln!(out, "{shape:<width$}", width = padded - 1)?;
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
    pub fn into_inner(self) -> W {
        self.out
    }
}

/// The number that stands in an array for a channel of a sample with this status: its value, `+inf`
/// for unflipped and failed, NaN for forbidden.
pub fn number_of(status: Status, value: f64) -> f64 {
    match status {
        Status::Flipped => value,
        Status::Unflipped | Status::Failed => f64::INFINITY,
        Status::Forbidden => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Outcome;

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
