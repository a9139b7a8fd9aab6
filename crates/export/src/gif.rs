//! Pictures as an animated GIF.

use gif::{Encoder, Frame, Repeat};

use crate::error::ExportError;

/// How hard colours are looked for: 1 is best and slowest, 30 quick.
const SPEED: i32 = 10;

/// A picture: red, green and blue of every pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three bytes per pixel.
    pub rgb: Vec<u8>,
}

/// The bytes of an animation that shows every picture for a time, in hundredths of a second, and begins again.
///
/// # Errors
/// [`ExportError::Pictures`] for pictures of different sizes, or none; [`ExportError::TooLarge`] beyond 65,535 pixels.
pub fn write(pictures: &[Picture], hundredths: &[u16]) -> Result<Vec<u8>, ExportError> {
    let Some(first) = pictures.first() else { return Err(ExportError::Pictures) };
    let is_like_it = |picture: &Picture| {
        (picture.width, picture.height) == (first.width, first.height)
            && picture.rgb.len() == 3 * picture.width * picture.height
    };
    if hundredths.len() != pictures.len() || !pictures.iter().all(is_like_it) {
        return Err(ExportError::Pictures);
    }
    let size = |pixels: usize| u16::try_from(pixels).map_err(|_| ExportError::TooLarge { what: "pixels of a GIF" });
    let (width, height) = (size(first.width)?, size(first.height)?);
    let failed = |e: gif::EncodingError| ExportError::Format(e.to_string());
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height, &[]).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    for (picture, delay) in pictures.iter().zip(hundredths) {
        let mut frame = Frame::from_rgb_speed(width, height, &picture.rgb, SPEED);
        frame.delay = *delay;
        encoder.write_frame(&frame).map_err(failed)?;
    }
    drop(encoder);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_comes_back_for_its_time() {
        let picture = |colour: [u8; 3]| Picture { width: 3, height: 2, rgb: colour.repeat(6) };
        let pictures = [picture([200, 10, 10]), picture([10, 10, 200])];
        let bytes = write(&pictures, &[5, 80]).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (3, 2));
        for (picture, delay) in pictures.iter().zip([5, 80]) {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, delay);
            let near = |(a, b): (&[u8], &[u8])| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) < 8);
            assert!(frame.buffer.chunks(4).zip(picture.rgb.chunks(3)).all(near));
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
        assert_eq!(write(&[], &[]), Err(ExportError::Pictures));
        let other = Picture { width: 2, height: 3, ..pictures[0].clone() };
        assert_eq!(write(&[pictures[0].clone(), other], &[1, 1]), Err(ExportError::Pictures));
    }
}
