//! Writing samples to files: pictures, arrays, and the safety of what was there before.
//!
//! Every regular file is written beside its destination and renamed onto it when it is complete, so
//! that a failure or an interruption leaves what was there. All are written as rows of samples
//! come, and only a few rows are held: pictures can be larger than memory.

pub mod compare;
mod comparison;
mod corner_rows;
mod curve;
mod device;
mod digest;
mod exr;
mod failure;
mod gradient;
mod legend;
mod lit_rows;
mod nearest_return;
mod npy;
mod one_file;
mod paint;
mod picture_file;
mod pixel_stream;
mod png;
mod pyramid;
mod read;
mod recipe;
mod render;
mod rows;
mod safe;
mod shell;
mod sinks;
mod spool;
mod state;
mod trace;
mod trace_channels;
mod trust;
mod whole_png;

pub use curve::CurveBand;
pub use device::{Device, stop_writing_when};
pub use digest::sha256;
pub use exr::ExrWriter;
pub use failure::{OutputError, RenderError, is_broken_pipe, is_stopped, sentence};
pub use flipmap_engine::plain_file::{open_plain, read_plain, read_text};
pub use gradient::{GradientError, read_gradient};
pub use legend::Legend;
pub use npy::NpyWriter;
pub use one_file::{is_one_file, is_stdout};
pub use paint::{RowPainter, blended};
pub use picture_file::PictureFile;
pub use png::{Picture, PngError, PngWriter, carries_scene, document_in_png, picture_in_png};
pub use pyramid::{Pyramid, PyramidFolder, TILE_SIDE};
pub use read::{ReadError, named_document, read_document};
pub use recipe::{PictureRecipe, RenderedPicture, Watch};
pub use render::{RenderClock, pass_samples, pass_work, render_pass};
pub use rows::RowOrder;
pub use safe::{Destination, SafeFile};
pub use shell::shell_word;
pub use sinks::{Paths, SinkPass, Sinks};
pub use spool::Spool;
pub use state::{RenderState, RunRecord, StateError};
pub use trace::{Advance, NotFinite, Trace, launch_from_text};
pub use trust::trust_colours;
