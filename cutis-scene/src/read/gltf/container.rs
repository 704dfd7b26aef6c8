//! The GLB container: a header and chunks; or plain JSON. (glTF 2.0 specification, section 4.)

use crate::SceneError;
use std::path::Path;

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;

/// Largest JSON text, bytes: honest ones have a few million even for large scenes.
const MAX_JSON_BYTES: usize = 256 << 20;

/// The two parts of a glTF file.
#[derive(Debug)]
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    /// The first buffer, where the file carries it.
    pub(super) binary: Option<&'a [u8]>,
}

/// Splits a file; text that is not GLB is taken for JSON.
pub(super) fn split<'a>(bytes: &'a [u8], file: &Path) -> Result<Container<'a>, SceneError> {
    let fail = |place: String, reason: String| Err(SceneError::new(file, place, reason));
    if bytes.is_empty() {
        return fail("whole file".to_owned(), "is empty".to_owned());
    }
    let container = if bytes.starts_with(MAGIC) {
        split_glb(bytes).or_else(|(at, reason)| fail(format!("byte {at}"), reason))?
    } else if bytes.trim_ascii_start().first().is_some_and(|&b| b == b'{' || b == 0xef) {
        Container { json: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), binary: None }
    } else {
        return fail("byte 0".to_owned(), "begins neither like GLB (`glTF`) nor like JSON (`{`)".to_owned());
    };
    if container.json.len() > MAX_JSON_BYTES {
        return fail(
            "JSON".to_owned(),
            format!("has {} bytes; at most {MAX_JSON_BYTES}", container.json.len()),
        );
    }
    Ok(container)
}

fn split_glb(bytes: &[u8]) -> Result<Container<'_>, (usize, String)> {
    let word = |at: usize| match bytes.get(at..at + 4) {
        Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d])),
        _ => Err((at, format!("the file ends here, after {} bytes", bytes.len()))),
    };
    if word(4)? != 2 {
        return Err((4, format!("GLB version {}; version 2 is read", word(4)?)));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        return Err((8, format!("the header claims {length} bytes, the file has {}", bytes.len())));
    }
    let mut container = Container { json: &[], binary: None };
    let mut at = 12;
    while at < length {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let begin = at + 8;
        let Some(chunk) = bytes[..length].get(begin..begin.saturating_add(size)) else {
            let left = length.saturating_sub(begin);
            return Err((at, format!("a chunk claims {size} bytes, but {left} are left")));
        };
        match kind {
            JSON_CHUNK if container.json.is_empty() => container.json = chunk,
            BINARY_CHUNK if container.binary.is_none() => container.binary = Some(chunk),
            _ => {} // unknown chunks are to be passed over
        }
        at = begin + size.next_multiple_of(4);
    }
    if container.json.is_empty() {
        return Err((12, "there is no JSON chunk".to_owned()));
    }
    Ok(container)
}
