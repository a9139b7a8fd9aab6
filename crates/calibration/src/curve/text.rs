//! The bytes of a file as text.

use std::borrow::Cow;

use super::reading::{CurveError, MAX_BYTES};

/// The text of a file: UTF-8, UTF-16 with a byte order mark, and otherwise Windows-1252, which machines like to write.
///
/// # Errors
/// A file larger than [`MAX_BYTES`], or with zero bytes, which is no text.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, CurveError> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file has {} MiB; at most {} MiB are read", bytes.len() >> 20, MAX_BYTES >> 20);
        return Err(CurveError::new(message).help("keep every tenth row, or only the part that is to be fitted"));
    }
    let text = match encoding_rs::Encoding::for_bom(bytes) {
        Some((encoding, length)) => encoding.decode_without_bom_handling(&bytes[length..]).0,
        None => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0,
        },
    };
    if text.contains('\0') {
        return Err(CurveError::new("the file is no text (it has zero bytes)")
            .help("export the table as CSV; spreadsheets (.xlsx) are not read"));
    }
    Ok(text)
}
