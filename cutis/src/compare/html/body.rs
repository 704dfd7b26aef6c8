//! What stands on the page: heading, table of numbers, the viewer, a card per technique, profiles.

use super::views::{Kind, View};
use super::{Figure, escaped};
use crate::compare::judged::Part;
use crate::compare::report::{Report, Row};
use cutis_render::difference::{RELATIVE_EPSILON, diverging, magma};

/// Colours in the gradient of a scale bar.
const STOPS: u32 = 16;

/// The whole body.
pub fn body(report: &Report, views: &[View], figures: &[Figure]) -> String {
    let cards = (0..report.techniques.len()).map(|row| card(report, views, row)).collect::<String>();
    let figures: String = figures.iter().map(figure).collect();
    [heading(report), table(report), viewer(views), cards, figures, notes(report)].concat()
}

fn heading(report: &Report) -> String {
    let warnings: String =
        report.warnings.iter().map(|warning| format!("<li>{}</li>", escaped(warning))).collect();
    let facts: String = facts(report)
        .into_iter()
        .map(|(name, value)| format!("<div><dt>{name}</dt><dd>{}</dd></div>", escaped(&value)))
        .collect();
    format!(
        "<header><h1>{}</h1><dl class=\"facts\">{facts}</dl><ul class=\"warnings\">{warnings}</ul></header>",
        escaped(&report.scene)
    )
}

fn facts(report: &Report) -> Vec<(&'static str, String)> {
    let samples = report.techniques.iter().find(|row| !row.is_reference);
    let of_reference = report.techniques.iter().find(|row| row.is_reference);
    let count =
        |row: Option<&Row>| row.map_or_else(|| "–".to_owned(), |row| row.samples_per_pixel.to_string());
    let mut facts = vec![
        ("Reference", report.reference.clone()),
        ("Picture", format!("{} × {} pixels", report.width, report.height)),
        ("Samples per pixel", format!("{} (reference {})", count(samples), count(of_reference))),
        ("Irradiance texture", format!("{} texels", report.irradiance_size)),
        ("Seed", report.seed.to_string()),
        ("View", format!("{} pixels per degree", report.pixels_per_degree)),
        ("Threads", report.threads.to_string()),
        ("Made by", format!("cutis {}", report.version)),
    ];
    if let Some(noise) = &report.reference_noise {
        let words =
            format!("{:.2} % mean, {:.5} W/(m² sr) RMS", 100.0 * noise.mean_relative, noise.rms_w_per_m2_sr);
        facts.insert(1, ("Noise of the reference", words));
    }
    facts
}

fn table(report: &Report) -> String {
    let rows: String = report.techniques.iter().map(table_rows).collect();
    format!(
        "<section><h2>Errors and cost</h2><div class=\"wide\"><table class=\"numbers\"><thead><tr>\
         <th>Technique</th><th>Light</th><th>RMSE<small>W/(m² sr)</small></th><th>Relative MSE<small>no unit</small></th>\
         <th>Bias R<small>%</small></th><th>Bias G<small>%</small></th><th>Bias B<small>%</small></th>\
         <th>FLIP LDR<small>mean, 0 to 1</small></th><th>FLIP HDR<small>mean, 0 to 1</small></th>\
         <th>Time<small>ms</small></th><th>Memory<small>MiB, most</small></th></tr></thead><tbody>{rows}</tbody></table>\
         </div></section>"
    )
}

fn table_rows(row: &Row) -> String {
    let name = escaped(&row.name);
    let memory = row.peak_memory_mib.map_or_else(|| "–".to_owned(), |mib| format!("{mib:.0}"));
    let cost = format!("<td>{:.0}</td><td>{memory}</td>", row.milliseconds);
    if row.parts.is_empty() {
        let words = if row.is_reference { "reference" } else { "" };
        return format!(
            "<tr class=\"reference\"><th>{name}</th><td class=\"words\">{words}</td>{}{cost}</tr>",
            "<td>–</td>".repeat(7)
        );
    }
    let rows = row.parts.iter().enumerate().map(|(i, part)| {
        let m = &part.measured;
        let bias = m.relative_bias_rgb.map(|bias| {
            bias.map_or_else(|| "<td>–</td>".to_owned(), |bias| format!("<td>{:+.2}</td>", 100.0 * bias))
        });
        let hdr = m.flip_hdr.as_ref().map_or(f64::NAN, |hdr| hdr.mean);
        let (head, cost) = if i == 0 { (name.as_str(), cost.as_str()) } else { ("", "<td></td><td></td>") };
        format!(
            "<tr><th>{head}</th><td class=\"words\">{}</td><td>{:.5}</td><td>{:.5}</td>{}{}{}{cost}</tr>",
            part.part.words(),
            m.rmse,
            m.relative_mse,
            bias.concat(),
            bar_cell(m.flip_ldr.mean),
            bar_cell(hdr),
        )
    });
    rows.collect()
}

/// A number in 0..=1 with a bar under it.
fn bar_cell(value: f64) -> String {
    format!(
        "<td><span class=\"bar\" style=\"--part:{:.1}%\"></span>{value:.4}</td>",
        100.0 * value.clamp(0.0, 1.0)
    )
}

/// The controls' options: every picture of the page by its number.
fn viewer(views: &[View]) -> String {
    let pictures: Vec<usize> = (0..views.len())
        .filter(|&i| views[i].kind == Kind::Picture && views[i].part == Part::Picture)
        .collect();
    let (a, b) = (pictures[0], pictures.get(1).copied().unwrap_or(pictures[0]));
    let options = |chosen: usize| -> String {
        let option = |(i, view): (usize, &View)| {
            let selected = if i == chosen { " selected" } else { "" };
            format!("<option value=\"view-{i}\"{selected}>{}</option>", escaped(&view.label))
        };
        views.iter().enumerate().map(option).collect()
    };
    include_str!("viewer.html").replace("{{a}}", &options(a)).replace("{{b}}", &options(b))
}

fn card(report: &Report, views: &[View], row: usize) -> String {
    let technique = &report.techniques[row];
    let own = views.iter().enumerate().filter(|(_, view)| view.row == row);
    let figures: String = own.map(|(i, view)| view_figure(report, i, view)).collect();
    let role = if technique.is_reference { " <span class=\"role\">reference</span>" } else { "" };
    format!(
        "<section class=\"card\"><h2>{}{role}</h2><div class=\"views\">{figures}</div>{}</section>",
        escaped(&technique.name),
        passes(technique),
    )
}

fn view_figure(report: &Report, index: usize, view: &View) -> String {
    let (label, uri) = (escaped(&view.label), &view.uri);
    let (words, scale) = match view.kind {
        Kind::Picture => (view.part.words().to_owned(), String::new()),
        Kind::Flip => {
            let bar = scale_bar(magma, ["0 unseen", "FLIP HDR", "1"]);
            (format!("{}: visible difference", view.part.words()), bar)
        }
        Kind::Luminance => {
            let percent = 100.0 * report.luminance_scale;
            let (dark, bright) = (format!("−{percent:.0} % darker"), format!("brighter +{percent:.0} %"));
            let bar = scale_bar(|part| diverging(2.0 * part - 1.0), [&dark, "0", &bright]);
            (format!("{}: luminance against the reference", view.part.words()), bar)
        }
    };
    format!(
        "<figure><img id=\"view-{index}\" src=\"{uri}\" alt=\"{label}\" width=\"{}\" height=\"{}\">\
         <figcaption>{words}</figcaption>{scale}</figure>",
        report.width, report.height
    )
}

/// A bar of the colours from 0 to 1 with what its ends and its middle mean.
fn scale_bar(colour: impl Fn(f32) -> [u8; 3], [low, middle, high]: [&str; 3]) -> String {
    let stop = |i: u32| {
        let [r, g, b] = colour(i as f32 / STOPS as f32);
        format!("rgb({r} {g} {b})")
    };
    let stops: Vec<_> = (0..=STOPS).map(stop).collect();
    format!(
        "<div class=\"scale\"><div style=\"background:linear-gradient(to right,{})\"></div>\
         <span>{low}</span><span>{middle}</span><span>{high}</span></div>",
        stops.join(",")
    )
}

fn passes(row: &Row) -> String {
    let most = row.passes.iter().map(|pass| pass.milliseconds).fold(f64::MIN_POSITIVE, f64::max);
    let lines: String = row
        .passes
        .iter()
        .map(|pass| {
            format!(
                "<tr><th>{}</th><td>{:.1}</td><td class=\"time\"><span class=\"bar\" style=\"--part:{:.1}%\"></span></td></tr>",
                escaped(&pass.name),
                pass.milliseconds,
                100.0 * pass.milliseconds / most
            )
        })
        .collect();
    format!(
        "<details><summary>Passes: {:.0} ms in all, by {}</summary><table class=\"passes\"><thead><tr><th>Pass</th>\
         <th>ms</th><th></th></tr></thead><tbody>{lines}</tbody></table></details>",
        row.milliseconds,
        escaped(&format!("{}, {}", row.backend, row.adapter))
    )
}

fn figure(figure: &Figure) -> String {
    format!(
        "<section class=\"card\"><h2>Diffusion profile: {}</h2><div class=\"profile\">{}</div></section>",
        escaped(&figure.materials),
        figure.svg
    )
}

fn notes(report: &Report) -> String {
    format!(
        "<footer><p>Errors are those of radiance, picture minus reference b: RMSE = √mean (a − b)²; relative MSE = mean \
         (a − b)² / (b² + {RELATIVE_EPSILON}); bias = mean a / mean b − 1; luminance maps show (Y − Y<sub>b</sub>) / \
         √(Y<sub>b</sub>² + {RELATIVE_EPSILON}). FLIP after Andersson et al. 2020 (LDR, of the pictures as shown) and 2021 \
         (HDR, of the radiance; maps and colours are those of HDR). Pictures are developed like those of cutis render, \
         without bloom. The diffuse part is the picture without what the surface itself reflects. Memory is the most that \
         the whole program held meanwhile.</p><p>{:.1} s in all.</p></footer>",
        report.wall_seconds
    )
}
