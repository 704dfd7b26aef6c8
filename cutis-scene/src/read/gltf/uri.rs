//! Where a glTF file keeps its bytes: data URIs and files beside it.

use crate::SceneError;
use crate::read::file::{Folder, read_bytes};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// What a URI stands for.
pub(super) enum Target {
    Bytes(Vec<u8>),
    File(PathBuf),
}

/// Resolves a URI without reading the file it may name.
pub(super) fn target(uri: &str, folder: &Folder, file: &Path, place: &str) -> Result<Target, SceneError> {
    let fail = |reason: String| SceneError::new(file, place, reason);
    if let Some(data) = uri.strip_prefix("data:") {
        return data_bytes(data).map(Target::Bytes).map_err(fail);
    }
    let scheme = uri.split(['/', '?', '#']).next().unwrap_or_default();
    if let Some((scheme, _)) = scheme.split_once(':') {
        return Err(fail(format!(
            "`{scheme}:` is not supported; only data URIs and files beside this one are"
        )));
    }
    let text = percent_decoded(uri).ok_or_else(|| fail(format!("`{uri}` is not a valid URI")))?;
    folder.resolve(&text).map(Target::File).map_err(fail)
}

/// The bytes behind a URI.
pub(super) fn bytes(uri: &str, folder: &Folder, file: &Path, place: &str) -> Result<Vec<u8>, SceneError> {
    match target(uri, folder, file, place)? {
        Target::Bytes(bytes) => Ok(bytes),
        Target::File(path) => read_bytes(&path, "buffer"),
    }
}

/// The payload of a data URI after `data:`.
fn data_bytes(data: &str) -> Result<Vec<u8>, String> {
    let (head, payload) = data.split_once(',').ok_or("the data URI has no comma")?;
    if !head.ends_with(";base64") {
        return Err("the data URI is not base64".to_owned());
    }
    base64_decoded(payload.as_bytes()).map_err(|at| format!("the data URI is not base64 at character {at}"))
}

/// RFC 4648, section 4, padding optional. The error is the offset of the offending character.
fn base64_decoded(text: &[u8]) -> Result<Vec<u8>, usize> {
    let padding = text.iter().rev().take(2).take_while(|&&b| b == b'=').count();
    let digits = &text[..text.len() - padding];
    if digits.len() % 4 == 1 {
        return Err(text.len());
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for (i, group) in digits.chunks(4).enumerate() {
        let mut bits = 0u32;
        for (j, &digit) in group.iter().enumerate() {
            bits |= base64_digit(digit).ok_or(4 * i + j)? << (18 - 6 * j);
        }
        let [_, a, b, c] = bits.to_be_bytes();
        bytes.extend_from_slice(&[a, b, c][..group.len() - 1]);
    }
    Ok(bytes)
}

fn base64_digit(digit: u8) -> Option<u32> {
    let value = match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(u32::from(value))
}

/// Text with `%41` turned into `A`; `None` if that is not UTF-8.
fn percent_decoded(uri: &str) -> Option<Cow<'_, str>> {
    if !uri.contains('%') {
        return Some(Cow::Borrowed(uri));
    }
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        if first == b'%' {
            let digits = std::str::from_utf8(tail.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &tail[2..];
        } else {
            bytes.push(first);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok().map(Cow::Owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_follows_the_test_vectors_of_rfc_4648() {
        let vectors = [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmFy", "foobar")];
        for (encoded, plain) in vectors {
            assert_eq!(base64_decoded(encoded.as_bytes()), Ok(plain.as_bytes().to_vec()));
        }
        assert_eq!(base64_decoded(b"Zm9*"), Err(3));
        assert_eq!(base64_decoded(b"Zm9vZ"), Err(5));
    }

    #[test]
    fn percent_signs_are_decoded_or_refused() {
        assert_eq!(percent_decoded("a%20b.bin").as_deref(), Some("a b.bin"));
        assert_eq!(percent_decoded("%2e%2e/x").as_deref(), Some("../x"), "and then refused as a path");
        for broken in ["%", "%4", "%zz", "%ff", "%\u{e9}"] {
            assert_eq!(percent_decoded(broken), None, "{broken}");
        }
    }
}
