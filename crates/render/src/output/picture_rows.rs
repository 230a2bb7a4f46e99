//! The rows of a PNG of any kind as red, green, blue and alpha in sixteen bits.

use std::io::{self, BufRead, Seek};

use png::{BitDepth, Transformations};

/// A picture that is read row by row, from the top.
pub(super) struct PictureRows<R: BufRead + Seek> {
    reader: png::Reader<R>,
    /// All bytes of an interlaced picture, which has no rows in order, and the place of the next row.
    whole: Option<(Vec<u8>, usize)>,
}

/// Largest size in bytes of an interlaced picture, which is held as a whole.
const MAX_WHOLE_BYTES: usize = 2 << 30;

impl<R: BufRead + Seek> PictureRows<R> {
    /// Reads the header of a picture; the error is the end of a sentence that begins with its path.
    pub(super) fn open(file: R) -> Result<Self, String> {
        let foreign = |error: png::DecodingError| format!("is not a PNG: {error}");
        let mut decoder = png::Decoder::new(file);
        decoder.set_transformations(Transformations::EXPAND | Transformations::ALPHA);
        let mut reader = decoder.read_info().map_err(foreign)?;
        let whole = if reader.info().interlaced {
            let bytes = reader.output_buffer_size().filter(|bytes| *bytes <= MAX_WHOLE_BYTES);
            let bytes = bytes.ok_or("is interlaced and too large to be held in memory")?;
            let mut pixels = vec![0; bytes];
            reader.next_frame(&mut pixels).map_err(foreign)?;
            Some((pixels, 0))
        } else {
            None
        };
        Ok(PictureRows { reader, whole })
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        let info = self.reader.info();
        [info.width, info.height]
    }

    /// Returns the next row, four channels for each pixel.
    pub(super) fn next(&mut self) -> io::Result<Vec<u16>> {
        let (color, depth) = self.reader.output_color_type();
        let deep = |bytes: &[u8]| -> Vec<u16> {
            match depth {
                BitDepth::Sixteen => {
                    bytes.as_chunks().0.iter().map(|pair| u16::from_be_bytes(*pair)).collect()
                }
                _ => bytes.iter().map(|byte| u16::from(*byte) * 257).collect(),
            }
        };
        let channels = match &mut self.whole {
            Some((pixels, begun)) => {
                let row_bytes = pixels.len() / self.reader.info().height as usize;
                let row = pixels.get(*begun..*begun + row_bytes);
                *begun += row_bytes;
                deep(row.ok_or(io::ErrorKind::UnexpectedEof)?)
            }
            None => match self.reader.next_row().map_err(io::Error::other)? {
                Some(row) => deep(row.data()),
                None => return Err(io::ErrorKind::UnexpectedEof.into()),
            },
        };
        if color == png::ColorType::Rgba {
            return Ok(channels);
        }
        // Grey with alpha.
        let pixels = channels.as_chunks::<2>().0.iter();
        Ok(pixels.flat_map(|[grey, alpha]| [*grey, *grey, *grey, *alpha]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use png::ColorType;
    use std::io::Cursor;

    fn rows(color: ColorType, depth: BitDepth, bytes: &[u8]) -> Vec<Vec<u16>> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.set_palette(vec![10, 20, 30, 255, 0, 1]);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        let mut rows = PictureRows::open(Cursor::new(file)).unwrap();
        assert_eq!(rows.size(), [2, 1]);
        let read = vec![rows.next().unwrap()];
        assert!(rows.next().is_err(), "there is one row");
        read
    }

    #[test]
    fn every_kind_of_picture_has_the_same_channels() {
        let full = u16::MAX;
        let of = |levels: [u16; 6]| {
            let [a, b, c, d, e, f] = levels.map(|level| level * 257);
            vec![vec![a, b, c, full, d, e, f, full]]
        };
        let eight = BitDepth::Eight;
        assert_eq!(rows(ColorType::Rgb, eight, &[1, 2, 3, 4, 5, 6]), of([1, 2, 3, 4, 5, 6]));
        assert_eq!(rows(ColorType::Indexed, eight, &[0, 1]), of([10, 20, 30, 255, 0, 1]));
        assert_eq!(
            rows(ColorType::Indexed, BitDepth::One, &[0b0100_0000]),
            of([10, 20, 30, 255, 0, 1])
        );
        assert_eq!(rows(ColorType::Grayscale, eight, &[7, 9]), of([7, 7, 7, 9, 9, 9]));
        let alpha = rows(ColorType::GrayscaleAlpha, eight, &[7, 128, 9, 255]);
        assert_eq!(alpha[0][3], 128 * 257);
        let deep = rows(ColorType::Rgb, BitDepth::Sixteen, &[0, 1, 0, 2, 0, 3, 1, 0, 0, 0, 0, 0]);
        assert_eq!(deep[0], [1, 2, 3, full, 256, 0, 0, full]);
    }
}
