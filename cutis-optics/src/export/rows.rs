//! CSV and JSON, in double precision.

use super::{KernelTable, Weights, comments};

pub(super) fn csv(table: &KernelTable) -> String {
    let rows: (&str, Vec<String>) = match &table.weights {
        Weights::Single(weights) => ("weight", weights.iter().map(f64::to_string).collect()),
        Weights::Rgb(weights) => (
            "weight_red,weight_green,weight_blue",
            weights.iter().map(|[r, g, b]| format!("{r},{g},{b}")).collect(),
        ),
    };
    let (header, weights) = rows;
    let row = |(v, w): (&f64, &String)| format!("{v},{w}\n");
    let rows: String = table.variances_mm2.iter().zip(&weights).map(row).collect();
    format!("{}variance_mm2,{header}\n{rows}", comments(table, "#"))
}

pub(super) fn json(table: &KernelTable) -> String {
    serde_json::to_string_pretty(table).expect("plain values are JSON") + "\n"
}
