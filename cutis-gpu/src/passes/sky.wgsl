// What a ray sees that meets nothing: the environment where it is visible, a backdrop, or nothing.

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> environment: Environment;
@group(0) @binding(2) var sky: texture_2d<f32>;
@group(0) @binding(3) var around_sky: sampler;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn cover_picture(@builtin(vertex_index) index: u32) -> Corner {
    let place = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    return Corner(vec4f(place, 1.0, 1.0), place);
}

@fragment
fn see_sky(corner: Corner) -> @location(0) vec4f {
    let dir = normalize(camera.forward + camera.right * corner.place.x + camera.up * corner.place.y);
    let radiance = textureSampleLevel(sky, around_sky, latlong_uv(environment, dir), 0.0).rgb;
    return vec4f(radiance * environment.radiance_scale, 1.0);
}
