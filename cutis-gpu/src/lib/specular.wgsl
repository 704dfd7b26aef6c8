// The specular lobe of skin: Kelemen & Szirmay-Kalos 2001 with a normalised Beckmann distribution and Schlick's Fresnel term.
// The twin of cutis-render's `specular_brdf` and of its pass `specular`.

const PI: f32 = 3.141592654;

struct Shine {
    normal: vec3f,
    dir_to_eye: vec3f,
    rho_s: f32,
    roughness: f32,
    f0: f32,
}

fn beckmann_per_sr(cos_half: f32, roughness: f32) -> f32 {
    if cos_half <= 0.0 {
        return 0.0;
    }
    let m = max(roughness, MIN_ROUGHNESS);
    let cos2 = cos_half * cos_half;
    let tan2 = max(1.0 - cos2, 0.0) / cos2;
    return exp(-tan2 / (m * m)) / (PI * m * m * cos2 * cos2);
}

fn fresnel_schlick(cos_incidence: f32, f0: f32) -> f32 {
    let x = 1.0 - clamp(cos_incidence, 0.0, 1.0);
    let x2 = x * x;
    return f0 + (1.0 - f0) * x2 * x2 * x;
}

fn kelemen_szirmay_kalos_per_sr(cos_half: f32, cos_difference: f32, roughness: f32, f0: f32) -> f32 {
    // |L + V| = 2 V·H. The floor bounds the lobe where light and eye are opposite and the cosine factor is 0 anyway.
    let sum_length2 = max(4.0 * cos_difference * cos_difference, 1e-4);
    return beckmann_per_sr(cos_half, roughness) * fresnel_schlick(cos_difference, f0) / sum_length2;
}

/// Radiance reflected from a light that is visible, W/(m² sr).
fn from_light(shine: Shine, light: LightSample) -> vec3f {
    let cos_light = dot(shine.normal, light.dir_to_light);
    if cos_light <= 0.0 {
        return vec3f(0.0);
    }
    let h = unit_or(light.dir_to_light + shine.dir_to_eye, shine.normal);
    let lobe_per_sr = kelemen_szirmay_kalos_per_sr(
        dot(shine.normal, h), dot(shine.dir_to_eye, h), shine.roughness, shine.f0,
    );
    return light.irradiance_w_per_m2 * (shine.rho_s * lobe_per_sr * cos_light);
}

/// Share of a specular lobe that is not hidden, by cosines of its mirror direction with the normal and with the bent normal
/// (Jimenez et al. 2016, section 5).
fn lobe_openness(cos_normal: f32, cos_bent: f32, roughness: f32, open: f32) -> f32 {
    let lobe_rad = 2.0 * atan(max(roughness, MIN_ROUGHNESS));
    let open_rad = asin(sqrt(clamp(open, 0.0, 1.0)));
    let whole = shared_by_caps(lobe_rad, 0.5 * PI, acos(clamp(cos_normal, 0.0, 1.0)));
    return min(shared_by_caps(lobe_rad, open_rad, acos(clamp(cos_bent, -1.0, 1.0))) / whole, 1.0);
}

/// Solid angle over 2 pi that two spherical caps share (Oat & Sander 2007).
fn shared_by_caps(a_rad: f32, b_rad: f32, apart_rad: f32) -> f32 {
    let smaller = 1.0 - cos(min(a_rad, b_rad));
    let inside = abs(a_rad - b_rad);
    let outside = a_rad + b_rad;
    let t = clamp((outside - apart_rad) / max(outside - inside, 1e-6), 0.0, 1.0);
    return smaller * t * t * (3.0 - 2.0 * t);
}
