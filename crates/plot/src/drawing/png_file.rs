//! PNG files.

use pneuflex_post::PostError;

use crate::error::PlotError;

/// The bytes of a PNG file with 3 (red, green, blue) or 4 (and opacity) bytes per pixel, sRGB, rows from the top.
///
/// # Errors
/// Bytes that do not fit the size.
pub fn encode(width: usize, height: usize, pixels: &[u8]) -> Result<Vec<u8>, PlotError> {
    let per_pixel = if pixels.len() == 4 * width * height { 4 } else { 3 };
    if pixels.len() != per_pixel * width * height || pixels.is_empty() {
        return Err(PostError::WrongLength {
            what: "image".into(),
            expected: per_pixel * width * height,
            found: pixels.len(),
        }
        .into());
    }
    let too_large = |_| PlotError::NotDrawable { what: format!("an image of {width} by {height} pixels") };
    let (columns, rows) = (u32::try_from(width).map_err(too_large)?, u32::try_from(height).map_err(too_large)?);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(if per_pixel == 4 { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let failed = |e: png::EncodingError| PlotError::NotDrawable { what: e.to_string() };
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}
