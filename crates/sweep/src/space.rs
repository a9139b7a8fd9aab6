//! Spaces of designs: which values of which keys are solved.

use rand::RngExt;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::base::Design;

/// Designs that a sweep may have.
pub const MOST_DESIGNS: usize = 1_000_000;

/// Points of the Sobol sequence that there are, and its dimensions.
pub const MOST_SOBOL: usize = 1 << 16;
/// Dimensions of the Sobol sequence.
pub const MOST_SOBOL_KEYS: usize = sobol_burley::NUM_DIMENSIONS as usize;

/// What a key may be.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    /// One of these.
    Values(Vec<toml::Value>),
    /// A number between two, both included.
    Between(f64, f64),
    /// A whole number between two, both included.
    WholeBetween(i64, i64),
}

/// How designs are taken from a space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sample {
    /// Every combination of values, the last key changing fastest.
    #[default]
    Grid,
    /// Every key has one value in each of as many equal parts of its range as there are designs.
    LatinHypercube,
    /// The first points of a scrambled Sobol sequence; powers of 2 are balanced best.
    Sobol,
}

/// Whether the values of a key are counts. Between 1 mm and 2 mm there are others, however the ends are written.
pub fn is_count(key: &str) -> bool {
    ["actuator.chambers", "mesh.wall_elements", "solver.max_iterations", "solver.states_past_limit"].contains(&key)
}

/// Keys and what they may be.
pub type Space = Vec<(String, Choice)>;

/// Number of combinations of a grid; `None` beyond every bound.
pub fn combinations(space: &Space) -> Option<usize> {
    space.iter().try_fold(1_usize, |count, (_, choice)| match choice {
        Choice::Values(values) => count.checked_mul(values.len()),
        Choice::Between(..) | Choice::WholeBetween(..) => None,
    })
}

/// Every combination of values, the last key changing fastest. Ranges have none.
pub fn grid(space: &Space) -> Vec<Design> {
    space.iter().fold(vec![Design::new()], |designs, (key, choice)| {
        let Choice::Values(values) = choice else { return Vec::new() };
        let with = |design: &Design, value: &toml::Value| [&design[..], &[(key.clone(), value.to_string())]].concat();
        designs.iter().flat_map(|design| values.iter().map(move |value| with(design, value))).collect()
    })
}

/// Designs of a Latin hypercube, the same for the same seed.
pub fn latin_hypercube(space: &Space, count: usize, seed: u64) -> Vec<Design> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut column = || {
        let mut parts: Vec<usize> = (0..count).collect();
        parts.shuffle(&mut random);
        parts.into_iter().map(|part| (part as f64 + random.random::<f64>()) / count as f64).collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = space.iter().map(|_| column()).collect();
    let point = |i: usize| columns.iter().map(|column| column[i]).collect::<Vec<f64>>();
    (0..count).map(|i| design(space, &point(i))).collect()
}

/// The first points of a scrambled Sobol sequence; a larger count has the designs of a smaller one first.
pub fn sobol(space: &Space, count: usize, seed: u64) -> Vec<Design> {
    sobol_points(space.len(), count, seed).iter().map(|point| design(space, point)).collect()
}

/// The same in the unit cube of so many dimensions, of which there may be [`MOST_SOBOL_KEYS`].
pub fn sobol_points(dimensions: usize, count: usize, seed: u64) -> Vec<Vec<f64>> {
    // Both halves of the seed count.
    let seed = (seed ^ (seed >> 32)) as u32;
    let coordinate = |i: usize, dimension: usize| f64::from(sobol_burley::sample(i as u32, dimension as u32, seed));
    (0..count).map(|i| (0..dimensions).map(|dimension| coordinate(i, dimension)).collect()).collect()
}

/// A point of the unit cube as a design.
fn design(space: &Space, point: &[f64]) -> Design {
    space.iter().zip(point).map(|((key, choice), x)| (key.clone(), choice.at(*x).to_string())).collect()
}

impl Choice {
    /// The value at a coordinate between 0 and 1.
    fn at(&self, x: f64) -> toml::Value {
        match self {
            Self::Values(values) => values[((x * values.len() as f64) as usize).min(values.len() - 1)].clone(),
            Self::Between(from, to) => (from + x * (to - from)).clamp(*from, *to).into(),
            Self::WholeBetween(from, to) => {
                let count = (*to as f64 - *from as f64) + 1.0;
                from.saturating_add((x * count) as i64).min(*to).into()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> Space {
        vec![
            ("actuator.gap".into(), Choice::Between(1.0, 2.0)),
            ("actuator.chambers".into(), Choice::WholeBetween(2, 4)),
            ("mesh.element".into(), Choice::Values(vec!["hex27".into(), "tet10".into()])),
        ]
    }

    fn gap(design: &Design) -> f64 {
        design[0].1.parse().unwrap()
    }

    #[test]
    fn samples_fill_their_ranges_and_depend_on_the_seed_alone() {
        for sample in [latin_hypercube, sobol] {
            let designs = sample(&space(), 12, 3);
            assert_eq!(designs, sample(&space(), 12, 3));
            assert_ne!(designs, sample(&space(), 12, 4));
            assert!(designs.iter().all(|design| (1.0..=2.0).contains(&gap(design))));
            for (column, count) in [(1, 3), (2, 2)] {
                let found: std::collections::BTreeSet<_> = designs.iter().map(|design| &design[column].1).collect();
                assert_eq!(found.len(), count, "{found:?}");
            }
        }
        assert_eq!(sobol(&space(), 9, 0)[..8], sobol(&space(), 8, 0));
        let mut parts: Vec<usize> =
            latin_hypercube(&space(), 12, 0).iter().map(|d| ((gap(d) - 1.0) * 12.0) as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..12).collect::<Vec<_>>());
        // Sixteen points of the sequence are one in each sixteenth.
        let mut parts: Vec<usize> = sobol(&space(), 16, 5).iter().map(|d| ((gap(d) - 1.0) * 16.0) as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..16).collect::<Vec<_>>());
    }

    /// The program takes a fraction of everything but of these.
    #[test]
    fn what_is_counted_takes_no_fraction() {
        let case = pneuflex::template::two_chambers();
        let takes = |key: &str| {
            let mut study = pneuflex::Study::from_text("case.toml", &case).unwrap();
            study.set_all([pneuflex::Change::new(key, "1.5")]).map(|_| ()).map_err(|error| error.to_string())
        };
        for key in ["actuator.chambers", "mesh.wall_elements", "solver.max_iterations", "solver.states_past_limit"] {
            let refused = takes(key).unwrap_err();
            assert!(is_count(key) && refused.contains("whole number"), "{key}: {refused}");
        }
        for key in ["actuator.gap", "mesh.size", "material.c10", "contact.stiffness", "solver.max_step_kpa"] {
            assert!(!is_count(key) && takes(key).is_ok(), "{key}");
        }
    }

    #[test]
    fn the_last_key_of_a_grid_changes_fastest() {
        let values = |values: &[i64]| Choice::Values(values.iter().map(|&value| value.into()).collect());
        let space = vec![("a".to_owned(), values(&[1, 2])), ("b".to_owned(), values(&[3, 4, 5]))];
        let designs = grid(&space);
        assert_eq!((designs.len(), combinations(&space)), (6, Some(6)));
        assert_eq!(designs[1], [("a".to_owned(), "1".to_owned()), ("b".to_owned(), "4".to_owned())]);
    }
}
