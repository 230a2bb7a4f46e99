//! Parts: files that hold all samples computed so far of a still or a film.
//!
//! Next to a plan `map.toml` lies a folder `map.parts`, into which any number of processes write:
//!
//! ```text
//! name   rows-1f0c92aa-0000128-64.part      patches-1f0c92aa-77b0e3d91a54c208.part
//!             of       first   count                 of       digest of the cells
//! file   "flipmap part 1\n" │ CRC-32 of the body │ body: of, holds, samples, in postcard
//! ```
//!
//! `of` is the SHA-256 of everything that decides the samples: scene, size, integrator config,
//! checking, program version. The name has its first eight digits, the body all of them. Names only
//! distinguish files; [`Parts::scan`] reads the contents from the bodies. So it does not matter who
//! computed a part, or in which order; parts may overlap, and two that hold the same samples are
//! equal.
//!
//! - A part is valid if its first line, checksum and encoding are right, and if it has as many
//!   samples as it states, with the width and channels that the plan requires for its digest. Any
//!   other file with the name of a part of this plan is damaged: its samples count as missing, and
//!   it is removed before they are computed again. A file that does not even begin as a part is
//!   foreign, and is refused. Files with other names are left alone.
//! - A part is written under a temporary name and then renamed ([`SafeFile`]), so it is either
//!   complete or absent. A process that is killed leaves at most a temporary file, which the scan
//!   ignores.
//! - Writing does not wait for the disk (no fsync). A part that lost bytes in a power failure, or
//!   was altered later, is detected by its checksum.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::output::{Destination, SafeFile, read_plain, sha256};
use crate::tiles::Samples;
use crate::tiles::patches::PATCH_SAMPLES;
use flipmap_scene::Turn;
use flipmap_scene::lattice::Cell;

/// First bytes of every part; the number is the format's.
const MAGIC: &[u8] = b"flipmap part 1\n";
/// Number of samples of decoded parts that stay in memory.
const CACHED_SAMPLES: usize = 8 << 20;

/// Reasons why a part cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// An error of the folder or of a file in it.
    #[error("cannot {verb} {path}")]
    File {
        /// The verb of the message: `read` or `write`.
        verb: &'static str,
        /// Path of the folder or file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A file that was damaged after it was written.
    #[error("{0} is cut short or altered ({1}): run its shard again, which computes it anew")]
    Damaged(PathBuf, &'static str),
    /// A file under the name of a part that was never one.
    #[error("{0} has the name of a part of this plan and is none: move it elsewhere")]
    Foreign(PathBuf),
    /// Samples that an earlier scan found and that are missing now.
    #[error("samples are missing that were there a moment ago; run again")]
    Gone,
}

/// The rows or patches whose samples a part holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum PartContents {
    /// Rows of a picture `width` samples wide: `count` of them, from `first` on.
    Rows { width: u32, first: u32, count: u32 },
    /// Patches: their levels, and the limbs of their lower left corners.
    Patches(Vec<(u32, [u64; 8], [u64; 8])>),
}

#[derive(Serialize, Deserialize)]
struct Part {
    /// Digest of everything that decides the samples.
    of: String,
    holds: PartContents,
    samples: Samples,
}

/// The form that a plan requires of the samples with one digest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartForm {
    /// Rows of a still.
    Rows {
        /// Number of samples in a row.
        width: u32,
        /// Number of rows to compute.
        rows: u32,
        /// Number of values of each sample.
        channels: usize,
    },
    /// Patches of a film of flips.
    Patches,
}

/// The forms of all samples of a plan, by digest.
pub type PartForms = HashMap<String, PartForm>;

impl Part {
    /// Refuses samples that are not as many as the part states, or not of the form that the plan
    /// requires.
    fn check(&self, forms: &PartForms) -> Result<(), &'static str> {
        let Some(form) = forms.get(&self.of) else { return Ok(()) };
        let (count, channels, fits) = match (&self.holds, *form) {
            (
                PartContents::Rows { width, first, count },
                PartForm::Rows { width: wide, rows, channels },
            ) => {
                let end = u64::from(*first) + u64::from(*count);
                let fits = *width == wide && end <= u64::from(rows);
                (u64::from(*width) * u64::from(*count), channels, fits)
            }
            (PartContents::Patches(places), PartForm::Patches) => {
                ((places.len() * PATCH_SAMPLES) as u64, 1, true)
            }
            _ => return Err("it holds rows where the plan has patches, or the other way round"),
        };
        if !fits {
            return Err("its rows are not those of the plan");
        }
        let is_whole = self.samples.len() as u64 == count && self.samples.are_whole(channels);
        if is_whole { Ok(()) } else { Err("its samples are not as many as it says") }
    }
}

/// Writes the parts of one pendulum or picture.
pub(crate) struct PartWriter {
    folder: PathBuf,
    of: String,
}

impl PartWriter {
    /// Opens a folder, creating it if necessary; `of` is the digest of what decides the samples.
    pub(crate) fn open(folder: &Path, of: &str) -> Result<Self, PartError> {
        fs::create_dir_all(folder).map_err(failed("write", folder))?;
        Ok(PartWriter { folder: folder.to_path_buf(), of: of.to_string() })
    }

    /// Writes a part of rows from `first` on.
    pub(crate) fn rows(&self, width: u32, first: u32, samples: Samples) -> Result<(), PartError> {
        let count = (samples.len() / width as usize) as u32;
        let name = format!("rows-{}-{first:07}-{count}.part", &self.of[..8]);
        self.write(&name, PartContents::Rows { width, first, count }, samples)
    }

    /// Writes a part of patches; `samples` holds those of one patch after another.
    pub(crate) fn patches(&self, cells: &[Cell], samples: Samples) -> Result<(), PartError> {
        let places: Vec<_> =
            cells.iter().map(|cell| (cell.level, cell.x.limbs(), cell.y.limbs())).collect();
        let name = format!(
            "patches-{}-{}.part",
            &self.of[..8],
            &sha256(format!("{places:?}").as_bytes())[..16]
        );
        self.write(&name, PartContents::Patches(places), samples)
    }

    fn write(&self, name: &str, holds: PartContents, samples: Samples) -> Result<(), PartError> {
        let path = self.folder.join(name);
        let part = Part { of: self.of.clone(), holds, samples };
        let written = || {
            let body = postcard::to_stdvec(&part).map_err(io::Error::other)?;
            let mut file = SafeFile::create(&Destination::from(path.as_path()))?;
            file.write_all(MAGIC)?;
            file.write_all(&crc32fast::hash(&body).to_le_bytes())?;
            file.write_all(&body)?;
            file.finish()
        };
        written().map_err(failed("write", &path))
    }
}

/// The parts in a folder.
#[derive(Debug, Default)]
pub struct Parts {
    paths: Vec<PathBuf>,
    /// Number of rows and index of the file, by digest and first row.
    rows: BTreeMap<(String, u32), (u32, usize)>,
    /// Index of the file and of the patch within it, by digest and cell.
    patches: HashMap<String, HashMap<Cell, (usize, usize)>>,
    /// Damaged files, each with its fault.
    damaged: Vec<(PathBuf, &'static str)>,
    forms: PartForms,
    at_hand: VecDeque<(usize, Arc<Part>)>,
}

impl std::fmt::Debug for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.holds)
    }
}

impl Parts {
    /// Reads every part of these forms in a folder from the first byte to the last; a missing
    /// folder counts as empty. Refuses foreign files under the names of such parts.
    pub fn scan(folder: &Path, forms: PartForms) -> Result<Self, PartError> {
        let mut parts = Parts { forms, ..Parts::default() };
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(parts),
            entries => entries.map_err(failed("read", folder))?,
        };
        for entry in entries {
            let path = entry.map_err(failed("read", folder))?.path();
            let is_ours = is_named_by(&path, &parts.forms);
            // Reading a pipe would wait for its writer, and a device would swallow the computed
            // samples.
            if is_ours && !path.is_file() {
                return Err(PartError::Foreign(path));
            }
            if path.extension().is_some_and(|ending| ending == "part") && path.is_file() {
                match read(&path, &parts.forms) {
                    Ok(Some(part)) => parts.add(path, &part),
                    Ok(None) => {}
                    Err(_) if !is_ours => {}
                    Err(PartError::Damaged(path, why)) => parts.damaged.push((path, why)),
                    Err(error) => return Err(error),
                }
            }
        }
        parts.damaged.sort();
        Ok(parts)
    }

    fn add(&mut self, path: PathBuf, part: &Part) {
        let file = self.paths.len();
        self.paths.push(path);
        match &part.holds {
            PartContents::Rows { first, count, .. } => {
                let longest = self.rows.entry((part.of.clone(), *first)).or_insert((0, file));
                if *count > longest.0 {
                    *longest = (*count, file);
                }
            }
            PartContents::Patches(places) => {
                let known = self.patches.entry(part.of.clone()).or_default();
                for (k, (level, x, y)) in places.iter().enumerate() {
                    let [x, y] = [*x, *y].map(Turn::from_limbs);
                    known.insert(Cell { level: *level, x, y }, (file, k));
                }
            }
        }
    }

    /// Returns the damaged files, each with its fault.
    pub fn damaged(&self) -> &[(PathBuf, &'static str)] {
        &self.damaged
    }

    /// Removes damaged files, so that what they held can be computed again.
    pub fn remove_damaged(&mut self) -> Result<(), PartError> {
        self.damaged.drain(..).try_for_each(|(path, _)| match fs::remove_file(&path) {
            // Another process removed it first.
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            removed => removed.map_err(failed("write", &path)),
        })
    }

    /// Returns those of `rows` that no part holds.
    pub(crate) fn missing_rows(&self, of: &str, rows: Range<u32>) -> Vec<Range<u32>> {
        let mut missing = Vec::new();
        let mut next = rows.start;
        for ((_, first), (count, _)) in self.of_rows(of) {
            if *first >= rows.end {
                break;
            }
            if *first > next {
                missing.push(next..*first);
            }
            next = next.max(first + count);
        }
        if next < rows.end {
            missing.push(next..rows.end);
        }
        missing
    }

    fn of_rows(&self, of: &str) -> impl Iterator<Item = (&(String, u32), &(u32, usize))> {
        let range = (of.to_string(), 0)..=(of.to_string(), u32::MAX);
        self.rows.range(range)
    }

    /// Returns the samples of at most `most` rows from `row` on, all from one part.
    pub(crate) fn rows(&mut self, of: &str, row: u32, most: u32) -> Result<Samples, PartError> {
        let holds = |(key, (count, file)): (&(String, u32), &(u32, usize))| {
            (key.1..key.1 + count).contains(&row).then_some((key.1, *count, *file))
        };
        let before = self.rows.range((of.to_string(), 0)..=(of.to_string(), row)).rev();
        let (first, count, file) = before.into_iter().find_map(holds).ok_or(PartError::Gone)?;
        let part = self.load(file)?;
        let PartContents::Rows { width, .. } = part.holds else { return Err(PartError::Gone) };
        let end = (row + most).min(first + count);
        let [from, to] = [row, end].map(|row| (row - first) as usize * width as usize);
        Ok(part.samples.part(from..to))
    }

    /// Returns true if some part holds a patch.
    pub(crate) fn has_patch(&self, of: &str, cell: &Cell) -> bool {
        self.patches.get(of).is_some_and(|known| known.contains_key(cell))
    }

    /// Returns the samples of a patch.
    pub(crate) fn patch(&mut self, of: &str, cell: &Cell) -> Result<Samples, PartError> {
        let known = self.patches.get(of).and_then(|known| known.get(cell));
        let (file, place) = *known.ok_or(PartError::Gone)?;
        Ok(self.load(file)?.samples.part(place * PATCH_SAMPLES..(place + 1) * PATCH_SAMPLES))
    }

    fn load(&mut self, file: usize) -> Result<Arc<Part>, PartError> {
        if let Some((_, part)) = self.at_hand.iter().find(|(at_hand, _)| *at_hand == file) {
            return Ok(part.clone());
        }
        let part = Arc::new(read(&self.paths[file], &self.forms)?.ok_or(PartError::Gone)?);
        self.at_hand.push_back((file, part.clone()));
        let samples = |(_, part): &(usize, Arc<Part>)| part.samples.len();
        while self.at_hand.len() > 1
            && self.at_hand.iter().map(samples).sum::<usize>() > CACHED_SAMPLES
        {
            self.at_hand.pop_front();
        }
        Ok(part)
    }
}

/// Largest size of a part in bytes, far larger than any that is written.
const MAX_BYTES: u64 = 1 << 30;

/// Reads a part; returns `None` if it is valid but belongs to another plan.
fn read(path: &Path, forms: &PartForms) -> Result<Option<Part>, PartError> {
    let bytes = read_plain(path, MAX_BYTES).map_err(failed("read", path))?;
    let damaged = |why| PartError::Damaged(path.to_path_buf(), why);
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        return Err(match may_be_lost(&bytes) {
            true => damaged("its first line is another"),
            false => PartError::Foreign(path.to_path_buf()),
        });
    };
    let cut = || damaged("it ends within its checksum, bytes 15 to 18");
    let (sum, body) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
    if crc32fast::hash(body) != u32::from_le_bytes(*sum) {
        return Err(damaged("the checksum in bytes 15 to 18 is not that of the bytes after it"));
    }
    let part: Part =
        postcard::from_bytes(body).map_err(|_| damaged("the bytes from 19 on are not a part"))?;
    if !forms.contains_key(&part.of) {
        return Ok(None);
    }
    part.check(forms).map_err(damaged)?;
    Ok(Some(part))
}

/// Largest number of bytes of a part's first line that damage may have changed.
const MAX_CHANGED_BYTES: usize = 3;

/// Returns true if a file that does not begin as a part may have done so before it was damaged: it
/// is empty, begins with zeros, as after a power failure, or begins with nearly the right line.
fn may_be_lost(bytes: &[u8]) -> bool {
    let first = &bytes[..bytes.len().min(MAGIC.len())];
    let changed = first.iter().zip(MAGIC).filter(|(found, byte)| found != byte).count();
    changed <= MAX_CHANGED_BYTES.min(first.len() / 2) || first.iter().all(|byte| *byte == 0)
}

/// Returns true if a file has the name of a part of one of the forms.
fn is_named_by(path: &Path, forms: &PartForms) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let of = name.split('-').nth(1).unwrap_or_default();
    is_named_as_part(path) && forms.keys().any(|form| form[..8] == *of)
}

/// Returns true if a file has the name of a part, of any plan.
fn is_named_as_part(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let words: Vec<&str> = name.strip_suffix(".part").unwrap_or_default().split('-').collect();
    let is_hex = |word: &str, length| {
        let hex = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        word.len() == length && word.bytes().all(hex)
    };
    let is_number =
        |word: &str, least| word.len() >= least && word.bytes().all(|byte| byte.is_ascii_digit());
    match words[..] {
        ["rows", of, first, count] => is_hex(of, 8) && is_number(first, 7) && is_number(count, 1),
        ["patches", of, cells] => is_hex(of, 8) && is_hex(cells, 16),
        _ => false,
    }
}

fn failed(verb: &'static str, path: &Path) -> impl FnOnce(io::Error) -> PartError {
    let path = path.to_path_buf();
    move |source| PartError::File { verb, path, source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Outcome;

    fn samples(count: usize, first: f64) -> Samples {
        let mut samples = Samples::unflipped(count);
        (0..count).for_each(|k| samples.set(k, Outcome::flipped(first + k as f64)));
        samples
    }

    fn forms(of: &str, form: PartForm) -> PartForms {
        PartForms::from([(of.to_string(), form)])
    }

    #[test]
    fn parts_whose_checksum_was_made_to_fit_are_compared_with_the_plan() {
        let of = sha256(b"a still");
        let form = PartForm::Rows { width: 3, rows: 10, channels: 1 };
        let damage = |holds: PartContents, samples: Samples| {
            let folder = tempfile::tempdir().unwrap();
            let writer = PartWriter::open(folder.path(), &of).unwrap();
            let name = format!("rows-{}-0000000-4.part", &of[..8]);
            writer.write(&name, holds, samples).unwrap();
            let parts = Parts::scan(folder.path(), forms(&of, form)).unwrap();
            parts.damaged().first().map(|(_, why)| *why)
        };
        let rows = |width, first, count| PartContents::Rows { width, first, count };
        assert_eq!(damage(rows(3, 0, 4), samples(12, 0.0)), None);
        let other = Some("its rows are not those of the plan");
        assert_eq!(damage(rows(4, 0, 3), samples(12, 0.0)), other);
        assert_eq!(damage(rows(3, 8, 4), samples(12, 0.0)), other);
        assert_eq!(damage(rows(3, u32::MAX, 4), samples(12, 0.0)), other);
        let few = Some("its samples are not as many as it says");
        assert_eq!(damage(rows(3, 0, 4), samples(11, 0.0)), few);
        assert_eq!(damage(rows(3, 0, 4), Samples::unanswered(12, 2)), few);
        let patch = PartContents::Patches(vec![(0, [0; 8], [0; 8])]);
        assert!(damage(patch, samples(PATCH_SAMPLES, 0.0)).unwrap().contains("patches"));
    }

    #[test]
    fn only_files_named_exactly_like_ours_are_ours() {
        let ours = |name: &str| is_named_as_part(Path::new(name));
        assert!(ours("rows-1f0c92aa-0000128-64.part"));
        assert!(ours("patches-1f0c92aa-77b0e3d91a54c208.part"));
        let others =
            ["rows-2024-budget.part", "patches-z.part", "rows-1f0c92aa-0000128-64-old.part"];
        for name in others.into_iter().chain(["rows-1F0C92AA-0000128-64.part", "rows.part"]) {
            assert!(!ours(name), "{name}");
        }
    }

    #[test]
    fn rows_are_found_whoever_wrote_them() {
        let folder = tempfile::tempdir().unwrap();
        let of = sha256(b"a still");
        let writer = PartWriter::open(folder.path(), &of).unwrap();
        // Rows 2 to 4, 4 to 8, and 3 to 5 once more, by another process.
        writer.rows(3, 2, samples(6, 200.0)).unwrap();
        writer.rows(3, 4, samples(12, 400.0)).unwrap();
        writer.rows(3, 3, samples(6, 300.0)).unwrap();
        let form = PartForm::Rows { width: 3, rows: 10, channels: 1 };
        let mut parts = Parts::scan(folder.path(), forms(&of, form)).unwrap();
        assert_eq!(parts.missing_rows(&of, 0..10), [0..2, 8..10]);
        assert_eq!(parts.missing_rows(&of, 2..8), []);
        assert_eq!(parts.missing_rows(&sha256(b"another"), 3..4).len(), 1);
        let row = |parts: &mut Parts, row| parts.rows(&of, row, 1).unwrap().get(0).time;
        assert_eq!([row(&mut parts, 2), row(&mut parts, 7)], [200.0, 409.0]);
        assert_eq!(parts.rows(&of, 5, 100).unwrap().len(), 9, "to the end of the part");
        assert!(matches!(parts.rows(&of, 8, 1), Err(PartError::Gone)));
    }

    #[test]
    fn patches_are_found_and_damage_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let of = sha256(b"a film");
        let writer = PartWriter::open(folder.path(), &of).unwrap();
        let [a, b, c, _] = Cell::WHOLE.children();
        writer.patches(&[a, b], samples(2 * PATCH_SAMPLES, 0.0)).unwrap();
        let mut parts = Parts::scan(folder.path(), forms(&of, PartForm::Patches)).unwrap();
        assert!(parts.has_patch(&of, &a) && !parts.has_patch(&of, &c));
        assert_eq!(parts.patch(&of, &b).unwrap().get(1).time, PATCH_SAMPLES as f64 + 1.0);
        let path = fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
        let whole = fs::read(&path).unwrap();
        for (at, xor) in [(0, 1), (MAGIC.len(), 1), (whole.len() / 2, 0x80), (whole.len() - 1, 1)] {
            let mut altered = whole.clone();
            altered[at] ^= xor;
            fs::write(&path, altered).unwrap();
            let parts = Parts::scan(folder.path(), forms(&of, PartForm::Patches)).unwrap();
            assert!(parts.damaged().len() == 1 && parts.damaged()[0].0 == path, "byte {at}");
            assert!(!parts.has_patch(&of, &a));
        }
        fs::write(&path, &whole[..whole.len() - 1]).unwrap();
        let mut parts = Parts::scan(folder.path(), forms(&of, PartForm::Patches)).unwrap();
        assert_eq!(parts.damaged().len(), 1);
        parts.remove_damaged().unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn files_of_others_are_told_from_damaged_parts() {
        let folder = tempfile::tempdir().unwrap();
        let of = sha256(b"a still");
        let form = PartForm::Rows { width: 3, rows: 10, channels: 1 };
        let named = |of: &str| folder.path().join(format!("rows-{}-0000000-4.part", &of[..8]));
        let scan = |bytes: &[u8]| {
            fs::write(named(&of), bytes).unwrap();
            Parts::scan(folder.path(), forms(&of, form))
        };
        fs::write(named(&"0".repeat(8)), "mine").unwrap();
        for lost in [&b""[..], &[0; 400], b"flipmap", b"flipnap part 1\n...", MAGIC] {
            let mut parts = scan(lost).unwrap();
            assert_eq!(parts.damaged().len(), 1, "{lost:?}");
            parts.remove_damaged().unwrap();
            assert!(!named(&of).exists() && named(&"0".repeat(8)).exists());
        }
        for foreign in [&b"mine"[..], b"m", b"a letter to somebody", &[0xff; 400]] {
            let refused = scan(foreign);
            assert!(matches!(refused, Err(PartError::Foreign(_))), "{foreign:?}: {refused:?}");
        }
        fs::remove_file(named(&of)).unwrap();
        fs::create_dir(named(&of)).unwrap();
        let refused = Parts::scan(folder.path(), forms(&of, form));
        assert!(matches!(refused, Err(PartError::Foreign(_))), "{refused:?}");
    }
}
