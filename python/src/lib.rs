//! The compiled half of the Python package: maps and traces as plain bytes, which the other half,
//! `flipmap/__init__.py`, turns into NumPy arrays; and films, in files.

mod clock;
mod film;
mod fork;
mod map;
mod measure;
mod place;
mod scene;
mod trace;

/// The functions that `flipmap/__init__.py` calls.
#[pyo3::pymodule]
mod _flipmap {
    use flipmap::{BuiltIn, PictureTable, Setting, Status, Trust};
    use flipmap_scene::Axis;
    use flipmap_scene::film::Film;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::film::film;
    #[pymodule_export]
    use crate::map::render;
    #[pymodule_export]
    use crate::measure::measure;
    #[pymodule_export]
    use crate::place::{coordinates, frame, part, whole};
    #[pymodule_export]
    use crate::trace::trace;

    /// Exports the words and codes that Python needs, so that they are defined only once.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let words: Vec<_> = Setting::all().map(Setting::name).collect();
        module.add("WORDS", words)?;
        let scenes: Vec<_> = BuiltIn::names().split(", ").map(str::to_string).collect();
        module.add("SCENES", scenes)?;
        let statuses = [
            ("UNFLIPPED", Status::Unflipped),
            ("FLIPPED", Status::Answered),
            ("FORBIDDEN", Status::Forbidden),
            ("FAILED", Status::Failed),
        ];
        let statuses = statuses.map(|(name, status)| (name, status as u8));
        module.add("STATUSES", statuses.to_vec())?;
        let trusts = Trust::ALL.map(|(name, trust)| (name.to_uppercase(), trust as u8));
        module.add("TRUSTS", trusts.to_vec())?;
        let axes = Axis::OF_STARTS.into_iter().chain([Axis::Momentum2]);
        module.add("AXES", axes.map(Axis::name).collect::<Vec<_>>())?;
        module.add("MAX_SIDE", PictureTable::MAX_SIDE)?;
        module.add("MAX_FRAMES", Film::MAX_FRAMES)?;
        module.add("FPS", (*Film::FPS.start(), *Film::FPS.end()))?;
        module.add("VERSION", env!("CARGO_PKG_VERSION"))
    }
}
