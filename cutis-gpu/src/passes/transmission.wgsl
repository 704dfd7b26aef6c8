// Light that comes through the body (d'Eon, Luebke & Enderton 2007, sections 5.2 and 5.4; equation 16 with exp(-d²/2v)), at
// half the size of the irradiance.
//
// Most of a body is opaque or lit: the thin places are marked first, and only tiles that hold some are drawn.

@group(0) @binding(1) var<uniform> slabs: Slabs;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
/// Charts at the size of the irradiance and at smaller ones.
@group(0) @binding(3) var charts: texture_2d<u32>;
@group(0) @binding(4) var levels: texture_2d_array<f32>;
@group(0) @binding(5) var places: texture_2d<u32>;
@group(0) @binding(6) var stretch_map: texture_2d<f32>;
@group(0) @binding(7) var depths: texture_2d_array<f32>;
@group(0) @binding(8) var surfaces: texture_2d_array<u32>;
@group(0) @binding(9) var shares: texture_2d_array<f32>;

struct Slab {
    weight: vec3f,
    variance_mm2: f32,
    /// Layer of its level, for the light.
    layer: u32,
    /// First layer of the level before, for the distance, and how often that one is halved.
    before_layer: u32,
    before_halvings: u32,
    pad0: u32,
}

struct Slabs {
    all: array<Slab, MAX_GAUSSIANS>,
    sizes: array<LevelSize, MAX_SIZES>,
    count: u32,
    size_count: u32,
    object: u32,
    /// 1 if every light has a share of its own.
    many_lights: u32,
}

const FADE_DEVIATIONS: f32 = 6.0;
const VISIBLE: f32 = 1e-6;
/// Light that is worth a closer look. Less than is visible, because it is told by the nearest texels.
const MARKED: f32 = 1e-8;

/// Where a texel of the map lies on the unrolled surface.
struct Under {
    chart: u32,
    texel: vec2i,
    atlas_uv: vec2f,
}

fn under(texel: vec2i) -> Under {
    let chart = textureLoad(charts, texel, 1).x;
    let fine = first_texel_under(charts, chart, 2 * texel);
    return Under(chart, fine, (vec2f(fine) + 0.5) / vec2f(textureDimensions(places)));
}

@vertex
fn cover_thin_tile(@builtin(vertex_index) corner: u32, @builtin(instance_index) tile: u32) -> @builtin(position) vec4f {
    return corner_of_thin_tile(corner, tile, 0);
}

@vertex
fn cover_marks(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
}

/// 1 where light may come through some of 4 × 4 texels.
@fragment
fn mark_thin(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let corner = vec2i(position.xy) * TEXELS_OF_MARK;
    var most = 0.0;
    var i = 0;
    loop {
        let texel = corner + vec2i(i % TEXELS_OF_MARK, i / TEXELS_OF_MARK);
        let chart = textureLoad(charts, texel, 1).x;
        let fine = first_texel_under(charts, chart, 2 * texel);
        var l = 0u;
        loop {
            most = max(most, select(most_through(l, fine), 0.0, chart == NO_CHART));
            continuing {
                l++;
                break if l >= arrayLength(&lights);
            }
        }
        continuing {
            i++;
            break if i >= TEXELS_OF_MARK * TEXELS_OF_MARK;
        }
    }
    return vec4f(select(0.0, 1.0, most > MARKED));
}

/// The most that any Gaussian lets through of a light, by the nearest texels; nothing where the light is faced.
fn most_through(l: u32, texel: vec2i) -> f32 {
    let component = component_of(l);
    let faces = textureLoad(levels, texel, layer_of(0u, l), 0)[component] <= 0.0;
    let uv = (vec2f(texel) + 0.5) / vec2f(textureDimensions(levels, 0));
    var most = 0.0;
    var i = 0u;
    loop {
        let before = vec2i(uv * vec2f(textureDimensions(levels, slabs.all[i].before_halvings)));
        let layer = layer_of(slabs.all[i].before_layer, l);
        let d_mm = textureLoad(levels, before, layer, slabs.all[i].before_halvings)[component];
        most = max(most, slab_weight(d_mm, slabs.all[i].variance_mm2));
        continuing {
            i++;
            break if i >= slabs.count;
        }
    }
    return select(most, 0.0, faces);
}

@fragment
fn transmit(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let here = under(vec2i(position.xy));
    if here.chart == NO_CHART {
        return vec4f(0.0);
    }
    let place = textureLoad(places, here.texel, 0);
    let point_mm = bitcast<vec3f>(place.xyz);
    let normal = unpack_unit(place.w);
    var sum = vec3f(0.0);
    var l = 0u;
    loop {
        let dir_to_light = dir_to_light(l, point_mm);
        let there = light_facing_surface(map_of(l), depths, surfaces, point_mm, slabs.object);
        let comes_through = there.found && !there.itself && dot(normal, dir_to_light) < 0.0;
        let apart_mm = max(apart_mm(here.atlas_uv, normal, here.chart, there) - uncertain_mm(there, dir_to_light), 0.0);
        sum += select(vec3f(0.0), through_all(l, here, there, apart_mm) * share(l, there), comes_through);
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    return vec4f(sum, 0.0);
}

/// Light of one place that comes through to another by all Gaussians.
fn through_all(l: u32, here: Under, there: LightFacing, apart_mm: f32) -> vec3f {
    var sum = vec3f(0.0);
    var i = 0u;
    for (var s = 0u; s < slabs.size_count; s++) {
        let size = slabs.sizes[s];
        let finer = on_levels(charts, size.finer_halvings, here.atlas_uv, here.chart);
        let own = on_levels(charts, size.halvings, here.atlas_uv, here.chart);
        let lit = on_levels(charts, size.halvings, there.atlas_uv, there.chart);
        let instead = instead_of_level(levels, charts, size, there.atlas_uv, there.chart).rgb;
        for (; i < size.end; i++) {
            let slab = slabs.all[i];
            var before = own;
            if slab.before_halvings != size.halvings {
                before = finer;
            }
            let d_mm = distance_mm(l, here, before, slab.before_layer);
            let through = slab_weight(d_mm, slab.variance_mm2) * fade_out(apart_mm, slab.variance_mm2);
            let light = select(instead, on_layer(levels, slab.layer, lit).rgb, lit.covered);
            sum += slab.weight * light * select(0.0, through, through > VISIBLE);
        }
    }
    return sum;
}

/// Layer of a level, told by its first one, that holds the distance towards a light. With one light it rides in alpha, with
/// several in further layers.
fn layer_of(level: u32, l: u32) -> u32 {
    return level + select(0u, 1u + l / 4u, slabs.many_lights == 1u);
}

fn component_of(l: u32) -> u32 {
    return select(3u, l % 4u, slabs.many_lights == 1u);
}

/// The distance towards a light, blurred by the Gaussian before, mm.
fn distance_mm(l: u32, here: Under, before: OnLevels, before_layer: u32) -> f32 {
    let blurred = on_layer(levels, layer_of(before_layer, l), before);
    let unblurred = textureLoad(levels, here.texel, layer_of(0u, l), 0);
    return select(unblurred, blurred, before.covered)[component_of(l)];
}

/// Share of a light in what falls on its light-facing side, so that light counted once is not counted again.
fn share(l: u32, there: LightFacing) -> f32 {
    if slabs.many_lights == 0u {
        return 1.0;
    }
    let texels = around(there.atlas_uv, textureDimensions(shares));
    return blend_layer(shares, l / 4u, texels, chart_weights(charts, texels, there.chart))[l % 4u];
}

/// Distance along the surface to the light-facing place, mm. Within a chart the texture tells. Between charts no blur has
/// brought its light here if it lies on the other side of a thin part; around an edge it is a neighbour beyond the seam.
fn apart_mm(atlas_uv: vec2f, normal: vec3f, chart: u32, there: LightFacing) -> f32 {
    let size = vec2f(textureDimensions(places));
    let texel_there = vec2i(there.atlas_uv * size);
    if chart == there.chart {
        let stretch = textureLoad(stretch_map, vec2i(atlas_uv * size), 0).xy + textureLoad(stretch_map, texel_there, 0).xy;
        return length((atlas_uv - there.atlas_uv) * size * 0.5 * stretch);
    }
    let normal_there = unpack_unit(textureLoad(places, texel_there, 0).w);
    let opposite = clamp(-dot(normal_there, normal), 0.0, 1.0);
    // 1e-6 keeps the quotient finite; a micrometre over it is a metre.
    return there.distance_mm / max(1.0 - opposite, 1e-6);
}

/// How far along the light-facing surface the place may be off: what the map cannot tell apart is not apart, mm.
fn uncertain_mm(there: LightFacing, dir_to_light: vec3f) -> f32 {
    let texel = vec2i(there.atlas_uv * vec2f(textureDimensions(places)));
    let cos = dot(unpack_unit(textureLoad(places, texel, 0).w), dir_to_light);
    // Seen at less than 3 degrees a surface has no place on the map.
    return there.uncertain_mm / max(cos, 0.05);
}

/// exp(-d²/2v): what a slab of thickness d leaves of a Gaussian of variance v.
fn slab_weight(d_mm: f32, variance_mm2: f32) -> f32 {
    return exp(-d_mm * d_mm / (2.0 * variance_mm2));
}

/// 0 where both places are one, 1 from six standard deviations on.
fn fade_out(apart_mm: f32, variance_mm2: f32) -> f32 {
    return min(apart_mm / (FADE_DEVIATIONS * sqrt(variance_mm2)), 1.0);
}
