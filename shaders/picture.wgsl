// Draws the samples of tiles through a colour table.
//
// A tile lies in a slot of an atlas, or in the slot's upper left as long as only some samples are
// known. Each sample is one packed word: the value of its time or the colour of another answer, how
// sure it is, and its status (counterpart: crates/screen/src/canvas/sample.rs). Each quad says
// which part of a slot is drawn where, and how much it covers what is beneath. Between samples, the
// light of the four nearest is mixed, at most over a few pixels; where many samples lie in a pixel, the light of all of them.
// Times are never mixed, because the mean of two flip times is the time of no pendulum.

struct Canvas {
    // The number in a word stands for a value, the logarithm of a time or its height on the colour
    // scale. These are the value of the number 0 and the step from one number to the next.
    value_bias: f32,
    value_step: f32,
    // The value of the table's first entry, and table entries per unit.
    first_value: f32,
    entries_per_unit: f32,
    // Answers with later values are not shown.
    until_value: f32,
    // 1 if uncertain samples are hatched.
    trust: u32,
    // 1 if words hold colours instead of times.
    coloured: u32,
    // Share of the light that comes from the side; if there is any, values are heights.
    relief: f32,
    // Linear light of samples that have no time.
    unflipped: vec4<f32>,
    forbidden: vec4<f32>,
    failed: vec4<f32>,
    // The direction to the light from the side, and the number of pixels from the left of the map
    // to its right.
    toward: vec4<f32>,
}

struct Quad {
    @location(0) corner: vec2<f32>,
    @location(1) right: vec2<f32>,
    @location(2) down: vec2<f32>,
    @location(3) texel: vec2<f32>,
    @location(4) span: vec2<f32>,
    @location(5) side: f32,
    @location(6) slot: u32,
    @location(7) alpha: f32,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) texel: vec2<f32>,
    // The slot's first sample in its layer, and the layer.
    @location(1) @interpolate(flat) origin: vec2<f32>,
    @location(2) @interpolate(flat) layer: i32,
    @location(3) @interpolate(flat) alpha: f32,
    // Samples along a side of the slot.
    @location(4) @interpolate(flat) side: f32,
}

@group(0) @binding(0) var<uniform> canvas: Canvas;
@group(0) @binding(1) var atlas: texture_2d_array<u32>;
@group(0) @binding(2) var table: texture_2d<f32>;
// Samples the nearest texel, never beyond the edge.
@group(0) @binding(3) var nearest: sampler;

// True if colours have to be encoded for the target here.
override ENCODE: bool = true;
// Largest number of places along a pixel whose light is mixed where samples are many.
override MAX_TAPS: u32 = 1u;

const SIDE: i32 = 64;
// Slots along a side of a layer of the atlas.
const SLOTS_ALONG: u32 = 16u;
const TABLE_ENTRIES: f32 = 8192.0;
const UNCERTAIN: u32 = 4u;
// Number of samples along a pixel above which all of them are mixed. There are fewer at the view's
// own level, unless the view is stretched.
const MANY: f32 = 1.35;
// Number of pixels over which neighbouring samples are mixed at most. Over the whole of a sample
// that fills the view, as in a fast zoom, the mixture would be a colour that no pendulum has.
const MIXED_PX: f32 = 16.0;

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
    out.alpha = quad.alpha;
    out.side = quad.side;
    return out;
}

// Linear light of a colour in sRGB (IEC 61966-2-1), eight bits a channel.
fn decoded(rgb: u32) -> vec3<f32> {
    let bytes = vec3<u32>((rgb >> 16u) & 255u, (rgb >> 8u) & 255u, rgb & 255u);
    let c = vec3<f32>(bytes) / 255.0;
    let high = pow((c + 0.055) / 1.055, vec3<f32>(2.4));
    return select(high, c / 12.92, c <= vec3<f32>(0.04045));
}

fn value_of(word: u32) -> f32 {
    return f32(word >> 5u) * canvas.value_step + canvas.value_bias;
}

fn light_of(word: u32) -> vec3<f32> {
    let status = word & 3u;
    let value = value_of(word);
    if status == FORBIDDEN {
        return canvas.forbidden.rgb;
    }
    if status == FAILED {
        return canvas.failed.rgb;
    }
    if canvas.coloured == 1u && status == ANSWERED {
        return decoded(word >> 5u);
    }
    if status != ANSWERED || value > canvas.until_value {
        return canvas.unflipped.rgb;
    }
    let entry = (value - canvas.first_value) * canvas.entries_per_unit + 0.5;
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

// The factor of the light at a place among four samples, anticlockwise from the lower left
// (counterpart: crates/scene/src/palette/relief.rs). `texel_x` and `texel_y` are the derivatives of
// the texel along the screen.
fn relief_of(words: vec4<u32>, part: vec2<f32>, texel_x: vec2<f32>, texel_y: vec2<f32>) -> f32 {
    if any((words & vec4<u32>(3u)) != vec4<u32>(ANSWERED)) {
        return 1.0;
    }
    let h = vec4<f32>(value_of(words.x), value_of(words.y), value_of(words.z), value_of(words.w));
    // Rows of texels run down the tile, which is the direction of rising rows.
    let across = mix(h.z - h.w, h.y - h.x, part.y);
    let down = mix(h.x - h.w, h.y - h.z, part.x);
    let most = max(max(abs(h.z - h.w), abs(h.y - h.x)), max(abs(h.x - h.w), abs(h.y - h.z)));
    let calm = clamp(1.0 - most / EDGE, 0.0, 1.0);
    let rise = vec2<f32>(across, down);
    // Rise over the map from left to right if the slope were the same everywhere, and over the same
    // distance upwards.
    let slope = canvas.toward.w * STEEPNESS * vec2<f32>(dot(rise, texel_x), -dot(rise, texel_y));
    let light = canvas.toward.xyz;
    let facing = (light.z - dot(light.xy, slope)) * inverseSqrt(1.0 + dot(slope, slope)) / light.z;
    return 1.0 + canvas.relief * calm * calm * (3.0 - 2.0 * calm) * (max(facing, 0.0) - 1.0);
}

// The four samples around a place, anticlockwise from the lower left, and the distance of the place
// from the upper left one. Beyond the middle of its outermost samples, a tile has no neighbours to
// mix.
struct Around {
    words: vec4<u32>,
    part: vec2<f32>,
}

fn around(in: Fragment, texel: vec2<f32>) -> Around {
    let place = clamp(texel, vec2<f32>(0.5), vec2<f32>(in.side - 0.5)) - 0.5;
    let first = min(floor(place), vec2<f32>(in.side - 2.0));
    let corner = (in.origin + first + 1.0) / f32(SIDE * i32(SLOTS_ALONG));
    return Around(textureGather(0, atlas, nearest, corner, in.layer), place - first);
}

fn nearest_word(at: Around) -> u32 {
    let above = select(at.words.wx, at.words.zy, at.part.x >= 0.5);
    return select(above.x, above.y, at.part.y >= 0.5);
}

// The mean light of `taps` places along the two sides of the pixel's parallelogram of samples.
fn mean_light(in: Fragment, taps: vec2<u32>, texel_x: vec2<f32>, texel_y: vec2<f32>) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    let share = 1.0 / vec2<f32>(taps);
    for (var row = 0u; row < taps.y; row += 1u) {
        for (var column = 0u; column < taps.x; column += 1u) {
            let away = (vec2<f32>(f32(column), f32(row)) + 0.5) * share - 0.5;
            let at = around(in, in.texel + away.x * texel_x + away.y * texel_y);
            var light = light_of(nearest_word(at));
            if canvas.relief > 0.0 {
                light *= relief_of(at.words, at.part, texel_x, texel_y);
            }
            sum += light;
        }
    }
    return sum * (share.x * share.y);
}

@fragment
fn colour_of(in: Fragment) -> @location(0) vec4<f32> {
    let texel_x = dpdx(in.texel);
    let texel_y = dpdy(in.texel);
    let at = around(in, in.texel);
    let along = vec2<f32>(
        max(abs(texel_x.x), abs(texel_x.y)),
        max(abs(texel_y.x), abs(texel_y.y))
    );
    var light: vec3<f32>;
    if MAX_TAPS > 1u && any(along > vec2<f32>(MANY)) {
        let taps = clamp(vec2<u32>(ceil(along)), vec2<u32>(1u), vec2<u32>(MAX_TAPS));
        light = mean_light(in, taps, texel_x, texel_y);
    } else {
        let sharpness = max(1.0, 1.0 / (MIXED_PX * max(max(along.x, along.y), 1e-12)));
        let part = clamp((at.part - 0.5) * sharpness + 0.5, vec2<f32>(0.0), vec2<f32>(1.0));
        let upper = mix(light_of(at.words.w), light_of(at.words.z), part.x);
        let lower = mix(light_of(at.words.x), light_of(at.words.y), part.x);
        light = mix(upper, lower, part.y);
        if canvas.relief > 0.0 {
            light *= relief_of(at.words, at.part, texel_x, texel_y);
        }
    }
    let word = nearest_word(at);
    if canvas.trust == 1u && ((word >> 2u) & 7u) == UNCERTAIN {
        // Hatched, so that doubt is not shown by colour alone.
        let stripe = (i32(in.position.x) + i32(in.position.y)) % 6 < 3;
        light = select(vec3<f32>(1.0, 0.0, 0.6), vec3<f32>(0.0), stripe);
    }
    light = min(light, vec3<f32>(1.0));
    return vec4<f32>(select(light, encoded(light), ENCODE), in.alpha);
}
