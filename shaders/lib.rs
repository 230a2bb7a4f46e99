//! The WGSL shaders of flipmap, as the texts of this folder.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

macro_rules! kernel_parts {
    ($($name:literal)*) => {
        /// The parts that kernels are made of, by the names of their files: minijinja templates.
        pub const KERNEL_PARTS: &[(&str, &str)] =
            &[$((concat!($name, ".wgsl"), include_str!(concat!($name, ".wgsl")))),*];
    };
}

kernel_parts! {
    "shared" "outcome" "f32" "df32" "f64" "state" "flip" "fixed" "fixed_look" "fixed_passes"
    "control" "carried" "gather" "tangents" "extremum" "phase" "adaptive" "look_on_quartic"
    "look_by_trials" "look" "series" "course" "series_look" "begin" "turn" "pack" "selfcheck"
}

/// The shader that colours the window's tiles.
pub const PICTURE: &str = include_str!("picture.wgsl");

/// The shader that shows the kept picture of the map, pixel by pixel.
pub const KEPT: &str = include_str!("kept.wgsl");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_in_its_table() {
        let entries = std::fs::read_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut files: Vec<String> = names.filter(|name| name.ends_with(".wgsl")).collect();
        let mut known: Vec<&str> = KERNEL_PARTS.iter().map(|(name, _)| *name).collect();
        // The window's own shaders, which are not assembled from parts.
        known.extend(["picture.wgsl", "kept.wgsl"]);
        files.sort();
        known.sort_unstable();
        assert_eq!(files, known);
    }
}
