//! The built-in scenes, colour tables, pages and letters of flipmap, as the files of this folder.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

macro_rules! places {
    ($($name:literal)*) => {
        /// The built-in scenes by their names as they are shown: from the whole map inwards, then
        /// the others.
        pub const SCENES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("scenes/", $name, ".toml")))),*];

        /// Small pictures of the built-in scenes as JPEG files, made by `scripts/gallery thumbs`.
        pub const THUMBS: &[(&str, &[u8])] =
            &[$(($name, include_bytes!(concat!("thumbs/", $name, ".jpg")))),*];
    };
}

places! {
    "home" "lesson" "filigree" "threads" "deep" "abyss" "trench" "seabed" "shore" "tip" "upright"
    "island" "either" "first" "rods" "heavy" "heyl" "moment" "islands" "turns" "section" "thrown"
    "damped"
}

macro_rules! palettes {
    ($($name:literal)*) => {
        /// The colour tables by their names: comments with source and licence, then 256 colours.
        pub const PALETTES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("palettes/", $name, ".txt")))),*];
    };
}

palettes! {
    "iris" "halo" "ember" "tide" "dusk" "batlow" "lipari" "viridis" "magma" "inferno" "plasma"
    "cividis" "turbo" "romao" "twilight"
}

/// The page that shows a pyramid of tiles: a minijinja template.
pub const PYRAMID_PAGE: &str = include_str!("pyramid/index.html");

/// The lesson as a page to print: a minijinja template.
pub const LESSON_SHEET: &str = include_str!("lesson/sheet.html");

/// Greek letters and the signs of powers of ten from Fira Sans Light, made by `scripts/greek-face`.
pub const GREEK_FACE: &[u8] = include_bytes!("faces/greek.ttf");

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of the files of a folder without their endings, but for notices of licences.
    fn files(folder: &str) -> Vec<String> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let stems = entries.map(|path| path.file_stem().unwrap().to_str().unwrap().to_string());
        let mut names: Vec<String> = stems.filter(|name| !name.starts_with("LICENSE")).collect();
        names.sort();
        names
    }

    fn sorted<T>(table: &[(&str, T)]) -> Vec<String> {
        let mut names: Vec<String> = table.iter().map(|(name, _)| name.to_string()).collect();
        names.sort();
        names
    }

    #[test]
    fn every_file_is_in_its_table() {
        assert_eq!(sorted(SCENES), files("scenes"));
        assert_eq!(sorted(THUMBS), files("thumbs"));
        assert_eq!(sorted(PALETTES), files("palettes"));
    }
}
