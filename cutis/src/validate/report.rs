//! What is said about a validation.

use super::errors::Errors;
use serde::Serialize;
use std::fmt::Write;

/// The JSON object.
#[derive(Debug, Serialize)]
pub struct Report {
    pub version: &'static str,
    pub truth: String,
    pub width: u32,
    pub height: u32,
    pub scenes: Vec<SceneReport>,
    /// Scenes that could not be made here, and why.
    pub skipped: Vec<String>,
    /// Whether nothing is worse than its bound.
    pub passed: bool,
    pub warnings: Vec<String>,
    pub wall_seconds: f64,
}

/// One scene.
#[derive(Debug, Serialize)]
pub struct SceneReport {
    pub name: &'static str,
    pub question: &'static str,
    /// Relative RMSE that the noise of the truth makes.
    pub truth_noise: f64,
    pub entries: Vec<EntryReport>,
}

/// One technique in that scene.
#[derive(Debug, Serialize)]
pub struct EntryReport {
    pub name: String,
    pub errors: Errors,
    /// What the noise of the truth may have done to each number: one standard deviation.
    pub spread: Errors,
    /// What is accepted; nothing for what has no bound yet.
    pub bound: Option<Errors>,
    /// What is worse than that, in words.
    pub worse: Vec<String>,
    pub milliseconds: f64,
}

impl Report {
    /// For people, on stdout.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<15}{:<22}{:>9}{:>27}{:>9}{:>8}{:>8}\n",
            "scene", "technique", "RMSE %", "bias R, G, B %", "FLIP", "noise %", ""
        );
        for (scene, entry) in self.rows() {
            let [r, g, b] = entry.errors.bias_rgb.map(percent);
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{:<15}{:<22}{:>9.1}{r:>+9.1}{g:>+9.1}{b:>+9.1}{:>9.3}{:>8.1}  {}",
                scene.name,
                entry.name,
                percent(entry.errors.relative_rmse),
                entry.errors.flip_hdr,
                percent(scene.truth_noise),
                entry.verdict()
            );
        }
        text
    }

    /// For a document: all numbers, then one of them at a glance.
    pub fn table(&self) -> String {
        let mut text =
            "| scene | technique | relative RMSE, % | bias R, G, B, % | HDR-FLIP | noise of the truth, % |\n\
                        |---|---|---:|---:|---:|---:|\n"
                .to_owned();
        for (scene, entry) in self.rows() {
            let [r, g, b] = entry.errors.bias_rgb.map(percent);
            let _ = writeln!(
                text,
                "| {} | {} | {:.1} | {r:+.1}, {g:+.1}, {b:+.1} | {:.3} | {:.1} |",
                scene.name,
                entry.name,
                percent(entry.errors.relative_rmse),
                entry.errors.flip_hdr,
                percent(scene.truth_noise)
            );
        }
        if self.scenes.is_empty() { text } else { text + "\n" + &self.glance() }
    }

    /// Relative RMSE in percent, a row for each technique and a column for each scene, and the mean time.
    fn glance(&self) -> String {
        let names: Vec<_> = self.scenes.iter().map(|scene| scene.name).collect();
        let mut text = format!("| relative RMSE, % | {} | ms |\n", names.join(" | "));
        text += &format!("|---|{}---:|\n", "---:|".repeat(names.len()));
        for (i, entry) in self.scenes[0].entries.iter().enumerate() {
            // Every scene is drawn by the same entries in the same order.
            let of_entry: Vec<_> = self.scenes.iter().map(|scene| &scene.entries[i]).collect();
            let cells = of_entry.iter().map(|e| format!("{:.1} |", percent(e.errors.relative_rmse)));
            let milliseconds: f64 = of_entry.iter().map(|e| e.milliseconds).sum();
            let mean = milliseconds / of_entry.len() as f64;
            text += &format!("| {} | {} {mean:.0} |\n", entry.name, cells.collect::<Vec<_>>().join(" "));
        }
        text
    }

    fn rows(&self) -> impl Iterator<Item = (&SceneReport, &EntryReport)> {
        self.scenes.iter().flat_map(|scene| scene.entries.iter().map(move |entry| (scene, entry)))
    }

    /// What is worse than its bound, a line each.
    pub fn complaints(&self) -> Vec<String> {
        let line = |(scene, entry): (&SceneReport, &EntryReport)| {
            (!entry.worse.is_empty())
                .then(|| format!("{}, {}: {}", scene.name, entry.name, entry.worse.join("; ")))
        };
        self.rows().filter_map(line).collect()
    }
}

impl EntryReport {
    fn verdict(&self) -> &'static str {
        match (&self.bound, self.worse.is_empty()) {
            (None, _) => "no bound",
            (Some(_), true) => "as before",
            (Some(_), false) => "WORSE",
        }
    }
}

fn percent(part: f64) -> f64 {
    100.0 * part
}
