//! Checks a PNG file to its end: a decoder stops at the last row, whatever follows.

use std::io::{self, Read};

use flate2::{Decompress, FlushDecompress, Status};

/// Number of bytes that are read at once.
const BLOCK: usize = 1 << 16;

/// Returns an error unless a PNG has all its chunks with correct checksums and its pixels are
/// complete.
pub(super) fn check_whole_png(file: impl Read) -> io::Result<()> {
    read_to_end(file).map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => io::Error::other("it is damaged: it ends early"),
        _ => io::Error::other(format!("it is damaged: {error}")),
    })
}

fn read_to_end(mut file: impl Read) -> io::Result<()> {
    let mut block = vec![0; BLOCK];
    let mut pixels = PackedPixels::new();
    // The signature.
    file.read_exact(&mut [0; 8])?;
    loop {
        let length = u32::from_be_bytes(four_bytes(&mut file)?) as usize;
        let name = four_bytes(&mut file)?;
        let mut sum = crc32fast::Hasher::new();
        sum.update(&name);
        for from in (0..length).step_by(BLOCK) {
            let part = &mut block[..BLOCK.min(length - from)];
            file.read_exact(part)?;
            sum.update(part);
            if &name == b"IDAT" {
                pixels.unpack(part)?;
            }
        }
        if u32::from_be_bytes(four_bytes(&mut file)?) != sum.finalize() {
            let name = String::from_utf8_lossy(&name);
            return Err(io::Error::other(format!("the checksum of a chunk {name} is wrong")));
        }
        if &name == b"IEND" {
            return pixels.check_end();
        }
    }
}

fn four_bytes(file: &mut impl Read) -> io::Result<[u8; 4]> {
    let mut bytes = [0; 4];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// The compressed pixels of a picture, which end with a checksum of their own.
struct PackedPixels {
    inflate: Decompress,
    unpacked: Vec<u8>,
    has_end: bool,
}

impl PackedPixels {
    fn new() -> Self {
        let unpacked = vec![0; BLOCK];
        PackedPixels { inflate: Decompress::new(true), unpacked, has_end: false }
    }

    /// Unpacks the next bytes and discards the result.
    fn unpack(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !self.has_end {
            let [read, made] = [self.inflate.total_in(), self.inflate.total_out()];
            let status =
                self.inflate.decompress(bytes, &mut self.unpacked, FlushDecompress::None)?;
            let read = (self.inflate.total_in() - read) as usize;
            bytes = &bytes[read..];
            self.has_end = status == Status::StreamEnd;
            if read == 0 && self.inflate.total_out() == made {
                break;
            }
        }
        Ok(())
    }

    fn check_end(&self) -> io::Result<()> {
        if self.has_end {
            Ok(())
        } else {
            Err(io::Error::other("the end of its pixels is missing"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::PngWriter;
    use flipmap_scene::Document;

    #[test]
    fn every_byte_of_a_picture_is_looked_at() {
        let mut writer = PngWriter::new(Vec::new(), [300, 200], &Document::default()).unwrap();
        let rgb: Vec<u8> = (0..180_000u32).map(|k| (k.wrapping_mul(k) >> 7) as u8).collect();
        writer.write(&rgb).unwrap();
        let whole = writer.finish().unwrap();
        check_whole_png(&whole[..]).unwrap();
        for byte in (8..whole.len()).step_by(997).chain(whole.len() - 20..whole.len()) {
            let mut altered = whole.clone();
            altered[byte] ^= 1;
            assert!(check_whole_png(&altered[..]).is_err(), "byte {byte}");
            assert!(check_whole_png(&whole[..byte]).is_err(), "to byte {byte}");
        }
    }
}
