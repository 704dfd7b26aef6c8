//! Whether a JPEG file is whole. Decoders fill what is missing with grey; a face that ends in grey is worse than an
//! error.

/// Walks the segments (ITU-T T.81, annex B) up to the end marker.
pub(super) fn check_complete(bytes: &[u8]) -> Result<(), String> {
    let mut at = 2; // after the start marker
    let mut in_scan = false;
    loop {
        let Some(&[first, marker]) = bytes.get(at..at + 2) else {
            return Err(format!("is cut off: the JPEG has no end marker in its {} bytes", bytes.len()));
        };
        match (first, marker) {
            (0xff, 0xd9) => return Ok(()),
            // Fill bytes, escaped data bytes and restart markers.
            (0xff, 0xff) => at += 1,
            (0xff, 0x00 | 0xd0..=0xd7) if in_scan => at += 2,
            (0xff, _) => {
                in_scan = marker == 0xda;
                at += 2 + segment_length(bytes, at + 2)?;
            }
            _ if in_scan => at += 1,
            _ => return Err(format!("byte {at}: a JPEG marker is expected, found {first:#04x}")),
        }
    }
}

/// Length of a segment, its two length bytes included.
fn segment_length(bytes: &[u8], at: usize) -> Result<usize, String> {
    match bytes.get(at..at + 2) {
        Some(&[high, low]) if u16::from_be_bytes([high, low]) >= 2 => {
            Ok(usize::from(u16::from_be_bytes([high, low])))
        }
        _ => Err(format!("byte {at}: a JPEG segment without a length")),
    }
}
