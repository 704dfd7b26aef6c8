//! Axes, lines and legends in one manner for all panels, and in any scale of dots.

use super::sampled::Points;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::error::Error;

/// What drawing may end with.
pub type Drawn = Result<(), Box<dyn Error>>;
/// A part of the figure.
pub type Area<DB> = DrawingArea<DB, Shift>;
/// A panel with its axes.
pub type Chart<'a, DB, X, Y> = ChartContext<'a, DB, Cartesian2d<X, Y>>;
/// A panel with axes over two ranges.
type ChartOn<'a, DB, X, Y> =
    Chart<'a, DB, <X as AsRangedCoord>::CoordDescType, <Y as AsRangedCoord>::CoordDescType>;

const INK: RGBColor = RGBColor(30, 30, 30);
const GRID: RGBColor = RGBColor(225, 225, 225);

/// How a curve is drawn. Dashes tell channels apart in grey, as colours do in colour.
#[derive(Clone, Copy)]
pub struct Pen {
    pub colour: RGBColor,
    /// Points.
    pub width: f64,
    /// Dash and gap in points; none: unbroken.
    pub dash: Option<(u32, u32)>,
    pub opacity: f64,
}

/// Red, green, blue, and the pen of a material that is the same in all.
pub const CHANNEL_PENS: [Pen; 3] = [
    Pen { colour: RGBColor(196, 30, 30), width: 1.8, dash: None, opacity: 1.0 },
    Pen { colour: RGBColor(20, 130, 50), width: 1.8, dash: Some((9, 4)), opacity: 1.0 },
    Pen { colour: RGBColor(30, 70, 190), width: 1.8, dash: Some((3, 3)), opacity: 1.0 },
];
/// One channel alone.
pub const ONE_PEN: Pen = Pen { colour: INK, width: 1.8, dash: None, opacity: 1.0 };

impl Pen {
    /// For what comes out on the other side.
    pub fn dotted(self) -> Self {
        Self { width: 1.4, dash: Some((2, 5)), ..self }
    }

    /// For what stands behind a curve.
    pub fn thin(self) -> Self {
        Self { width: 0.7, dash: None, opacity: 0.45, ..self }
    }
}

/// Words and ranges of a panel.
pub struct Axes<'a> {
    pub title: &'a str,
    pub x: &'a str,
    pub y: &'a str,
    pub scale: u32,
}

impl Axes<'_> {
    fn dots(&self, points: f64) -> i32 {
        (points * f64::from(self.scale)).round() as i32
    }

    /// Axes over two ranges, with grid, numbers and words.
    pub fn chart<'c, DB, X, Y>(
        &self,
        area: &Area<DB>,
        x: X,
        y: Y,
    ) -> Result<ChartOn<'c, DB, X, Y>, Box<dyn Error>>
    where
        DB: DrawingBackend + 'c,
        DB::ErrorType: 'static,
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let title = ("sans-serif", self.dots(17.0)).into_font().color(&INK);
        let mut chart = ChartBuilder::on(area)
            .caption(self.title, title)
            .margin(self.dots(10.0))
            .margin_right(self.dots(22.0))
            .x_label_area_size(self.dots(44.0))
            .y_label_area_size(self.dots(72.0))
            .build_cartesian_2d(x, y)?;
        let words = ("sans-serif", self.dots(15.0)).into_font().color(&INK);
        let numbers = ("sans-serif", self.dots(13.0)).into_font().color(&INK);
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .axis_desc_style(words)
            .label_style(numbers)
            .x_labels(7)
            .y_labels(8)
            .x_label_formatter(&|v| number(*v))
            .y_label_formatter(&|v| number(*v))
            .axis_style(INK.stroke_width(self.scale))
            .bold_line_style(GRID.stroke_width(self.scale))
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(self.dots(4.0))
            .draw()?;
        Ok(chart)
    }

    /// A curve; points outside `y_from..` are left out, as an axis does not cut what is drawn over it.
    pub fn curve<DB, X, Y>(
        &self,
        chart: &mut Chart<DB, X, Y>,
        points: &Points,
        y_from: f64,
        pen: Pen,
    ) -> Drawn
    where
        DB: DrawingBackend,
        DB::ErrorType: 'static,
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let style = pen.colour.mix(pen.opacity).stroke_width(self.dots(pen.width).max(1) as u32);
        for run in points.split(|p| !(p.1.is_finite() && p.1 >= y_from)).filter(|run| run.len() > 1) {
            let run = run.to_vec();
            match pen.dash {
                None => {
                    chart.draw_series(LineSeries::new(run, style))?;
                }
                Some((dash, gap)) => {
                    let (dash, gap) = (dash * self.scale, gap * self.scale);
                    chart.draw_series(DashedLineSeries::new(run, dash, gap, style))?;
                }
            }
        }
        Ok(())
    }

    /// Names beside short strokes, in the upper right corner of the plotting area; `row` counts from the top.
    pub fn legend<DB, X, Y>(&self, chart: &Chart<DB, X, Y>, row: usize, name: &str, pen: Pen) -> Drawn
    where
        DB: DrawingBackend,
        DB::ErrorType: 'static,
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let area = chart.plotting_area().strip_coord_spec();
        let (width, _) = area.dim_in_pixel();
        let (right, y) = (width as i32 - self.dots(8.0), self.dots(14.0 + 19.0 * row as f64));
        let (from, to) = (right - self.dots(40.0), right);
        let anchor = Pos::new(HPos::Right, VPos::Center);
        let words = ("sans-serif", self.dots(14.0)).into_font().color(&INK).pos(anchor);
        let left = from - self.dots(12.0) - area.estimate_text_size(name, &words)?.0 as i32;
        let (half, edge) = (self.dots(9.5), self.dots(3.0));
        // Paper under the words, so that no grid line crosses them.
        area.draw(&Rectangle::new([(left, y - half), (to + edge, y + half)], WHITE.filled()))?;
        let style = pen.colour.mix(pen.opacity).stroke_width(self.dots(pen.width).max(1) as u32);
        let stroke = vec![(from, y), (to, y)];
        match pen.dash {
            None => area.draw(&PathElement::new(stroke, style))?,
            Some((dash, gap)) => {
                let (dash, gap) = (dash * self.scale, gap * self.scale);
                area.draw(&DashedPathElement::new(stroke, dash, gap, style))?;
            }
        }
        area.draw(&Text::new(name.to_owned(), (from - self.dots(6.0), y), words))?;
        Ok(())
    }
}

/// A number of an axis: plain where that is short, powers of ten otherwise.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        // Ticks are sums of steps: twelve digits hide what rounding left.
        let digits = (3.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.3e}").replace(".000e", "e").replace("00e", "e").replace("0e", "e")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_axes_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.30000000000000004, "0.3"),
            (12.0, "12"),
            (0.002, "0.002"),
            (1e-6, "1e-6"),
            (2.5e-5, "2.5e-5"),
            (-0.05, "-0.05"),
            (1e5, "1e5"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
