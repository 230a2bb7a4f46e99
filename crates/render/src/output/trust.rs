//! A picture that shows how far each pixel can be trusted.

use crate::tiles::Samples;
use flipmap_engine::Trust;
use flipmap_pendulum::Status;
use flipmap_scene::palette::{Ground, Rgb};

/// Colours by trust: dark for answers that a cheap check confirmed, brighter for those that took
/// more, red for those that stay open. The order holds in grey too.
const COLOURS: [(Trust, Rgb); 5] = [
    (Trust::Unchecked, [0x60, 0x60, 0x60]),
    (Trust::Agreed, [0x10, 0x28, 0x40]),
    (Trust::Confirmed, [0x2a, 0x6f, 0x97]),
    (Trust::Settled, [0xf2, 0xc1, 0x4e]),
    (Trust::Uncertain, [0xff, 0x30, 0x20]),
];

/// Returns the RGB bytes of samples by their trust; forbidden samples have their colour on a light
/// ground.
pub(crate) fn trust_colours(samples: &Samples) -> Vec<u8> {
    let colour = |(index, status): (usize, Status)| match status {
        Status::Forbidden => Ground::LIGHT.forbidden,
        _ => COLOURS[samples.trust(index) as usize].1,
    };
    samples.iter().map(|outcome| outcome.status).enumerate().flat_map(colour).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Outcome;

    #[test]
    fn every_trust_has_a_colour_of_its_own_in_its_place() {
        let mut samples = Samples::unflipped(6);
        for (index, (_, trust)) in Trust::ALL.into_iter().enumerate() {
            assert_eq!((COLOURS[index].0, trust as usize), (trust, index));
            samples.assure(index, trust);
        }
        samples.set(5, Outcome::without_time(Status::Forbidden));
        let bytes = trust_colours(&samples);
        let mut colours: Vec<&[u8]> = bytes.chunks(3).collect();
        assert_eq!(colours[4], [0xff, 0x30, 0x20]);
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), 6);
    }
}
