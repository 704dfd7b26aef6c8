// The mean of the samples of every pixel.

@group(0) @binding(0) var samples: texture_2d<f32>;
@group(0) @binding(1) var<uniform> pixels: Pixels;

struct Pixels {
    /// Samples along a side of a pixel.
    grid: i32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

@fragment
fn downsample(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let corner = vec2i(position.xy) * pixels.grid;
    var sum = vec4f(0.0);
    for (var i = 0; i < pixels.grid * pixels.grid; i++) {
        sum += textureLoad(samples, corner + vec2i(i % pixels.grid, i / pixels.grid), 0);
    }
    return sum / f32(pixels.grid * pixels.grid);
}
