//! The whole actuator as boxes: what its mesh and the mould that it is cast in are made from.

use super::lengths::{Actuator, Part};
use super::planes::Cuts;
use super::ranges::GeometryError;
use super::row::{Region, Row};
use crate::lattice::Lattice;

/// What fills a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// Silicone.
    Solid,
    /// A cavity or the channel.
    Air,
    /// Nothing: it lies in a gap or above a flange.
    Outside,
}

/// The boxes between the planes in which the shape of the whole actuator changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The planes, mm.
    pub lattice: Lattice,
    fillings: Vec<Filling>,
}

impl Plan {
    /// What fills a box.
    pub fn filling(&self, cell: [usize; 3]) -> Filling {
        let [_, along_y, along_z] = self.lattice.num_cells();
        self.fillings[(cell[0] * along_y + cell[1]) * along_z + cell[2]]
    }
}

impl Actuator {
    /// The plan of both halves.
    ///
    /// # Errors
    /// A length out of range, see [`Self::validate`].
    pub fn plan(&self) -> Result<Plan, GeometryError> {
        self.validate()?;
        let whole = Self { part: Part::Whole, ..self.clone() };
        let row = Row::of(&whole);
        let lines = row.intervals(&Cuts::default()).map(|intervals| {
            let first = intervals.first().map(|interval| interval.start);
            first.into_iter().chain(intervals.iter().map(|interval| interval.end)).collect()
        });
        let lattice = Lattice { lines };
        let [along_x, along_y, along_z] = lattice.num_cells();
        let cells = (0..along_x).flat_map(|i| (0..along_y).flat_map(move |j| (0..along_z).map(move |k| [i, j, k])));
        let filling = |cell| match row.region(lattice.centre(cell)) {
            Region::Solid => Filling::Solid,
            Region::Air(_) => Filling::Air,
            Region::Gap(_) | Region::Outside => Filling::Outside,
        };
        let fillings = cells.map(filling).collect();
        Ok(Plan { lattice, fillings })
    }
}
