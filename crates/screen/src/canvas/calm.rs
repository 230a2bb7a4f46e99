//! The kept picture without its grain. Once the map rests, a thread of its own reads the picture
//! back from the card and denoises it like a picture that is written to a file.

use std::thread::JoinHandle;
use std::time::Duration;

use super::copied::CopiedPicture;
use super::kept::{KeptPicture, KeptTarget};
use flipmap_engine::clock::Instant;
use flipmap_render::Denoiser;
use flipmap_scene::palette::{Ground, Rgb};

/// The denoised picture of a map at rest.
#[derive(Default)]
pub(crate) struct CalmPicture {
    /// Version of the kept picture that was last read back, and its pixels while they are computed.
    asked: Option<(u64, Option<Pixels>)>,
    /// The moment from which on another picture may be denoised.
    free_at: Option<Instant>,
    shown: Option<KeptTarget>,
}

/// Denoised pixels that a thread computes, four bytes each; none if the card did not answer.
type Pixels = JoinHandle<Option<Vec<u8>>>;

/// Time between two pictures while finer samples come in, so that these have the processor.
const PAUSE: Duration = Duration::from_secs(2);

impl CalmPicture {
    /// Denoises the kept picture if it rests on a ground, and forgets all pictures if it moves or is
    /// to keep its grain. Returns true if this version has been denoised, or cannot be.
    pub(crate) fn follow(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        kept: &KeptPicture,
        ground: Option<Ground>,
    ) -> bool {
        let Some(ground) = ground else {
            *self = CalmPicture::default();
            return false;
        };
        self.receive(device, queue, kept);
        self.ask(device, queue, kept, ground);
        matches!(&self.asked, Some((asked, None)) if *asked == kept.version())
    }

    /// Returns what is to be shown in place of the kept picture, if anything. It may show an
    /// earlier version, with coarser samples, until the latest one is denoised.
    pub(crate) fn shown(&self) -> Option<&KeptTarget> {
        self.shown.as_ref()
    }

    /// Begins to denoise the kept picture, unless that has been done or another one is being
    /// denoised.
    fn ask(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        kept: &KeptPicture,
        ground: Ground,
    ) {
        let version = kept.version();
        let busy = matches!(&self.asked, Some((_, Some(_))));
        let now = Instant::now();
        if busy || self.free_at.is_some_and(|free_at| now < free_at) {
            return;
        }
        if self.asked.as_ref().is_some_and(|(asked, _)| *asked == version) {
            return;
        }
        self.free_at = Some(now + PAUSE);
        let pixels = read_back(device, queue, kept, ground);
        self.asked = Some((version, pixels));
    }

    /// Takes the picture that has been denoised, if there is one.
    fn receive(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, kept: &KeptPicture) {
        let Some((_, pixels)) = &mut self.asked else { return };
        if let Some(finished) = pixels.take_if(|pixels| pixels.is_finished())
            && let Ok(Some(bytes)) = finished.join()
        {
            self.shown = kept.target_with(device, queue, &bytes);
        }
    }
}

/// Copies the kept picture into memory and denoises it on a thread of its own. `None` if there is
/// no picture, or its pixels have a format that is not one of four bytes.
fn read_back(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    kept: &KeptPicture,
    ground: Ground,
) -> Option<Pixels> {
    let copied = CopiedPicture::begin(device, queue, kept.target()?)?;
    let (width, is_reversed) = (copied.size_px[0] as usize, copied.is_reversed);
    let denoise = move || Some(denoised(copied.bytes()?, width, ground, is_reversed));
    std::thread::Builder::new().name("denoise".into()).spawn(denoise).ok()
}

/// Denoises pixels of four bytes, whose red is last if they are `reversed`.
fn denoised(mut pixels: Vec<u8>, width: usize, ground: Ground, reversed: bool) -> Vec<u8> {
    let order = |[r, g, b]: Rgb| if reversed { [b, g, r] } else { [r, g, b] };
    let (places, _) = pixels.as_chunks_mut::<4>();
    let colours: Vec<Rgb> = places.iter().map(|&[r, g, b, _]| order([r, g, b])).collect();
    let denoised = Denoiser::new(width, &ground).colours(&colours);
    for (place, colour) in places.iter_mut().zip(denoised) {
        let [r, g, b] = order(colour);
        *place = [r, g, b, place[3]];
    }
    pixels
}
