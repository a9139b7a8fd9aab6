//! `pneuflex picture`: a state of a result folder as a picture.

use std::fs;

use pneuflex::InputError;
use pneuflex::folder::PICTURE;
use pneuflex::picture::{Colours, Look};
use pneuflex::plot::picture::View;

use crate::args::{PictureArguments, PictureColours, PictureView};
use crate::error::CliError;
use crate::terminal::say;

/// Draws the picture and says where it is.
///
/// # Errors
/// A folder that is none of this program's, files that are missing or damaged, results without fields, a state that is not among them, a file that
/// is no picture or cannot be written.
pub fn picture(arguments: &PictureArguments) -> Result<(), CliError> {
    let out = arguments.out.clone().unwrap_or_else(|| arguments.results.join(PICTURE));
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let is_svg = match ending.as_deref() {
        Some("png") => false,
        Some("svg") => true,
        _ => {
            let what = format!("--out {}: a picture ends with .png or .svg", out.display());
            return Err(InputError::new(what).into());
        }
    };
    check_range(arguments.range)?;
    let look = Look {
        at: arguments.at,
        colours: colours(arguments.colour),
        view: view(arguments.view),
        range: arguments.range,
        width: f64::from(arguments.width),
    };
    let drawing = pneuflex::picture::picture(&arguments.results, &look)?;
    let drawn = if is_svg { drawing.to_svg().map(String::into_bytes) } else { drawing.to_png(1.0) };
    let bytes = drawn.map_err(|e| InputError::about_file(&out, e))?;
    fs::write(&out, bytes).map_err(|e| CliError::Output(format!("{}: cannot be written: {e}", out.display())))?;
    say(&format!("wrote {}", out.display()));
    Ok(())
}

/// What the colours mean.
pub fn colours(wanted: PictureColours) -> Colours {
    match wanted {
        PictureColours::VonMises => Colours::VonMises,
        PictureColours::Displacement => Colours::Displacement,
        PictureColours::Contact => Colours::ContactPressure,
        PictureColours::None => Colours::Plain,
    }
}

/// From where.
pub fn view(wanted: PictureView) -> View {
    match wanted {
        PictureView::Iso => View::OUTSIDE,
        PictureView::Section => View::SECTION,
        PictureView::Side => View::SIDE,
    }
}

/// Checks the ends of the colours.
///
/// # Errors
/// Ends between which there is nothing.
pub fn check_range(range: Option<[f64; 2]>) -> Result<(), InputError> {
    match range.filter(|[low, high]| !(low < high && (high - low).is_finite())) {
        None => Ok(()),
        Some([low, high]) => {
            let what = format!("--range {low},{high}: expected two finite numbers, the first one smaller");
            Err(InputError::new(what))
        }
    }
}
