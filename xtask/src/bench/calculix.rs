//! Input decks for CalculiX, written from a [`Problem`].
//!
//! Units stay mm, N, MPa. Node numbers are ours plus one. Both programs number a hexahedron's nodes alike: corners, then the
//! mid-edges of the bottom, of the top, and those in between.
//!
//! CalculiX's Yeoh law is Σ Cᵢ₀ (Ī₁ − 3)ⁱ + Σ (J − 1)²ⁱ / Dᵢ with the isochoric invariant Ī₁, so that our ½ κ (J − 1)² is
//! D₁ = 2 / κ. A pressure on an element face follows the deformed face if the step is geometrically nonlinear.

use std::fmt::Write as _;

use pneuflex::mesh::ElementKind;
use pneuflex::model::{Invariant, Law, MPA_PER_KPA, Problem};

/// CalculiX's number of the face for each of our local faces −ξ, +ξ, −η, +η, −ζ, +ζ.
///
/// Its faces in its own nodes are 1: 1-2-3-4, 2: 5-8-7-6, 3: 1-5-6-2, 4: 2-6-7-3, 5: 3-7-8-4, 6: 4-8-5-1.
const FACE_NUMBERS: [u8; 6] = [6, 4, 3, 5, 1, 2];

/// Entries that fit on one line of a deck.
const PER_LINE: usize = 16;

/// D₂ and D₃ so large that their terms vanish; CalculiX replaces zeros by numbers of its own.
const NO_TERM: &str = "1e20";

/// Increments of one step: first, whole, smallest, largest. CalculiX shortens them by itself.
const INCREMENTS: &str = "0.2, 1., 1e-4, 1.";

/// Residual and correction relative to their typical sizes, and the residual that is accepted of an increment that converges
/// slowly: by itself CalculiX takes 0.5 % and 2 %, which shows in the tip's third digit.
const TOLERANCES: &str = "1e-6, 1e-4, , , 1e-6";

/// Iterations before convergence is looked at, before the residual of slow convergence counts, before the extrapolation of
/// the iterations counts, and at the most.
const ITERATIONS: &str = "10, 20, 30, 40, 30, 4, , 5";

/// Increments after which CalculiX gives up.
const MOST_INCREMENTS: usize = 200;

/// Writes the deck: one step per pressure (kPa), the displacement of node `tip` (ours) at the end of each.
///
/// Facing walls are not kept from touching: the deck is for pressures at which they stay apart.
///
/// # Errors
/// An `element` (C3D8, C3D20, C3D20R) that does not have the mesh's nodes, or the full invariant, which CalculiX does not have.
pub fn deck(problem: &Problem, element: &str, pressures_kpa: &[f64], tip: usize) -> Result<String, String> {
    let mesh = &problem.mesh;
    match (mesh.kind_of(0), element) {
        (ElementKind::Hex8, "C3D8") | (ElementKind::Hex20, "C3D20" | "C3D20R") => {}
        (kind, _) => return Err(format!("{element} does not have the nodes of {kind:?}")),
    }
    if problem.material.invariant != Invariant::Isochoric {
        return Err("CalculiX knows the isochoric invariant only".to_owned());
    }
    let mut text = String::from("*NODE, NSET=ALL\n");
    for (number, [x, y, z]) in (1..).zip(&mesh.nodes) {
        put(&mut text, format_args!("{number}, {x:.12e}, {y:.12e}, {z:.12e}\n"));
    }
    put(&mut text, format_args!("*ELEMENT, TYPE={element}, ELSET=BODY\n"));
    for element in 0..mesh.num_elements() {
        let entries: Vec<String> = std::iter::once(element as u32)
            .chain(mesh.element(element).iter().copied())
            .map(|number| (number + 1).to_string())
            .collect();
        let lines: Vec<String> = entries.chunks(PER_LINE).map(|line| line.join(", ")).collect();
        put(&mut text, format_args!("{}\n", lines.join(",\n")));
    }
    let material = &problem.material;
    let Law::Yeoh { c10, c20, c30 } = material.law else {
        return Err("the deck is written for Yeoh's law only".to_owned());
    };
    put(&mut text, format_args!("*NSET, NSET=TIP\n{}\n", tip + 1));
    put(&mut text, format_args!("*MATERIAL, NAME=SILICONE\n*HYPERELASTIC, YEOH\n"));
    let d1 = 2.0 / material.bulk_modulus;
    put(&mut text, format_args!("{:e}, {:e}, {:e}, {d1:e}, {NO_TERM}, {NO_TERM}\n", c10, c20, c30));
    text += "*SOLID SECTION, ELSET=BODY, MATERIAL=SILICONE\n*BOUNDARY\n";
    for (dof, _) in problem.held_dofs().iter().enumerate().filter(|(_, held)| **held) {
        let (node, axis) = (dof / 3 + 1, dof % 3 + 1);
        put(&mut text, format_args!("{node}, {axis}, {axis}\n"));
    }
    for pressure in pressures_kpa {
        put(&mut text, format_args!("*STEP, NLGEOM, INC={MOST_INCREMENTS}\n*STATIC\n{INCREMENTS}\n"));
        put(&mut text, format_args!("*CONTROLS, PARAMETERS=FIELD\n{TOLERANCES}\n"));
        put(&mut text, format_args!("*CONTROLS, PARAMETERS=TIME INCREMENTATION\n{ITERATIONS}\n*DLOAD\n"));
        for facet in &problem.cavity_facets() {
            let (element, face) = (facet.element + 1, FACE_NUMBERS[usize::from(facet.face)]);
            put(&mut text, format_args!("{element}, P{face}, {:e}\n", pressure * MPA_PER_KPA));
        }
        text += "*NODE PRINT, NSET=TIP, FREQUENCY=100000\nU\n*END STEP\n";
    }
    Ok(text)
}

fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).expect("a string takes any text");
}

/// Displacements, mm, of the printed node in a `.dat` file at the end of steps 1, 2, … as far as they were reached.
pub fn displacements(dat: &str) -> Vec<[f64; 3]> {
    let mut found: Vec<[f64; 3]> = Vec::new();
    let mut time = None;
    for line in dat.lines() {
        if line.contains("displacements") {
            time = line.rsplit_once("time").and_then(|(_, number)| number.trim().parse::<f64>().ok());
            continue;
        }
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        if let (Some(at), &[_, x, y, z]) = (time, numbers.as_slice()) {
            // Every step lasts one unit of time.
            if (at - (found.len() + 1) as f64).abs() < 1e-6 {
                found.push([x, y, z]);
            }
            time = None;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex::mesh::{Actuator, MeshSize};
    use pneuflex::model::{Contact, Formulation, Material};
    use pneuflex::post::measures::cavity_volume;

    /// CalculiX's faces, as in its manual.
    const FACES: [[usize; 4]; 6] = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];

    fn problem(formulation: Formulation) -> Problem {
        Problem::from_actuator(
            &Actuator::two_chambers(),
            &MeshSize::uniform(4.0),
            formulation,
            Material::default(),
            Contact::default(),
        )
        .unwrap()
    }

    /// Lines of numbers after a keyword, up to the next; continued lines joined.
    fn block(deck: &str, keyword: &str) -> Vec<Vec<String>> {
        let body = deck.split_once(keyword).unwrap().1.split_once('\n').unwrap().1;
        let body = body.split("\n*").next().unwrap().replace(",\n", ", ");
        body.lines().map(|line| line.split(", ").map(|word| word.trim().to_owned()).collect()).collect()
    }

    fn numbers<T: std::str::FromStr>(words: &[String]) -> Vec<T> {
        words.iter().map(|word| word.parse().ok().unwrap()).collect()
    }

    #[test]
    fn normals_of_loaded_faces_point_out_of_the_solid() {
        for (formulation, element) in [(Formulation::Hex8Q1p0, "C3D8"), (Formulation::Hex20, "C3D20R")] {
            let problem = problem(formulation);
            let deck = deck(&problem, element, &[5.0], 0).unwrap();
            let nodes: Vec<Vec<f64>> = block(&deck, "*NODE,").iter().map(|line| numbers(&line[1..])).collect();
            let elements: Vec<Vec<usize>> = block(&deck, "*ELEMENT").iter().map(|line| numbers(&line[1..])).collect();
            assert_eq!(elements[0].len(), problem.mesh.kind_of(0).num_nodes());
            let loads = block(&deck, "*DLOAD");
            assert_eq!(loads.len(), problem.cavity_facets().len());
            let mut volume = 0.0;
            for load in &loads {
                let corners = &elements[load[0].parse::<usize>().unwrap() - 1];
                let face = FACES[load[1].strip_prefix('P').unwrap().parse::<usize>().unwrap() - 1];
                let at = |corner: usize| -> [f64; 3] { nodes[corners[corner - 1] - 1].as_slice().try_into().unwrap() };
                let [a, b, c, d] = face.map(at);
                let mean = |points: &[[f64; 3]]| -> [f64; 3] {
                    std::array::from_fn(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64)
                };
                let (p, q): ([f64; 3], [f64; 3]) =
                    (std::array::from_fn(|i| c[i] - a[i]), std::array::from_fn(|i| d[i] - b[i]));
                // Half the product of the diagonals; CalculiX numbers a face so that it points inwards.
                let area: [f64; 3] = std::array::from_fn(|i| {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    -0.5 * (p[j] * q[k] - p[k] * q[j])
                });
                let (centre, inside) = (mean(&[a, b, c, d]), mean(&[1, 2, 3, 4, 5, 6, 7, 8].map(at)));
                assert!((0..3).map(|i| area[i] * (centre[i] - inside[i])).sum::<f64>() > 0.0, "{load:?}");
                // No other element is behind the face.
                let key = face.map(|corner| corners[corner - 1]);
                assert_eq!(elements.iter().filter(|e| key.iter().all(|node| e.contains(node))).count(), 1);
                assert_eq!(load[2].parse::<f64>().unwrap(), 5e-3);
                volume -= centre[1] * area[1];
            }
            // The faces enclose the air of the modelled half together with the plane of symmetry.
            volume *= problem.parts_of_whole() as f64;
            let expected = cavity_volume(&problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).unwrap();
            assert!((volume - expected).abs() < 1e-9 * expected, "{volume} {expected}");
        }
    }

    #[test]
    fn mid_edge_nodes_are_where_calculix_expects_them() {
        const EDGES: [[usize; 2]; 12] =
            [[1, 2], [2, 3], [3, 4], [4, 1], [5, 6], [6, 7], [7, 8], [8, 5], [1, 5], [2, 6], [3, 7], [4, 8]];
        let nodes = ElementKind::Hex20.reference_nodes();
        for (number, [a, b]) in (9..).zip(EDGES) {
            let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (nodes[a - 1][i] + nodes[b - 1][i]));
            assert_eq!(nodes[number - 1], middle);
        }
    }

    #[test]
    fn what_calculix_does_not_have_is_refused() {
        let mut hex20 = problem(Formulation::Hex20);
        assert!(deck(&hex20, "C3D8", &[5.0], 0).is_err());
        assert!(deck(&problem(Formulation::Hex27), "C3D20", &[5.0], 0).is_err());
        hex20.material.invariant = Invariant::Full;
        assert!(deck(&hex20, "C3D20", &[5.0], 0).is_err());
    }

    #[test]
    fn only_ends_of_steps_are_read() {
        let at = |time: &str, x: &str| {
            format!("\n displacements (vx,vy,vz) for set TIP and time  {time}\n\n        12 {x} 2.0E-01 -3.0E-01\n")
        };
        let dat = at("0.5000000E+00", "9.0E+00") + &at("0.1000000E+01", "1.0E-01") + &at("0.1700000E+01", "8.0E+00");
        assert_eq!(displacements(&dat), [[0.1, 0.2, -0.3]]);
        assert_eq!(displacements(""), [[0.0; 3]; 0]);
    }
}
