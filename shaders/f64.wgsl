// The number type f64. Only + - * / abs round sqrt are used: the language's other functions compile
// to garbage for it (wgpu issue 6087).

alias Real = f64;

const PI = 3.141592653589793lf;

fn real(x: f32) -> Real {
    return f64(x);
}

fn rough(x: Real) -> f32 {
    return f32(x);
}

fn from_parts(parts: vec2<f32>) -> Real {
    return f64(parts.x) + f64(parts.y);
}

fn to_parts(x: Real) -> vec2<f32> {
    let high = f32(x);
    return vec2<f32>(high, f32(x - f64(high)));
}

fn finite(x: Real) -> bool {
    return (bitcast<u32>(f32(x)) & 0x7f800000u) != 0x7f800000u;
}
