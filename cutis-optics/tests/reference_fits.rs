//! Our dipoles and fits against an independent table over the 36 measured profiles of Jensen et al. 2001.
//!
//! The table lies outside the repository: `../reference/jmlh01_gaussian_fits.csv` beside the folder that `CUTIS_ASSETS` names.
#![allow(clippy::unwrap_used, reason = "tests")]

use cutis_optics::presets::measured_media::MEASURED_MEDIA;
use cutis_optics::{Dipole, FitMethod, Medium, Profile, fit};
use std::path::PathBuf;

/// The table's boundary uses the three-digit polynomial of Jensen et al. 2001, ours the four-digit one: A differs by this.
const A_DIFFERENCE: f64 = 2.5e-4;

struct Row {
    material: String,
    channel: usize,
    medium: Medium,
    total: f64,
    error: f64,
    variances_mm2: Vec<f64>,
}

impl Row {
    fn label(&self) -> String {
        format!("{} {} K = {}", self.material, self.channel, self.variances_mm2.len())
    }

    /// The last term has fled to infinity: such a row is a fit of one term less and not the global optimum.
    fn is_degenerate(&self) -> bool {
        let [.., before, last] = self.variances_mm2[..] else { return false };
        last > 1000.0 * before
    }
}

/// The table, or `None` with a word on stderr where it is not at hand; `CUTIS_REQUIRE_ASSETS=1` makes that a failure.
fn reference_rows(test: &str) -> Option<Vec<Row>> {
    let default = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/assets"));
    let assets = std::env::var_os("CUTIS_ASSETS").map_or(default, PathBuf::from);
    // Not `join("..")`: the assets folder itself need not exist for its neighbour to be there.
    let path = assets.parent().unwrap_or(&assets).join("reference/jmlh01_gaussian_fits.csv");
    match std::fs::read_to_string(&path) {
        Ok(text) => Some(text.lines().skip(1).map(row).collect()),
        Err(why) => {
            let required = std::env::var("CUTIS_REQUIRE_ASSETS").is_ok_and(|v| v == "1");
            assert!(!required, "{test} needs {}: {why}", path.display());
            eprintln!("SKIPPED: {test}: {}: {why}", path.display());
            None
        }
    }
}

fn row(line: &str) -> Row {
    let cells: Vec<&str> = line.split(',').collect();
    let number = |i: usize| cells[i].parse::<f64>().unwrap();
    let gaussians: usize = cells[2].parse().unwrap();
    Row {
        material: cells[0].to_lowercase(),
        channel: "RGB".find(cells[1]).unwrap(),
        medium: Medium::new(number(5), number(4), number(3)).unwrap(),
        total: number(6),
        error: number(7),
        variances_mm2: (8..8 + gaussians).map(number).collect(),
    }
}

#[test]
fn the_media_we_carry_are_those_of_the_table() {
    let Some(rows) = reference_rows("the_media_we_carry_are_those_of_the_table") else { return };
    assert_eq!(rows.len(), 108);
    for row in rows {
        let mine = MEASURED_MEDIA.iter().find(|(name, _)| name.replace('-', "") == row.material).unwrap();
        assert_eq!(mine.1[row.channel], row.medium, "{}", row.label());
    }
}

#[test]
fn totals_meet_the_table() {
    let Some(rows) = reference_rows("totals_meet_the_table") else { return };
    for row in rows {
        let total = Dipole::new(&row.medium).unwrap().total();
        // R_d depends on A through e^-x_v, x_v = x + (4A/3) x: d ln R_d / d ln A is at most max(x e^-x) < 0.37.
        // Half a unit of the sixth decimal is the table's own rounding.
        let tolerance = 0.37 * A_DIFFERENCE * row.total + 5e-7;
        assert!((total - row.total).abs() < tolerance, "{}: {total} against {}", row.label(), row.total);
    }
}

#[test]
fn totals_with_the_table_s_own_boundary_agree_to_its_last_digit() {
    let Some(rows) = reference_rows("totals_with_the_table_s_own_boundary_agree_to_its_last_digit") else {
        return;
    };
    for row in rows {
        let m = row.medium;
        let eta = m.refractive_index;
        let fdr = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
        let x = m.sigma_tr_per_mm() * m.transport_mean_free_path_mm();
        let virtual_x = x * (1.0 + 4.0 / 3.0 * (1.0 + fdr) / (1.0 - fdr));
        let total = 0.5 * m.albedo_reduced() * ((-x).exp() + (-virtual_x).exp());
        assert!((total - row.total).abs() < 5.1e-7, "{}: {total} against {}", row.label(), row.total);
    }
}

#[test]
fn optimal_fits_meet_the_global_optima() {
    let Some(rows) = reference_rows("optimal_fits_meet_the_global_optima") else { return };
    for row in rows.iter().filter(|row| !row.is_degenerate()) {
        let f = fit(&Dipole::new(&row.medium).unwrap(), row.variances_mm2.len(), FitMethod::Optimal).unwrap();
        // The error follows A less than proportionally; seen: 8e-5 at most. Asked: 1e-3.
        let off = f.relative_rms_power_error / row.error - 1.0;
        assert!(off.abs() < A_DIFFERENCE, "{}: off by {off:e}", row.label());
        for (term, variance) in f.sum.terms.iter().zip(&row.variances_mm2) {
            // At a minimum the error is flat: variances may differ by the root of what the errors do.
            let off = term.variance_mm2 / variance - 1.0;
            assert!(off.abs() < A_DIFFERENCE.sqrt(), "{}: variance {variance} off by {off:e}", row.label());
        }
    }
}

#[test]
fn rows_whose_last_term_fled_are_beaten() {
    let Some(rows) = reference_rows("rows_whose_last_term_fled_are_beaten") else { return };
    let fled: Vec<&Row> = rows.iter().filter(|row| row.is_degenerate()).collect();
    assert_eq!(fled.len(), 7);
    for row in fled {
        let f = fit(&Dipole::new(&row.medium).unwrap(), row.variances_mm2.len(), FitMethod::Optimal).unwrap();
        // One term more is worth a factor of about four everywhere else in the table.
        let ratio = f.relative_rms_power_error / row.error;
        assert!(ratio < 1.0 / 3.0, "{}: {ratio}", row.label());
    }
}
