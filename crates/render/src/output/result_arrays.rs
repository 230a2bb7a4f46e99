//! The answers of all pixels in one array of a `.npy`, or in an array for each channel in a `.npz`,
//! read row by row.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use zip::{CompressionMethod, ZipArchive};

use super::npy::{NpyNumbers, npy_shape};
use flipmap_engine::plain_file::open_plain;
use flipmap_scene::question::QuestionName;

/// Arrays of one size whose rows lie side by side.
pub(super) struct ResultArrays {
    size: [u32; 2],
    arrays: Vec<Array>,
}

/// An array that is read from the top.
struct Array {
    file: BufReader<File>,
    channels: usize,
    numbers: NpyNumbers,
}

/// Reasons why a file has no such arrays, as phrases.
#[derive(Debug, thiserror::Error)]
pub(super) enum ArrayError {
    #[error("{0}")]
    Unreadable(#[from] io::Error),
    #[error("is not such an array: {0}")]
    Shape(&'static str),
    #[error("has {found} bytes, and its header says {needed}")]
    Length { found: u64, needed: u64 },
    #[error("is no .npz: {0}")]
    Zip(#[from] zip::result::ZipError),
    #[error("does not begin with the arrays that render writes into a .npz, such as time")]
    NoChannel,
    #[error("holds '{0}' compressed: save it with numpy.savez")]
    Compressed(String),
    #[error("holds arrays of different sizes")]
    Sizes,
}

impl ResultArrays {
    /// Opens a `.npy`.
    pub(super) fn of_npy(path: &Path) -> Result<Self, ArrayError> {
        let file = open_plain(path)?;
        let length = file.metadata()?.len();
        let (size, array) = Array::begin(BufReader::new(file), length)?;
        Ok(ResultArrays { size, arrays: vec![array] })
    }

    /// Opens the channels in a `.npz`, which come first in it: later arrays, of coordinates, can be
    /// called as a channel of another question is.
    pub(super) fn of_npz(path: &Path) -> Result<Self, ArrayError> {
        let mut zip = ZipArchive::new(BufReader::new(open_plain(path)?))?;
        let known = QuestionName::channel_names();
        let mut channels = Vec::new();
        for index in 0..zip.len() {
            let entry = zip.by_index_raw(index)?;
            let name = entry.name().strip_suffix(".npy").unwrap_or_default();
            if !known.contains(&name) {
                break;
            }
            if entry.compression() != CompressionMethod::Stored {
                return Err(ArrayError::Compressed(name.to_string()));
            }
            let mut file = open_plain(path)?;
            file.seek(SeekFrom::Start(entry.data_start()))?;
            channels.push(Array::begin(BufReader::new(file), entry.data_start() + entry.size())?);
        }
        let size = channels.first().map(|(size, _)| *size).ok_or(ArrayError::NoChannel)?;
        if channels.iter().any(|(other, _)| *other != size) {
            return Err(ArrayError::Sizes);
        }
        Ok(ResultArrays { size, arrays: channels.into_iter().map(|(_, array)| array).collect() })
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the number of values of each pixel.
    pub(super) fn channels(&self) -> usize {
        self.arrays.iter().map(|array| array.channels).sum()
    }

    /// Returns the values of the next row, pixel by pixel.
    pub(super) fn next(&mut self) -> io::Result<Vec<f64>> {
        let width = self.size[0] as usize;
        let each: Vec<(usize, Vec<f64>)> = self
            .arrays
            .iter_mut()
            .map(|array| Ok((array.channels, array.row(width)?)))
            .collect::<io::Result<_>>()?;
        let of_pixel = |x: usize| {
            each.iter().flat_map(move |(count, row)| row[x * count..][..*count].iter().copied())
        };
        Ok((0..width).flat_map(of_pixel).collect())
    }
}

impl Array {
    /// Reads the header of an array that ends at byte `end` of its file; returns its size in pixels
    /// as well.
    fn begin(mut file: BufReader<File>, end: u64) -> Result<([u32; 2], Self), ArrayError> {
        let (size, channels, numbers) = npy_shape(&mut file).map_err(ArrayError::Shape)?;
        // At most 64 channels of a million times a million pixels.
        let values = size.map(u64::from).iter().product::<u64>() * channels as u64;
        let needed = numbers.bytes as u64 * values + file.stream_position()?;
        if end != needed {
            return Err(ArrayError::Length { found: end, needed });
        }
        Ok((size, Array { file, channels, numbers }))
    }

    fn row(&mut self, width: usize) -> io::Result<Vec<f64>> {
        let mut bytes = vec![0; self.numbers.bytes * width * self.channels];
        self.file.read_exact(&mut bytes)?;
        Ok(self.numbers.read(&bytes))
    }
}
