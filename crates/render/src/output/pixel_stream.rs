//! Compresses the pixels of a PNG into one zlib stream, in separate blocks.
//!
//! A deflate stream (RFC 1951) that is flushed ends at a whole byte, and an encoder can be given
//! the bytes that precede its own. So blocks of rows are compressed on all cores, as M. Adler's
//! *pigz* does, and joined in order between the header and the checksum of zlib (RFC 1950).

use flate2::{Compress, Compression, FlushCompress};
use rayon::prelude::*;
use simd_adler32::Adler32;

/// Level of compression. Maps consist of flat areas of few colours, which filters break up: without
/// filters, this level takes a third of the time of the usual level with filters, for files of
/// about the same size.
const LEVEL: u32 = 3;
/// Smallest size of a block in bytes.
const BLOCK_BYTES: usize = 1 << 18;
/// Number of bytes before a block that it may refer to.
const WINDOW_BYTES: usize = 1 << 15;
/// The header of a zlib stream: deflate with a window of 32 KiB, fastest compression.
const HEAD: [u8; 2] = [0x78, 0x01];
/// An empty block that is marked as the last.
const LAST: [u8; 2] = [0x03, 0x00];
/// The filter type before each row, 0 for unfiltered.
const UNFILTERED: u8 = 0;

/// The pixels of a picture, compressed as they come.
pub(super) struct PixelStream {
    /// Size of a row in bytes, without its filter.
    row_bytes: usize,
    /// Size of a block in bytes: whole rows with their filters.
    block_bytes: usize,
    /// Rows with their filters: the last bytes that were compressed, then those that do not fill a
    /// block yet.
    rows: Vec<u8>,
    /// Number of bytes at the front of `rows` that are already compressed.
    packed: usize,
    sum: Adler32,
}

impl PixelStream {
    /// Begins the stream of a picture with rows of `row_bytes` bytes, and also returns its header.
    pub(super) fn begin(row_bytes: usize) -> (Self, [u8; 2]) {
        let block_bytes = BLOCK_BYTES.next_multiple_of(row_bytes + 1);
        let (rows, sum) = (Vec::new(), Adler32::new());
        (PixelStream { row_bytes, block_bytes, rows, packed: 0, sum }, HEAD)
    }

    /// Takes the next whole rows and returns the compressed blocks that they complete.
    pub(super) fn pack(&mut self, rows: &[u8]) -> Vec<Vec<u8>> {
        assert!(rows.len().is_multiple_of(self.row_bytes), "rows come whole");
        for row in rows.chunks(self.row_bytes) {
            self.rows.push(UNFILTERED);
            self.rows.extend_from_slice(row);
        }
        let blocks = (self.rows.len() - self.packed) / self.block_bytes;
        let end = self.packed + blocks * self.block_bytes;
        self.sum.write(&self.rows[self.packed..end]);
        let block = |packer: &mut Compress, k: usize| {
            let first = self.packed + k * self.block_bytes;
            packed(packer, &self.rows[..first + self.block_bytes], first)
        };
        let blocks = (0..blocks).into_par_iter().map_init(packer, block).collect();
        self.rows.drain(..end.saturating_sub(WINDOW_BYTES));
        self.packed = end.min(WINDOW_BYTES);
        blocks
    }

    /// Returns the last block, compressed, and the end of the stream.
    pub(super) fn end(mut self) -> Vec<u8> {
        self.sum.write(&self.rows[self.packed..]);
        let last = packed(&mut packer(), &self.rows, self.packed);
        [last, LAST.to_vec(), self.sum.finish().to_be_bytes().to_vec()].concat()
    }
}

/// Creates an encoder of blocks.
fn packer() -> Compress {
    Compress::new(Compression::new(LEVEL), false)
}

/// Deflates the bytes from `first` on, with those before as dictionary; ends on a whole byte.
fn packed(packer: &mut Compress, bytes: &[u8], first: usize) -> Vec<u8> {
    packer.reset();
    let (before, block) = bytes.split_at(first);
    if !before.is_empty() {
        let window = &before[before.len().saturating_sub(WINDOW_BYTES)..];
        packer.set_dictionary(window).expect("an encoder at its beginning");
    }
    let mut packed_bytes = Vec::with_capacity(block.len() / 4 + 64);
    loop {
        let rest = &block[packer.total_in() as usize..];
        packer
            .compress_vec(rest, &mut packed_bytes, FlushCompress::Sync)
            .expect("an encoder at its beginning");
        // Room left in the buffer means that everything has been flushed.
        if packed_bytes.len() < packed_bytes.capacity() {
            return packed_bytes;
        }
        packed_bytes.reserve(packed_bytes.len());
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    /// Returns the rows that a stream holds.
    fn unpacked(stream: &[u8]) -> Vec<u8> {
        let mut rows = Vec::new();
        flate2::read::ZlibDecoder::new(stream).read_to_end(&mut rows).unwrap();
        rows
    }

    #[test]
    fn rows_come_back_and_their_pieces_change_no_byte() {
        let row_bytes = 3 * 1000;
        // A smooth part, and one that cannot be compressed.
        let value =
            |k: u32| if k < 600_000 { k / 7000 } else { k.wrapping_mul(2_654_435_761) >> 13 };
        let rows: Vec<u8> = (0..450 * row_bytes as u32).map(|k| value(k) as u8).collect();
        let stream = |rows_at_once: usize| {
            let (mut pixels, head) = PixelStream::begin(row_bytes);
            let mut bytes = head.to_vec();
            for piece in rows.chunks(rows_at_once * row_bytes) {
                bytes.extend(pixels.pack(piece).concat());
            }
            bytes.extend(pixels.end());
            bytes
        };
        let whole = stream(450);
        assert!(whole.len() < rows.len() * 3 / 4, "{} of {}", whole.len(), rows.len());
        for rows_at_once in [1, 7, 200] {
            assert!(stream(rows_at_once) == whole, "{rows_at_once} rows at once");
        }
        let filtered: Vec<u8> =
            rows.chunks(row_bytes).flat_map(|row| [&[UNFILTERED], row].concat()).collect();
        assert!(unpacked(&whole) == filtered);
    }

    #[test]
    fn a_picture_without_rows_is_a_whole_stream() {
        let (pixels, head) = PixelStream::begin(3);
        assert!(unpacked(&[&head[..], &pixels.end()].concat()).is_empty());
    }
}
