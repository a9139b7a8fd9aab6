//! One line of the table.

use pneuflex_model::Formulation;

/// A quantity on successively finer meshes against its exact value.
#[derive(Clone, Debug)]
pub struct Row {
    /// Problem and quantity.
    pub quantity: String,
    /// Element formulation.
    pub element: Formulation,
    /// Meshes in words, coarsest first.
    pub meshes: Vec<String>,
    /// Elements along a typical length, one number per mesh.
    pub refinement: Vec<f64>,
    /// Value on the finest mesh.
    pub measured: f64,
    /// Exact value; `None` where the error itself is the quantity.
    pub exact: Option<f64>,
    /// Errors, relative unless the quantity says otherwise, one per mesh solved.
    pub errors: Vec<f64>,
    /// Order expected in theory, where errors fall with the mesh size.
    pub expected_order: Option<f64>,
    /// Bound of the first mesh's error, and the least order with which the bound falls and errors must fall.
    pub bound: f64,
    /// Least order accepted; 0 for a bound that stays.
    pub least_order: f64,
    /// First mesh whose error is judged; those before it show the trend.
    pub judged_from: usize,
    /// Whether a miss is a limit of the element that the section's text explains, not a fault.
    pub is_known_limit: bool,
    /// Why there is no result, if there is none.
    pub failure: Option<String>,
}

impl Row {
    /// A row from a sequence of meshes: `solve` returns measured and exact value for a mesh.
    ///
    /// `expected` is the order in theory and the least order accepted.
    pub fn sequence<T>(
        quantity: impl Into<String>,
        element: Formulation,
        meshes: &[T],
        describe: impl Fn(&T) -> (String, f64),
        expected: Option<[f64; 2]>,
        bound: f64,
        mut solve: impl FnMut(&T) -> Result<[f64; 2], String>,
    ) -> Self {
        let mut row = Self {
            quantity: quantity.into(),
            element,
            meshes: Vec::new(),
            refinement: Vec::new(),
            measured: f64::NAN,
            exact: None,
            errors: Vec::new(),
            expected_order: expected.map(|e| e[0]),
            bound,
            least_order: expected.map_or(0.0, |e| e[1]),
            judged_from: 0,
            is_known_limit: false,
            failure: None,
        };
        for mesh in meshes {
            let (name, refinement) = describe(mesh);
            row.meshes.push(name);
            row.refinement.push(refinement);
            match solve(mesh) {
                Ok([measured, exact]) => {
                    row.measured = measured;
                    // Without an exact value the measured one is an error already.
                    row.exact = (exact != 0.0).then_some(exact);
                    row.errors.push(if exact == 0.0 { measured } else { measured / exact - 1.0 });
                }
                Err(why) => {
                    row.failure = Some(why);
                    return row;
                }
            }
        }
        row
    }

    /// The row with its possible miss explained in the section's text if `condition` holds.
    pub fn with_known_limit(mut self, condition: bool) -> Self {
        self.is_known_limit = condition;
        self
    }

    /// Whether the row misses its bound without this being a known limit. A result is wanted in any case.
    pub fn is_fault(&self) -> bool {
        self.failure.is_some() || (!self.passes() && !self.is_known_limit)
    }

    /// Slope of the straight line through (ln h, ln |error|) by least squares; `None` with one mesh or errors of zero.
    pub fn order(&self) -> Option<f64> {
        let points: Vec<(f64, f64)> =
            self.refinement.iter().zip(&self.errors).map(|(n, e)| (-n.ln(), e.abs().ln())).collect();
        if points.len() < 2 || points.iter().any(|p| !p.1.is_finite()) {
            return None;
        }
        let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        Some(covariance / points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum::<f64>())
    }

    /// Bound of the error on mesh `i`.
    pub fn bound_of(&self, i: usize) -> f64 {
        self.bound * (self.refinement[i] / self.refinement[0]).powf(-self.least_order)
    }

    /// Whether all errors are within their bounds and, with three meshes or more, fall with the least order.
    pub fn passes(&self) -> bool {
        let bounded = self.errors.iter().enumerate().skip(self.judged_from).all(|(i, e)| e.abs() <= self.bound_of(i));
        let falls = self.least_order == 0.0
            || self.errors.len() < 3
            || self.order().is_some_and(|order| order >= self.least_order);
        self.failure.is_none() && !self.errors.is_empty() && bounded && falls
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(errors: &[f64], bound: f64, expected: Option<[f64; 2]>) -> Row {
        let meshes: Vec<usize> = (0..errors.len()).collect();
        Row::sequence(
            "q",
            Formulation::Hex27,
            &meshes,
            |&i| (String::new(), f64::from(1 << i)),
            expected,
            bound,
            |&i| Ok([1.0 + errors[i], 1.0]),
        )
    }

    #[test]
    fn errors_must_stay_below_a_falling_bound_and_fall_with_their_order() {
        let second_order = row(&[0.08, -0.02, 0.005], 0.1, Some([2.0, 1.8]));
        assert!((second_order.order().unwrap() - 2.0).abs() < 1e-9 && second_order.passes());
        assert!(!row(&[0.08, 0.04, 0.02], 0.1, Some([2.0, 1.8])).passes(), "first order");
        assert!(!row(&[0.12, 0.02, 0.005], 0.1, Some([2.0, 1.8])).passes(), "above the bound");
        assert!(row(&[0.08, 0.04], 0.1, None).passes() && !row(&[f64::NAN], 0.1, None).passes());
        assert!(!row(&[], 0.1, None).passes());
    }

    #[test]
    fn a_failure_is_kept() {
        let row = Row::sequence("q", Formulation::Tet15, &[1], |_| ("1".into(), 1.0), None, 1.0, |_| Err("why".into()));
        assert!(!row.passes() && row.failure.as_deref() == Some("why"));
        assert!(row.with_known_limit(true).is_fault());
    }

    #[test]
    fn known_limits_are_misses_but_no_faults() {
        let slow = row(&[0.08, 0.04, 0.02], 0.1, Some([2.0, 1.8]));
        assert!(slow.is_fault());
        let slow = slow.with_known_limit(true);
        assert!(!slow.passes() && !slow.is_fault());
    }
}
