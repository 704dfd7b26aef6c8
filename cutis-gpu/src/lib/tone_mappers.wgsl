// From light without upper limit to the 0 to 1 of a screen. The twin of cutis-render's `tone_map`, where the sources are.

const NONE = 0u;
const REINHARD = 1u;
const ACES = 2u;
const AGX = 3u;
const NEUTRAL = 4u;

/// Screen light of a scene light that is a number, not negative and not beyond MAX_RADIANCE.
fn tone_mapped(tone_mapper: u32, light: vec3f) -> vec3f {
    var shown = light;
    switch tone_mapper {
        case REINHARD: { shown = reinhard(light); }
        case ACES: { shown = aces(light); }
        case AGX: { shown = agx(light); }
        case NEUTRAL: { shown = neutral(light); }
        default: {}
    }
    return clamp(shown, vec3f(0.0), vec3f(1.0));
}

fn reinhard(light: vec3f) -> vec3f {
    let luminance = dot(light, vec3f(0.2126, 0.7152, 0.0722));
    return light * ((1.0 + luminance / 16.0) / (1.0 + luminance));
}

fn aces(light: vec3f) -> vec3f {
    // By rows: the vector stands on the left.
    let curve_from_rec709 =
        mat3x3f(0.59719, 0.35458, 0.04823, 0.07600, 0.90834, 0.01566, 0.02840, 0.13383, 0.83777);
    let rec709_from_curve =
        mat3x3f(1.60475, -0.53108, -0.07367, -0.10208, 1.10813, -0.00605, -0.00327, -0.07276, 1.07602);
    let v = light * curve_from_rec709;
    let above = v * (v + 0.0245786) - 0.000090537;
    let below = v * (0.983729 * v + 0.432951) + 0.238081;
    return max(above / below, vec3f(0.0)) * rec709_from_curve;
}

fn agx(light: vec3f) -> vec3f {
    let inset = mat3x3f(
        0.84247906, 0.042328242, 0.042375655,
        0.0784336, 0.8784686, 0.0784336,
        0.079223745, 0.07916613, 0.879143,
    );
    let outset = mat3x3f(
        1.196879, -0.052896852, -0.052971636,
        -0.09802088, 1.1519031, -0.09804345,
        -0.09902974, -0.09896118, 1.1510737,
    );
    let c = inset * light;
    let encoded = outset * vec3f(sigmoid(logarithmic(c.r)), sigmoid(logarithmic(c.g)), sigmoid(logarithmic(c.b)));
    return pow(max(encoded, vec3f(0.0)), vec3f(2.2));
}

/// Place on the logarithmic scale from -10 to 6.5 EV about middle grey, 0 to 1.
fn logarithmic(light: f32) -> f32 {
    // The logarithm of 0 is left alone.
    let ev = log2(max(light, 1e-10) / 0.18);
    return clamp((ev + 10.0) / 16.5, 0.0, 1.0);
}

/// The curve through (0, 0), the pivot and (1, 1).
fn sigmoid(x: f32) -> f32 {
    if x <= 0.0 {
        return 0.0;
    }
    let pivot_in = 10.0 / 16.5;
    let is_toe = x < pivot_in;
    let reach_in = select(1.0 - pivot_in, pivot_in, is_toe);
    let power = select(3.25, 3.0, is_toe);
    let end = 2.0 * reach_in;
    let limit = end / pow(pow(end / 0.5, power) - 1.0, 1.0 / power);
    let d = 2.0 * (x - pivot_in);
    return clamp(0.5 + d / pow(1.0 + pow(abs(d / limit), power), 1.0 / power), 0.0, 1.0);
}

fn neutral(light: vec3f) -> vec3f {
    let f90 = 0.04;
    let start = 0.8 - f90;
    let least = min(light.r, min(light.g, light.b));
    let colour = light - select(f90, least - least * least / (4.0 * f90), least <= 2.0 * f90);
    let peak = max(colour.r, max(colour.g, colour.b));
    if peak <= start {
        return colour;
    }
    let room = 1.0 - start;
    let new_peak = 1.0 - room * room / (peak + room - start);
    let kept = 1.0 / (0.15 * (peak - new_peak) + 1.0);
    return mix(vec3f(new_peak), colour * (new_peak / peak), kept);
}
