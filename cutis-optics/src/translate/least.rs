//! The length that makes an error least.

/// Step of the first look, in ln length: an error curve of one scale is not narrower.
const STEP: f64 = 0.25;
/// Where the second look ends, in ln length: six digits are written.
const ENOUGH: f64 = 1e-8;

/// The length between two others at which `error` is least: a look at every quarter of e, then golden sections around the
/// best. A curve that falls to an end gives that end.
pub(super) fn least_error_length(from_mm: f64, to_mm: f64, error: impl Fn(f64) -> f64) -> f64 {
    let at = |ln: f64| error(ln.exp());
    let (from, to) = (from_mm.ln(), to_mm.ln());
    let count = ((to - from) / STEP).ceil() as usize;
    let looks = (0..=count).map(|i| from + (to - from) * i as f64 / count as f64);
    let best = looks.map(|x| (x, at(x))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(from, |(x, _)| x);
    golden_section((best - STEP).max(from), (best + STEP).min(to), at).exp()
}

fn golden_section(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > ENOUGH {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - ratio * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + ratio * (high - low);
            fb = f(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_and_a_slope() {
        let least = least_error_length(1e-3, 1e3, |x| (x.ln() - 0.7).powi(2));
        // At the bottom of a parabola values differ by rounding over 1e-8 of the place.
        assert!((least.ln() - 0.7).abs() < 1e-7, "{least}");
        assert!((least_error_length(1.0, 10.0, |x| x) - 1.0).abs() < 1e-7);
        assert!((least_error_length(1.0, 10.0, |x| -x) - 10.0).abs() < 1e-6);
    }

    #[test]
    fn the_deeper_of_two_valleys_is_found() {
        let valleys = |x: f64| (x.ln() + 2.0).abs().min(0.1 + (x.ln() - 2.0).abs());
        assert!((least_error_length(1e-3, 1e3, valleys).ln() + 2.0).abs() < 1e-7);
    }
}
