//! A sheet of values to type in, as JSON: for targets whose own files are not made for writing by hand.

use super::{ChannelLoss, Field, Translation};

#[derive(serde::Serialize)]
struct Sheet<'a> {
    target: String,
    material: &'a str,
    place: &'a str,
    fields: &'a [Field],
    notes: &'a [String],
    /// Red, green, blue.
    loss: &'a [ChannelLoss; 3],
}

/// The sheet of a translation.
pub(super) fn sheet(translation: &Translation) -> String {
    let Translation { target, material, place, fields, notes, loss, .. } = translation;
    let sheet = Sheet { target: target.to_string(), material, place, fields, notes, loss };
    serde_json::to_string_pretty(&sheet).expect("plain values are JSON") + "\n"
}
