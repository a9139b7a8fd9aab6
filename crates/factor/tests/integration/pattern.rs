//! The node graph and the matrix-vector product.

use pneuflex_factor::testing::{Cell, positive_definite_values, solid_lattice};
use pneuflex_factor::{BlockPattern, FactorError, multiply};

#[test]
fn cliques_couple_all_their_nodes() {
    let cliques: [&[u32]; 4] = [&[0, 2], &[2, 1, 3], &[], &[3, 3]];
    let pattern = BlockPattern::from_cliques(5, cliques.into_iter());
    let columns: Vec<&[u32]> = (0..5).map(|j| pattern.column(j)).collect();
    let expected: [&[u32]; 5] = [&[0, 2], &[1, 2, 3], &[2, 3], &[3], &[4]];
    assert_eq!(columns, expected);
    assert_eq!(pattern.num_blocks(), 9);
    assert_eq!(pattern.position(3, 1), Some(4));
    assert_eq!(pattern.position(4, 4), Some(8));
    assert_eq!(pattern.position(1, 3), None);
    assert_eq!(pattern.position(4, 0), None);
    assert_eq!(pattern.position(0, 9), None);
}

#[test]
fn malformed_patterns_are_errors() {
    let offsets = |offsets: &[usize], rows: &[u32]| BlockPattern::new(offsets.into(), rows.into());
    assert!(offsets(&[0, 2, 3], &[0, 1, 1]).is_ok());
    for (bad, rows) in
        [(&[][..], &[][..]), (&[1, 2], &[0, 0]), (&[0, 2], &[0]), (&[0, 1], &[0, 0]), (&[0, 2, 1], &[0, 1])]
    {
        assert!(matches!(offsets(bad, rows), Err(FactorError::InvalidOffsets { .. })));
    }
    for (bad, rows) in
        [(&[0, 0][..], &[][..]), (&[0, 1, 2], &[0, 0]), (&[0, 3, 4], &[0, 1, 1, 1]), (&[0, 2, 3], &[0, 2, 1])]
    {
        assert!(matches!(offsets(bad, rows), Err(FactorError::InvalidRows { .. })));
    }
}

#[test]
fn product_matches_the_dense_matrix() -> Result<(), FactorError> {
    let pattern = solid_lattice::<3>([2, 1, 2], Cell::Hex8).pattern;
    let values = positive_definite_values::<3>(&pattern, 1.0, 4);
    let n = 3 * pattern.num_nodes();
    let mut dense = vec![vec![0.0; n]; n];
    for j in 0..pattern.num_nodes() {
        for &i in pattern.column(j) {
            let i = i as usize;
            let block = pattern.position(i, j).map_or(0, |p| 9 * p);
            for c in 0..3 {
                for r in 0..3 {
                    dense[3 * i + r][3 * j + c] = values[block + 3 * c + r];
                    dense[3 * j + c][3 * i + r] = values[block + 3 * c + r];
                }
            }
        }
    }
    let x: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
    let mut y = vec![f64::NAN; n];
    multiply::<3>(&pattern, &values, &x, &mut y)?;
    for i in 0..n {
        let expected: f64 = (0..n).map(|j| dense[i][j] * x[j]).sum();
        assert!((y[i] - expected).abs() < 1e-12 * dense[i][i]);
    }
    assert!(multiply::<3>(&pattern, &values[1..], &x, &mut y).is_err());
    Ok(())
}
