//! A rubber cylinder crushed with default settings, against the limit of stiff penalties.

use std::path::Path;

use pneuflex::{Change, Study};
use pneuflex_model::Formulation;

use crate::Effort;
use crate::row::Row;

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A lying cylinder of neo-Hookean rubber (R = 10 mm, c10 = 0.25 MPa, κ = 500 MPa, a slice in plane strain) is crushed to half its height by a \
rigid plate, and pressed by a block of the same rubber whose mesh does not match, by 4 mm (`fixtures/cases/crushed_cylinder.toml`, \
`block_on_cylinder.toml`). The files say nothing about the contact: gaps between surfaces are averaged, and multipliers take away what the \
penalty leaves of the depth. Exact is the force with a penalty of 50,000 N/mm³ (for the block: with 5,000 N/mm³ and depths below 10⁻⁶ mm on the mean), \
on the same mesh. Bound: 1 %.";

/// A file below `fixtures/cases`, and its contact with a penalty that leaves no depth.
struct Crush {
    quantity: &'static str,
    file: &'static str,
    stiff: (&'static str, &'static str),
    /// The force in a solution's last state, N.
    force: fn(&pneuflex::post::summary::StepSummary) -> Option<f64>,
}

const ALL: [Crush; 2] = [
    Crush {
        quantity: "force of the plate",
        file: "crushed_cylinder.toml",
        stiff: (
            "obstacle",
            "[{ name = \"plate\", shape = \"plane\", faces = \"ROUND\", point = [0.0, 10.0, 0.0], normal = [0.0, -1.0, 0.0], \
             displacement = [0.0, -5.0, 0.0], stiffness = 50000.0 }]",
        ),
        force: |state| state.obstacles.get("plate").map(|plate| plate.force_n[1]),
    },
    Crush {
        quantity: "force of the block",
        file: "block_on_cylinder.toml",
        stiff: (
            "contact",
            "[{ slave = \"LOW\", master = \"ROUND\", stiffness = 5000.0, penetration_tolerance = 1e-6 }]",
        ),
        force: |state| state.reactions.get("TOP").map(|force| force[1].abs()),
    },
];

/// One row each: the meshes of the files.
pub fn rows(_: Effort) -> Vec<Row> {
    let row = |crush: &Crush| {
        Row::sequence(
            crush.quantity,
            Formulation::Hex8Q1p0,
            &[()],
            |()| ("that of the file".into(), 4.0),
            None,
            0.01,
            |()| Ok([solve(crush, false)?, solve(crush, true)?]),
        )
    };
    ALL.iter().map(row).collect()
}

/// Force at the end, N.
fn solve(crush: &Crush, is_stiff: bool) -> Result<f64, String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cases").join(crush.file);
    let (key, value) = crush.stiff;
    let changes = if is_stiff { vec![Change::new(key, value)] } else { Vec::new() };
    let study = Study::load_with(file, changes).map_err(|e| e.to_string())?;
    let solution = study.solve().map_err(|e| e.to_string())?;
    solution.states.last().and_then(crush.force).ok_or_else(|| "no force".into())
}
