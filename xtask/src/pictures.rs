//! The pictures of README.md, drawn from the fixtures.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use pneuflex_model::{Case, Problem};
use pneuflex_newton::{Event, follow_path};
use pneuflex_post::picture::{Body, Figure, Panel};
use pneuflex_post::stress;

/// Pressure of the paper's figures, kPa.
const PRESSURE_KPA: f64 = 35.0;

/// Writes `docs/two_chamber.png` and `docs/actuator.png`.
pub fn run() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (fixture, picture) in [("two_chamber.toml", "two_chamber.png"), ("actuator.toml", "actuator.png")] {
        if let Err(error) = draw(&root.join("fixtures").join(fixture), &root.join("docs").join(picture)) {
            eprintln!("{fixture}: {error}");
            return ExitCode::FAILURE;
        }
        println!("docs/{picture}");
    }
    ExitCode::SUCCESS
}

fn draw(case: &Path, picture: &Path) -> Result<(), Box<dyn Error>> {
    let case: Case = toml::from_str(&fs::read_to_string(case)?)?;
    let problem = Problem::from_case(&case)?;
    let pressures: Vec<f64> = case.load.pressure_kpa.iter().copied().filter(|p| *p <= PRESSURE_KPA).collect();
    let mut displacement = Vec::new();
    follow_path(&problem, &pressures, &case.solver, &mut |event| {
        if let Event::Landed(state) = event {
            displacement.clone_from(&state.displacement);
        }
    })
    .map_err(|(failure, _)| failure)?;

    let field = stress::recover(&problem, &displacement)?;
    let von_mises: Vec<f64> = field.at_nodes(&problem).into_iter().map(stress::von_mises).collect();
    let body = Body { field: Some(&von_mises), ..Body::plain(&problem, &displacement) };
    let figure = Figure {
        caption: format!(
            "{}; {} mm elements ({}). The colours end at the stress that 99 % of the volume stays below.",
            case.title,
            case.mesh.size.per_axis()[0],
            case.mesh.element
        ),
        range: Some([0.0, field.von_mises_quantile(0.99)]),
        label: "von Mises stress (MPa)".into(),
        ..Figure::new(
            &format!("Half model at {PRESSURE_KPA} kPa"),
            vec![Panel::new("seen through the symmetry plane", body).with_contact_inset(None)?],
        )
    };
    fs::create_dir_all(picture.parent().unwrap_or(Path::new(".")))?;
    fs::write(picture, figure.draw()?.to_png(1.0)?)?;
    Ok(())
}
