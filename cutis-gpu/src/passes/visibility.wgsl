// What every texel sees of four lights, and how far it is through the body towards each: percentage-closer soft shadows
// (Fernando 2005) and the translucent shadow map.
//
// The bias follows from the map: no texel of it may hold a depth that the surface under the point itself has within
// that texel. The surface is taken for its tangent plane, moved outwards by as much as it may be curved; but where the map
// shows another surface in front of it, nothing there is its own, and nothing is allowed for.

@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var<uniform> group_of: Group;
@group(0) @binding(3) var places: texture_2d<u32>;
@group(0) @binding(4) var stretch_map: texture_2d<f32>;
@group(0) @binding(5) var depths: texture_2d_array<f32>;
@group(0) @binding(6) var surfaces: texture_2d_array<u32>;
@group(0) @binding(7) var charts: texture_2d<u32>;

struct Group {
    first_light: u32,
    light_count: u32,
    object: u32,
    /// Places on a light's disc that are tried.
    samples: u32,
    /// Distance beyond which nothing comes through, mm.
    opaque_mm: f32,
    /// Factor on distances through the body.
    thickness_scale: f32,
    pad0: u32,
    pad1: u32,
}

struct Visibility {
    @location(0) seen: vec4f,
    @location(1) distance_mm: vec4f,
}

/// Samples of the search for what may hide a light.
const SEARCH_SAMPLES: u32 = 12u;
/// Stream of random numbers this pass draws from; one per light from here on.
const STREAM: u32 = 0x100u;
/// Share of what a surface's depth changes by within a texel that its curvature may add to that of its tangent plane.
const BENT: f32 = 0.15;
/// Slope of a surface against a map's plane beyond which the map says nothing about it.
const MAX_SLOPE: f32 = 12.0;

@fragment
fn see_lights(@builtin(position) position: vec4f) -> Visibility {
    return visibility_at(vec2i(position.xy), true);
}

/// For lights of which none has an extent: most of the work is left out when this is compiled.
@fragment
fn see_sharp_lights(@builtin(position) position: vec4f) -> Visibility {
    return visibility_at(vec2i(position.xy), false);
}

fn visibility_at(texel: vec2i, any_extent: bool) -> Visibility {
    var result = Visibility(vec4f(0.0), vec4f(0.0));
    let chart = textureLoad(charts, texel, 0).x;
    if chart == NO_CHART {
        return result;
    }
    let place = textureLoad(places, texel, 0);
    let point_mm = bitcast<vec3f>(place.xyz);
    let normal = unpack_unit(place.w);
    let own = own_at(texel, chart, point_mm, normal);
    var i = 0u;
    loop {
        let l = group_of.first_light + i;
        let dir_to_light = dir_to_light(l, point_mm);
        let map = map_of(l);
        let faces = dot(normal, dir_to_light) >= 0.0;
        if faces {
            let shift = random2(vec2u(texel), STREAM + l);
            let extent = select(0.0, lights[l].extent, any_extent);
            result.seen[i] = visible_fraction(map, extent, own, shift);
        }
        if !faces {
            result.distance_mm[i] = distance_mm(map, point_mm, normal, dir_to_light);
        }
        continuing {
            i++;
            break if i >= group_of.light_count;
        }
    }
    return result;
}

/// How many places of the lights are tried for a texel: those of the search for what may hide them, and of their discs.
@fragment
fn count_places(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, 0).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let place = textureLoad(places, texel, 0);
    let point_mm = bitcast<vec3f>(place.xyz);
    let normal = unpack_unit(place.w);
    let own = own_at(texel, chart, point_mm, normal);
    var tried = 0u;
    var i = 0u;
    loop {
        let l = group_of.first_light + i;
        if dot(normal, dir_to_light(l, point_mm)) >= 0.0 {
            tried += places_tried(map_of(l), lights[l].extent, own, random2(vec2u(texel), STREAM + l));
        }
        continuing {
            i++;
            break if i >= group_of.light_count;
        }
    }
    return vec4f(f32(tried), 0.0, 0.0, 0.0);
}

/// Distance d through the body, scaled, never more than what is opaque anyway, mm.
fn distance_mm(map: LightMap, point_mm: vec3f, normal: vec3f, dir_to_light: vec3f) -> f32 {
    let there = light_facing_surface(map, depths, surfaces, point_mm, group_of.object);
    if !there.found {
        return group_of.opaque_mm;
    }
    let texel = vec2i(there.atlas_uv * vec2f(textureDimensions(places)));
    let normal_there = unpack_unit(textureLoad(places, texel, 0).w);
    let d_mm = corrected_mm(there.distance_mm, normal, normal_there, dir_to_light);
    return min(scaled_mm(d_mm, group_of.thickness_scale), group_of.opaque_mm);
}

/// A point and the surface that it lies on.
struct Own {
    point_mm: vec3f,
    normal: vec3f,
    atlas_uv: vec2f,
    mm_per_uv: vec2f,
    chart: u32,
}

fn own_at(texel: vec2i, chart: u32, point_mm: vec3f, normal: vec3f) -> Own {
    let stretch = textureLoad(stretch_map, texel, 0).xyz;
    let size = vec2f(textureDimensions(charts));
    return Own(point_mm + normal * stretch.z, normal, (vec2f(texel) + 0.5) / size, size * stretch.xy, chart);
}

/// A point before a light's map.
struct Receiver {
    axes_mm: vec3f,
    /// Its tangent plane: depth at the map's centre and growth per unit of the map, in what is linear on the map.
    uv: vec2f,
    normal: vec3f,
    /// Depth that may be missed within one texel, mm.
    bias_mm: f32,
    /// Whether the map shows another surface in the point's place: then nothing there is taken for its own.
    covered: bool,
}

fn visible_fraction(map: LightMap, extent: f32, own: Own, shift: vec2f) -> f32 {
    if map.layer == NO_MAP {
        return 1.0;
    }
    let to = receiver(map, own);
    if any(to.uv < vec2f(0.0)) || any(to.uv > vec2f(1.0)) {
        return 1.0;
    }
    if extent <= 0.0 {
        return lit_share(map, to, to.uv);
    }
    return soft_share(map, extent, to, shift);
}

fn places_tried(map: LightMap, extent: f32, own: Own, shift: vec2f) -> u32 {
    if map.layer == NO_MAP {
        return 0u;
    }
    let to = receiver(map, own);
    if any(to.uv < vec2f(0.0)) || any(to.uv > vec2f(1.0)) {
        return 0u;
    }
    if extent <= 0.0 {
        return 1u;
    }
    return SEARCH_SAMPLES + cone_to(map, extent, to, shift).samples;
}

/// The cone from a point to a disc of light, where it is cut by what hides it.
struct Cone {
    /// Radius on the map.
    radius: f32,
    hidden_by_mm: f32,
    /// Places that have to be tried: none where nothing is in between, nor the horizon.
    samples: u32,
}

fn cone_to(map: LightMap, extent: f32, to: Receiver, shift: vec2f) -> Cone {
    let blocker = blocker_before(map, extent, to, shift);
    // The horizon is the same at any depth of the cone to the light.
    let hidden_by_mm = select(to.axes_mm.z - 1.0, blocker.depth_mm, blocker.found);
    let radius = disc_radius(map, extent, to.axes_mm.z, hidden_by_mm);
    let is_clear = !blocker.found && is_high(map, to, radius, hidden_by_mm);
    return Cone(radius, hidden_by_mm, select(group_of.samples, 0u, is_clear));
}

/// Share of a disc of light that is seen.
fn soft_share(map: LightMap, extent: f32, to: Receiver, shift: vec2f) -> f32 {
    let cone = cone_to(map, extent, to, shift);
    var sum = 0.0;
    var s = 0u;
    loop {
        let uv = to.uv + cone.radius * disc(r2_point(s, shift));
        sum += select(0.0, lit_share(map, to, uv), height_mm(map, to, uv, cone.hidden_by_mm) > 0.0);
        continuing {
            s++;
            break if s >= cone.samples;
        }
    }
    return select(sum / f32(group_of.samples), 1.0, cone.samples == 0u);
}

/// Whether what the map shows at a place lies before the point's tangent plane.
fn hides(map: LightMap, to: Receiver, uv: vec2f) -> bool {
    return lit(map, to, texel_at(uv)) == 0.0 && inside(uv);
}

/// What is nearest to the light at a place of the map, mm.
fn nearest_mm(map: LightMap, uv: vec2f) -> f32 {
    return textureLoad(depths, texel_at(uv), map.layer, 0).x;
}

fn texel_at(uv: vec2f) -> vec2i {
    let size = vec2i(textureDimensions(depths));
    return clamp(vec2i(uv * vec2f(size)), vec2i(0), size - 1);
}

/// How high above the point's tangent plane a place of the map lies at a depth, mm.
fn height_mm(map: LightMap, to: Receiver, uv: vec2f, depth_mm: f32) -> f32 {
    let place = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y) * map_half_width_mm(map, depth_mm);
    return dot(to.normal, vec3f(place, depth_mm) - to.axes_mm);
}

/// Whether the whole cone to the light's disc, `radius` wide on the map at a depth, lies above the point's horizon.
fn is_high(map: LightMap, to: Receiver, radius: f32, depth_mm: f32) -> bool {
    return height_mm(map, to, to.uv, depth_mm) > 2.0 * radius * map_half_width_mm(map, depth_mm);
}

fn receiver(map: LightMap, own: Own) -> Receiver {
    let n = vec3f(dot(map.right, own.normal), dot(map.up, own.normal), dot(map.forward, own.normal));
    let depth_mm = in_map_axes(map, own.point_mm).z;
    let texel_mm = 2.0 * map_half_width_mm(map, depth_mm) / f32(textureDimensions(depths).x);
    // Half a texel outwards: the surface may be curved, and the map holds flat triangles.
    let axes_mm = in_map_axes(map, own.point_mm + own.normal * (0.5 * texel_mm));
    let uv = light_map_uv(map, axes_mm);
    let slope = min(length(n.xy) / max(abs(n.z), 1e-3), MAX_SLOPE);
    let covered = nearest_mm(map, uv) < depth_mm - texel_mm && is_other(map, uv, own, 2.0 * texel_mm * (1.0 + slope));
    let bent_mm = select(BENT * texel_mm * slope, 0.0, covered);
    // The last term is rounding.
    return Receiver(axes_mm, uv, n, bent_mm + 2e-6 * depth_mm, covered);
}

/// Whether the map shows another surface at a place than the point's own, which goes on there for `itself_mm`. Between charts
/// of one object nothing is known.
fn is_other(map: LightMap, uv: vec2f, own: Own, itself_mm: f32) -> bool {
    let shown = textureLoad(surfaces, texel_at(uv), map.layer, 0).xy;
    let along_mm = length((unpack2x16unorm(shown.x) - own.atlas_uv) * own.mm_per_uv);
    let same_chart = (shown.y & 65535u) == own.chart;
    return (shown.y >> 16u) != group_of.object || (same_chart && along_mm > itself_mm);
}

/// Radius on the map of the cone from a point to the light's disc, where something at `hidden_by_mm` cuts it.
fn disc_radius(map: LightMap, extent: f32, depth_mm: f32, hidden_by_mm: f32) -> f32 {
    let gap_mm = max(depth_mm - hidden_by_mm, 0.0);
    if map.directional {
        return 0.5 * extent * gap_mm / map.half_width;
    }
    return 0.5 * extent * gap_mm / (depth_mm * map_half_width_mm(map, hidden_by_mm));
}

/// What lies before a point, and its mean depth. Depths of a directional light may be below 0.
struct Blocker {
    found: bool,
    depth_mm: f32,
}

/// What lies before the point, as seen from the light's disc.
fn blocker_before(map: LightMap, extent: f32, to: Receiver, shift: vec2f) -> Blocker {
    let radius = disc_radius(map, extent, to.axes_mm.z, map.near_mm);
    var sum_mm = 0.0;
    var count = 0.0;
    var s = 0u;
    loop {
        let uv = to.uv + radius * disc(r2_point(s, shift));
        if hides(map, to, uv) {
            sum_mm += nearest_mm(map, uv);
            count += 1.0;
        }
        continuing {
            s++;
            break if s >= SEARCH_SAMPLES;
        }
    }
    return Blocker(count > 0.0, sum_mm / max(count, 1.0));
}

/// Depth of the point's tangent plane elsewhere on the map, if that is nearer to the light than the point, mm.
fn plane_depth_mm(map: LightMap, to: Receiver, uv: vec2f) -> f32 {
    let place = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y) * map.half_width;
    var depth_mm = to.axes_mm.z;
    if map.directional {
        depth_mm += dot(to.normal.xy, to.axes_mm.xy - place) / min(to.normal.z, -1e-3);
    } else {
        let facing_mm = dot(to.normal, to.axes_mm);
        let on_plane_mm = facing_mm / min(dot(to.normal, vec3f(place, 1.0)), -1e-3);
        // Moved outwards, a surface at a grazing angle may turn its back: then its plane says nothing.
        depth_mm = select(depth_mm, on_plane_mm, facing_mm < 0.0);
    }
    return select(clamp(depth_mm, map.near_mm, to.axes_mm.z), to.axes_mm.z, to.covered);
}

fn inside(uv: vec2f) -> bool {
    return all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
}

/// Share of the four texels around a place that do not hide the point.
fn lit_share(map: LightMap, to: Receiver, uv: vec2f) -> f32 {
    let place = uv * vec2f(textureDimensions(depths)) - 0.5;
    let f = fract(place);
    let corner = vec2i(floor(place));
    let upper = mix(lit(map, to, corner), lit(map, to, corner + vec2i(1, 0)), f.x);
    let lower = mix(lit(map, to, corner + vec2i(0, 1)), lit(map, to, corner + vec2i(1, 1)), f.x);
    return select(1.0, mix(upper, lower, f.y), inside(uv));
}

/// 1 unless what a texel shows lies before the point's tangent plane there.
fn lit(map: LightMap, to: Receiver, texel: vec2i) -> f32 {
    let size = vec2i(textureDimensions(depths));
    let clamped = clamp(texel, vec2i(0), size - 1);
    let limit_mm = plane_depth_mm(map, to, (vec2f(clamped) + 0.5) / vec2f(size)) - to.bias_mm;
    return select(0.0, 1.0, textureLoad(depths, clamped, map.layer, 0).x >= limit_mm);
}
