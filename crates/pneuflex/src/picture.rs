//! Pictures of the states in a result folder, in the manner of those in the guide and of `cargo xtask validate`.

use std::path::Path;

use pneuflex_model::LoadParameter;
use pneuflex_plot::drawing::Drawing;
use pneuflex_plot::picture::{Body, Figure, Panel, View};
use pneuflex_report::state::State;

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

/// How a state is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Pressure, kPa, of an actuator, or time of a model, that must be among the results; `None` for the last one.
    pub at: Option<f64>,
    /// What the colours mean.
    pub colours: Colours,
    /// From where; [`View::OUTSIDE`] shows half models together with their other half, all others cut them open.
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
    let RecordedRun { analysis, summary, states } = RecordedRun::read(folder)?;
    let problem = &analysis.problem;
    let states = states.ok_or_else(|| {
        let help = "solve it again without output.fields = false".to_owned();
        InputError::about_file(folder, "its results have no fields").with_help(Some(help))
    })?;
    let (state, step) = states
        .iter()
        .zip(summary.reached())
        .filter(|(state, _)| look.at.is_none_or(|at| (state.time - at).abs() <= SAME * at.abs().max(SAME)))
        .last()
        .ok_or_else(|| {
            let places: Vec<String> = states.iter().map(|state| rounded(state.time, DIGITS).to_string()).collect();
            let what = match look.at {
                Some(at) => format!("there are no results at {}", problem.clock.words(LoadParameter(at))),
                None => "no state was reached".to_owned(),
            };
            let help = (!places.is_empty()).then(|| format!("there are those at {}", places.join(", ")));
            InputError::about_file(folder, what).with_help(help)
        })?;
    let (field, label) = field(state, look.colours);
    let is_outside = look.view == View::OUTSIDE;
    let body = Body {
        field: field.as_deref(),
        is_mirrored: is_outside && problem.supports.iter().any(|support| support.name == "symmetry"),
        obstacles_at: Some(LoadParameter(state.time)),
        ..Body::plain(problem, &state.displacement)
    };
    let most = step.1.von_mises_p99_mpa;
    let of_stress = (look.colours == Colours::VonMises && most > 0.0).then_some([0.0, most]);
    let range = look.range.or(of_stress);
    let ends = "The colours end at the stress that 99 % of the volume stays below.";
    let mesh = format!("{} elements {}.", summary.mesh.elements, summary.mesh.element);
    let caption = if look.range.is_none() && of_stress.is_some() { format!("{mesh} {ends}") } else { mesh };
    let is_part = !(problem.symmetry.is_empty() || body.is_mirrored);
    let caption = if is_part { format!("{caption} One {} of the body.", problem.modelled_part()) } else { caption };
    let when = problem.clock.words(LoadParameter(rounded(state.time, DIGITS)));
    let figure = Figure {
        caption,
        view: look.view,
        range,
        label: label.into(),
        width: look.width,
        max_panel_height: 0.75 * look.width,
        ..Figure::new(&analysis.title, vec![Panel::new(&format!("at {when}"), body)])
    };
    Ok(figure.draw().map_err(|e| InputError::about_file(folder, e))?)
}

/// A nodal field, and what it is called.
fn field(state: &State, colours: Colours) -> (Option<Vec<f64>>, &'static str) {
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
