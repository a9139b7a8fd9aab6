//! The figures: which of the paper's they stand for, and their drawings.

use pneuflex::model::{LoadParameter, Pressure};
use pneuflex::plot::chart::{Chart, PALETTE, Scale, Series, Style};
use pneuflex::plot::drawing::{Colour, Drawing};
use pneuflex::plot::picture::{self, Panel, View};
use pneuflex::plot::tornado::{Tornado, TornadoBar};
use pneuflex::post::surface_stress::{self, SurfaceState};
use pneuflex::post::{contact, stress};

use super::Outcome;
use super::plan::{Body, Extent, Method, PICTURED, PRESSURES};
use super::record::Sensitivity;
use super::rods::RodResult;
use super::shapes::{MeasuredPoint, tip_distance};
use super::solution::{Solution, Solutions};
use super::statements::both;

/// A drawing with its place in the report.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name of its files.
    pub name: String,
    /// Heading in the report.
    pub heading: String,
    /// What to look at.
    pub text: String,
    /// The drawing.
    pub drawing: Drawing,
}

/// A drawn state: displacements and nodal von Mises stress.
struct State<'a> {
    solution: &'a Solution,
    displacement: Vec<[f64; 3]>,
    von_mises: Vec<f64>,
}

fn state(solution: &Solution) -> Outcome<State<'_>> {
    let displacement = solution.displacement(PICTURED)?;
    let field = stress::recover(&solution.problem, &displacement)?;
    let parameter = LoadParameter(PICTURED);
    let contact = contact::evaluate_at(&solution.problem, &displacement, parameter, &[])?;
    let pressures = [Pressure::from_kpa(PICTURED)];
    let surface = SurfaceState { displacement: &displacement, parameter, pressures: &pressures, contact: &contact };
    let nodal = surface_stress::nodal(&solution.problem, &field, &surface);
    let von_mises = nodal.into_iter().map(stress::von_mises).collect();
    Ok(State { solution, displacement, von_mises })
}

impl State<'_> {
    fn body(&self, has_field: bool, is_mirrored: bool) -> picture::Body<'_> {
        picture::Body {
            field: has_field.then_some(&self.von_mises),
            is_mirrored,
            ..picture::Body::plain(&self.solution.problem, &self.displacement)
        }
    }

    fn p99(&self) -> Outcome<f64> {
        Ok(self.solution.step(PICTURED)?.von_mises_p99_mpa)
    }

    fn mesh(&self) -> String {
        let mesh = self.solution.run.mesh;
        format!(
            "{} elements of {} mm, wall faces up to {:.1} mm ({} elements)",
            mesh.element,
            mesh.size,
            self.solution.face_size(),
            self.solution.problem.mesh.num_elements()
        )
    }
}

/// Figs. 4 to 13.
///
/// # Errors
/// Fields that cannot be read or drawn.
pub fn pictures(extent: Extent, solutions: &Solutions) -> Outcome<Vec<Figure>> {
    let mut figures = Vec::new();
    for (body, plain, stressed) in
        [(Body::TwoChambers, "figure-04-05", "figure-06-07"), (Body::Actuator, "figure-08-09", "figure-10-11")]
    {
        let states = both(solutions, body, extent.meshes(body)[0])?.map(state);
        let [single, multiple] = states;
        let states = [single?, multiple?];
        figures.push(side_by_side(plain, body, &states, false)?);
        figures.push(side_by_side(stressed, body, &states, true)?);
    }
    let [_, multiple] = both(solutions, Body::Actuator, extent.meshes(Body::Actuator)[0])?;
    figures.push(whole(&state(multiple)?)?);
    Ok(figures)
}

fn numbers(name: &str) -> String {
    let mut parts = name.trim_start_matches("figure-").split('-').map(|n| n.trim_start_matches('0'));
    format!("Figs. {} and {}", parts.next().unwrap_or_default(), parts.next().unwrap_or_default())
}

fn side_by_side(name: &str, body: Body, states: &[State<'_>; 2], has_field: bool) -> Outcome<Figure> {
    let mut panels = Vec::new();
    let mut depths = Vec::new();
    // The same gap is enlarged in both: the one that is deepest with single-point contact.
    let deepest = picture::nearest(&states[0].solution.problem, &states[0].displacement)?;
    let gap = deepest.iter().min_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm)).map(|n| n.gap);
    for state in states {
        let contact = &state.solution.step(PICTURED)?.contact;
        depths.push(format!("{:.3} mm", contact.max_penetration_mm));
        let title = format!("{} contact", state.solution.run.method.name());
        panels.push(Panel::new(&title, state.body(has_field, false)).with_contact_inset(gap)?);
    }
    let what = if has_field { "von Mises stress" } else { "deformed configuration" };
    let range = has_field.then_some([0.0, states[0].p99()?.max(states[1].p99()?)]);
    let colours = if has_field {
        " The colours end at the stress that 99 % of the volume stays below, the same in both pictures; \"max\" is the \
         highest nodal value."
    } else {
        ""
    };
    let drawing = picture::Figure {
        caption: format!(
            "Half model, seen through the symmetry plane; {}.{colours} Red: two walls at the same place. Dotted oval: \
             walls more than 0.1 mm inside each other.",
            states[0].mesh()
        ),
        range,
        label: "von Mises stress (MPa)".into(),
        max_panel_height: 430.0,
        inset_width: if body == Body::TwoChambers { 5.0 } else { 6.0 },
        ..picture::Figure::new(&format!("{}, {what} at {PICTURED} kPa", capital(body.name())), panels)
    }
    .draw()?;
    Ok(Figure {
        name: name.into(),
        heading: format!("{}: {what} of half of the {}", numbers(name), body.name()),
        text: format!(
            "Depth by dense sampling: {} with single-point, {} with multiple-point contact.",
            depths[0], depths[1]
        ),
        drawing,
    })
}

fn whole(state: &State<'_>) -> Outcome<Figure> {
    let view = View { azimuth_deg: -58.0, elevation_deg: 26.0, distance: None };
    let panels = vec![
        Panel::new("deformed configuration", state.body(false, true)),
        Panel::new("von Mises stress", state.body(true, true)),
    ];
    let drawing = picture::Figure {
        caption: format!(
            "Half model mirrored at its symmetry plane; multiple-point contact; {}. The colours end at the stress that 99 % \
             of the volume stays below.",
            state.mesh()
        ),
        range: Some([0.0, state.p99()?]),
        label: "von Mises stress (MPa)".into(),
        view,
        max_panel_height: 430.0,
        ..picture::Figure::new(&format!("Whole actuator at {PICTURED} kPa"), panels)
    }
    .draw()?;
    Ok(Figure {
        name: "figure-12-13".into(),
        heading: "Figs. 12 and 13: the whole actuator, multiple-point contact".into(),
        text: "That the whole body moves like its half is checked below (half-and-whole).".into(),
        drawing,
    })
}

/// Sampled depth against the size of the faces.
///
/// # Errors
/// A run that is missing.
pub fn depth_chart(extent: Extent, solutions: &Solutions) -> Outcome<Figure> {
    let mut series = Vec::new();
    for (method, colour) in [(Method::Single, PALETTE[1]), (Method::Multiple, PALETTE[0])] {
        for (element, style) in [("hex27", Style::SolidWithDots), ("hex8-sri", Style::Markers)] {
            let mut points = Vec::new();
            for mesh in extent.face_sizes().into_iter().filter(|m| m.element == element) {
                let solution = solutions.standard(Body::TwoChambers, mesh, method)?;
                points.push([solution.face_size(), solution.step(PICTURED)?.contact.max_penetration_mm]);
            }
            let kind = if element == "hex27" { "quadratic faces" } else { "bilinear faces" };
            series.push(Series::line(&format!("{}, {kind}", method.name()), points).style(style).colour(colour));
        }
    }
    let drawing = Chart {
        x_label: "longest side of a wall face (mm)".into(),
        y_label: "depth at 35 kPa (mm)".into(),
        x_shows: vec![0.0],
        y_shows: vec![0.005, 0.5],
        y_scale: Scale::Logarithmic,
        series,
        caption: "Two chambers; depth by dense sampling of the deformed faces.".into(),
        height: 300.0,
        ..Chart::new("Penetration against the size of the faces")
    }
    .draw()?;
    Ok(Figure {
        name: "penetration-face-size".into(),
        heading: "The claim of Figs. 4 to 9 and its limit".into(),
        text: "How deep walls pass through each other depends on the faces, with single-point contact above all: the numbers are \
               under penetration-on-every-mesh."
            .into(),
        drawing,
    })
}

/// Fig. 15: shapes of both variants, on every mesh of the actuator.
///
/// # Errors
/// A run that is missing.
pub fn shapes(extent: Extent, solutions: &Solutions, measured: &[MeasuredPoint]) -> Outcome<Vec<Figure>> {
    let mut figures = Vec::new();
    for (i, mesh) in extent.meshes(Body::Actuator).into_iter().enumerate() {
        let mut series = Vec::new();
        let [single, multiple] = both(solutions, Body::Actuator, mesh)?;
        let mut apart = Vec::new();
        for p in PRESSURES {
            let distance = tip_distance(&single.step(p)?.centreline, &multiple.step(p)?.centreline);
            apart.push(format!("{distance:.2} mm at {p} kPa"));
        }
        for (method, style, colour) in
            [(Method::Multiple, Style::Solid, PALETTE[0]), (Method::Single, Style::Dashed, PALETTE[1])]
        {
            let solution = solutions.standard(Body::Actuator, mesh, method)?;
            for p in PRESSURES {
                let line = solution.step(p)?.centreline.clone();
                let label = if method == Method::Multiple { format!("{p} kPa") } else { String::new() };
                let name = format!("{} contact", method.name());
                series.push(Series::line(&name, line).style(style).colour(colour).end_label(&label));
            }
        }
        if !measured.is_empty() {
            let points = measured.iter().map(|p| [p.x_mm, p.z_mm]).collect();
            series.push(Series::line("measured points", points).style(Style::Markers).colour(Colour::BLACK));
        }
        let drawing = shape_chart(&format!("Bottom centreline of the actuator, {mesh}"), series)?;
        let (name, which) = if i == 0 { ("figure-15", "") } else { ("figure-15-refined", ", refined mesh") };
        figures.push(Figure {
            name: name.into(),
            heading: format!("Fig. 15: deformed shapes at 5, 15, 25, 35 and 50 kPa{which}"),
            text: format!("Distance of the two variants' tips: {}.", apart.join(", ")),
            drawing,
        });
    }
    Ok(figures)
}

fn shape_chart(title: &str, series: Vec<Series>) -> Outcome<Drawing> {
    Ok(Chart {
        x_label: "x (mm)".into(),
        y_label: "z (mm)".into(),
        x_shows: vec![0.0],
        y_shows: vec![0.0],
        has_equal_axes: true,
        series,
        width: 900.0,
        height: 520.0,
        ..Chart::new(title)
    }
    .draw()?)
}

/// Fig. 16: the rod against the 3D model, and the distance of their tips.
///
/// # Errors
/// A run that is missing.
pub fn rods(rods: &[RodResult], solutions: &Solutions) -> Outcome<Vec<Figure>> {
    let Some(rod) = rods.first() else { return Ok(Vec::new()) };
    let solution = solutions.standard(Body::Actuator, rod.mesh, Method::Multiple)?;
    let mut series = Vec::new();
    for p in PRESSURES {
        let line = solution.step(p)?.centreline.clone();
        series.push(Series::line("3D, multiple-point contact", line).colour(PALETTE[0]).end_label(&format!("{p} kPa")));
    }
    for shape in &rod.shapes {
        series.push(Series::line("rod, five parameters", shape.line.clone()).style(Style::Dashed).colour(PALETTE[1]));
    }
    for (i, shape) in rod.shapes.iter().enumerate() {
        let line = &shape.without_contact;
        // Lines that end at the same place share one label.
        let next = rod.shapes.get(i + 1).filter(|n| tip_distance(&n.without_contact, line) < 2.0);
        let is_labelled = i > 0 && tip_distance(&rod.shapes[i - 1].without_contact, line) < 2.0;
        let label = match next {
            _ if shape.pressure_kpa <= 15.0 || is_labelled => String::new(),
            Some(next) => format!("{}, {} kPa", shape.pressure_kpa, next.pressure_kpa),
            None => format!("{} kPa", shape.pressure_kpa),
        };
        let line = Series::line("rod without contact", line.clone()).style(Style::Dotted).colour(PALETTE[2]);
        series.push(line.end_label(&label));
    }
    let shapes = Figure {
        name: "figure-16".into(),
        heading: "Fig. 16: the 3D model against the rod-based baseline".into(),
        text:
            "The rod is identified from two chambers on 0 to 15 kPa. Without its fifth parameter it knows nothing of \
               contact, like the paper's."
                .into(),
        drawing: shape_chart(&format!("3D model and rod, {}", rod.mesh), series)?,
    };
    let mut series = Vec::new();
    for (i, rod) in rods.iter().enumerate() {
        for (k, what) in ["five parameters", "without contact"].into_iter().enumerate() {
            let points = PRESSURES.iter().zip(&rod.tip_distance).map(|(p, d)| [*p, d[k]]).collect();
            let style = if i == 0 { Style::SolidWithDots } else { Style::DashedWithRings };
            let name = format!("{what}, {}", rod.mesh);
            series.push(Series::line(&name, points).style(style).colour(PALETTE[1 + k]));
        }
    }
    let drawing = Chart {
        x_label: "air pressure (kPa)".into(),
        y_label: "distance of the tips (mm)".into(),
        y_scale: Scale::Logarithmic,
        x_shows: vec![0.0],
        series,
        height: 300.0,
        ..Chart::new("Distance of the rod's tip from that of the 3D model")
    }
    .draw()?;
    let distance = Figure {
        name: "figure-16-tip-distance".into(),
        heading: "Fig. 16 in numbers: how far the rod is off".into(),
        text: "The paper's two models agree up to 15 kPa and part from 25 kPa on; the numbers are under rod-baseline."
            .into(),
        drawing,
    };
    Ok(vec![shapes, distance])
}

/// The tornado of the lengths that are our own reading.
///
/// # Errors
/// Numbers that cannot be drawn.
pub fn tornado(found: &[Sensitivity]) -> Outcome<Option<Figure>> {
    let Some(on) = found.first().and_then(|f| f.angles_deg.first()) else { return Ok(None) };
    let bars = found
        .iter()
        .filter_map(|f| {
            let name = format!("{} {} ± {:.2} mm", f.name, f.value_mm, 0.1 * f.value_mm);
            f.angles_deg.first().map(|a| TornadoBar { name, lowered: a.lowered, raised: a.raised })
        })
        .collect();
    let drawing = Tornado {
        title: "Angle of the end face at 50 kPa, each length changed by 10 %".into(),
        label: "angle (°)".into(),
        centre: on.unchanged,
        bars,
        caption: format!(
            "Actuator, multiple-point contact, {}. \"Base\" is its top between the chambers, with the cavities' floor where it \
             is; a changed gap changes the overall length with it.",
            on.mesh
        ),
        width: 820.0,
    }
    .draw()?;
    Ok(Some(Figure {
        name: "sensitivity".into(),
        heading: "What hangs on our reading of the geometry".into(),
        text: "No drawing of the actuator survived; these lengths are our reading of the paper's numbers.".into(),
        drawing,
    }))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
