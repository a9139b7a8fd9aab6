//! Pictures of the states in a result folder, in the manner of those in the guide and of `cargo xtask validate`.

use std::path::{Path, PathBuf};

use pneuflex_model::LoadParameter;
use pneuflex_plot::drawing::Drawing;
use pneuflex_plot::picture::{Body, Figure, Panel, View};
use pneuflex_report::state::State;
use pneuflex_report::summary::Summary;

use crate::analysis::Analysis;

use crate::error::Error;
use crate::input_error::InputError;
use crate::report_page::RecordedRun;
use crate::words::rounded;

/// A state is the one that was asked for if it is no further from it than this, relative to it.
const SAME: f64 = 1e-6;

/// Digits of numbers in the caption.
const DIGITS: i32 = 4;

/// What the colours mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// von Mises stress, MPa.
    #[default]
    VonMises,
    /// How far nodes have moved, mm.
    Displacement,
    /// Traction of opposite walls and obstacles, MPa.
    ContactPressure,
    /// Nothing: one colour.
    Plain,
}

impl Colours {
    /// Those of a name: `von-mises`, `displacement`, `contact`, `none`.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "von-mises" => Some(Self::VonMises),
            "displacement" => Some(Self::Displacement),
            "contact" => Some(Self::ContactPressure),
            "none" => Some(Self::Plain),
            _ => None,
        }
    }
}

/// The view of a name: `iso`, `section`, `side`.
pub fn view_named(name: &str) -> Option<View> {
    match name {
        "iso" => Some(View::OUTSIDE),
        "section" => Some(View::SECTION),
        "side" => Some(View::SIDE),
        _ => None,
    }
}

/// How a state is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Pressure, kPa, of an actuator, or time of a model, that must be among the results; `None` for the last one.
    pub at: Option<f64>,
    /// What the colours mean.
    pub colours: Colours,
    /// From where; [`View::OUTSIDE`] shows a modelled part together with its mirror images, all others cut it open.
    pub view: View,
    /// Range of the colours; `None` for all values, of stresses up to what 99 % of the volume stays below.
    pub range: Option<[f64; 2]>,
    /// Width of the picture, px.
    pub width: f64,
}

impl Default for Look {
    fn default() -> Self {
        Self { at: None, colours: Colours::default(), view: View::OUTSIDE, range: None, width: 1100.0 }
    }
}

/// A drawing of a state of a result folder, with the obstacles where they are then.
///
/// # Errors
/// [`Error::Input`]: a folder that is none of this program's, files that are missing or damaged, results without fields, a pressure or time that is
/// not among them, a range or width that cannot be drawn.
pub fn picture(folder: &Path, look: &Look) -> Result<Drawing, Error> {
    let run = FieldsOfRun::read(folder)?;
    let state = run.place_of(look.at)?;
    let range = look.range.or_else(|| run.stress_range(look.colours, state..state + 1));
    let ends = "The colours end at the stress that 99 % of the volume stays below.";
    let is_cut = look.range.is_none() && range.is_some();
    let words = if is_cut { ends } else { "" };
    run.draw(look, &run.states[state], &Shown { range, words, room: None, sharpness: 2.0 })
}

/// What a run has written about its states, with fields.
pub(crate) struct FieldsOfRun {
    folder: PathBuf,
    pub(crate) analysis: Analysis,
    pub(crate) summary: Summary,
    /// In the order of the path, at least one.
    pub(crate) states: Vec<State>,
}

impl FieldsOfRun {
    pub(crate) fn read(folder: &Path) -> Result<Self, Error> {
        let RecordedRun { analysis, summary, states } = RecordedRun::read(folder)?;
        let states = states.ok_or_else(|| {
            let help = "solve it again without output.fields = false".to_owned();
            InputError::about_file(folder, "its results have no fields").with_help(Some(help))
        })?;
        if states.is_empty() {
            return Err(InputError::about_file(folder, "no state was reached").into());
        }
        Ok(Self { folder: folder.to_owned(), analysis, summary, states })
    }

    /// The number of the state at a pressure or time, of several the last; of all if nothing is said.
    pub(crate) fn place_of(&self, at: Option<f64>) -> Result<usize, InputError> {
        let is_there = |state: &State| at.is_none_or(|at| (state.time - at).abs() <= SAME * at.abs().max(SAME));
        self.states.iter().rposition(is_there).ok_or_else(|| {
            let places: Vec<String> = self.states.iter().map(|state| rounded(state.time, DIGITS).to_string()).collect();
            let what = format!("there are no results at {}", self.when(at.unwrap_or_default()));
            InputError::about_file(&self.folder, what)
                .with_help(Some(format!("there are those at {}", places.join(", "))))
        })
    }

    /// A pressure or time in words.
    pub(crate) fn when(&self, at: f64) -> String {
        self.analysis.problem.clock.words(LoadParameter(rounded(at, DIGITS)))
    }

    /// The range of stresses of some states: what 99 % of the volume stays below. `None` for other fields.
    pub(crate) fn stress_range(&self, colours: Colours, states: std::ops::Range<usize>) -> Option<[f64; 2]> {
        let p99 = self.summary.reached().map(|(_, reached)| reached.von_mises_p99_mpa);
        let most = p99.take(states.end).skip(states.start).fold(0.0, f64::max);
        (colours == Colours::VonMises && most > 0.0).then_some([0.0, most])
    }

    /// A state as a figure, which says something of itself.
    pub(crate) fn draw(&self, look: &Look, state: &State, shown: &Shown<'_>) -> Result<Drawing, Error> {
        let problem = &self.analysis.problem;
        let (field, label) = field(state, look.colours);
        let body = Body {
            field: field.as_deref(),
            is_mirrored: look.view == View::OUTSIDE && !problem.symmetry.is_empty(),
            obstacles_at: Some(LoadParameter(state.time)),
            ..Body::plain(problem, &state.displacement)
        };
        let mesh = &self.summary.mesh;
        let is_part = !(problem.symmetry.is_empty() || body.is_mirrored);
        let part = if is_part { format!("One {} of the body.", problem.modelled_part()) } else { String::new() };
        let caption = [&format!("{} elements {}.", mesh.elements, mesh.element), shown.words, &part];
        let caption: Vec<&str> = caption.into_iter().filter(|words| !words.is_empty()).collect();
        let figure = Figure {
            caption: caption.join(" "),
            view: look.view,
            range: shown.range,
            label: label.into(),
            width: look.width,
            max_panel_height: 0.75 * look.width,
            room: shown.room.clone(),
            sharpness: shown.sharpness,
            ..Figure::new(&self.analysis.title, vec![Panel::new(&format!("at {}", self.when(state.time)), body)])
        };
        Ok(figure.draw().map_err(|e| InputError::about_file(&self.folder, e))?)
    }
}

/// What several pictures of a run have in common.
#[derive(Clone, Debug)]
pub(crate) struct Shown<'a> {
    pub range: Option<[f64; 2]>,
    /// What is said below.
    pub words: &'a str,
    pub room: Option<[Vec<[f64; 3]>; 2]>,
    pub sharpness: f64,
}

/// A nodal field, and what it is called.
pub(crate) fn field(state: &State, colours: Colours) -> (Option<Vec<f64>>, &'static str) {
    match colours {
        Colours::VonMises => (Some(state.von_mises.clone()), "von Mises stress (MPa)"),
        Colours::Displacement => {
            let length = |u: &[f64; 3]| pneuflex_mesh::vector::norm(*u);
            (Some(state.displacement.iter().map(length).collect()), "displacement (mm)")
        }
        Colours::ContactPressure => (Some(state.contact_pressure.clone()), "contact pressure (MPa)"),
        Colours::Plain => (None, ""),
    }
}
