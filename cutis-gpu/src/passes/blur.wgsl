// One blur step along one axis of the texture, its width corrected by the local stretch
// (d'Eon, Luebke & Enderton 2007, sections 5.1 and 5.4). The twin of cutis-render's `blur`, texel by texel.
//
// Three layouts of seven taps, one loop: taps on neighbouring texels are read as they are, spaced ones by linear or cubic
// interpolation. No tap leaves the texel's own chart.

@group(0) @binding(1) var<uniform> widening: Widening;
@group(0) @binding(2) var charts: texture_2d<u32>;
@group(0) @binding(3) var light: texture_2d_array<f32>;
@group(0) @binding(4) var stretch_map: texture_2d<f32>;
/// Spacings, discrete variances, then weights of cells: see `Taps` in cutis-render.
@group(0) @binding(5) var<storage, read> tables: array<f32>;

struct Widening {
    from_mm2: f32,
    to_mm2: f32,
    saved_texel2: f32,
    /// Deviation in texels at the end of the table of spacings.
    max_deviation: f32,
    /// Weight of the centre and of one tap at each distance.
    weights: vec4f,
    /// Variance of the weights at spacing 1, texel².
    unit_variance: f32,
    /// 0 along u, 1 along v.
    axis: u32,
    /// Layer of the light that is blurred.
    layer: u32,
    pad0: u32,
}

struct Blurred {
    @location(0) light: vec4f,
    @location(1) stretch: vec4f,
}

const SPACINGS: u32 = 4096u;
const VARIANCES: u32 = 512u;
const WIDEST_CELLS_TEXEL2: f32 = 1.25;
const NARROW_TEXEL2: f32 = 1.0;
const RAW_TEXEL2: f32 = 0.06;
const CUBIC_SPACING: f32 = 4.0;
const CUBIC_TEXEL2: f32 = 3.0;
const FARTHEST: f32 = 20.0;

/// Where the taps of one texel lie.
struct Reads {
    /// Texels that one tap is interpolated from; 0 if only the texel itself is read.
    per_tap: u32,
    /// Weight of the centre and of one tap at each distance.
    weights: vec4f,
    /// Distances in texels of the taps ahead and behind.
    near: vec3f,
    far: vec3f,
}

fn step_texels() -> vec2i {
    return select(vec2i(1, 0), vec2i(0, 1), widening.axis == 1u);
}

fn texel_mm_at(texel: vec2i) -> f32 {
    return textureLoad(stretch_map, texel, 0)[widening.axis];
}

fn interpolated(first: u32, count: u32, x: f32) -> f32 {
    let place = clamp(x, 0.0, f32(count - 1u));
    let i = min(u32(place), count - 2u);
    return mix(tables[first + i], tables[first + i + 1u], place - f32(i));
}

fn discrete_variance(variance_texel2: f32) -> f32 {
    if variance_texel2 >= NARROW_TEXEL2 {
        return variance_texel2 + 1.0 / 12.0;
    }
    return interpolated(SPACINGS, VARIANCES, variance_texel2 / NARROW_TEXEL2 * f32(VARIANCES - 1u));
}

fn linear_spacing(variance_texel2: f32) -> f32 {
    let deviation = sqrt(max(variance_texel2, 0.0));
    return interpolated(0u, SPACINGS, deviation / widening.max_deviation * f32(SPACINGS - 1u));
}

fn cell_weights(variance_texel2: f32) -> vec4f {
    let place = clamp(variance_texel2 / WIDEST_CELLS_TEXEL2, 0.0, 1.0) * f32(VARIANCES - 1u);
    let i = min(u32(place), VARIANCES - 2u);
    let first = SPACINGS + VARIANCES + 4u * i;
    let a = vec4f(tables[first], tables[first + 1u], tables[first + 2u], tables[first + 3u]);
    let b = vec4f(tables[first + 4u], tables[first + 5u], tables[first + 6u], tables[first + 7u]);
    return mix(a, b, place - f32(i));
}

/// What one texel reads. Towards a seam its taps come closer.
fn of_texel(texel: vec2i, reach: f32) -> Reads {
    let own = Reads(0u, vec4f(1.0, 0.0, 0.0, 0.0), vec3f(0.0), vec3f(0.0));
    let texel_mm = texel_mm_at(texel);
    let from_texel2 = widening.from_mm2 / (texel_mm * texel_mm);
    let to_texel2 = widening.to_mm2 / (texel_mm * texel_mm);
    if from_texel2 < RAW_TEXEL2 && to_texel2 < WIDEST_CELLS_TEXEL2 && reach >= 3.0 {
        return Reads(1u, cell_weights(to_texel2), vec3f(1.0, 2.0, 3.0), vec3f(1.0, 2.0, 3.0));
    }
    let variance = discrete_variance(to_texel2) - discrete_variance(from_texel2) - widening.saved_texel2;
    let cubic_spacing = sqrt(max(variance, 0.0) / widening.unit_variance);
    var cubic = cubic_spacing < CUBIC_SPACING && from_texel2 < CUBIC_TEXEL2;
    var spacing = min(cubic_spacing, (reach - 1.0) / 3.0);
    if !cubic {
        spacing = min(linear_spacing(variance), reach / 3.0);
    }
    let room = reach - select(0.001, 1.001, cubic);
    if room <= 0.0 || spacing <= 0.0 {
        return own;
    }
    let near = min(distances(texel, texel_mm, spacing, room, 1), vec3f(room));
    let far = min(distances(texel, texel_mm, spacing, room, -1), vec3f(room));
    cubic = cubic && max(near.z, far.z) < FARTHEST - 2.0;
    return Reads(select(2u, 4u, cubic), widening.weights, near, far);
}

/// Distances in texels of three taps on one side, the same distance of surface apart.
fn distances(texel: vec2i, texel_mm: f32, spacing: f32, room: f32, side: i32) -> vec3f {
    var places = vec3f(0.0);
    var place = 0.0;
    for (var tap = 0; tap < 3; tap++) {
        let middle = i32(min((f32(tap) + 0.5) * spacing, room));
        place += spacing * texel_mm / texel_mm_at(texel + side * middle * step_texels());
        places[tap] = place;
    }
    return places;
}

/// Weights of interpolation between `per_tap` neighbours at the fraction `f`.
fn interpolation(per_tap: u32, f: f32) -> vec4f {
    if per_tap == 1u {
        return vec4f(1.0, 0.0, 0.0, 0.0);
    }
    if per_tap == 2u {
        return vec4f(1.0 - f, f, 0.0, 0.0);
    }
    let f2 = f * f;
    let f3 = f2 * f;
    // Catmull & Rom 1974, exact for parabolas.
    return vec4f(
        f2 - 0.5 * (f + f3),
        1.0 - 2.5 * f2 + 1.5 * f3,
        0.5 * f + 2.0 * f2 - 1.5 * f3,
        0.5 * (f3 - f2),
    );
}

fn gather(texel: vec2i, reads: Reads, side: i32, places: vec3f) -> Blurred {
    var sum = Blurred(vec4f(0.0), vec4f(0.0));
    // A cubic read begins one texel before the place.
    let lead = select(0, 1, reads.per_tap == 4u);
    let step = side * step_texels();
    for (var tap = 0; tap < select(3, 0, reads.per_tap == 0u); tap++) {
        let whole = floor(places[tap]);
        let weights = interpolation(reads.per_tap, places[tap] - whole);
        let weight = reads.weights[tap + 1];
        for (var j = 0; j < i32(reads.per_tap); j++) {
            let read = texel + (i32(whole) + j - lead) * step;
            sum.light += textureLoad(light, read, widening.layer, 0) * (weights[j] * weight);
        }
        sum.stretch += textureLoad(stretch_map, texel + i32(places[tap] + 0.5) * step, 0) * weight;
    }
    return sum;
}

fn blurred(texel: vec2i) -> Blurred {
    let own = textureLoad(charts, texel, 0).xy;
    if own.x == NO_CHART {
        return Blurred(vec4f(0.0), vec4f(0.0));
    }
    let reach = f32((own.y >> (8u * widening.axis)) & 255u);
    let reads = of_texel(texel, reach);
    let near = gather(texel, reads, 1, reads.near);
    let far = gather(texel, reads, -1, reads.far);
    let centre = reads.weights.x;
    return Blurred(
        textureLoad(light, texel, widening.layer, 0) * centre + near.light + far.light,
        textureLoad(stretch_map, texel, 0) * centre + near.stretch + far.stretch,
    );
}

@fragment
fn blur(@builtin(position) position: vec4f) -> Blurred {
    return blurred(vec2i(position.xy));
}

/// The same for a further layer, whose stretch is already blurred.
@fragment
fn blur_layer(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return blurred(vec2i(position.xy)).light;
}
