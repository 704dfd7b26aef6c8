//! HLSL.

use super::{KernelTable, Weights, comments, float, lines};

pub(super) fn table(table: &KernelTable) -> String {
    let (kind, zero, weights) = match &table.weights {
        Weights::Single(weights) => ("float", "0.0", lines(weights.iter().map(|w| float(*w)))),
        Weights::Rgb(weights) => ("float3", "float3(0.0, 0.0, 0.0)", lines(weights.iter().map(vector))),
    };
    let count = table.variances_mm2.len();
    let variances = lines(table.variances_mm2.iter().map(|v| float(*v)));
    format!(
        "{}\
static const uint CUTIS_GAUSSIANS = {count};
static const float CUTIS_VARIANCES_MM2[{count}] = {{
{variances}
}};
static const {kind} CUTIS_WEIGHTS[{count}] = {{
{weights}
}};

{kind} cutis_diffuse_reflectance_per_mm2(float r_mm) {{
    {kind} sum = {zero};
    [unroll] for (uint i = 0; i < CUTIS_GAUSSIANS; i++) {{
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
    format!("float3({r}, {g}, {b})")
}
