//! How large the errors may be: `bounds.toml` beside the truth, by scene and entry.

use super::errors::Errors;
use miette::{IntoDiagnostic, Result, miette};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Spreads of a number that chance is granted: one in a thousand, as one side counts.
pub const SPREADS: f64 = 3.0;
/// What rounding on another processor is granted beyond the stored digits, as a part of one.
const ROUNDING: f64 = 1e-4;

/// Errors that are accepted, by scene and by the name of the entry.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bounds(BTreeMap<String, BTreeMap<String, Errors>>);

impl Bounds {
    /// Where they lie.
    pub fn path(folder: &Path) -> PathBuf {
        folder.join("bounds.toml")
    }

    /// Reads them; none where there is no file.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = Self::path(folder);
        if !path.exists() {
            return Ok(Self::default());
        }
        let text = std::fs::read_to_string(&path)
            .map_err(|reason| miette!("{}: cannot be read: {reason}", path.display()))?;
        let bounds: Self = toml::from_str(&text)
            .map(Self)
            .map_err(|error| miette!("{}: {}", path.display(), one_line(error.message())))?;
        let all = bounds.0.values().flat_map(BTreeMap::values);
        if all.flat_map(Errors::list).any(|number| !number.is_finite()) {
            return Err(miette!("{}: a bound is not a finite number", path.display()));
        }
        Ok(bounds)
    }

    /// The bound of an entry.
    pub fn get(&self, scene: &str, entry: &str) -> Option<&Errors> {
        self.0.get(scene)?.get(entry)
    }

    /// Takes what was measured for the bound, to four digits after the point.
    pub fn accept(&mut self, scene: &str, entry: &str, errors: &Errors) {
        let rounded = |x: f64| (x * 1e4).round() / 1e4;
        let bound = Errors {
            relative_rmse: rounded(errors.relative_rmse),
            bias_rgb: errors.bias_rgb.map(rounded),
            flip_hdr: rounded(errors.flip_hdr),
        };
        self.0.entry(scene.to_owned()).or_default().insert(entry.to_owned(), bound);
    }

    /// The file.
    pub fn text(&self) -> Result<String> {
        let mut text =
            "# Errors of the diffuse part that `cutis validate` accepts; written by --update.\n".to_owned();
        for (scene, entries) in &self.0 {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\n[{scene}]");
            for (entry, errors) in entries {
                let [r, g, b] = errors.bias_rgb;
                let _ = writeln!(
                    text,
                    "\"{entry}\" = {{ relative_rmse = {:.4}, bias_rgb = [{r:.4}, {g:.4}, {b:.4}], flip_hdr = {:.4} }}",
                    errors.relative_rmse, errors.flip_hdr
                );
            }
        }
        // What was written by hand is read by the parser once, so that no file is left that cannot be.
        toml::from_str::<BTreeMap<String, BTreeMap<String, Errors>>>(&text).into_diagnostic()?;
        Ok(text)
    }
}

/// What is worse than its bound by more than chance allows, in words; biases count without their sign.
pub fn worse(errors: &Errors, bound: &Errors, spread: &Errors) -> Vec<String> {
    const NAMES: [&str; 5] = ["relative RMSE", "bias of red", "bias of green", "bias of blue", "HDR-FLIP"];
    let numbers = errors.list().into_iter().zip(bound.list()).zip(spread.list()).zip(NAMES);
    let too_much = numbers.filter_map(|(((error, bound), spread), name)| {
        let allowed = bound.abs() + SPREADS * spread + ROUNDING;
        (error.abs() > allowed).then(|| format!("{name} {error:.4} is above {allowed:.4}"))
    });
    too_much.collect()
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: Errors = Errors { relative_rmse: 0.123_449, bias_rgb: [0.01, -0.02, 0.5], flip_hdr: 0.2 };
    const STILL: Errors = Errors { relative_rmse: 0.0, bias_rgb: [0.0; 3], flip_hdr: 0.0 };

    #[test]
    fn bounds_are_read_back() {
        let mut bounds = Bounds::default();
        bounds.accept("sphere", "texture-space/none", &SOME);
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(Bounds::read(folder.path()).expect("none"), Bounds::default());
        std::fs::write(Bounds::path(folder.path()), bounds.text().expect("sound")).expect("written");
        let read = Bounds::read(folder.path()).expect("sound");
        assert_eq!(read, bounds);
        let bound = read.get("sphere", "texture-space/none").expect("there");
        assert!((bound.relative_rmse - 0.1234).abs() < 1e-9 && read.get("sphere", "other").is_none());
        assert!(worse(&SOME, bound, &STILL).is_empty(), "rounding is no failure");
    }

    #[test]
    fn what_is_worse_is_named_unless_chance_explains_it() {
        let bound = Errors { relative_rmse: 0.1, bias_rgb: [0.02, 0.02, 0.4], ..SOME };
        let words = worse(&SOME, &bound, &STILL);
        assert_eq!(words, ["relative RMSE 0.1234 is above 0.1001", "bias of blue 0.5000 is above 0.4001"]);
        let spread = Errors { relative_rmse: 0.008, bias_rgb: [0.0, 0.0, 0.04], ..STILL };
        assert!(worse(&SOME, &bound, &spread).is_empty());
    }

    #[test]
    fn nonsense_is_refused_by_the_file_s_name() {
        let folder = tempfile::tempdir().expect("a folder");
        for text in [
            "[sphere]\nx = 5",
            "sphere = [",
            "[s]\nx = { relative_rmse = nan, bias_rgb = [0.0, 0.0, 0.0], flip_hdr = 0.0 }",
        ] {
            std::fs::write(Bounds::path(folder.path()), text).expect("written");
            let error = Bounds::read(folder.path()).expect_err("nonsense").to_string();
            assert!(error.contains("bounds.toml: ") && !error.contains('\n'), "{error}");
        }
    }
}
