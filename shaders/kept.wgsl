// Shows the kept picture of the map, pixel by pixel.

@group(0) @binding(0) var kept: texture_2d<f32>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
}

// A triangle that covers the viewport.
@vertex
fn corner_of(@builtin(vertex_index) index: u32) -> Fragment {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0;
    var out: Fragment;
    out.position = vec4<f32>(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
    out.place = corner;
    return out;
}

@fragment
fn colour_of(in: Fragment) -> @location(0) vec4<f32> {
    let size = vec2<f32>(textureDimensions(kept));
    return textureLoad(kept, vec2<i32>(in.place * size), 0);
}
