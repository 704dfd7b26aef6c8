//! Numbers and texts as TOML has them: as short as they can be to be read back as they are.

use glam::Vec3;

/// A text in quotes, as keys and values may be written.
pub(super) fn quoted(text: &str) -> String {
    let escaped = text.chars().fold(String::new(), |mut escaped, c| {
        match c {
            '"' | '\\' => escaped.extend(['\\', c]),
            c if c.is_control() => escaped += &format!("\\u{:04X}", u32::from(c)),
            c => escaped.push(c),
        }
        escaped
    });
    format!("\"{escaped}\"")
}

/// A number of single precision. Debug writes the shortest digits that mean it, with an exponent where they are many.
pub(super) fn number(value: f32) -> String {
    format!("{value:?}")
}

/// A number of double precision.
pub(super) fn double(value: f64) -> String {
    format!("{value:?}")
}

/// Three numbers.
pub(super) fn vector(v: Vec3) -> String {
    list(v.to_array().map(number))
}

/// A list of what is written already.
pub(super) fn list(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(", "))
}

/// The degrees that are read as an angle.
pub(super) fn degrees(rad: f32) -> String {
    shortest(f64::from(rad).to_degrees(), |degrees| degrees.to_radians() as f32 == rad)
}

/// The fewest digits after the point that mean the same as `value`.
pub(super) fn shortest(value: f64, same: impl Fn(f64) -> bool) -> String {
    // Seventeen digits tell all numbers of double precision apart; small ones have zeros before them.
    let rounded = (1..=20).map(|digits| format!("{value:.digits$}"));
    rounded.into_iter().find(|text| text.parse().is_ok_and(&same)).unwrap_or_else(|| double(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn angles_are_written_as_people_do() {
        assert_eq!(degrees(FRAC_PI_2), "90.0");
        assert_eq!(degrees(-PI), "-180.0");
        assert_eq!(degrees(0.0), "0.0");
        assert_eq!(degrees(25.5f64.to_radians() as f32), "25.5");
    }

    #[test]
    fn texts_keep_their_quotes_and_backslashes() {
        for text in ["plain", "a \"b\" \\ c", "tab\there", "two\nlines", "'"] {
            let document: toml::Table = format!("key = {}", quoted(text)).parse().expect("is TOML");
            assert_eq!(document["key"].as_str(), Some(text));
        }
    }
}
