// The normal with the material's relief, as cutis-scene's `NormalMap` gives it.

/// `stored` is what the map holds: 0.5 + 0.5 n.
fn with_relief(material: Material, stored: vec3f, normal: vec3f, tangent: vec4f) -> vec3f {
    if material.relief_space == NO_RELIEF {
        return normal;
    }
    let n = stored * 2.0 - 1.0;
    if material.relief_space == OBJECT_SPACE {
        return unit_or(mix(normal, n, material.relief_strength), normal);
    }
    let t = unit_or(tangent.xyz - normal * dot(normal, tangent.xyz), any_tangent(normal));
    let b = cross(normal, t) * select(1.0, -1.0, tangent.w < 0.0);
    return unit_or((t * n.x + b * n.y) * material.relief_strength + normal * n.z, normal);
}

/// Some unit vector at right angles to a unit vector.
fn any_tangent(normal: vec3f) -> vec3f {
    let aside = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.9);
    return normalize(cross(aside, normal));
}
