//! The results that can be differentiated: by their columns, with their values and derivatives at a state.

use std::collections::BTreeSet;

use pneuflex_model::{Pressure, Problem};
use pneuflex_newton::ConvergedState;
use pneuflex_newton::adjoint::{Frozen, Objective};
use pneuflex_post::peak::Peak;
use pneuflex_post::smallest_gap::SmallestGap;
use pneuflex_post::summary::{StepSummary, probe_sites};
use pneuflex_post::{PostError, measures};

use super::beside_columns::{Along, beside_columns, mass};
use crate::analysis::Analysis;
use crate::columns::{Tip, columns};
use crate::find::FORCE;
use crate::input_error::{InputError, InputErrorKind};

/// A result: a weighted sum of parts, whose weights are those of the state that it is of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scalar {
    /// Its column, the name of a vector or [`FORCE`].
    pub column: String,
    /// Its value there.
    pub value: f64,
    parts: Vec<(f64, Part)>,
}

/// A part of a result.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    EndFaceAngle,
    ChordAngle,
    /// Displacement of a node along an axis.
    Displacement(usize, usize),
    /// Volume of all cavities.
    Volume,
    /// Volume of a cavity, by its number.
    VolumeOf(usize),
    /// Pressure of a cavity, by its number.
    Pressure(usize),
    /// Force of a support along an axis; of all supports without a name.
    Reaction(Option<String>, usize),
    /// Force on an obstacle, by its number, along an axis.
    Obstacle(usize, usize),
    Energy,
    /// Position of a point of the bottom centreline along an axis, mm.
    Centreline(Along, usize),
    /// Volume of the solid, mm³.
    SolidVolume,
    /// Its mass, g.
    Mass,
    /// A smooth measure of the largest stress or stretch.
    Peak(Peak),
    /// A smooth measure of the smallest gap between walls.
    Gap(SmallestGap),
}

impl Scalar {
    /// Whether there are derivatives of the result of a name in states like this one.
    ///
    /// # Errors
    /// A result that the body does not have, or that has no derivative.
    pub fn check(name: &str, state: &StepSummary, analysis: &Analysis, tip: &Tip) -> Result<(), InputError> {
        let rest = vec![[0.0; 3]; analysis.problem.mesh.num_nodes()];
        if beside_columns(name, &analysis.problem, &rest)?.is_some() {
            return Ok(());
        }
        let columns = columns_of(name, state, tip)?;
        columns.iter().try_for_each(|column| part(column, analysis, tip).map(drop))
    }

    /// The result of a name in a state, of which there is a summary: a column, with or without its unit, a vector, whose length it is, [`FORCE`],
    /// or what [`beside_columns`] has.
    ///
    /// # Errors
    /// As [`Self::check`]; a vector of no length.
    pub fn find(
        name: &str,
        (state, summary): (&ConvergedState, &StepSummary),
        analysis: &Analysis,
        tip: &Tip,
    ) -> Result<Self, InputError> {
        if let Some((column, part)) = beside_columns(name, &analysis.problem, &state.displacement)? {
            let mut found = Self { column, value: 0.0, parts: vec![(1.0, part)] };
            let (displacement, cavity_pressures) = (state.displacement.clone(), state.cavity_pressures.clone());
            let frozen = Frozen { displacement, cavity_pressures, lagrangians: Vec::new() };
            let value = found.explicit(&analysis.problem, &frozen);
            found.value = value.map_err(|error| refused(name, &error.to_string()))?;
            if found.is_at_corner() {
                return Err(refused(name, "nothing is deformed there, where it has a corner"));
            }
            return Ok(found);
        }
        let found = columns(summary, tip);
        let value = |column: &String| found.get(column).and_then(serde_json::Value::as_f64).unwrap_or_default();
        let names = columns_of(name, summary, tip)?;
        let values: Vec<f64> = names.iter().map(value).collect();
        let ([column], [value]) = (&names[..], &values[..]) else {
            let length = values.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length == 0.0 {
                return Err(refused(name, "the vector is zero there, and its length has a corner"));
            }
            let weighted = names.iter().zip(values);
            let parts = weighted.map(|(column, value)| Ok((value / length, part(column, analysis, tip)?)));
            let parts = parts.collect::<Result<_, InputError>>()?;
            return Ok(Self { column: name.to_owned(), value: length, parts });
        };
        Ok(Self { column: column.clone(), value: *value, parts: vec![(1.0, part(column, analysis, tip)?)] })
    }

    /// Whether it is a measure of a stress or stretch that is the same as at rest everywhere.
    fn is_at_corner(&self) -> bool {
        self.parts.iter().any(|(_, part)| matches!(part, Part::Peak(peak) if self.value == peak.at_rest()))
    }

    /// What of it the adjoint is told at a state.
    ///
    /// # Errors
    /// A state that is none of the problem's.
    pub fn objective(&self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<Objective, PostError> {
        let zero = || vec![[0.0; 3]; displacement.len()];
        let mut objective = Objective { by_displacement: zero(), ..Objective::default() };
        let mut by_pressure = vec![0.0; problem.cavities.len()];
        let mut reactions: Option<Vec<[f64; 3]>> = None;
        for (weight, part) in &self.parts {
            let gradient = match part {
                Part::EndFaceAngle => Some(measures::end_face_angle_gradient(problem, displacement)?),
                Part::ChordAngle => Some(measures::chord_angle_gradient(problem, displacement)?),
                Part::Volume => Some(measures::cavity_volume_gradient(problem, displacement)?),
                Part::VolumeOf(number) => measures::volume_gradient(problem, &problem.cavities[*number], displacement)?,
                Part::Displacement(node, axis) => {
                    objective.by_displacement[*node][*axis] += weight;
                    None
                }
                Part::Centreline(along, axis) => {
                    for (node, own) in along.weights(problem).unwrap_or_default() {
                        objective.by_displacement[node as usize][*axis] += weight * own;
                    }
                    None
                }
                Part::SolidVolume | Part::Mass => None,
                Part::Peak(peak) => Some(peak.gradient(problem, displacement)?),
                Part::Gap(gap) => Some(gap.gradient(problem, displacement)?),
                Part::Pressure(number) => {
                    by_pressure[*number] += weight * Pressure::from_mpa(1.0).kpa();
                    None
                }
                Part::Reaction(support, axis) => {
                    let own = weights_of_reaction(problem, support.as_deref(), *axis);
                    add(reactions.get_or_insert_with(zero), *weight, &own);
                    None
                }
                Part::Obstacle(number, axis) => {
                    let own = weights_on_obstacle(problem, *number, *axis);
                    objective.obstacles.push((*number, own.map(|own| weight * own)));
                    None
                }
                Part::Energy => {
                    objective.energy += weight * problem.parts_of_whole() as f64;
                    None
                }
            };
            if let Some(gradient) = gradient {
                add(&mut objective.by_displacement, *weight, &gradient);
            }
        }
        Ok(Objective { by_pressure, reactions: reactions.unwrap_or_default(), ..objective })
    }

    /// Its slope by the places of nodes, where it is a function of where these are now: 0 where all of it is found by the adjoint. `None` where it also
    /// depends on where they were at rest.
    ///
    /// # Errors
    /// As [`Self::objective`]; what there is no such slope of.
    pub fn slope_by_positions(
        &self,
        problem: &Problem,
        displacement: &[[f64; 3]],
    ) -> Result<Option<Vec<[f64; 3]>>, PostError> {
        let mut slope = vec![[0.0; 3]; displacement.len()];
        for (weight, part) in &self.parts {
            let gradient = match part {
                Part::Volume => measures::cavity_volume_gradient(problem, displacement)?,
                Part::VolumeOf(number) => {
                    let cavity = &problem.cavities[*number];
                    measures::volume_gradient(problem, cavity, displacement)?.unwrap_or_default()
                }
                Part::Gap(gap) => gap.gradient(problem, displacement)?,
                Part::Displacement(..) | Part::Pressure(_) | Part::Reaction(..) | Part::Obstacle(..) | Part::Energy => {
                    continue;
                }
                Part::EndFaceAngle
                | Part::ChordAngle
                | Part::Centreline(..)
                | Part::SolidVolume
                | Part::Mass
                | Part::Peak(_) => return Ok(None),
            };
            add(&mut slope, *weight, &gradient);
        }
        Ok(Some(slope))
    }

    /// Refuses the result of a name that has no derivative by the places of nodes at rest.
    ///
    /// # Errors
    /// One that depends on all of them by itself, as volumes of elements do.
    pub fn check_shape(name: &str, problem: &Problem) -> Result<(), InputError> {
        let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
        match beside_columns(name, problem, &rest)? {
            Some((_, Part::SolidVolume | Part::Mass | Part::Peak(_))) => Err(refused(
                name,
                "it is a sum over the volumes of all elements at rest, which is not differentiated by nodes",
            )),
            _ => Ok(()),
        }
    }

    /// The parts that the adjoint does not evaluate, of a problem at the frozen unknowns.
    ///
    /// # Errors
    /// As [`Self::objective`].
    pub fn explicit(&self, problem: &Problem, frozen: &Frozen) -> Result<f64, PostError> {
        let u = &frozen.displacement;
        let mut sum = 0.0;
        for (weight, part) in &self.parts {
            sum += weight
                * match part {
                    Part::EndFaceAngle => measures::end_face_angle_deg(problem, u)?,
                    Part::ChordAngle => {
                        let line = measures::centreline(problem, u)?;
                        measures::angle_of_chord_deg(&line).unwrap_or_default()
                    }
                    Part::Displacement(node, axis) => u[*node][*axis],
                    Part::Volume => measures::cavity_volume(problem, u)?,
                    Part::VolumeOf(number) => {
                        measures::volume(problem, &problem.cavities[*number], u)?.unwrap_or_default()
                    }
                    Part::Pressure(number) => frozen.cavity_pressures[*number].kpa(),
                    Part::Centreline(along, axis) => {
                        let weights = along.weights(problem).unwrap_or_default().into_iter();
                        let at = |node: usize| problem.mesh.nodes[node][*axis] + u[node][*axis];
                        weights.map(|(node, weight)| weight * at(node as usize)).sum()
                    }
                    Part::SolidVolume => problem.parts_of_whole() as f64 * problem.mesh.volume(),
                    Part::Mass => mass(problem),
                    Part::Peak(peak) => peak.value(problem, u)?,
                    Part::Gap(gap) => gap.value(problem, u)?,
                    Part::Reaction(..) | Part::Obstacle(..) | Part::Energy => 0.0,
                };
        }
        Ok(sum)
    }
}

/// The column of a name, or the three of a vector.
fn columns_of(name: &str, state: &StepSummary, tip: &Tip) -> Result<Vec<String>, InputError> {
    let names: Vec<String> = columns(state, tip).0.into_iter().map(|(column, _)| column).collect();
    let has_unit = |column: &&String| {
        let rest = column.strip_prefix(name);
        rest.is_some_and(|unit| unit.starts_with('_') && !unit.contains('.'))
    };
    let exact = names.iter().find(|column| *column == name);
    if let Some(column) = exact.or_else(|| names.iter().find(has_unit)) {
        return Ok(vec![column.clone()]);
    }
    let mut obstacles = state.obstacles.keys();
    let vector = match (name, obstacles.next(), obstacles.next()) {
        (FORCE, Some(one), None) => format!("obstacle.{one}"),
        _ => name.to_owned(),
    };
    let is_component =
        |column: &&String| column.rsplit_once('.').is_some_and(|(head, rest)| head == vector && rest.contains('_'));
    let components: Vec<String> = names.iter().filter(is_component).cloned().collect();
    if components.len() == 3 {
        return Ok(components);
    }
    let help = format!("there are {}, and the lengths of vectors by their names", names.join(", "));
    Err(refused(name, "this body has no such result").of_kind(InputErrorKind::Unknown).with_help(Some(help)))
}

/// The part of a column.
fn part(column: &str, analysis: &Analysis, tip: &Tip) -> Result<Part, InputError> {
    let problem = &analysis.problem;
    let none = || refused(column, "this body has no such result");
    match column {
        "end_face_angle_deg" => return Ok(Part::EndFaceAngle),
        "chord_angle_deg" => return Ok(Part::ChordAngle),
        "cavity_volume_mm3" => return Ok(Part::Volume),
        "strain_energy_mj" => return Ok(Part::Energy),
        "max_von_mises_mpa" => {
            return Err(refused(column, "the largest value is now at one place and now at another, and has corners")
                .with_help(Some("von_mises_norm[12] is smooth".to_owned())));
        }
        "von_mises_p99_mpa" => {
            return Err(refused(column, "it is the value of one point or of the next one, and jumps")
                .with_help(Some("von_mises_quantile[99%] is smooth".to_owned())));
        }
        "time" | "pressure_kpa" => return Err(refused(column, "it is given, not found")),
        "iterations" | "load_steps" => return Err(refused(column, "it is a count")),
        column if column.starts_with("contact.") => {
            let help = column.starts_with("contact.min_gap").then(|| "smallest_gap[0.02] is smooth".to_owned());
            return Err(refused(column, "it is found by samples of the walls, and has corners").with_help(help));
        }
        _ => {}
    }
    let (head, component) = column.rsplit_once('.').ok_or_else(none)?;
    if let Some(name) = head.strip_prefix("cavity.") {
        let number = problem.cavities.iter().position(|cavity| cavity.name == name).ok_or_else(none)?;
        return Ok(if component == "volume_mm3" { Part::VolumeOf(number) } else { Part::Pressure(number) });
    }
    let axis = ["x_", "y_", "z_"].iter().position(|axis| component.starts_with(axis)).ok_or_else(none)?;
    if head == "reaction" {
        return Ok(Part::Reaction(None, axis));
    }
    if let Some(name) = head.strip_prefix("reaction.") {
        return Ok(Part::Reaction(Some(name.to_owned()), axis));
    }
    if let Some(name) = head.strip_prefix("obstacle.") {
        let number = problem.obstacles.iter().position(|obstacle| obstacle.name == name).ok_or_else(none)?;
        return Ok(Part::Obstacle(number, axis));
    }
    let sites = probe_sites(&problem.mesh, &analysis.probes);
    let node = match head.strip_prefix("probe.") {
        Some(name) => sites.get(name).map(|site| site.node),
        // The tip of an actuator is the end of its centreline.
        None if tip.length.is_some() => measures::centreline_nodes(problem).last().map(|node| *node as usize),
        None => sites.get("tip").map(|site| site.node),
    };
    Ok(Part::Displacement(node.ok_or_else(none)?, axis))
}

/// A result without a derivative.
pub(super) fn refused(column: &str, why: &str) -> InputError {
    InputError::new(format!("no derivative of {column}: {why}"))
}

/// Weights of the supports' forces in a reaction along an axis, one entry per node; that of all supports, where every node counts once, without
/// a name.
fn weights_of_reaction(problem: &Problem, name: Option<&str>, axis: usize) -> Vec<[f64; 3]> {
    let mut weights = vec![[0.0; 3]; problem.mesh.num_nodes()];
    let unit = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
    let weight = problem.whole_force(unit)[axis];
    let planes: BTreeSet<usize> = problem.symmetry.iter().map(|plane| plane.support).collect();
    for (number, support) in problem.supports.iter().enumerate() {
        let counts = name.is_none_or(|name| support.name == name) && !planes.contains(&number) && support.axes[axis];
        for &node in support.nodes.iter().filter(|_| counts) {
            let own = &mut weights[node as usize][axis];
            *own = if name.is_some() { *own + weight } else { weight };
        }
    }
    weights
}

/// Weights of the modelled part's force on an obstacle in the whole body's along an axis.
fn weights_on_obstacle(problem: &Problem, number: usize, axis: usize) -> [f64; 3] {
    let unit = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
    let of_planes = problem.symmetry.iter().filter(|plane| plane.is_symmetry_of(&problem.obstacles[number]));
    of_planes.fold(unit, |weights, plane| {
        let mirrored = plane.mirror_vector(weights);
        std::array::from_fn(|k| weights[k] + mirrored[k])
    })
}

fn add(sum: &mut [[f64; 3]], factor: f64, other: &[[f64; 3]]) {
    let pairs = sum.as_flattened_mut().iter_mut().zip(other.as_flattened());
    pairs.for_each(|(sum, more)| *sum += factor * more);
}
