//! The statements that are checked by numbers.

use pneuflex::mesh::Actuator;

use super::Outcome;
use super::places::{Peaks, highest};
use super::plan::{self, Body, Extent, Mesh, Method, PICTURED, PRESSURES, Run};
use super::record::{Places, Statement, on};
use super::shapes::{distance_to_line, tip_distance};
use super::solution::{Solution, Solutions};

/// Runs that a few statements need besides the standard ones: half and whole bodies, and small steps.
pub fn extra_runs(extent: Extent) -> Vec<Run> {
    let mut runs = Vec::new();
    for (body, mesh) in whole_meshes(extent) {
        runs.extend(half_and_whole(body, mesh));
    }
    for body in [Body::TwoChambers, Body::Actuator] {
        for mesh in work_meshes(extent, body) {
            for method in Method::BOTH {
                runs.push(work_run(extent, body, mesh, method));
            }
        }
    }
    runs
}

/// Nothing touches at 5 kPa, and the two variants are the same there.
pub fn no_touch(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "no-touch-5-kpa",
        "At 5 kPa no walls touch, and the two contact variants give the same shape.",
        "Fig. 15: \"at p = 5 kPa, the adjacent air chambers do not contact each other\"; both variants conform.",
        "Least distance of facing walls by dense sampling ≥ 0.1 mm; displacements of the variants equal to 1e-9 of the \
         largest displacement.",
    );
    for (body, mesh) in bodies_and_meshes(extent) {
        let [single, multiple] = both(solutions, body, mesh)?;
        let on = on(body, mesh);
        for solution in [single, multiple] {
            let gap = solution.step(5.0)?.contact.min_gap_mm;
            statement.at_least(&format!("least gap, {}", solution.run.method.name()), &on, gap, 0.1, "mm");
            let touching = solution.step(5.0)?.contact.points_active as f64;
            statement.at_most(&format!("contact points, {}", solution.run.method.name()), &on, touching, 0.0, "");
        }
        let difference = relative_difference(&single.displacement(5.0)?, &multiple.displacement(5.0)?);
        statement.at_most("relative difference of the displacements", &on, difference, 1e-9, "");
    }
    Ok(statement)
}

/// Single-point lets walls through, multiple-point does not.
pub fn penetration(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "penetration-35-kpa",
        "At 35 kPa on large curved faces neighbouring chambers pass through each other with single-point contact, and do \
         not with multiple-point contact.",
        "Figs. 4, 5, 8, 9: \"two adjacent air chambers have penetrated each other in the model with single-point \
         contact\"; \"does not occur at all\" with multiple-point contact.",
        "Depth by dense sampling of the deformed faces, on the coarse mesh: single-point ≥ 0.2 mm, a tenth of the gap, \
         which is seen in a picture; multiple-point ≤ 0.05 mm, a fortieth of the gap, the compliance of the penalty \
         (traction / 4 N/mm³).",
    );
    for body in [Body::TwoChambers, Body::Actuator] {
        let mesh = extent.meshes(body)[0];
        let [single, multiple] = both(solutions, body, mesh)?;
        let (s, m) = (&single.step(PICTURED)?.contact, &multiple.step(PICTURED)?.contact);
        let on = on(body, mesh);
        statement.at_least("depth, single-point", &on, s.max_penetration_mm, 0.2, "mm");
        statement.at_most("depth, multiple-point", &on, m.max_penetration_mm, 0.05, "mm");
        statement.note("area, single-point", &on, s.penetrating_area_mm2, "mm²");
        statement.note("area, multiple-point", &on, m.penetrating_area_mm2, "mm²");
    }
    Ok(statement.limit(
        "The failure of single-point contact belongs to large curved faces; smaller faces leave a fraction of it. See the \
         next statement and the chart.",
    ))
}

/// The same on every mesh, as far as it goes.
pub fn face_sizes(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "penetration-on-every-mesh",
        "On every mesh single-point contact lets walls deeper into each other than multiple-point contact; multiple-point \
         contact stays at the compliance of the penalty on all of them.",
        "Figs. 4, 5, 8, 9, and: \"the present model may have larger mesh size\".",
        "At 35 kPa: depth single-point / multiple-point ≥ 1.5; multiple-point ≤ 0.05 mm.",
    );
    let mut pairs: Vec<(Body, Mesh)> = extent.face_sizes().into_iter().map(|m| (Body::TwoChambers, m)).collect();
    pairs.extend(extent.meshes(Body::Actuator).into_iter().map(|m| (Body::Actuator, m)));
    let mut least: Option<(f64, String)> = None;
    for (body, mesh) in pairs {
        let [single, multiple] = both(solutions, body, mesh)?;
        let depth = |s: &Solution| Ok::<f64, super::Failure>(s.step(PICTURED)?.contact.max_penetration_mm);
        let (s, m) = (depth(single)?, depth(multiple)?);
        let on = on(body, mesh);
        statement.note("largest face side", &on, single.face_size(), "mm");
        statement.note("depth, single-point", &on, s, "mm");
        statement.at_most("depth, multiple-point", &on, m, 0.05, "mm");
        statement.at_least("single-point / multiple-point", &on, s / m, 1.5, "");
        if least.as_ref().is_none_or(|(depth, _)| s < *depth) {
            least = Some((s, on));
        }
    }
    let limit = least.map_or(String::new(), |(depth, on)| {
        format!("Least depth with single-point contact: {depth:.3} mm ({on}), hardly visible in a picture.")
    });
    Ok(statement.remark(&limit))
}

/// All gaps are closed at 35 kPa.
pub fn all_gaps(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "contact-in-every-gap",
        "At 35 kPa all neighbouring chambers touch.",
        "Figs. 8 to 13: contact between all adjacent chambers of the actuator.",
        "Gaps in contact by dense sampling = all (1 of the two chambers, 7 of the actuator).",
    );
    for (body, mesh) in bodies_and_meshes(extent) {
        for solution in both(solutions, body, mesh)? {
            let name = format!("gaps in contact, {}", solution.run.method.name());
            let gaps = solution.step(PICTURED)?.contact.gaps_in_contact;
            statement.at_least(&name, &on(body, mesh), gaps as f64, body.gaps() as f64, "");
        }
    }
    Ok(statement)
}

/// The two variants' shapes part once walls touch.
pub fn variants_part(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "variants-part",
        "The shapes of the two variants coincide at 5 kPa and part as contact sets in.",
        "Fig. 15: both conform at 5 kPa; later multiple-point contact coincides with the experiment, single-point \
         contact does not.",
        "Greatest distance between the bottom centrelines: ≤ 1e-9 mm at 5 kPa; larger at 35 kPa than at 15 kPa by \
         0.1 mm or more on every mesh; ≥ 1 % of the length (0.82 mm) at 35 kPa on the coarse mesh.",
    );
    for (i, mesh) in extent.meshes(Body::Actuator).into_iter().enumerate() {
        let [single, multiple] = both(solutions, Body::Actuator, mesh)?;
        let on = on(Body::Actuator, mesh);
        let mut distances = Vec::new();
        for p in PRESSURES {
            let (a, b) = (&single.step(p)?.centreline, &multiple.step(p)?.centreline);
            distances.push(a.iter().map(|point| distance_to_line(*point, b)).fold(0.0, f64::max));
        }
        statement.at_most("distance at 5 kPa", &on, distances[0], 1e-9, "mm");
        for (p, d) in PRESSURES.iter().zip(&distances).skip(1) {
            let name = format!("distance at {p} kPa");
            if i == 0 && *p == PICTURED {
                statement.at_least(&name, &on, *d, 0.82, "mm");
            } else {
                statement.note(&name, &on, *d, "mm");
            }
        }
        statement.at_least("growth from 15 to 35 kPa", &on, distances[3] - distances[1], 0.1, "mm");
    }
    Ok(statement.limit(
        "Which variant is nearer to the experiment cannot be checked: no measured points survived. How far the shapes part \
         depends on the size of the faces, as penetration does.",
    ))
}

/// Multiple-point contact keeps its shape on large faces.
pub fn larger_mesh(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "larger-mesh-size",
        "Multiple-point contact keeps its shape on a coarser mesh; single-point contact does not.",
        "\"The present model may have larger mesh size (that is, fewer elements) …, while accuracy is improved.\"",
        "At 35 kPa, change of the tip's position from the coarse to the refined mesh: multiple-point ≤ 2 % of the \
         length; single-point at least three times as much.",
    );
    for body in [Body::TwoChambers, Body::Actuator] {
        let meshes = extent.meshes(body);
        let [coarse, refined] = meshes[..] else { continue };
        let mut moved = Vec::new();
        for method in Method::BOTH {
            let line = |mesh| solutions.standard(body, mesh, method).and_then(|s| s.step(PICTURED));
            moved.push(tip_distance(&line(coarse)?.centreline, &line(refined)?.centreline));
        }
        let length = solutions.standard(body, coarse, Method::Multiple)?.problem.mesh.nodes.iter().map(|x| x[0]);
        let length = length.fold(0.0, f64::max);
        let on = format!("{}, {coarse} to {refined}", body.name());
        statement.note("tip moves, single-point", &on, moved[0], "mm");
        statement.at_most("tip moves, multiple-point, share of the length", &on, moved[1] / length, 0.02, "");
        statement.at_least("single-point / multiple-point", &on, moved[0] / moved[1], 3.0, "");
    }
    Ok(statement)
}

/// Where the von Mises stress peaks.
pub fn stress_places(extent: Extent, solutions: &Solutions) -> Outcome<(Statement, Vec<Places>)> {
    let mut statement = Statement::new(
        "peak-stress",
        "With multiple-point contact the von Mises stress peaks in the contact area or at the roots between chambers.",
        "Figs. 6, 7, 10 to 13: the maximum is \"in the contact area between two adjacent air chambers and the root \
         areas connecting two adjacent air chambers\".",
        "At 35 kPa, highest stress at an integration point in these two regions / highest in the rest of the body ≥ 1. \
         Contact area: walls of a gap within a wall's thickness (1 mm) of where they touch; root: within 1.25 mm of the \
         foot of these walls.",
    );
    let mut listed = Vec::new();
    let mut in_contact: Vec<f64> = Vec::new();
    let mut elsewhere_leads = String::new();
    // Finer meshes than one refinement are listed, but the edges' stresses have no limit there.
    let finer = extent.face_sizes().into_iter().filter(|m| *m == plan::FINE).map(|m| (Body::TwoChambers, m));
    for (body, mesh) in bodies_and_meshes(extent).chain(finer) {
        let actuator = match body {
            Body::TwoChambers => Actuator::two_chambers(),
            Body::Actuator => Actuator::full(),
        };
        let solution = solutions.standard(body, mesh, Method::Multiple)?;
        let (places, Peaks { contact, root_between, outer_root, elsewhere }) = highest(solution, &actuator, PICTURED)?;
        let on = on(body, mesh);
        statement.note("contact area", &on, contact, "MPa");
        statement.note("roots between chambers", &on, root_between, "MPa");
        statement.note("roots of the row's outer walls", &on, outer_root, "MPa");
        statement.note("elsewhere", &on, elsewhere, "MPa");
        let ratio = contact.max(root_between) / outer_root.max(elsewhere);
        if mesh == plan::FINE {
            statement.note("these two / the rest", &on, ratio, "");
            if ratio < 1.0 {
                elsewhere_leads =
                    format!(" On the finest mesh another edge leads: these two / the rest = {ratio:.2} ({on}).");
            }
        } else {
            statement.at_least("these two / the rest", &on, ratio, 1.0, "");
        }
        in_contact.push(contact / contact.max(root_between).max(outer_root).max(elsewhere));
        listed.push(places);
    }
    let [least, most] = [f64::min, f64::max].map(|pick| in_contact.iter().copied().reduce(pick).unwrap_or(0.0));
    let limit = format!(
        "The peak is at the roots; the contact area reaches {:.0} to {:.0} % of it. That the very peak is in the contact \
         area, as the paper says of Figs. 10 and 11, is not found. The roots are sharp re-entrant edges, like others of the \
         body, where the highest stress grows with refinement.{elsewhere_leads}",
        100.0 * least,
        100.0 * most
    );
    let statement = if most < 1.0 { statement.limit(&limit) } else { statement };
    Ok((statement, listed))
}

/// The half model and the whole one are the same.
pub fn half_whole(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "half-and-whole",
        "Half of the body with a symmetry plane moves like the whole body.",
        "The paper models one half and mirrors it (Figs. 12, 13).",
        "At 35 kPa, with contact, difference of the displacements at common nodes ≤ 1e-8 of the largest displacement.",
    );
    for (body, mesh) in whole_meshes(extent) {
        let [half, whole] = half_and_whole(body, mesh);
        let (half, whole) = (solutions.get(&half)?, solutions.get(&whole)?);
        let (u, v) = (half.displacement(PICTURED)?, whole.displacement(PICTURED)?);
        let mut other = vec![[f64::NAN; 3]; u.len()];
        for (x, value) in half.problem.mesh.nodes.iter().zip(&mut other) {
            if let Some((node, distance)) = whole.problem.mesh.nearest_node(*x)
                && distance < 1e-9
            {
                *value = v[node];
            }
        }
        let on = on(body, mesh);
        statement.at_most("relative difference of the displacements", &on, relative_difference(&u, &other), 1e-8, "");
        let points = half.step(PICTURED)?.contact.points_active as f64;
        statement.at_least("contact points", &on, points, 1.0, "");
    }
    Ok(statement)
}

/// Work of the pressure is found in the energies.
pub fn energy(extent: Extent, solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "energy-balance",
        "The work of the air pressure equals the strain energy and the penalty energy of the contact.",
        "The model's elastic forces derive from the strain energy; the penalty's energy is ½ k ∫ ⟨−d⟩² dA.",
        "∫ p dV along the path by the trapezoidal rule, from the first pressure reached to 50 kPa, against the change of \
         both energies: ≤ 0.5 %.",
    );
    for body in [Body::TwoChambers, Body::Actuator] {
        for mesh in work_meshes(extent, body) {
            for method in Method::BOTH {
                let solution = solutions.get(&work_run(extent, body, mesh, method))?;
                let (first, last) = (&solution.steps[0], &solution.steps[solution.steps.len() - 1]);
                let work: f64 = solution
                    .steps
                    .windows(2)
                    .map(|w| {
                        let mean_mpa = 0.5e-3 * (w[0].pressure_kpa + w[1].pressure_kpa);
                        mean_mpa * (w[1].cavity_volume_mm3 - w[0].cavity_volume_mm3)
                    })
                    .sum();
                let strain = last.strain_energy_mj - first.strain_energy_mj;
                let penalty = last.contact.penalty_energy_mj - first.contact.penalty_energy_mj;
                let on = format!("{}, {}, steps of {} kPa", on(body, mesh), method.name(), extent.work_step(body));
                statement.note("work of the pressure", &on, work, "mJ");
                statement.note("strain energy", &on, strain, "mJ");
                statement.note("penalty energy", &on, penalty, "mJ");
                let error = (work - strain - penalty).abs() / work.abs();
                statement.at_most("relative difference", &on, error, 0.005, "");
            }
        }
    }
    Ok(statement.remark(
        "Energies are differences between two equilibria, because the full invariant leaves the undeformed body stressed. \
         What remains is mostly the trapezoidal rule.",
    ))
}

/// The clamp feels no resultant of the pressure.
pub fn reactions(solutions: &Solutions) -> Outcome<Statement> {
    let mut statement = Statement::new(
        "reactions",
        "A closed cavity has no resultant: the clamp's reaction along x and z vanishes, with and without contact.",
        "Static equilibrium; the contact traction acts on both surfaces.",
        "|sum of the clamp's reactions| along x and z ≤ 1e-6 N at every pressure reached in every run.",
    );
    for solution in &solutions.0 {
        let largest =
            solution.steps.iter().flat_map(|s| [s.reaction_n[0].abs(), s.reaction_n[2].abs()]).fold(0.0, f64::max);
        statement.at_most("largest reaction along x or z", &solution.run.name, largest, 1e-6, "N");
    }
    Ok(statement)
}

fn bodies_and_meshes(extent: Extent) -> impl Iterator<Item = (Body, Mesh)> {
    [Body::TwoChambers, Body::Actuator]
        .into_iter()
        .flat_map(move |body| extent.meshes(body).into_iter().map(move |mesh| (body, mesh)))
}

/// The single- and the multiple-point run of a body.
pub fn both(solutions: &Solutions, body: Body, mesh: Mesh) -> Outcome<[&Solution; 2]> {
    let [single, multiple] = Method::BOTH;
    Ok([solutions.standard(body, mesh, single)?, solutions.standard(body, mesh, multiple)?])
}

fn whole_meshes(extent: Extent) -> Vec<(Body, Mesh)> {
    let two = extent.meshes(Body::TwoChambers).into_iter().map(|mesh| (Body::TwoChambers, mesh));
    match extent {
        Extent::Full => two.chain([(Body::Actuator, plan::TRILINEAR_COARSE), (Body::Actuator, plan::COARSE)]).collect(),
        Extent::Quick => two.take(1).chain([(Body::Actuator, plan::TRILINEAR_COARSE)]).collect(),
    }
}

/// The same case as one half and as a whole, solved more tightly than the bound asks for.
fn half_and_whole(body: Body, mesh: Mesh) -> [Run; 2] {
    ["half", "whole"].map(|part| {
        let tight = ["solver.tolerance=1e-9", "solver.residual_tolerance=1e-10"].map(String::from);
        let changes = [vec![format!("actuator.part={part}")], tight.to_vec()].concat();
        let run = Run::standard(body, mesh, Method::Multiple).landing_on(vec![PICTURED]);
        Run { has_fields: true, ..run }.varied(part, &changes)
    })
}

fn work_meshes(extent: Extent, body: Body) -> Vec<Mesh> {
    match (extent, body) {
        (Extent::Full, Body::TwoChambers) => extent.meshes(body),
        (Extent::Full, Body::Actuator) => vec![plan::TRILINEAR_COARSE, plan::COARSE],
        (Extent::Quick, Body::TwoChambers) => vec![plan::COARSE],
        (Extent::Quick, Body::Actuator) => vec![plan::TRILINEAR_COARSE],
    }
}

fn work_run(extent: Extent, body: Body, mesh: Mesh, method: Method) -> Run {
    let step = extent.work_step(body);
    let count = (50.0 / step).round() as usize;
    let pressures = (1..=count).map(|i| i as f64 * step).collect();
    Run::standard(body, mesh, method).landing_on(pressures).varied("work", &[])
}

/// Largest difference relative to the largest value; NaN if one of them is.
fn relative_difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let [a, b] = [a, b].map(<[[f64; 3]]>::as_flattened);
    let largest = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let difference = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    let worst = difference.fold(0.0_f64, |m, d| if d.is_nan() || m.is_nan() { f64::NAN } else { m.max(d) });
    if a.len() == b.len() { worst / largest } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_node_is_no_agreement() {
        assert_eq!(relative_difference(&[[1.0, -4.0, 0.0]], &[[1.0, -3.0, 0.0]]), 0.25);
        assert!(relative_difference(&[[1.0, 2.0, 0.0]], &[[f64::NAN, 2.0, 0.0]]).is_nan());
        assert!(relative_difference(&[[1.0; 3], [2.0; 3]], &[[1.0; 3]]).is_nan());
    }
}
