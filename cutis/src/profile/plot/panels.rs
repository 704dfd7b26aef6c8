//! The figure: r R(r), R(r) with its Gaussians, what the fit leaves, and the spectrum.

use super::axes::{Area, Axes, CHANNEL_PENS, Drawn, ONE_PEN, Pen};
use super::sampled::{Points, Ranges, Sampled, highest, largest_deviation};
use crate::profile::Profiled;
use plotters::prelude::*;

/// Decades of R(r) shown below its highest value.
const DECADES: i32 = 6;

/// Everything that is drawn.
pub struct Figure {
    title: String,
    subtitle: String,
    ranges: Ranges,
    curves: Vec<Curve>,
}

struct Curve {
    /// Name and relative error.
    name: String,
    error: String,
    pen: Pen,
    sampled: Sampled,
}

impl Figure {
    pub fn new(profiled: &Profiled) -> Self {
        let channels = &profiled.channels;
        let ranges = Ranges::of(channels);
        let curve = |(i, channel): (usize, &crate::profile::channel::Channel)| Curve {
            name: match channel.name {
                Some("r") => "red".to_owned(),
                Some("g") => "green".to_owned(),
                Some("b") => "blue".to_owned(),
                _ => "all channels".to_owned(),
            },
            error: format!("{:.3} %", 100.0 * channel.sum.error()),
            pen: if channels.len() == 1 { ONE_PEN } else { CHANNEL_PENS[i] },
            sampled: Sampled::new(channel, &ranges),
        };
        let curves = channels.iter().enumerate().map(curve).collect();
        let most = channels.iter().map(|c| c.sum.sum().terms.len()).max().unwrap_or(0);
        let first = &channels[0];
        let made = format!("{}, {most} Gaussians ({})", first.source_name(), first.sum.method());
        Self {
            title: format!("{}: {made}", profiled.material.name),
            subtitle: profiled.material.origin.clone(),
            ranges,
            curves,
        }
    }

    fn all<'a>(
        &'a self,
        of: impl Fn(&'a Sampled) -> &'a Points + 'a,
    ) -> impl Iterator<Item = &'a Points> + 'a {
        self.curves.iter().map(move |curve| of(&curve.sampled))
    }
}

/// Draws the figure; `scale` is dots per point.
pub fn draw<DB: DrawingBackend>(figure: &Figure, area: &Area<DB>, scale: u32) -> Drawn
where
    DB::ErrorType: 'static,
{
    area.fill(&WHITE)?;
    let area = area.margin(12 * scale, 4 * scale, 4 * scale, 4 * scale);
    let points = |size: u32| ("sans-serif", size * scale).into_font();
    let area = area.titled(&figure.title, points(24))?;
    let area = area.titled(&figure.subtitle, points(15).color(&RGBColor(90, 90, 90)))?;
    let panels = area.split_evenly((2, 2));
    r_profile(figure, &panels[0], scale)?;
    profile(figure, &panels[1], scale)?;
    residual(figure, &panels[2], scale)?;
    spectrum(figure, &panels[3], scale)?;
    area.present()?;
    Ok(())
}

fn r_profile<DB: DrawingBackend>(figure: &Figure, area: &Area<DB>, scale: u32) -> Drawn
where
    DB::ErrorType: 'static,
{
    let axes = Axes { title: "(a) profile times radius", x: "r [mm]", y: "r R(r) [1/mm]", scale };
    let most = highest(figure.all(|s| &s.r_profile)).max(highest(figure.all(|s| &s.r_transmittance)));
    let mut chart = axes.chart(area, 0.0..figure.ranges.r_max_mm, 0.0..1.08 * most)?;
    for (row, curve) in figure.curves.iter().enumerate() {
        axes.curve(&mut chart, &curve.sampled.r_profile, 0.0, curve.pen)?;
        axes.legend(&chart, row, &curve.name, curve.pen)?;
    }
    let below = figure.curves.iter().filter(|curve| !curve.sampled.r_transmittance.is_empty());
    for (i, curve) in below.enumerate() {
        axes.curve(&mut chart, &curve.sampled.r_transmittance, 0.0, curve.pen.dotted())?;
        let name = format!("{}, transmitted", curve.name);
        axes.legend(&chart, figure.curves.len() + i, &name, curve.pen.dotted())?;
    }
    Ok(())
}

fn profile<DB: DrawingBackend>(figure: &Figure, area: &Area<DB>, scale: u32) -> Drawn
where
    DB::ErrorType: 'static,
{
    let axes =
        Axes {
            title: "(b) profile; thin: its fit and the Gaussians", x: "r [mm]", y: "R(r) [1/mm²]", scale
        };
    let most = highest(figure.all(|s| &s.profile)).max(highest(figure.all(|s| &s.transmittance)));
    let top = 10_f64.powf((1.3 * most).log10());
    let bottom = top * 10_f64.powi(-DECADES);
    let (from, to) = figure.ranges.r_log_mm;
    let mut chart = axes.chart(area, (from..to).log_scale(), (bottom..top).log_scale())?;
    for curve in &figure.curves {
        let thin = curve.pen.thin();
        for gaussian in &curve.sampled.gaussians {
            axes.curve(&mut chart, gaussian, bottom, thin)?;
        }
        axes.curve(&mut chart, &curve.sampled.fit, bottom, thin)?;
        axes.curve(&mut chart, &curve.sampled.profile, bottom, curve.pen)?;
        axes.curve(&mut chart, &curve.sampled.transmittance, bottom, curve.pen.dotted())?;
    }
    Ok(())
}

fn residual<DB: DrawingBackend>(figure: &Figure, area: &Area<DB>, scale: u32) -> Drawn
where
    DB::ErrorType: 'static,
{
    let axes = Axes {
        title: "(c) what the fit leaves; relative RMS power error",
        x: "r [mm]",
        y: "r (R - fit) [1/mm]",
        scale,
    };
    // A sum that is the profile leaves nothing: the axis then shows a thousandth of panel (a).
    let floor = 1e-3 * highest(figure.all(|s| &s.r_profile));
    let most = 1.25 * largest_deviation(figure.all(|s| &s.residual));
    let most = if most > 1e-12 { most } else { floor };
    let mut chart = axes.chart(area, 0.0..figure.ranges.r_max_mm, -most..most)?;
    for (row, curve) in figure.curves.iter().enumerate() {
        axes.curve(&mut chart, &curve.sampled.residual, -most, curve.pen)?;
        axes.legend(&chart, row, &format!("{}  {}", curve.name, curve.error), curve.pen)?;
    }
    Ok(())
}

fn spectrum<DB: DrawingBackend>(figure: &Figure, area: &Area<DB>, scale: u32) -> Drawn
where
    DB::ErrorType: 'static,
{
    let axes = Axes { title: "(d) spectrum; thin: of the fit", x: "k [1/mm]", y: "R(k) [no unit]", scale };
    let top = 1.08 * highest(figure.all(|s| &s.spectrum));
    let (from, to) = figure.ranges.k_log_per_mm;
    let mut chart = axes.chart(area, (from..to).log_scale(), 0.0..top)?;
    for (row, curve) in figure.curves.iter().enumerate() {
        axes.curve(&mut chart, &curve.sampled.spectrum_of_fit, 0.0, curve.pen.thin())?;
        axes.curve(&mut chart, &curve.sampled.spectrum, 0.0, curve.pen)?;
        axes.legend(&chart, row, &curve.name, curve.pen)?;
    }
    Ok(())
}
