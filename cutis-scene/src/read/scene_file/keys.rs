//! Tables of a scene file: values by key, with the line and full name of the key in every error.

use crate::SceneError;
use glam::{Vec2, Vec3};
use std::ops::{Range, RangeInclusive};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// The text of a scene file.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) file: &'a Path,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// Number of the line in which a byte lies.
    pub(super) fn line(&self, byte: usize) -> usize {
        let before = self.text.as_bytes().get(..byte).unwrap_or(self.text.as_bytes());
        1 + before.iter().filter(|&&b| b == b'\n').count()
    }
}

/// One table of a scene file.
pub(super) struct Keys<'a> {
    source: Source<'a>,
    /// Name with its parents, such as `material.specular`; empty for the whole file.
    name: String,
    table: &'a DeTable<'a>,
    span: Range<usize>,
}

impl<'a> Keys<'a> {
    /// The whole file.
    pub(super) fn root(source: Source<'a>, table: &'a Spanned<DeTable<'a>>) -> Self {
        Self { source, name: String::new(), table: table.get_ref(), span: 0..0 }
    }

    /// An error at a key; at the table itself if it has no such key.
    pub(super) fn error(&self, key: &str, reason: impl Into<String>) -> SceneError {
        let start = self.table.get(key).map_or(self.span.start, |value| value.span().start);
        let place = format!("line {}, key `{}`", self.source.line(start), self.full(key));
        SceneError::new(self.source.file, place, reason)
    }

    /// Where the table stands, for errors that are found later.
    pub(super) fn place(&self) -> String {
        format!("line {}, key `{}`", self.source.line(self.span.start), self.name)
    }

    /// All keys, whatever they are.
    pub(super) fn names(&self) -> impl Iterator<Item = &'a str> {
        self.table.iter().map(|(key, _)| key.get_ref().as_ref())
    }

    fn full(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// Refuses keys other than these, and names the nearest of them.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), SceneError> {
        let Some((key, _)) = self.table.iter().find(|(key, _)| !known.contains(&key.get_ref().as_ref()))
        else {
            return Ok(());
        };
        let nearest = known.iter().min_by_key(|name| edit_distance(name, key.get_ref()));
        let nearest = nearest.copied().unwrap_or_default();
        let place =
            format!("line {}, key `{}`", self.source.line(key.span().start), self.full(key.get_ref()));
        let reason = format!("is not known; did you mean `{nearest}`? Known here: {}", known.join(", "));
        Err(SceneError::new(self.source.file, place, reason))
    }

    /// Whether the key is there.
    pub(super) fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// The kind of value at a key, as TOML calls it.
    pub(super) fn kind(&self, key: &str) -> Option<&'static str> {
        self.table.get(key).map(|value| value.get_ref().type_str())
    }

    fn wrong<T>(&self, key: &str, wanted: &str, value: &DeValue) -> Result<T, SceneError> {
        Err(self.error(key, format!("must be {wanted}, found {}", value.type_str())))
    }

    /// A table below this one.
    pub(super) fn table(&self, key: &str) -> Result<Option<Keys<'a>>, SceneError> {
        let Some(value) = self.table.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Table(table) => {
                Ok(Some(Keys { source: self.source, name: self.full(key), table, span: value.span() }))
            }
            other => self.wrong(key, "a table", other),
        }
    }

    /// A list of tables, as `[[key]]` writes it.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<Keys<'a>>, SceneError> {
        let Some(value) = self.table.get(key) else { return Ok(Vec::new()) };
        let DeValue::Array(array) = value.get_ref() else {
            return self.wrong(key, &format!("a list of tables, written [[{key}]]"), value.get_ref());
        };
        let to_keys = |(i, item): (usize, &'a Spanned<DeValue<'a>>)| match item.get_ref() {
            DeValue::Table(table) => {
                let name = format!("{}[{i}]", self.full(key));
                Ok(Keys { source: self.source, name, table, span: item.span() })
            }
            other => self.wrong(key, "a list of tables", other),
        };
        array.iter().enumerate().map(to_keys).collect()
    }

    /// A text.
    pub(super) fn string(&self, key: &str) -> Result<Option<&'a str>, SceneError> {
        match self.table.get(key).map(Spanned::get_ref) {
            None => Ok(None),
            Some(DeValue::String(text)) => Ok(Some(text.as_ref())),
            Some(other) => self.wrong(key, "a text in quotes", other),
        }
    }

    /// `true` or `false`.
    pub(super) fn boolean(&self, key: &str) -> Result<Option<bool>, SceneError> {
        match self.table.get(key).map(Spanned::get_ref) {
            None => Ok(None),
            Some(DeValue::Boolean(value)) => Ok(Some(*value)),
            Some(other) => self.wrong(key, "true or false", other),
        }
    }

    /// A finite number in double precision.
    pub(super) fn double(&self, key: &str) -> Result<Option<f64>, SceneError> {
        self.table.get(key).map(|value| self.to_number(key, value.get_ref())).transpose()
    }

    /// A finite number.
    pub(super) fn number(&self, key: &str) -> Result<Option<f32>, SceneError> {
        Ok(self.double(key)?.map(|number| number as f32))
    }

    /// A number within limits.
    pub(super) fn number_in(
        &self,
        key: &str,
        limits: RangeInclusive<f32>,
    ) -> Result<Option<f32>, SceneError> {
        let Some(number) = self.number(key)? else { return Ok(None) };
        self.check(key, number, &limits)?;
        Ok(Some(number))
    }

    /// An angle that is written in degrees, within limits in degrees.
    pub(super) fn radians(&self, key: &str, limits: RangeInclusive<f32>) -> Result<Option<f32>, SceneError> {
        self.number_in(key, limits)?;
        // In double precision, so that every angle of single precision has degrees that mean it.
        Ok(self.double(key)?.map(|degrees| degrees.to_radians() as f32))
    }

    fn check(&self, key: &str, number: f32, limits: &RangeInclusive<f32>) -> Result<(), SceneError> {
        if limits.contains(&number) {
            return Ok(());
        }
        let (lo, hi) = (limits.start(), limits.end());
        let range =
            if *lo == f32::MIN_POSITIVE { format!("above 0, up to {hi}") } else { format!("{lo} to {hi}") };
        Err(self.error(key, format!("must be {range}, got {number}")))
    }

    fn to_number(&self, key: &str, value: &DeValue) -> Result<f64, SceneError> {
        let parsed = match value {
            DeValue::Integer(integer) => {
                i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64)
            }
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            other => return self.wrong(key, "a number", other),
        };
        match parsed {
            // Finite as f32, in which most numbers end.
            Some(number) if (number as f32).is_finite() => Ok(number),
            _ => Err(self.error(key, "must be a finite number")),
        }
    }

    /// Three finite numbers in double precision.
    pub(super) fn triple(&self, key: &str) -> Result<Option<[f64; 3]>, SceneError> {
        self.table.get(key).map(|value| self.to_triple(key, value.get_ref())).transpose()
    }

    fn to_triple(&self, key: &str, value: &DeValue) -> Result<[f64; 3], SceneError> {
        let DeValue::Array(array) = value else {
            return self.wrong(key, "a list of three numbers", value);
        };
        if array.len() != 3 {
            return Err(self.error(key, format!("must be a list of three numbers, found {}", array.len())));
        }
        let mut triple = [0.0; 3];
        for (slot, item) in triple.iter_mut().zip(array.iter()) {
            *slot = self.to_number(key, item.get_ref())?;
        }
        Ok(triple)
    }

    /// A list of finite numbers in double precision.
    pub(super) fn doubles(&self, key: &str, most: usize) -> Result<Option<Vec<f64>>, SceneError> {
        let to_number = |item: &Spanned<DeValue>| self.to_number(key, item.get_ref());
        self.array(key, most)?.map(|array| array.iter().map(to_number).collect()).transpose()
    }

    /// A list of lists of three finite numbers.
    pub(super) fn triples(&self, key: &str, most: usize) -> Result<Option<Vec<[f64; 3]>>, SceneError> {
        let to_triple = |item: &Spanned<DeValue>| self.to_triple(key, item.get_ref());
        self.array(key, most)?.map(|array| array.iter().map(to_triple).collect()).transpose()
    }

    fn array(&self, key: &str, most: usize) -> Result<Option<&'a DeArray<'a>>, SceneError> {
        match self.table.get(key).map(Spanned::get_ref) {
            None => Ok(None),
            Some(DeValue::Array(array)) if array.len() <= most => Ok(Some(array)),
            Some(DeValue::Array(array)) => {
                Err(self.error(key, format!("has {} elements; at most {most}", array.len())))
            }
            Some(other) => self.wrong(key, "a list", other),
        }
    }

    /// Three finite numbers.
    pub(super) fn vector(&self, key: &str) -> Result<Option<Vec3>, SceneError> {
        Ok(self.triple(key)?.map(|triple| Vec3::from_array(triple.map(|number| number as f32))))
    }

    /// Three numbers within limits.
    pub(super) fn vector_in(
        &self,
        key: &str,
        limits: RangeInclusive<f32>,
    ) -> Result<Option<Vec3>, SceneError> {
        let Some(vector) = self.vector(key)? else { return Ok(None) };
        vector.to_array().iter().try_for_each(|&number| self.check(key, number, &limits))?;
        Ok(Some(vector))
    }

    /// Two numbers within limits.
    pub(super) fn pair_in(&self, key: &str, limits: RangeInclusive<f32>) -> Result<Option<Vec2>, SceneError> {
        let Some(numbers) = self.doubles(key, 2)? else { return Ok(None) };
        let [x, y] = numbers[..] else {
            return Err(self.error(key, format!("must be a list of two numbers, found {}", numbers.len())));
        };
        let pair = Vec2::new(x as f32, y as f32);
        pair.to_array().iter().try_for_each(|&number| self.check(key, number, &limits))?;
        Ok(Some(pair))
    }

    /// A direction of any length but zero, as a unit vector.
    pub(super) fn direction(&self, key: &str) -> Result<Option<Vec3>, SceneError> {
        let Some(vector) = self.vector(key)? else { return Ok(None) };
        // A unit vector stays as it is written: to divide it by its rounded length would only move its last digit.
        if (vector.length_squared() - 1.0).abs() < 4.0 * f32::EPSILON {
            return Ok(Some(vector));
        }
        match vector.try_normalize() {
            Some(unit) => Ok(Some(unit)),
            None => Err(self.error(key, "has no direction: it is zero, or too long")),
        }
    }

    /// What a key must have.
    pub(super) fn required<T>(&self, key: &str, value: Option<T>) -> Result<T, SceneError> {
        value.ok_or_else(|| self.error(key, "is missing"))
    }
}

/// Insertions, removals and replacements that turn one word into the other (Levenshtein).
fn edit_distance(a: &str, b: &str) -> usize {
    // Hostile keys may be long; sixty-four letters tell words apart.
    let b: Vec<char> = b.chars().take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_levenshtein() {
        for (a, b, distance) in
            [("kitten", "sitting", 3), ("albedo", "albdo", 1), ("", "abc", 3), ("a", "a", 0)]
        {
            assert_eq!(edit_distance(a, b), distance, "{a} {b}");
        }
    }
}
