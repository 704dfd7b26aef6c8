//! GLSL.

use super::{KernelTable, Weights, comments, float, lines};

pub(super) fn table(table: &KernelTable) -> String {
    let (kind, weights) = match &table.weights {
        Weights::Single(weights) => ("float", lines(weights.iter().map(|w| float(*w)))),
        Weights::Rgb(weights) => ("vec3", lines(weights.iter().map(vector))),
    };
    let count = table.variances_mm2.len();
    let variances = lines(table.variances_mm2.iter().map(|v| float(*v)));
    format!(
        "{}\
const int CUTIS_GAUSSIANS = {count};
const float CUTIS_VARIANCES_MM2[{count}] = float[{count}](
{variances}
);
const {kind} CUTIS_WEIGHTS[{count}] = {kind}[{count}](
{weights}
);

{kind} cutis_diffuse_reflectance_per_mm2(float r_mm) {{
    {kind} sum = {kind}(0.0);
    for (int i = 0; i < CUTIS_GAUSSIANS; i++) {{
        float v = CUTIS_VARIANCES_MM2[i];
        sum += CUTIS_WEIGHTS[i] * exp(-0.5 * r_mm * r_mm / v) / (6.2831853 * v);
    }}
    return sum;
}}
",
        comments(table, "//")
    )
}

fn vector(rgb: &[f64; 3]) -> String {
    let [r, g, b] = rgb.map(float);
    format!("vec3({r}, {g}, {b})")
}
