//! The animation that cycles the palette over the map.

use flipmap_scene::PictureTable;
use flipmap_scene::palette::Palette;

/// Range of speeds of the palette, in cycles per second.
pub(crate) const CYCLE_SPEEDS: std::ops::RangeInclusive<f64> = 0.02..=1.0;

/// The animation of the palette's offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourCycle {
    /// True while the palette runs.
    pub runs: bool,
    /// Speed in cycles per second.
    pub speed: f64,
}

impl Default for ColourCycle {
    fn default() -> Self {
        ColourCycle { runs: false, speed: 0.1 }
    }
}

impl ColourCycle {
    /// Advances the palette of a picture. A palette that is not cyclic is mirrored, to hide its
    /// ends.
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
