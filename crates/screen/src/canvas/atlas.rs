//! The assignment of tiles to slots of the graphics card's atlas. Independent of any graphics API.

use std::collections::HashMap;

/// Number of slots along a side of a layer (counterpart in shaders/picture.wgsl).
pub(crate) const SLOTS_ALONG: u32 = 16;
/// Number of slots in a layer.
pub(crate) const SLOTS_IN_LAYER: u32 = SLOTS_ALONG * SLOTS_ALONG;

/// Slots by the serial numbers of the samples in them; the least recently used is evicted first.
#[derive(Debug)]
pub(crate) struct Atlas {
    slots: HashMap<u64, AtlasSlot>,
    free: Vec<u32>,
    frame: u64,
}

#[derive(Clone, Copy, Debug)]
struct AtlasSlot {
    index: u32,
    used: u64,
}

/// The slot of some samples, and whether they are already in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AtlasPlace {
    /// The samples are already in this slot.
    There(u32),
    /// The samples must first be uploaded to this slot.
    New(u32),
}

impl Atlas {
    /// Creates an empty atlas of `layers` layers.
    pub(crate) fn new(layers: u32) -> Self {
        let free = (0..layers * SLOTS_IN_LAYER).rev().collect();
        Atlas { slots: HashMap::new(), free, frame: 0 }
    }

    /// Begins a new frame: slots used from now on are not evicted before the next one.
    pub(crate) fn begin_frame(&mut self) {
        self.frame += 1;
    }

    /// Returns a slot for the samples with this serial number; none if this frame uses all slots.
    pub(crate) fn place(&mut self, serial: u64) -> Option<AtlasPlace> {
        if let Some(slot) = self.slots.get_mut(&serial) {
            slot.used = self.frame;
            return Some(AtlasPlace::There(slot.index));
        }
        let index = self.free.pop().or_else(|| self.evict())?;
        self.slots.insert(serial, AtlasSlot { index, used: self.frame });
        Some(AtlasPlace::New(index))
    }

    fn evict(&mut self) -> Option<u32> {
        let idle = self.slots.iter().filter(|(_, slot)| slot.used < self.frame);
        let (&serial, slot) = idle.min_by_key(|(serial, slot)| (slot.used, **serial))?;
        let index = slot.index;
        self.slots.remove(&serial);
        Some(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_keep_their_slot_until_it_is_needed() {
        let mut atlas = Atlas::new(1);
        atlas.begin_frame();
        let first = atlas.place(5000);
        assert_eq!(first, Some(AtlasPlace::New(0)));
        (1..SLOTS_IN_LAYER.into()).for_each(|serial| assert!(atlas.place(serial).is_some()));
        assert_eq!(atlas.place(999), None, "all are in use");
        atlas.begin_frame();
        assert_eq!(atlas.place(5000), Some(AtlasPlace::There(0)));
        let Some(AtlasPlace::New(slot)) = atlas.place(999) else { panic!("none given away") };
        assert_ne!(slot, 0, "in use in this frame");
        assert_eq!(atlas.place(1), Some(AtlasPlace::New(2)), "1 was the longest unused");
    }
}
