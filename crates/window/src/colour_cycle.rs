//! The palette running over the map, round and round.

use flipmap_scene::PictureTable;
use flipmap_scene::palette::Palette;

/// Times a second that the palette can come round.
pub(crate) const CYCLE_SPEEDS: std::ops::RangeInclusive<f64> = 0.02..=1.0;

/// The animation of the palette's offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourCycle {
    /// True while the palette runs.
    pub runs: bool,
    /// Times a second that it comes round.
    pub speed: f64,
}

impl Default for ColourCycle {
    fn default() -> Self {
        ColourCycle { runs: false, speed: 0.1 }
    }
}

impl ColourCycle {
    /// Moves the palette of a picture on; a palette that has ends is mirrored, so that none is seen.
    pub(crate) fn advance(&self, picture: &mut PictureTable, elapsed_secs: f64) {
        if self.runs {
            picture.mirror |= !Palette::is_cyclic(&picture.palette);
            picture.offset = (picture.offset + self.speed * elapsed_secs).fract();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_palette_comes_round_without_a_seam() {
        let mut picture = PictureTable::default();
        let mut cycle = ColourCycle { runs: false, speed: 0.25 };
        cycle.advance(&mut picture, 1.0);
        assert_eq!(picture, PictureTable::default(), "it stands");
        cycle.runs = true;
        for _ in 0..5 {
            cycle.advance(&mut picture, 1.0);
        }
        assert!((picture.offset - 0.25).abs() < 1e-12 && picture.mirror);
        let mut cyclic = PictureTable { palette: Palette::CYCLIC.into(), ..Default::default() };
        cycle.advance(&mut cyclic, 1.0);
        assert!(!cyclic.mirror && cyclic.offset == 0.25);
    }
}
