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

/// Occlusion of a specular lobe from that of the whole hemisphere (Lagarde & de Rousiers 2014, section 4.10.2).
fn specular_openness(cos_eye: f32, open: f32, roughness: f32) -> f32 {
    let exponent = exp2(-16.0 * roughness - 1.0);
    return clamp(pow(max(cos_eye + open, 1e-12), exponent) - 1.0 + open, 0.0, 1.0);
}
