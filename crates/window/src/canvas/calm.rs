//! The kept picture without its grain. Once the map rests, a thread of its own reads the picture
//! back from the card and denoises it like a picture that is written to a file.

use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::kept::{KeptPicture, KeptTarget};
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
/// Longest time that the card may take to finish the frames before a picture is read back.
const PATIENCE: Duration = Duration::from_secs(10);
/// Alignment of the rows of a texture that is read back, in bytes.
const ROW_UNIT: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

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
    use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb};
    let (texture, [width, height]) = kept.texture()?;
    let reversed = match texture.format() {
        Rgba8Unorm | Rgba8UnormSrgb => false,
        Bgra8Unorm | Bgra8UnormSrgb => true,
        _ => return None,
    };
    let row_bytes = (4 * width).next_multiple_of(ROW_UNIT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("kept picture"),
        size: u64::from(row_bytes) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(row_bytes),
        rows_per_image: None,
    };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    let submission = queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    let device = device.clone();
    let denoise = move || {
        let submission_index = Some(submission);
        let wait = wgpu::PollType::Wait { submission_index, timeout: Some(PATIENCE) };
        device.poll(wait).ok()?;
        let bytes = buffer.slice(..).get_mapped_range().ok()?;
        let rows = bytes.chunks(row_bytes as usize).flat_map(|row| &row[..4 * width as usize]);
        let pixels: Vec<u8> = rows.copied().collect();
        Some(denoised(pixels, width as usize, ground, reversed))
    };
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
