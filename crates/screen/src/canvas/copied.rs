//! A picture of the map that is copied from the card into memory.

use std::time::Duration;

use super::kept::KeptTarget;
use flipmap_scene::palette::Rgb;

/// Longest time that the card may take to finish the frames before a picture is read back.
const PATIENCE: Duration = Duration::from_secs(10);
/// Alignment of the rows of a texture that is read back, in bytes.
const ROW_UNIT: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// A picture on its way from the card.
pub struct CopiedPicture {
    /// Width and height in pixels.
    pub size_px: [u32; 2],
    /// True if the red of a pixel is its third byte.
    pub(crate) is_reversed: bool,
    device: wgpu::Device,
    buffer: wgpu::Buffer,
    submission: wgpu::SubmissionIndex,
}

impl CopiedPicture {
    /// Begins to copy a picture; none if its pixels have a format that is not one of four bytes.
    pub(super) fn begin(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: &KeptTarget,
    ) -> Option<Self> {
        use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb};
        let (texture, size_px) = target.texture();
        let is_reversed = match texture.format() {
            Rgba8Unorm | Rgba8UnormSrgb => false,
            Bgra8Unorm | Bgra8UnormSrgb => true,
            _ => return None,
        };
        let row_bytes = row_bytes(size_px);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("copied picture"),
            size: u64::from(row_bytes) * u64::from(size_px[1]),
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
        Some(CopiedPicture { size_px, is_reversed, device: device.clone(), buffer, submission })
    }

    /// Waits for the picture and returns its pixels, four bytes each; none if the card does not
    /// answer.
    pub(super) fn bytes(self) -> Option<Vec<u8>> {
        let submission_index = Some(self.submission);
        let wait = wgpu::PollType::Wait { submission_index, timeout: Some(PATIENCE) };
        self.device.poll(wait).ok()?;
        let bytes = self.buffer.slice(..).get_mapped_range().ok()?;
        let row = 4 * self.size_px[0] as usize;
        let rows = bytes.chunks(row_bytes(self.size_px) as usize).flat_map(|bytes| &bytes[..row]);
        Some(rows.copied().collect())
    }

    /// Waits for the picture and returns its colours; none if the card does not answer.
    pub fn colours(self) -> Option<Vec<Rgb>> {
        let is_reversed = self.is_reversed;
        let bytes = self.bytes()?;
        let (pixels, _) = bytes.as_chunks::<4>();
        let order = |[a, b, c, _]: [u8; 4]| if is_reversed { [c, b, a] } else { [a, b, c] };
        Some(pixels.iter().copied().map(order).collect())
    }
}

/// Returns the bytes from one row to the next in the copy of a picture.
fn row_bytes([width, _]: [u32; 2]) -> u32 {
    (4 * width).next_multiple_of(ROW_UNIT)
}
