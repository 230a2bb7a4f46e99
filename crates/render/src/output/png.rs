//! Writes PNG files row by row with the scene inside, and reads the scene back.

use std::io::{self, BufRead, Seek, Write};

use super::pixel_stream::PixelStream;
use flipmap_scene::{Document, DocumentError};

/// The keyword of the text chunk.
const KEYWORD: &str = "flipmap";

/// Size in bytes of the chunk that ends a file.
const END_BYTES: usize = 12;

/// Reasons why a PNG could not be written, or has no scene.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// Reading or writing failed.
    #[error("{0}")]
    File(#[from] io::Error),
    /// A file that is not a PNG, or was cut short.
    #[error("is not a complete PNG ({0})")]
    Broken(#[from] png::DecodingError),
    /// A PNG by some other program, or one that has lost its scene.
    #[error(
        "is a PNG without a scene: flipmap did not write it, or its '{KEYWORD}' text was damaged or \
         left out when it was saved again"
    )]
    Foreign,
    /// A picture of a later version.
    #[error("was written by a newer flipmap: {0}")]
    Newer(DocumentError),
    /// A picture with a longer side than the reader accepts.
    #[error("is {side} pixels long; at most {longest_side} are read here")]
    Large {
        /// The side that is too long, in pixels.
        side: u32,
        /// The longest side that is read, in pixels.
        longest_side: u32,
    },
    /// A text chunk of flipmap's that holds no scene.
    #[error("has a '{KEYWORD}' text that is damaged, or of a newer flipmap: {0}")]
    Text(DocumentError),
}

/// Writes RGB rows of eight or sixteen bits a channel as they come. Blocks of rows are compressed
/// on all cores; a file depends neither on their number nor on how many rows come at a time.
pub struct PngWriter<W: Write> {
    out: W,
    pixels: PixelStream,
    /// Number of bytes of rows that have not come yet.
    missing: usize,
    /// The chunk after the pixels.
    end: Vec<u8>,
}

impl<W: Write> PngWriter<W> {
    /// Begins a `size` picture that carries `document`.
    pub fn new(out: W, size: [u32; 2], document: &Document) -> Result<Self, PngError> {
        Self::begin(out, size, Some(document.text()), png::BitDepth::Eight)
    }

    /// Begins a `size` picture of sixteen bits a channel that carries `document`.
    pub(crate) fn deep(out: W, size: [u32; 2], document: &Document) -> Result<Self, PngError> {
        Self::begin(out, size, Some(document.text()), png::BitDepth::Sixteen)
    }

    /// Begins a `size` picture that carries no scene.
    pub(crate) fn without_scene(out: W, size: [u32; 2]) -> Result<Self, PngError> {
        Self::begin(out, size, None, png::BitDepth::Eight)
    }

    fn begin(
        mut out: W,
        [width, height]: [u32; 2],
        text: Option<String>,
        depth: png::BitDepth,
    ) -> Result<Self, PngError> {
        let mut head = Vec::new();
        let mut encoder = png::Encoder::new(&mut head, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(depth);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let texted = text.map_or(Ok(()), |text| encoder.add_itxt_chunk(KEYWORD.to_string(), text));
        // Dropping the encoder writes the chunk that ends the file.
        texted.and_then(|()| encoder.write_header().map(drop)).map_err(io::Error::from)?;
        let end = head.split_off(head.len() - END_BYTES);
        out.write_all(&head)?;
        let pixel_bytes = if depth == png::BitDepth::Eight { 3 } else { 6 };
        let row_bytes = width as usize * pixel_bytes;
        let (pixels, first) = PixelStream::begin(row_bytes);
        write_pixels(&mut out, &first)?;
        Ok(PngWriter { out, pixels, missing: row_bytes * height as usize, end })
    }

    /// Writes the next rows, three bytes per pixel, or six with each channel's high byte first.
    pub fn write(&mut self, rgb: &[u8]) -> Result<(), PngError> {
        let missing = self.missing.checked_sub(rgb.len());
        self.missing = missing.ok_or_else(|| io::Error::other("the picture has fewer rows"))?;
        for block in self.pixels.pack(rgb) {
            write_pixels(&mut self.out, &block)?;
        }
        Ok(())
    }

    /// Completes the picture and returns the file.
    pub fn finish(mut self) -> Result<W, PngError> {
        if self.missing > 0 {
            return Err(io::Error::other("rows of the picture are missing").into());
        }
        write_pixels(&mut self.out, &self.pixels.end())?;
        self.out.write_all(&self.end)?;
        Ok(self.out)
    }
}

/// Writes a chunk of compressed pixels.
fn write_pixels(out: &mut impl Write, packed: &[u8]) -> io::Result<()> {
    let name = b"IDAT";
    let mut sum = crc32fast::Hasher::new();
    sum.update(name);
    sum.update(packed);
    out.write_all(&(packed.len() as u32).to_be_bytes())?;
    out.write_all(name)?;
    out.write_all(packed)?;
    out.write_all(&sum.finalize().to_be_bytes())
}

/// A picture that flipmap wrote, in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The scene that it carries.
    pub document: Document,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The pixels, three bytes each, rows from the top.
    pub rgb: Vec<u8>,
}

/// Reads the document inside a PNG that flipmap wrote. The whole file is read, so a truncated one
/// is refused.
pub fn document_in_png(file: impl BufRead + Seek) -> Result<Document, PngError> {
    let mut reader = png::Decoder::new(file).read_info()?;
    while reader.next_row()?.is_some() {}
    reader.finish()?;
    document_of(reader.info())
}

/// Returns true if a file begins as a PNG that carries a scene of flipmap's; its pixels are not
/// read.
pub(crate) fn carries_scene(file: impl BufRead + Seek) -> bool {
    let reader = png::Decoder::new(file).read_info();
    reader.is_ok_and(|reader| text_of(reader.info()).is_ok_and(|text| text.is_some()))
}

/// Reads a whole picture that flipmap wrote, if no side is longer than `longest_side`.
pub fn picture_in_png(file: impl BufRead + Seek, longest_side: u32) -> Result<Picture, PngError> {
    let mut decoder = png::Decoder::new(file);
    decoder.set_transformations(png::Transformations::STRIP_16);
    let mut reader = decoder.read_info()?;
    let size = [reader.info().width, reader.info().height];
    if reader.output_color_type() != (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Err(PngError::Foreign);
    }
    if let Some(side) = size.into_iter().find(|side| *side > longest_side) {
        return Err(PngError::Large { side, longest_side });
    }
    let mut rgb = Vec::new();
    while let Some(row) = reader.next_row()? {
        rgb.extend_from_slice(row.data());
    }
    reader.finish()?;
    Ok(Picture { document: document_of(reader.info())?, size, rgb })
}

/// Largest size in bytes of a document inside a PNG, far larger than any that flipmap writes.
const MAX_TEXT: usize = 1 << 20;

fn document_of(info: &png::Info<'_>) -> Result<Document, PngError> {
    let text = text_of(info)?.ok_or(PngError::Foreign)?;
    Document::parse(&text).map_err(|why| match why {
        why @ DocumentError::Future { .. } => PngError::Newer(why),
        why => PngError::Text(why),
    })
}

/// Returns the text with flipmap's keyword. Other programs that save a picture again write it as
/// another kind of chunk, and may change the case of its keyword.
fn text_of(info: &png::Info<'_>) -> Result<Option<String>, PngError> {
    let is_ours = |keyword: &str| keyword.eq_ignore_ascii_case(KEYWORD);
    if let Some(chunk) = info.utf8_text.iter().find(|chunk| is_ours(&chunk.keyword)) {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(MAX_TEXT)?;
        return Ok(Some(chunk.get_text()?));
    }
    if let Some(chunk) = info.compressed_latin1_text.iter().find(|chunk| is_ours(&chunk.keyword)) {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(MAX_TEXT)?;
        return Ok(Some(chunk.get_text()?));
    }
    let plain = info.uncompressed_latin1_text.iter().find(|chunk| is_ours(&chunk.keyword));
    Ok(plain.map(|chunk| chunk.text.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn picture(document: &Document) -> Vec<u8> {
        let mut writer = PngWriter::new(Vec::new(), [3, 2], document).unwrap();
        writer.write(&[7; 9]).unwrap();
        writer.write(&[200; 9]).unwrap();
        writer.finish().unwrap()
    }

    #[test]
    fn a_document_that_unpacks_without_end_is_refused() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        let mut chunk = png::text_metadata::ITXtChunk::new(KEYWORD, "#".repeat(MAX_TEXT + 1));
        chunk.compressed = true;
        writer.write_text_chunk(&chunk).unwrap();
        writer.write_image_data(&[0; 3]).unwrap();
        writer.finish().unwrap();
        assert!(bytes.len() < MAX_TEXT / 10, "it is packed");
        assert!(document_in_png(Cursor::new(bytes)).is_err());
    }

    #[test]
    fn the_scene_comes_back_out() {
        let mut document = Document::default();
        document.view.center[0] = "-1.66".to_string();
        assert_eq!(document_in_png(Cursor::new(picture(&document))).unwrap(), document);
    }

    #[test]
    fn the_whole_picture_comes_back_out_unless_it_is_too_large() {
        let bytes = picture(&Document::default());
        let rgb = [[7; 9], [200; 9]].concat();
        let whole = picture_in_png(Cursor::new(&bytes), 3).unwrap();
        assert_eq!(whole, Picture { document: Document::default(), size: [3, 2], rgb });
        let error = picture_in_png(Cursor::new(&bytes), 2).unwrap_err().to_string();
        assert_eq!(error, "is 3 pixels long; at most 2 are read here");
    }

    #[test]
    fn a_picture_of_sixteen_bits_is_read_as_one_of_eight() {
        let mut writer = PngWriter::deep(Vec::new(), [1, 2], &Document::default()).unwrap();
        writer.write(&[7, 99, 8, 200, 9, 1]).unwrap();
        writer.write(&[255, 255, 0, 0, 128, 0]).unwrap();
        let bytes = writer.finish().unwrap();
        assert_eq!(document_in_png(Cursor::new(&bytes)).unwrap(), Document::default());
        let picture = picture_in_png(Cursor::new(&bytes), 9).unwrap();
        assert_eq!(picture.rgb, [7, 8, 9, 255, 0, 128]);
    }

    #[test]
    fn maps_are_smaller_than_by_the_encoders_own_choice() {
        let map = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/heyl.png");
        let file = io::BufReader::new(std::fs::File::open(map).unwrap());
        let Picture { document, size, rgb } = picture_in_png(file, 4096).unwrap();
        let mut ours = PngWriter::new(Vec::new(), size, &document).unwrap();
        ours.write(&rgb).unwrap();
        let ours = ours.finish().unwrap();
        let mut usual = Vec::new();
        let mut encoder = png::Encoder::new(&mut usual, size[0], size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(&rgb).unwrap();
        assert!(ours.len() < usual.len(), "{} of {} bytes", ours.len(), usual.len());
    }

    #[test]
    fn pictures_that_others_saved_again_keep_their_scene() {
        let mut document = Document::default();
        document.view.width = "0.25".to_string();
        let text = document.text();
        for (kind, color) in [
            (0, png::ColorType::Indexed),
            (1, png::ColorType::GrayscaleAlpha),
            (2, png::ColorType::Rgba),
        ] {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
            encoder.set_color(color);
            encoder.set_palette(vec![1, 2, 3]);
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(&vec![0; color.samples()]).unwrap();
            use png::text_metadata::{ITXtChunk, TEXtChunk, ZTXtChunk};
            // After the pixels, as some programs write it.
            match kind {
                0 => writer.write_text_chunk(&TEXtChunk::new("Flipmap", &text)),
                1 => writer.write_text_chunk(&ZTXtChunk::new("flipmap", &text)),
                _ => writer.write_text_chunk(&ITXtChunk::new("FLIPMAP", &text)),
            }
            .unwrap();
            writer.finish().unwrap();
            assert_eq!(document_in_png(Cursor::new(bytes)).unwrap(), document, "{kind}");
        }
    }

    #[test]
    fn a_newer_picture_is_newer_and_not_damaged() {
        let document = Document { format: 2, ..Document::default() };
        let error = document_in_png(Cursor::new(picture(&document))).unwrap_err().to_string();
        assert!(
            error.starts_with("was written by a newer flipmap: the file has format 2"),
            "{error}"
        );
    }

    #[test]
    fn equal_pictures_are_equal_files() {
        assert_eq!(picture(&Document::default()), picture(&Document::default()));
    }

    #[test]
    fn truncated_and_foreign_files_are_refused() {
        let bytes = picture(&Document::default());
        for length in [0, 4, 60, bytes.len() / 2, bytes.len() - 14] {
            let error = document_in_png(Cursor::new(&bytes[..length])).unwrap_err();
            assert!(matches!(error, PngError::Broken(_)), "{length}: {error}");
        }
        let mut foreign = Vec::new();
        let mut encoder = png::Encoder::new(&mut foreign, 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[0]).unwrap();
        let error = document_in_png(Cursor::new(foreign)).unwrap_err();
        assert!(matches!(error, PngError::Foreign), "{error}");
    }
}
