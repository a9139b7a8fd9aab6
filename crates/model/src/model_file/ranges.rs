//! Range checks of a model file that need no mesh.

use super::tables::Model;
use crate::obstacle_table;
use crate::options::{ContactMethod, check_names, check_probes};
use crate::range_check::{CaseError, Problems, Quantity};
use crate::series::Series;

impl Model {
    /// Every key whose value is out of range, table by table.
    pub fn problems(&self) -> Vec<CaseError> {
        let mut found = Problems::default();
        if self.model.is_some() == self.actuator.is_some() {
            let allowed = "must be there once: [model] with a file, or [actuator]";
            found.add("model", &self.model.as_ref().map(|source| &source.file), allowed);
        }
        if let Some(source) = &self.model {
            found.unless_positive("model.scale", source.scale, Quantity::Factor);
            if let Some(size) = source.size {
                found.unless_positive("model.size", size, Quantity::Length);
            }
            finite(&mut found, "model.inlet", source.inlet.0.as_flattened(), Quantity::Length);
        }
        self.output.check(&mut found);
        found.0.extend(self.actuator.iter().flat_map(|actuator| actuator.problems()).map(CaseError::from));
        match &self.model {
            Some(_) => self.mesh.check_imported(&mut found),
            None => self.mesh.check(&mut found),
        }
        found.0.extend(self.material.iter().flat_map(|material| material.problems("material")));
        check_names("region", self.regions.iter().map(|region| &region.name), &mut found);
        for (i, region) in self.regions.iter().enumerate() {
            found.0.extend(region.material.problems(&format!("region[{i}].material")));
            if region.elements.is_some() == region.within.is_some() {
                let allowed = "must be there once: elements with the name of an element set, or box with two corners";
                found.add(&format!("region[{i}].elements"), &region.elements, allowed);
            }
            if let Some(corners) = region.within {
                finite(&mut found, &format!("region[{i}].box"), corners.as_flattened(), Quantity::Length);
            }
        }
        for (i, support) in self.supports.iter().enumerate() {
            let key = format!("support[{i}]");
            let is_axis = |c: char| "xyz".contains(c);
            if support.axes.is_empty() || !support.axes.chars().all(is_axis) {
                found.add(&format!("{key}.axes"), &support.axes, "must be letters out of x, y and z");
            }
            let displacement = support.displacement.unwrap_or_default();
            finite(&mut found, &format!("{key}.displacement"), &displacement, Quantity::Length);
            series(&mut found, &format!("{key}.factor"), support.factor.as_ref(), Quantity::Factor);
        }
        for (i, equation) in self.equations.iter().enumerate() {
            for (j, (_, axis, coefficient)) in equation.terms.iter().enumerate() {
                let key = format!("equation[{i}].terms[{j}]");
                if !["x", "y", "z"].contains(&axis.as_str()) {
                    found.add(&key, axis, "the second entry must be \"x\", \"y\" or \"z\"");
                }
                if !Quantity::Factor.allows(*coefficient) || *coefficient == 0.0 {
                    found.add(&key, coefficient, "the third entry must be a finite number other than 0");
                }
            }
            if equation.terms.is_empty() {
                found.add(&format!("equation[{i}].terms"), &equation.terms, "must not be empty");
            }
            series(&mut found, &format!("equation[{i}].value"), equation.value.as_ref(), Quantity::Length);
        }
        for (key, _, choice) in self.choices() {
            choice.check(&key, &mut found);
        }
        self.check_loads(&mut found);
        self.check_obstacles(&mut found);
        self.check_times(&mut found);
        check_probes(&self.probes, &mut found);
        found.0
    }

    fn check_loads(&self, found: &mut Problems) {
        check_names("cavity", self.cavities.iter().map(|cavity| &cavity.name), found);
        for (i, cavity) in self.cavities.iter().enumerate() {
            let key = |name: &str| format!("cavity[{i}].{name}");
            let given = [&cavity.pressure_kpa, &cavity.volume_mm3, &cavity.gas];
            if given.iter().filter(|series| series.is_some()).count() != 1 {
                let allowed = "must be there once: pressure_kpa, volume_mm3 or gas";
                found.add(&key("pressure_kpa"), &cavity.pressure_kpa, allowed);
            }
            let quantities = [Quantity::Pressure, Quantity::Volume, Quantity::Factor];
            for ((name, quantity), values) in
                ["pressure_kpa", "volume_mm3", "gas"].into_iter().zip(quantities).zip(given)
            {
                series(found, &key(name), values.as_ref(), quantity);
            }
            found.unless_positive(&key("atmosphere_kpa"), cavity.atmosphere_kpa, Quantity::Pressure);
            if !(1.0..=2.0).contains(&cavity.exponent) {
                found.add(&key("exponent"), &cavity.exponent, "must be from 1 to 2");
            }
        }
        for (i, force) in self.forces.iter().enumerate() {
            finite(found, &format!("force[{i}].total"), &force.total, Quantity::Force);
            series(found, &format!("force[{i}].factor"), force.factor.as_ref(), Quantity::Factor);
        }
        for (i, traction) in self.tractions.iter().enumerate() {
            finite(found, &format!("traction[{i}].traction_mpa"), &traction.traction_mpa, Quantity::Stress);
            series(found, &format!("traction[{i}].factor"), traction.factor.as_ref(), Quantity::Factor);
        }
        for (i, pressure) in self.pressures.iter().enumerate() {
            series(found, &format!("pressure[{i}].pressure_kpa"), Some(&pressure.pressure_kpa), Quantity::Pressure);
        }
        if let Some(gravity) = &self.gravity {
            finite(found, "gravity.acceleration", &gravity.acceleration, Quantity::Acceleration);
            series(found, "gravity.factor", gravity.factor.as_ref(), Quantity::Factor);
        }
        for (i, contact) in self.contacts.iter().enumerate() {
            if let Some(stiffness) = contact.stiffness {
                found.unless_positive(&format!("contact[{i}].stiffness"), stiffness, Quantity::Stiffness);
            }
            if let Some(tolerance) = contact.penetration_tolerance {
                found.unless_positive(&format!("contact[{i}].penetration_tolerance"), tolerance, Quantity::Tolerance);
            }
            if let Some(method @ (ContactMethod::None | ContactMethod::SinglePoint)) = contact.method {
                found.add(&format!("contact[{i}].method"), &method, "must be mortar or multi-point");
            }
        }
    }

    fn check_obstacles(&self, found: &mut Problems) {
        obstacle_table::check(&self.obstacles, found);
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            series(found, &format!("obstacle[{i}].factor"), obstacle.factor.as_ref(), Quantity::Factor);
        }
    }

    fn check_times(&self, found: &mut Problems) {
        if let Some(load) = &self.load {
            let increasing = load.times.windows(2).all(|w| w[0] < w[1]);
            let [least, most] = Quantity::Time.range();
            let positive = load.times.iter().all(|time| (least..=most).contains(time));
            if load.times.is_empty() || !positive || !increasing {
                let allowed = "must be a non-empty, strictly increasing list of finite times greater than 0";
                found.add("load.times", &load.times, &format!("{allowed}, from {least:e} to {most:e}"));
            }
        }
        let solver = &self.solver;
        for (key, value, quantity) in [
            ("solver.tolerance", solver.tolerance, Quantity::Tolerance),
            ("solver.residual_tolerance", solver.residual_tolerance, Quantity::Tolerance),
            ("solver.first_step", solver.first_step, Quantity::Time),
            ("solver.max_step", solver.max_step, Quantity::Time),
            ("solver.min_step", solver.min_step, Quantity::Time),
            ("solver.imperfection", solver.imperfection, Quantity::Tolerance),
        ] {
            if let Some(value) = value {
                found.unless_positive(key, value, quantity);
            }
        }
        if solver.max_step.zip(solver.min_step).is_some_and(|(max, min)| max < min) {
            found.add("solver.max_step", &solver.max_step, "must not be below solver.min_step");
        }
        if let Some(count) = solver.states_past_limit.filter(|count| !(1..=1000).contains(count)) {
            found.add("solver.states_past_limit", &count, "must be from 1 to 1000");
        }
        if let Some(count) = solver.max_iterations.filter(|count| !(2..=1000).contains(count)) {
            found.add("solver.max_iterations", &count, "must be from 2 to 1000");
        }
    }
}

fn finite(found: &mut Problems, key: &str, values: &[f64], quantity: Quantity) {
    found.unless_finite(key, values, "finite numbers", quantity);
}

fn series(found: &mut Problems, key: &str, series: Option<&Series>, quantity: Quantity) {
    match series {
        Some(Series::End(value)) => finite(found, key, &[*value], quantity),
        Some(Series::Points(points)) => {
            let increasing = points.windows(2).all(|w| w[0][0] < w[1][0]);
            let are_finite = points.iter().all(|&[time, value]| Quantity::Time.allows(time) && quantity.allows(value));
            if points.is_empty() || !increasing || !are_finite {
                found.add(key, points, "must be finite points [time, value] in the order of time");
            }
        }
        None => {}
    }
}
