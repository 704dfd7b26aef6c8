//! The numbers as a table for other programs: RFC 4180, one row per technique and part of the light.

use super::report::{PartReport, Report, Row};

/// Names of the columns, units included.
const HEADER: &str = "name,technique,diffusion,backend,is_reference,part,rmse_w_per_m2_sr,relative_mse,\
bias_r_w_per_m2_sr,bias_g_w_per_m2_sr,bias_b_w_per_m2_sr,relative_bias_r,relative_bias_g,relative_bias_b,\
flip_ldr_mean,flip_hdr_mean,milliseconds,peak_memory_mib,samples_per_pixel";

/// The whole table. Numbers that are not known are left empty; the reference has a row without errors.
pub fn table(report: &Report) -> String {
    let rows = report.techniques.iter().flat_map(|row| {
        let reference = row.is_reference.then(|| line(row, None));
        reference.into_iter().chain(row.parts.iter().map(|part| line(row, Some(part))))
    });
    std::iter::once(HEADER.to_owned()).chain(rows).map(|line| line + "\r\n").collect()
}

fn line(row: &Row, part: Option<&PartReport>) -> String {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let measured = part.map(|part| &part.measured);
    let name = part.map_or("picture", |part| part.part.words());
    let is_reference = row.is_reference.to_string();
    let head = [&row.name, &row.technique, &row.diffusion, &row.backend, &is_reference, name].map(quoted);
    let bias = [0, 1, 2].map(|c| number(measured.map(|m| m.bias_rgb[c])));
    let relative_bias = [0, 1, 2].map(|c| number(measured.and_then(|m| m.relative_bias_rgb[c])));
    let errors = [number(measured.map(|m| m.rmse)), number(measured.map(|m| m.relative_mse))];
    let flip = [
        number(measured.map(|m| m.flip_ldr.mean)),
        number(measured.and_then(|m| m.flip_hdr.as_ref()).map(|hdr| hdr.mean)),
    ];
    let cost = [row.milliseconds.to_string(), number(row.peak_memory_mib), row.samples_per_pixel.to_string()];
    let fields = head.into_iter().chain(errors).chain(bias).chain(relative_bias).chain(flip).chain(cost);
    fields.collect::<Vec<_>>().join(",")
}

/// A field that may hold anything.
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        assert_eq!(quoted("texture-space"), "texture-space");
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }
}
