// Draws the samples of tiles through a colour table.
//
// A tile lies in a slot of an atlas, one packed word per sample: the logarithm of the time or the
// colour of another answer, how sure it is, and the status (counterpart: src/app/canvas/sample.rs). Quads say which part of which
// slot goes where. Between samples the light of the four nearest is mixed, never their times: the
// mean of two flip times is the time of no pendulum.

struct Canvas {
    // log2 of the seconds at the table's beginning, and table entries per doubling of the time.
    first_log2: f32,
    entries_per_octave: f32,
    // log2 of the simulated seconds: later flips are not shown.
    budget_log2: f32,
    // 1 if uncertain samples are hatched.
    trust: u32,
    // 1 if words hold colours instead of times.
    coloured: u32,
    // Linear light of samples that have no time.
    unflipped: vec4<f32>,
    forbidden: vec4<f32>,
    failed: vec4<f32>,
}

struct Quad {
    @location(0) corner: vec2<f32>,
    @location(1) right: vec2<f32>,
    @location(2) down: vec2<f32>,
    @location(3) texel: vec2<f32>,
    @location(4) span: vec2<f32>,
    @location(5) slot: u32,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) texel: vec2<f32>,
    // The slot's first sample in its layer, and the layer.
    @location(1) @interpolate(flat) origin: vec2<f32>,
    @location(2) @interpolate(flat) layer: i32,
}

@group(0) @binding(0) var<uniform> canvas: Canvas;
@group(0) @binding(1) var atlas: texture_2d_array<u32>;
@group(0) @binding(2) var table: texture_2d<f32>;
// Samples the nearest texel, never beyond the edge.
@group(0) @binding(3) var nearest: sampler;

// True if the target needs its colours encoded here.
override ENCODE: bool = true;

const SIDE: i32 = 128;
// Slots along a side of a layer of the atlas.
const SLOTS_ALONG: u32 = 8u;
const TABLE_ENTRIES: f32 = 2048.0;
const UNCERTAIN: u32 = 4u;
// Logarithms are counted from 2^-32 s, in steps of 2^-21.
const LOG_BIAS: f32 = 32.0;
const LOG_STEP: f32 = 4.76837158203125e-7;

@vertex
fn corner_of(quad: Quad, @builtin(vertex_index) index: u32) -> Fragment {
    let uv = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    var out: Fragment;
    out.position = vec4<f32>(quad.corner + uv.x * quad.right + uv.y * quad.down, 0.0, 1.0);
    out.texel = quad.texel + uv * quad.span;
    let in_layer = quad.slot % (SLOTS_ALONG * SLOTS_ALONG);
    let place = vec2<u32>(in_layer % SLOTS_ALONG, in_layer / SLOTS_ALONG);
    out.origin = vec2<f32>(place) * f32(SIDE);
    out.layer = i32(quad.slot / (SLOTS_ALONG * SLOTS_ALONG));
    return out;
}

// Linear light of a colour in sRGB (IEC 61966-2-1), eight bits a channel.
fn decoded(rgb: u32) -> vec3<f32> {
    let bytes = vec3<u32>((rgb >> 16u) & 255u, (rgb >> 8u) & 255u, rgb & 255u);
    let c = vec3<f32>(bytes) / 255.0;
    let high = pow((c + 0.055) / 1.055, vec3<f32>(2.4));
    return select(high, c / 12.92, c <= vec3<f32>(0.04045));
}

fn light_of(word: u32) -> vec3<f32> {
    let status = word & 3u;
    let log2_secs = f32(word >> 5u) * LOG_STEP - LOG_BIAS;
    if status == FORBIDDEN {
        return canvas.forbidden.rgb;
    }
    if status == FAILED {
        return canvas.failed.rgb;
    }
    if canvas.coloured == 1u && status == FLIPPED {
        return decoded(word >> 5u);
    }
    if status != FLIPPED || log2_secs > canvas.budget_log2 {
        return canvas.unflipped.rgb;
    }
    let entry = (log2_secs - canvas.first_log2) * canvas.entries_per_octave + 0.5;
    return textureSampleLevel(table, nearest, vec2<f32>(entry / TABLE_ENTRIES, 0.5), 0.0).rgb;
}

// sRGB's curve (IEC 61966-2-1) from square roots, which graphics processors have: off by at most
// 0.02 of 255 steps.
fn encoded(light: vec3<f32>) -> vec3<f32> {
    let root2 = sqrt(light);
    let root4 = sqrt(root2);
    let root8 = sqrt(root4);
    let high = 0.644560 * root2 + 0.709946 * root4 - 0.336052 * root8 - 0.018486 * light;
    return select(high, light * 12.92, light <= vec3<f32>(0.0031308));
}

@fragment
fn colour_of(in: Fragment) -> @location(0) vec4<f32> {
    // Beyond the middle of its outermost samples a tile has no neighbours to mix.
    let place = clamp(in.texel, vec2<f32>(0.5), vec2<f32>(f32(SIDE) - 0.5)) - 0.5;
    let first = floor(place);
    let part = place - first;
    // The four samples around the corner that they share, anticlockwise from the lower left.
    let corner = (in.origin + first + 1.0) / f32(SIDE * i32(SLOTS_ALONG));
    let words = textureGather(0, atlas, nearest, corner, in.layer);
    let upper = mix(light_of(words.w), light_of(words.z), part.x);
    let lower = mix(light_of(words.x), light_of(words.y), part.x);
    var light = mix(upper, lower, part.y);
    let above = select(words.wx, words.zy, part.x >= 0.5);
    let word = select(above.x, above.y, part.y >= 0.5);
    if canvas.trust == 1u && ((word >> 2u) & 7u) == UNCERTAIN {
        // Hatched, so that doubt is not shown by colour alone.
        let stripe = (i32(in.position.x) + i32(in.position.y)) % 6 < 3;
        light = select(vec3<f32>(1.0, 0.0, 0.6), vec3<f32>(0.0), stripe);
    }
    return vec4<f32>(select(light, encoded(light), ENCODE), 1.0);
}
