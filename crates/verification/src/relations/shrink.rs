//! Making a problem smaller for which a relation fails: what can be left out without mending it is left out.

use pneuflex::mesh::Actuator;
use pneuflex::model::model_file::{Model, Steps};
use pneuflex::model::{Case, Contact, Law, Material, Series};

use super::draw::Draw;

/// Problems with one thing less, those with the most left out first.
pub fn smaller(draw: &Draw) -> Vec<Draw> {
    match draw {
        Draw::Case(case) => smaller_cases(case)
            .into_iter()
            .filter(|new| new != &**case)
            .map(|case| Draw::Case(Box::new(case)))
            .collect(),
        Draw::Model(model, body) => (smaller_models(model).into_iter())
            .filter(|new| new != &**model)
            .map(|model| Draw::Model(Box::new(model), body.clone()))
            .collect(),
    }
}

fn smaller_cases(case: &Case) -> Vec<Case> {
    let mut found = Vec::new();
    let mut less = |change: &dyn Fn(&mut Case)| {
        let mut new = case.clone();
        change(&mut new);
        found.push(new);
    };
    less(&|case| case.obstacles.clear());
    less(&|case| case.probes.clear());
    less(&|case| case.material = simple(&case.material));
    less(&|case| case.contact = Contact::of_actuator(&case.material, &case.actuator));
    less(&|case| {
        case.load.pressure_kpa.drain(..case.load.pressure_kpa.len() - 1);
    });
    less(&|case| case.load.chamber_factor = None);
    less(&|case| alike(&mut case.actuator));
    less(&|case| {
        alike(&mut case.actuator);
        (case.actuator.chambers, case.load.chamber_factor) = (1, None);
    });
    less(&|case| case.actuator.flange = 0.0);
    found
}

fn smaller_models(model: &Model) -> Vec<Model> {
    let mut found = Vec::new();
    let mut less = |change: &dyn Fn(&mut Model)| {
        let mut new = model.clone();
        change(&mut new);
        found.push(new);
    };
    less(&|model| model.actuator.iter_mut().for_each(alike));
    less(&|model| model.probes.clear());
    less(&|model| model.regions.clear());
    less(&|model| model.equations.clear());
    less(&|model| model.cavities.clear());
    less(&|model| model.forces.clear());
    less(&|model| model.tractions.clear());
    less(&|model| model.pressures.clear());
    less(&|model| model.gravity = None);
    less(&|model| model.contacts.clear());
    less(&|model| {
        model.solver = Steps {
            tolerance: model.solver.tolerance,
            residual_tolerance: model.solver.residual_tolerance,
            ..Steps::default()
        }
    });
    less(&|model| model.material = model.material.as_ref().map(simple));
    less(&|model| {
        if let Some(load) = &mut model.load {
            load.times.drain(..load.times.len().saturating_sub(1));
        }
    });
    for number in 0..model.obstacles.len() {
        less(&|model| {
            model.obstacles.remove(number);
        });
        less(&|model| {
            let obstacle = &mut model.obstacles[number];
            (obstacle.displacement, obstacle.factor) = (None, None);
        });
    }
    // The clamp stays.
    for number in 1..model.supports.len() {
        less(&|model| {
            model.supports.remove(number);
        });
    }
    less(&|model| {
        let factors = (model.supports.iter_mut().map(|table| &mut table.factor))
            .chain(model.forces.iter_mut().map(|table| &mut table.factor))
            .chain(model.tractions.iter_mut().map(|table| &mut table.factor))
            .chain(model.obstacles.iter_mut().map(|table| &mut table.factor));
        factors.for_each(|factor| *factor = None);
    });
    less(&|model| {
        let values = (model.cavities.iter_mut())
            .flat_map(|table| [&mut table.pressure_kpa, &mut table.volume_mm3, &mut table.gas])
            .flatten();
        for series in values {
            if let Series::Points(points) = series {
                *series = Series::End(points.last().map_or(0.0, |point| point[1]));
            }
        }
    });
    found
}

/// All chambers are like the first.
fn alike(actuator: &mut Actuator) {
    let Actuator { chamber_length, cavity_length, gap, side_wall, top_wall, .. } = actuator;
    for value in [chamber_length, cavity_length, gap, side_wall, top_wall] {
        // There is no gap behind a single chamber.
        *value = value.entries().first().copied().unwrap_or(1.0).into();
    }
}

/// The plainest material of the same stiffness.
fn simple(material: &Material) -> Material {
    let law = Law::NeoHooke { c10: 0.5 * material.shear_modulus() };
    Material { density: material.density, bulk_modulus: material.bulk_modulus, ..Material::from(law) }
}
