//! Sizes of pictures in words: two side lengths, or the name of a screen.

use flipmap_scene::in_a_row;

/// Sizes with names, in pixels.
pub(super) const NAMED: [(&str, [u32; 2]); 6] = [
    ("720p", [1280, 720]),
    ("1080p", [1920, 1080]),
    ("1440p", [2560, 1440]),
    ("2160p", [3840, 2160]),
    ("4k", [3840, 2160]),
    ("8k", [7680, 4320]),
];

/// Returns the names of sizes as alternatives.
pub(super) fn names() -> String {
    in_a_row(&NAMED.map(|(name, _)| name), "or")
}

/// Returns the accepted forms of a size, for messages.
pub(super) fn ways() -> String {
    format!("WIDTHxHEIGHT, or {}", names())
}

/// Parses two side lengths with an x between them, or the name of a screen's size.
pub(super) fn parse(text: &str) -> Option<[u32; 2]> {
    let text = text.to_ascii_lowercase();
    let named = NAMED.iter().find(|(name, _)| *name == text).map(|(_, size)| *size);
    let sides = || {
        let (width, height) = text.split_once(['x', '×'])?;
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    };
    named.or_else(sides)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_given_by_their_sides_or_by_name() {
        for text in ["1920x1080", "1920X1080", "1920 × 1080", "1080p", "1080P"] {
            assert_eq!(parse(text), Some([1920, 1080]), "{text}");
        }
        assert_eq!(parse("4K"), Some([3840, 2160]));
        for bad in ["", "x", "1080", "1080px", "-1x5", "5k", "10x10x10"] {
            assert_eq!(parse(bad), None, "{bad}");
        }
    }
}
