//! WGSL.

use super::{KernelTable, Weights, comments, float, lines};

pub(super) fn table(table: &KernelTable) -> String {
    let (kind, weights) = match &table.weights {
        Weights::Single(weights) => ("f32", lines(weights.iter().map(|w| float(*w)))),
        Weights::Rgb(weights) => ("vec3<f32>", lines(weights.iter().map(vector))),
    };
    let count = table.variances_mm2.len();
    let variances = lines(table.variances_mm2.iter().map(|v| float(*v)));
    format!(
        "{}\
const CUTIS_GAUSSIANS: u32 = {count}u;
const CUTIS_VARIANCES_MM2: array<f32, {count}> = array<f32, {count}>(
{variances}
);
const CUTIS_WEIGHTS: array<{kind}, {count}> = array<{kind}, {count}>(
{weights}
);

fn cutis_diffuse_reflectance_per_mm2(r_mm: f32) -> {kind} {{
    // Copies, because not every compiler indexes a constant array by a variable.
    var variances = CUTIS_VARIANCES_MM2;
    var weights = CUTIS_WEIGHTS;
    var sum = {kind}();
    for (var i = 0u; i < CUTIS_GAUSSIANS; i++) {{
        let v = variances[i];
        sum += weights[i] * exp(-0.5 * r_mm * r_mm / v) / (6.2831853 * v);
    }}
    return sum;
}}
",
        comments(table, "//")
    )
}

fn vector(rgb: &[f64; 3]) -> String {
    let [r, g, b] = rgb.map(float);
    format!("vec3<f32>({r}, {g}, {b})")
}
