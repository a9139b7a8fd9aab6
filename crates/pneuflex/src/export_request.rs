//! An export by the names that people use: those of the command line's options and of Python's arguments.

use pneuflex_plot::picture::View;

use crate::export::{Format, Reel};
use crate::picture::{Colours, Look};

/// Names of the formats.
pub const FORMATS: [&str; 11] = ["stl", "obj", "glb", "csv", "npz", "vtk", "msh", "png", "gif", "mp4", "mould"];

/// Formats that are films, and those with colours.
const FILMS: [&str; 3] = ["png", "gif", "mp4"];
const PAINTED: [&str; 5] = ["obj", "glb", "png", "gif", "mp4"];

/// Width of the pictures of a film, px, and their number.
const WIDTH: f64 = 700.0;
const PICTURES: usize = 40;

/// Thickness of a mould's walls, mm.
const WALL: f64 = 5.0;

/// What is asked of a format; `None` for what it does by itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Pressure, kPa, or time of the only state.
    pub at: Option<f64>,
    /// What the colours mean.
    pub colour: Option<Colours>,
    /// Ends of the colours.
    pub range: Option<[f64; 2]>,
    /// From where a film is seen.
    pub view: Option<View>,
    /// Width of a film's pictures, px.
    pub width: Option<f64>,
    /// How many pictures a film has.
    pub pictures: Option<usize>,
    /// Thickness of a mould's walls, mm.
    pub wall: Option<f64>,
}

/// Why a request is none that a format can meet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFormat {
    /// There is no format of this name.
    #[error("there is no format `{0}`; allowed: {allowed}", allowed = FORMATS.join(", "))]
    Unknown(String),
    /// The format has no use for an option.
    #[error("`{option}` means nothing to the format `{format}`; it is for {allowed}", allowed = .formats.join(", "))]
    Unused {
        /// The option.
        option: &'static str,
        /// The format.
        format: String,
        /// Formats that it is for.
        formats: &'static [&'static str],
    },
    /// The ends of the colours have nothing between them.
    #[error("`range` is {0} to {1}; expected two finite numbers, the smaller one first")]
    Range(f64, f64),
}

impl Format {
    /// The format of a name, one of [`FORMATS`], as it was asked for.
    ///
    /// # Errors
    /// An unknown name, an option that the format has no use for, an empty range.
    pub fn named(name: &str, request: &Request) -> Result<Self, NoFormat> {
        if let Some([low, high]) = request.range.filter(|[low, high]| !(low < high && (high - low).is_finite())) {
            return Err(NoFormat::Range(low, high));
        }
        let format = match name {
            "stl" => Self::Stl(request.at),
            "obj" => Self::Obj(request.look()),
            "glb" => Self::Glb(request.look()),
            "csv" => Self::Csv(request.at),
            "npz" => Self::Npz,
            "vtk" => Self::Vtk,
            "msh" => Self::Msh,
            "png" => request.film(Reel::Png),
            "gif" => request.film(Reel::Gif),
            "mp4" => request.film(Reel::Mp4),
            "mould" => Self::Mould(request.wall.unwrap_or(WALL)),
            _ => return Err(NoFormat::Unknown(name.to_owned())),
        };
        match request.unused(name) {
            None => Ok(format),
            Some((option, formats)) => Err(NoFormat::Unused { option, format: name.to_owned(), formats }),
        }
    }
}

impl Request {
    fn look(&self) -> Look {
        Look {
            at: self.at,
            colours: self.colour.unwrap_or_default(),
            view: self.view.unwrap_or(View::OUTSIDE),
            range: self.range,
            width: self.width.unwrap_or(WIDTH),
        }
    }

    fn film(&self, reel: Reel) -> Format {
        Format::Film { look: self.look(), pictures: self.pictures.unwrap_or(PICTURES), reel }
    }

    /// An option that the format has no use for, with the formats that have.
    fn unused(&self, format: &str) -> Option<(&'static str, &'static [&'static str])> {
        let options: [(&str, bool, &[&str]); 7] = [
            ("at", self.at.is_some(), &["stl", "obj", "glb", "csv"]),
            ("colour", self.colour.is_some(), &PAINTED),
            ("range", self.range.is_some(), &PAINTED),
            ("view", self.view.is_some(), &FILMS),
            ("width", self.width.is_some(), &FILMS),
            ("pictures", self.pictures.is_some(), &FILMS),
            ("wall", self.wall.is_some(), &["mould"]),
        ];
        let unused = options.into_iter().find(|(_, is_given, formats)| *is_given && !formats.contains(&format));
        unused.map(|(option, _, formats)| (option, formats))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_a_format_and_what_it_has_no_use_for_is_refused() {
        for name in FORMATS {
            assert!(Format::named(name, &Request::default()).is_ok(), "{name}");
        }
        let at = Request { at: Some(2.0), ..Request::default() };
        assert_eq!(Format::named("stl", &at), Ok(Format::Stl(Some(2.0))));
        let message = Format::named("npz", &at).unwrap_err().to_string();
        assert_eq!(message, "`at` means nothing to the format `npz`; it is for stl, obj, glb, csv");
        assert!(Format::named("step", &at).unwrap_err().to_string().contains("allowed: stl, obj"));
        let range = Request { range: Some([2.0, 1.0]), ..Request::default() };
        assert_eq!(Format::named("glb", &range), Err(NoFormat::Range(2.0, 1.0)));
    }
}
