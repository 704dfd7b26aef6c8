// The mesh in its pose: shapes, then joints, then the wave. The twin of cutis-scene's `deform`.

@group(0) @binding(0) var<uniform> deformation: Deformation;
@group(0) @binding(1) var<storage, read> rest: array<Vertex>;
@group(0) @binding(2) var<storage, read_write> vertices: array<Vertex>;
/// Where the offsets of a vertex begin in the next list, one more than there are vertices.
@group(0) @binding(3) var<storage, read> first_offsets: array<u32>;
@group(0) @binding(4) var<storage, read> offsets: array<Offset>;
@group(0) @binding(5) var<storage, read> morph_weights: array<f32>;
@group(0) @binding(6) var<storage, read> influences: array<Influence>;
@group(0) @binding(7) var<storage, read> joints: array<JointPair>;

struct Deformation {
    wave_direction: vec3f,
    wave_amplitude_mm: f32,
    wave_travel: vec3f,
    wavelength_mm: f32,
    wave_phase_rad: f32,
    /// 1 where joints are turned.
    turned: u32,
    /// 1 where shapes are in.
    morphed: u32,
    pad0: u32,
}

/// What one shape does to one vertex.
struct Offset {
    position_mm: vec3f,
    morph_target: u32,
    normal: vec3f,
    pad0: u32,
    tangent: vec3f,
    pad1: u32,
}

struct Influence {
    joints: vec4u,
    weights: vec4f,
}

/// From the mesh as it was bound to the world, mm.
struct JointPair {
    rest: mat4x4f,
    posed: mat4x4f,
}

const TAU: f32 = 6.2831853;
const LARGEST: f32 = 3.0e38;

@compute @workgroup_size(64)
fn deform_vertices(@builtin(global_invocation_id) id: vec3u) {
    let v = id.x;
    if v >= arrayLength(&rest) {
        return;
    }
    let resting = rest[v];
    var vertex = resting;
    if deformation.morphed == 1u {
        vertex = morphed(v, vertex);
    }
    if deformation.turned == 1u {
        vertex = skinned(influences[v], vertex);
    }
    if deformation.wave_amplitude_mm != 0.0 {
        vertex = waved(vertex);
    }
    // Matrices of a hostile file may overflow; such a vertex does not move.
    if !all(abs(vertex.position_mm) < vec3f(LARGEST)) {
        vertex = resting;
    }
    vertices[v] = mended(vertex, resting);
}

fn morphed(v: u32, resting: Vertex) -> Vertex {
    var vertex = resting;
    for (var i = first_offsets[v]; i < first_offsets[v + 1u]; i++) {
        let offset = offsets[i];
        let weight = morph_weights[offset.morph_target];
        vertex.position_mm += offset.position_mm * weight;
        vertex.normal += offset.normal * weight;
        vertex.tangent += vec4f(offset.tangent * weight, 0.0);
    }
    return vertex;
}

fn skinned(influence: Influence, resting: Vertex) -> Vertex {
    var bound = mat4x4f();
    var posed = mat4x4f();
    for (var i = 0u; i < 4u; i++) {
        bound += joints[influence.joints[i]].rest * influence.weights[i];
        posed += joints[influence.joints[i]].posed * influence.weights[i];
    }
    let linear = mat3x3f(bound[0].xyz, bound[1].xyz, bound[2].xyz);
    let determinant = dot(linear[0], cross(linear[1], linear[2]));
    if determinant == 0.0 {
        return resting;
    }
    let unbound = transpose(cofactors(linear)) * (1.0 / determinant);
    let directions = mat3x3f(posed[0].xyz, posed[1].xyz, posed[2].xyz) * unbound;
    var vertex = resting;
    vertex.position_mm = directions * (resting.position_mm - bound[3].xyz) + posed[3].xyz;
    // A joint that mirrors turns the surface inside out; normals still point out, and the bitangent turns around.
    let facing = select(-1.0, 1.0, dot(directions[0], cross(directions[1], directions[2])) >= 0.0);
    vertex.normal = cofactors(directions) * resting.normal * facing;
    vertex.tangent = vec4f(directions * resting.tangent.xyz, resting.tangent.w * facing);
    return vertex;
}

/// The determinant times the inverse transpose.
fn cofactors(m: mat3x3f) -> mat3x3f {
    return mat3x3f(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
}

/// The derivative of the displacement is `1 + s direction travelᵀ`; its cofactors, which normals follow, are
/// `(1 + s direction·travel) - s travel directionᵀ`.
fn waved(still: Vertex) -> Vertex {
    let direction = deformation.wave_direction;
    let travel = deformation.wave_travel;
    let turns = dot(travel, still.position_mm) / deformation.wavelength_mm + deformation.wave_phase_rad / TAU;
    // Sines of large numbers are worth little on graphics processors: whole turns are left out.
    let angle = TAU * (turns - floor(turns + 0.5));
    let slope = deformation.wave_amplitude_mm * TAU / deformation.wavelength_mm * cos(angle);
    let stretch = 1.0 + slope * dot(direction, travel);
    let tangent = still.tangent.xyz;
    var vertex = still;
    vertex.position_mm = still.position_mm + direction * (deformation.wave_amplitude_mm * sin(angle));
    vertex.normal = still.normal * stretch - travel * (slope * dot(direction, still.normal));
    vertex.tangent = vec4f(tangent + direction * (slope * dot(travel, tangent)), still.tangent.w);
    return vertex;
}

/// Normal and tangent made unit vectors again, at a right angle. A vertex that nothing has moved keeps its bits.
fn mended(moved: Vertex, resting: Vertex) -> Vertex {
    if all(moved.normal == resting.normal) && all(moved.tangent == resting.tangent) {
        return moved;
    }
    var vertex = moved;
    vertex.normal = unit_or(moved.normal, resting.normal);
    let along = moved.tangent.xyz - vertex.normal * dot(vertex.normal, moved.tangent.xyz);
    let across = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(vertex.normal.x) > 0.7);
    vertex.tangent = vec4f(unit_or(along, normalize(cross(vertex.normal, across))), moved.tangent.w);
    return vertex;
}
