//! TIFF written strip by strip, so that no picture is too large: over 4 GiB as BigTIFF.

use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use tiff::encoder::colortype::{ColorType, RGB8, RGB16};
use tiff::encoder::{TiffEncoder, TiffKind, TiffKindBig, TiffKindStandard, TiffValue};

use super::{SafeFile, Spool};

/// Size in bytes from which a picture is a BigTIFF: TIFF has 32 bits for its offsets, and some room
/// is left for the directory.
const BIG_BYTES: u64 = (1 << 32) - (1 << 20);
/// Number of strips that wait for the encoder.
const AHEAD: usize = 2;

/// A picture whose rows an encoder on a thread of its own writes as they come: the encoder borrows
/// its file, so that the two cannot live side by side.
pub(super) struct TiffStream {
    rows: Option<SyncSender<Vec<u8>>>,
    encoder: Option<JoinHandle<io::Result<Spool>>>,
}

impl TiffStream {
    /// Begins a picture of eight bits a channel, or of sixteen if it is `deep`.
    pub(super) fn begin(file: SafeFile, size: [u32; 2], deep: bool) -> io::Result<Self> {
        let bytes = size.map(u64::from).iter().product::<u64>() * if deep { 6 } else { 3 };
        Self::begin_as(file, size, deep, bytes >= BIG_BYTES)
    }

    fn begin_as(file: SafeFile, size: [u32; 2], deep: bool, is_big: bool) -> io::Result<Self> {
        let spool = Spool::new(file)?;
        let (rows, taken) = sync_channel(AHEAD);
        let encode = move || match (is_big, deep) {
            (false, false) => encode::<TiffKindStandard, RGB8>(spool, size, &taken, to_bytes),
            (false, true) => encode::<TiffKindStandard, RGB16>(spool, size, &taken, to_numbers),
            (true, false) => encode::<TiffKindBig, RGB8>(spool, size, &taken, to_bytes),
            (true, true) => encode::<TiffKindBig, RGB16>(spool, size, &taken, to_numbers),
        };
        let encoder = std::thread::Builder::new().name("tiff".to_string()).spawn(encode)?;
        Ok(TiffStream { rows: Some(rows), encoder: Some(encoder) })
    }

    /// Adds the next rows, three bytes per pixel, or six with each channel's high byte first.
    pub(super) fn write(&mut self, rgb: &[u8]) -> io::Result<()> {
        let sent = self.rows.as_ref().map(|rows| rows.send(rgb.to_vec()));
        match sent {
            Some(Ok(())) => Ok(()),
            // The encoder has ended early, and says why.
            _ => Err(self.end().err().unwrap_or_else(|| io::Error::other("it has fewer rows"))),
        }
    }

    /// Completes the picture and returns its file.
    pub(super) fn finish(mut self) -> io::Result<SafeFile> {
        self.end()?.into_file()
    }

    /// Waits until the encoder has written what it was given.
    fn end(&mut self) -> io::Result<Spool> {
        drop(self.rows.take());
        let failed = || io::Error::other("the encoder failed");
        let encoder = self.encoder.take().ok_or_else(failed)?;
        encoder.join().unwrap_or_else(|_| Err(failed()))
    }
}

impl Drop for TiffStream {
    fn drop(&mut self) {
        // An unfinished file is removed before the program ends.
        drop(self.end());
    }
}

fn to_bytes(rows: &[u8]) -> Vec<u8> {
    rows.to_vec()
}

fn to_numbers(rows: &[u8]) -> Vec<u16> {
    rows.as_chunks().0.iter().map(|channel| u16::from_be_bytes(*channel)).collect()
}

/// Writes rows as strips, as they come.
fn encode<K: TiffKind, C: ColorType>(
    mut file: Spool,
    [width, height]: [u32; 2],
    rows: &Receiver<Vec<u8>>,
    numbers: fn(&[u8]) -> Vec<C::Inner>,
) -> io::Result<Spool>
where
    [C::Inner]: TiffValue,
{
    let mut encoder = TiffEncoder::<_, K>::new_generic(&mut file).map_err(cause)?;
    let mut image = encoder.new_image::<C>(width, height).map_err(cause)?;
    let mut waiting: Vec<C::Inner> = Vec::new();
    for part in rows {
        waiting.extend(numbers(&part));
        loop {
            let strip = image.next_strip_sample_count() as usize;
            if strip == 0 || waiting.len() < strip {
                break;
            }
            let rest = waiting.split_off(strip);
            image.write_strip(&waiting).map_err(cause)?;
            waiting = rest;
        }
    }
    image.finish().map_err(cause)?;
    Ok(file)
}

fn cause(error: tiff::TiffError) -> io::Error {
    match error {
        tiff::TiffError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Destination;
    use std::path::Path;

    #[test]
    fn rows_come_back_however_they_came() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.tiff");
        let size = [300, 70];
        let bytes: Vec<u8> = (0..300 * 70 * 6).map(|k| (k % 251) as u8).collect();
        for (deep, is_big, part) in [
            (false, false, 1800),
            (true, false, 5400),
            (true, false, 300 * 70 * 6),
            (false, true, 1800),
            (true, true, 5400),
        ] {
            let file = SafeFile::create(&Destination::from(&*path)).unwrap();
            let mut tiff = TiffStream::begin_as(file, size, deep, is_big).unwrap();
            let all = if deep { &bytes[..] } else { &bytes[..300 * 70 * 3] };
            all.chunks(part).for_each(|rows| tiff.write(rows).unwrap());
            tiff.finish().unwrap().finish().unwrap();
            // The version after the order of the bytes: 43 in a BigTIFF.
            assert_eq!(std::fs::read(&path).unwrap()[2], if is_big { 43 } else { 42 });
            let read = image::open(&path).unwrap();
            assert_eq!((read.width(), read.height()), (300, 70));
            if deep {
                assert_eq!(read.to_rgb16().as_raw()[..], to_numbers(&bytes)[..]);
            } else {
                assert_eq!(&read.to_rgb8().as_raw()[..], all);
            }
        }
    }

    #[test]
    fn an_unfinished_picture_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.tiff");
        let file = SafeFile::create(&Destination::from(&*path)).unwrap();
        let mut tiff = TiffStream::begin(file, [64, 64], false).unwrap();
        tiff.write(&[0; 64 * 3]).unwrap();
        drop(tiff);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_ends_the_work_early() {
        let file = SafeFile::create(&Destination::from(Path::new("/dev/full"))).unwrap();
        let mut tiff = TiffStream::begin(file, [64, 64], false).unwrap();
        // A device gets the whole file at the end.
        (0..64).for_each(|_| tiff.write(&[0; 64 * 3]).unwrap());
        assert_eq!(tiff.finish().err().unwrap().kind(), io::ErrorKind::StorageFull);
    }
}
