// Where the taps of one blur step along one axis lie, by the local stretch, and the stretch blurred by them
// (d'Eon, Luebke & Enderton 2007, sections 5.1 and 5.4). The twin of cutis-render's `lines`. All of it follows from the
// geometry alone, and is done again only when that has changed; it changes slowly over the surface, so that half the size of
// the light will do. Texels are those of the light, unless they are called half ones.

@group(0) @binding(1) var<uniform> widening: Widening;
@group(0) @binding(2) var charts: texture_2d<u32>;
@group(0) @binding(3) var stretch_map: texture_2d<f32>;
/// What a Gaussian of a variance up to NARROW_TEXEL2 makes of one lit texel, as a variance: see `Taps` in cutis-render.
@group(0) @binding(4) var<storage, read> narrow: array<f32>;

struct Widening {
    from_mm2: f32,
    to_mm2: f32,
    saved_texel2: f32,
    /// Variance of the weights at spacing 1, texel².
    unit_variance: f32,
    /// Weight of the centre and of one tap at each distance.
    weights: vec4f,
    /// 0 along u, 1 along v.
    axis: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

struct Laid {
    /// Variance of the Gaussian ahead and behind, texel²: what `blur.wgsl` samples at every texel.
    @location(0) variance: vec2f,
    @location(1) stretch: vec2f,
}

const VARIANCES: u32 = 512u;
const NARROW_TEXEL2: f32 = 1.0;
/// What `blur.wgsl` leaves out, as a share of the variance, on the mean.
const LEFT_OUT: f32 = 0.005;
/// Variance in texel² below which a sampled Gaussian has noticeably less of it than its formula says.
const UNDERSAMPLED_TEXEL2: f32 = 0.6;

/// The stretch so many texels away, but not beyond the chart, which goes on for `reach` texels.
fn stretch_at(half_texel: vec2i, away: f32, reach: f32) -> vec2f {
    let step = select(vec2i(1, 0), vec2i(0, 1), widening.axis == 1u);
    return textureLoad(stretch_map, half_texel + i32(round(0.5 * clamp(away, -reach, reach))) * step, 0).xy;
}

fn discrete_variance(variance_texel2: f32) -> f32 {
    if variance_texel2 >= NARROW_TEXEL2 {
        return variance_texel2 + 1.0 / 12.0;
    }
    let place = clamp(variance_texel2 / NARROW_TEXEL2, 0.0, 1.0) * f32(VARIANCES - 1u);
    let i = min(u32(place), VARIANCES - 2u);
    return mix(narrow[i], narrow[i + 1u], place - f32(i));
}

/// Distances in texels of three taps on one side, the same distance of surface apart.
fn distances(half_texel: vec2i, texel_mm: f32, spacing: f32, reach: f32, side: f32) -> vec3f {
    let ahead = vec3f(0.5, 1.5, 2.5) * spacing * side;
    let axis = widening.axis;
    let a = spacing * texel_mm / stretch_at(half_texel, ahead.x, reach)[axis];
    let b = a + spacing * texel_mm / stretch_at(half_texel, ahead.y, reach)[axis];
    let c = b + spacing * texel_mm / stretch_at(half_texel, ahead.z, reach)[axis];
    return vec3f(a, b, c);
}

/// The variance whose Gaussian, sampled at whole texels, has the variance that is asked for.
fn sampled_variance(variance_texel2: f32) -> f32 {
    var v = max(variance_texel2, 1e-4) * (1.0 + LEFT_OUT);
    if variance_texel2 < UNDERSAMPLED_TEXEL2 {
        // Each round takes away three quarters of the error or more.
        for (var round = 0; round < 8; round++) {
            let q = exp(-0.5 / max(v, 0.02));
            let q4 = q * q * q * q;
            v += variance_texel2 - 2.0 * (q + 4.0 * q4) / (1.0 + 2.0 * (q + q4));
        }
    }
    return v;
}

@fragment
fn lay_taps(@builtin(position) position: vec4f) -> Laid {
    let half_texel = vec2i(position.xy);
    let own = textureLoad(charts, half_texel, 0).xy;
    if own.x == NO_CHART {
        return Laid(vec2f(0.0), vec2f(0.0));
    }
    let reach = 2.0 * f32((own.y >> (8u * widening.axis)) & 255u);
    let texel_mm = stretch_at(half_texel, 0.0, reach)[widening.axis];
    let texel2_mm2 = texel_mm * texel_mm;
    let wanted = discrete_variance(widening.to_mm2 / texel2_mm2) - discrete_variance(widening.from_mm2 / texel2_mm2)
        - widening.saved_texel2;
    let spacing = sqrt(max(wanted, 0.0) / widening.unit_variance);
    let near = distances(half_texel, texel_mm, spacing, reach, 1.0);
    let far = distances(half_texel, texel_mm, spacing, reach, -1.0);
    let weights = widening.weights;
    let stretch = stretch_at(half_texel, 0.0, reach) * weights.x
        + (stretch_at(half_texel, near.x, reach) + stretch_at(half_texel, -far.x, reach)) * weights.y
        + (stretch_at(half_texel, near.y, reach) + stretch_at(half_texel, -far.y, reach)) * weights.z
        + (stretch_at(half_texel, near.z, reach) + stretch_at(half_texel, -far.z, reach)) * weights.w;
    // The variance of the taps on either side, which lie evenly on the surface and not in the texture.
    let sides = 2.0 * vec2f(dot(weights.yzw, near * near), dot(weights.yzw, far * far));
    return Laid(vec2f(sampled_variance(sides.x), sampled_variance(sides.y)), stretch);
}
