//! Rigid motions of parts that constraints join: what is left of them.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::DMatrix;

/// A rigid motion that its constraints resist by no more than this share counts as free. A body held by a share s has s² of its stiffness
/// against that motion: below 1e-12 rounding decides.
const FREE: f64 = 1e-6;

/// Rows that are collected before they are reduced to a triangle.
const CHUNK: usize = 64;

/// A displacement as a linear function of the motions of some parts: t and r ω of each.
pub(super) type Row = BTreeMap<usize, [f64; 6]>;

/// Parts whose motions depend on each other, and a basis of the motions that are left: six rows per part, orthonormal columns.
struct Cluster {
    parts: Vec<usize>,
    basis: DMatrix<f64>,
}

/// The clusters of all parts.
pub(super) struct Clusters {
    of_part: Vec<usize>,
    /// Emptied once they are part of another.
    list: Vec<Cluster>,
}

impl Clusters {
    /// Every part by itself, as the rows of its supports hold it.
    pub fn of(parts: Vec<Rows>) -> Self {
        let count = parts.len();
        let list =
            parts.into_iter().enumerate().map(|(part, rows)| Cluster { parts: vec![part], basis: rows.kernel() });
        Self { of_part: (0..count).collect(), list: list.collect() }
    }

    /// What is left of the motions under constraints.
    pub fn constrain(&mut self, rows: Vec<Row>) {
        // Those of the same parts together.
        let mut groups: BTreeMap<Vec<usize>, Vec<Row>> = BTreeMap::new();
        for row in rows {
            groups.entry(row.keys().copied().collect()).or_default().push(row);
        }
        for (parts, rows) in groups {
            let cluster = self.join(&parts);
            let Cluster { parts: members, basis } = &self.list[cluster];
            if basis.ncols() == 0 {
                continue;
            }
            let place: BTreeMap<usize, usize> =
                members.iter().enumerate().map(|(place, &part)| (part, place)).collect();
            let mut reduced = Rows::new(basis.ncols());
            for row in &rows {
                let along = |motion: usize| -> f64 {
                    let entries = row.iter().flat_map(|(part, row)| {
                        let first = 6 * place[part];
                        row.iter().enumerate().map(move |(k, entry)| entry * basis[(first + k, motion)])
                    });
                    entries.sum()
                };
                reduced.push(&(0..basis.ncols()).map(along).collect::<Vec<_>>());
            }
            let basis = basis * reduced.kernel();
            self.list[cluster].basis = basis;
        }
    }

    /// The cluster that some parts are members of, after theirs were joined.
    fn join(&mut self, parts: &[usize]) -> usize {
        let numbers: BTreeSet<usize> = parts.iter().map(|&part| self.of_part[part]).collect();
        let number = numbers.first().copied().unwrap_or(0);
        if numbers.len() < 2 {
            return number;
        }
        let rows = numbers.iter().map(|&n| self.list[n].basis.nrows()).sum();
        let columns = numbers.iter().map(|&n| self.list[n].basis.ncols()).sum();
        let mut joined = Cluster { parts: Vec::new(), basis: DMatrix::zeros(rows, columns) };
        let mut corner = (0, 0);
        for other in numbers {
            let empty = Cluster { parts: Vec::new(), basis: DMatrix::zeros(0, 0) };
            let Cluster { parts, basis } = std::mem::replace(&mut self.list[other], empty);
            joined.basis.view_mut(corner, basis.shape()).copy_from(&basis);
            corner = (corner.0 + basis.nrows(), corner.1 + basis.ncols());
            parts.iter().for_each(|&part| self.of_part[part] = number);
            joined.parts.extend(parts);
        }
        self.list[number] = joined;
        number
    }

    /// Motions of a part that are left: t and r ω in six rows, orthonormal columns.
    pub fn motions(&self, part: usize) -> DMatrix<f64> {
        let Cluster { parts, basis } = &self.list[self.of_part[part]];
        let first = parts.iter().position(|&member| member == part).unwrap_or(0);
        if basis.ncols() == 0 {
            return DMatrix::zeros(6, 0);
        }
        let own = basis.rows(6 * first, 6).into_owned();
        let svd = own.svd(true, false);
        let u = svd.u.unwrap_or_else(|| DMatrix::zeros(6, 0));
        let kept: Vec<usize> = (0..u.ncols()).filter(|&k| svd.singular_values[k] > FREE).collect();
        u.select_columns(&kept)
    }
}

/// Rows of a linear system as they come in, reduced to a triangle.
pub(super) struct Rows {
    columns: usize,
    entries: Vec<f64>,
}

impl Rows {
    pub fn new(columns: usize) -> Self {
        Self { columns, entries: Vec::new() }
    }

    pub fn push(&mut self, row: &[f64]) {
        self.entries.extend_from_slice(row);
        if self.entries.len() >= (CHUNK + self.columns) * self.columns {
            self.entries = self.matrix().qr().r().transpose().as_slice().to_vec();
        }
    }

    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.entries.len() / self.columns.max(1), self.columns, &self.entries)
    }

    /// Orthonormal columns that span what the rows do not resist.
    fn kernel(&self) -> DMatrix<f64> {
        let rows = self.matrix();
        // All right singular vectors, also those that no row belongs to.
        let missing = self.columns.saturating_sub(rows.nrows());
        let square = rows.clone().insert_rows(rows.nrows(), missing, 0.0);
        let svd = square.svd(false, true);
        let vectors = svd.v_t.unwrap_or_else(|| DMatrix::zeros(0, self.columns)).transpose();
        let kept: Vec<usize> = (0..vectors.ncols()).filter(|&k| svd.singular_values[k] <= FREE).collect();
        vectors.select_columns(&kept)
    }
}
