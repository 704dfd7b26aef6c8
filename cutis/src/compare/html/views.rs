//! The pictures of the page: what was rendered, and maps of where it errs.

use super::base64;
use crate::compare::Compared;
use crate::compare::judged::Part;
use crate::compare::report::Report;
use crate::measure::{Measured, map_png};
use cutis_render::difference::{diverging, magma};
use miette::Result;

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Light as a screen shows it.
    Picture,
    /// FLIP's error in magma.
    Flip,
    /// Error of the luminance in the diverging map.
    Luminance,
}

/// A picture of the page.
pub struct View {
    /// Which technique it belongs to.
    pub row: usize,
    pub part: Part,
    pub kind: Kind,
    /// For people.
    pub label: String,
    /// `data:` and so on.
    pub uri: String,
}

/// All pictures, technique by technique.
pub fn all(report: &Report, compared: &Compared) -> Result<Vec<View>> {
    let mut views = Vec::new();
    for (row, drawn) in compared.drawn.iter().enumerate() {
        let name = &report.techniques[row].name;
        let mut add = |part: Part, kind, words: &str, png: Vec<u8>| {
            let label = match part {
                Part::Picture => format!("{name}{words}"),
                Part::Diffuse => format!("{name}, diffuse part{words}"),
            };
            let uri = format!("data:image/png;base64,{}", base64::encode(&png));
            views.push(View { row, part, kind, label, uri });
        };
        let seen = [(Part::Picture, Some(&drawn.picture)), (Part::Diffuse, drawn.diffuse.as_ref())];
        for (part, seen) in seen {
            let Some(seen) = seen else { continue };
            add(part, Kind::Picture, "", seen.png()?);
            let judged = compared.judged[row].iter().find(|(judged, _)| *judged == part);
            let Some((_, measured)) = judged else { continue };
            add(part, Kind::Flip, ": FLIP", map_png(seen.width, &measured.flip().errors, magma)?);
            let luminance = luminance_png(seen.width, measured, report.luminance_scale)?;
            add(part, Kind::Luminance, ": luminance error", luminance);
        }
    }
    Ok(views)
}

fn luminance_png(width: usize, measured: &Measured, scale: f64) -> Result<Vec<u8>> {
    map_png(width, &measured.luminance_errors, |error| diverging((f64::from(error) / scale) as f32))
}
