//! Writes samples to files: pictures, arrays and tables, without risk to earlier files.
//!
//! Every regular file is written beside its destination and renamed onto it when it is complete, so
//! a failure or an interruption leaves the earlier file as it was. Rows are written as their
//! samples come, and only a few are held: pictures can be larger than memory.

pub mod compare;
mod comparison;
mod corner_rows;
mod csv;
mod curve;
mod device;
mod digest;
mod ending;
mod exr;
mod failure;
mod gradient;
mod legend;
mod lit_rows;
mod nearest_return;
mod npy;
mod npz;
mod one_file;
mod paint;
mod paths;
mod picture_file;
mod picture_rows;
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
mod trace_table;
mod trust;
mod whole_picture;
mod whole_png;

pub(crate) use curve::CurveBand;
pub use device::{Device, stop_writing_when};
pub use digest::sha256;
pub use ending::check_ending;
pub(crate) use exr::ExrWriter;
pub use failure::{OutputError, RenderError, is_broken_pipe, is_stopped, sentence};
pub use flipmap_engine::plain_file::{open_plain, read_plain, read_text};
pub use gradient::read_gradient;
pub use legend::Legend;
pub use npy::NpyWriter;
pub use one_file::{is_one_file, is_stdout};
pub use paint::RowPainter;
pub(crate) use paint::blended;
pub use paths::Paths;
pub use picture_file::PictureFile;
pub(crate) use png::carries_scene;
pub use png::{Picture, PngError, PngWriter, document_in_png, picture_in_png};
pub use pyramid::Pyramid;
pub(crate) use pyramid::PyramidFolder;
pub use read::{named_document, read_document};
pub use recipe::{PictureRecipe, RenderedPicture};
pub use render::{RenderClock, pass_work, render_pass};
pub use rows::RowOrder;
pub use safe::{Destination, SafeFile};
pub use shell::shell_word;
pub(crate) use sinks::SinkPass;
pub use sinks::Sinks;
pub(crate) use spool::Spool;
pub use state::{RenderState, RunRecord};
pub use trace::Trace;
pub use trace_table::TraceError;
pub(crate) use trust::trust_colours;
pub use whole_picture::PICTURES;
