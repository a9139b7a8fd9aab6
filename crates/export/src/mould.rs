//! What an actuator is cast in: two halves of a mould and a core, mm.
//!
//! The mould stands on its head and is open below (z = 0), where the silicone is poured in. The halves meet in the plane y = 0 and come off
//! sideways, out of the gaps between the chambers. The core is the air; it is held by a stem with the cross-section of the channel, which
//! leaves through the clamped end and the mould's wall there, and is the inlet afterwards. It cannot be pulled out: it has to melt or to
//! dissolve.

use std::collections::BTreeMap;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::vector::Vec3;
use pneuflex_mesh::{Actuator, Filling};

use crate::error::ExportError;

/// A closed surface around a part of the mould; normals point out of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// Corners, mm.
    pub corners: Vec<Vec3>,
    /// Corners of the triangles.
    pub triangles: Vec<[u32; 3]>,
}

/// The parts of a mould.
#[derive(Clone, Debug, PartialEq)]
pub struct Mould {
    /// The half at y < 0 and the one at y > 0.
    pub halves: [Piece; 2],
    /// What keeps the air free.
    pub core: Piece,
}

/// What a box of the mould belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Filled {
    Wall,
    Core,
    Silicone,
}

impl Mould {
    /// The mould of an actuator with walls of a thickness, mm.
    ///
    /// # Errors
    /// [`ExportError::Geometry`], [`ExportError::Wall`], [`ExportError::NoChannel`].
    pub fn new(actuator: &Actuator, wall: f64) -> Result<Self, ExportError> {
        if !(wall.is_finite() && wall > 0.0) {
            return Err(ExportError::Wall(wall));
        }
        let plan = actuator.plan()?;
        if !actuator.has_channel() {
            return Err(ExportError::NoChannel);
        }
        let body = &plan.lattice;
        let mut lines = body.lines.clone();
        for (axis, line) in lines.iter_mut().enumerate() {
            let (first, last) = (line[0], line[line.len() - 1]);
            line.push(last + wall);
            if axis < 2 {
                line.insert(0, first - wall);
            }
        }
        let lattice = Lattice { lines };
        let inlet = actuator.row().first().map_or(0.0, |chamber| chamber.cavity[0]);
        let channel = &actuator.channel;
        let in_stem =
            |[x, y, z]: Vec3| x < inlet && y.abs() < channel.half_width && z > channel.bottom && z < channel.top;
        let size = body.num_cells();
        let filled = |cell: [usize; 3]| {
            if in_stem(lattice.centre(cell)) {
                return Filled::Core;
            }
            let place = [cell[0].checked_sub(1), cell[1].checked_sub(1), Some(cell[2])];
            match place {
                [Some(i), Some(j), Some(k)] if i < size[0] && j < size[1] && k < size[2] => {
                    match plan.filling([i, j, k]) {
                        Filling::Solid => Filled::Silicone,
                        Filling::Air => Filled::Core,
                        Filling::Outside => Filled::Wall,
                    }
                }
                _ => Filled::Wall,
            }
        };
        let half = |side: f64| {
            Piece::around(&lattice, |cell| filled(cell) == Filled::Wall && side * lattice.centre(cell)[1] > 0.0)
        };
        let core = Piece::around(&lattice, |cell| filled(cell) == Filled::Core);
        Ok(Self { halves: [half(-1.0), half(1.0)], core })
    }
}

impl Piece {
    /// The surface of some boxes of a lattice.
    fn around(lattice: &Lattice, is_in: impl Fn([usize; 3]) -> bool) -> Self {
        let size = lattice.num_cells();
        let mut piece = Self::default();
        let mut known: BTreeMap<[usize; 3], u32> = BTreeMap::new();
        for cell in (0..size[0]).flat_map(|i| (0..size[1]).flat_map(move |j| (0..size[2]).map(move |k| [i, j, k]))) {
            if !is_in(cell) {
                continue;
            }
            for (axis, ahead) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
                let mut next = cell;
                next[axis] = if ahead { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
                if next[axis] < size[axis] && is_in(next) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                    let mut at = cell;
                    at[axis] += usize::from(ahead);
                    at[u] += a;
                    at[v] += b;
                    *known.entry(at).or_insert_with(|| {
                        piece.corners.push(std::array::from_fn(|d| lattice.lines[d][at[d]]));
                        (piece.corners.len() - 1) as u32
                    })
                });
                let [a, b, c, d] = corners;
                piece.triangles.extend(if ahead { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
        piece
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::volume;
    use crate::testing::is_closed;
    use pneuflex_mesh::Channel;

    #[test]
    fn the_parts_are_closed_and_leave_room_for_exactly_the_silicone() {
        let varied = Actuator {
            chambers: 3,
            chamber_length: vec![8.0, 9.0, 10.0].into(),
            cavity_length: vec![6.0, 6.5, 7.0].into(),
            gap: vec![2.0, 0.0].into(),
            side_wall: vec![1.0, 1.5, 1.2].into(),
            top_wall: vec![1.0, 1.3, 2.0].into(),
            flange: 3.0,
            cavity_floor: Some(3.5),
            channel: Channel { half_width: 1.5, bottom: 1.5, top: 2.75 },
            ..Actuator::two_chambers()
        };
        let wall = 4.0;
        for actuator in [Actuator::two_chambers(), Actuator::full(), varied] {
            let Mould { halves, core } = Mould::new(&actuator, wall).unwrap();
            for piece in halves.iter().chain([&core]) {
                is_closed(&piece.triangles).unwrap();
            }
            let of = |piece: &Piece| volume(&piece.corners, &piece.triangles);
            let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-9;
            // Written down from the lengths alone.
            let (length, row) = (actuator.length(), actuator.row());
            let sum = |of: &dyn Fn(&pneuflex_mesh::Chamber) -> f64| row.iter().map(of).sum::<f64>();
            let outside = actuator.width
                * (length * actuator.base + (actuator.height - actuator.base) * sum(&|c| c.end - c.start));
            let channel = &actuator.channel;
            let section = 2.0 * channel.half_width * (channel.top - channel.bottom);
            let floor = actuator.floor();
            let cavities = sum(&|c| {
                let [a, b] = c.cavity;
                (b - a) * (actuator.width - 2.0 * c.side_wall) * (actuator.height - c.top_wall - floor)
            });
            // Below the cavities the channel reaches up to their floor.
            let below = 2.0 * channel.half_width * (floor - channel.bottom) * sum(&|c| c.cavity[1] - c.cavity[0]);
            let (begin, end) = (row[0].cavity[0], row[row.len() - 1].cavity[1]);
            let between = section * (end - begin - sum(&|c| c.cavity[1] - c.cavity[0]));
            let stem = section * (begin + wall);
            assert!(
                near(of(&core), cavities + below + between + stem),
                "{} {}",
                of(&core),
                cavities + below + between + stem
            );
            let block = (length + 2.0 * wall) * (actuator.width + 2.0 * wall) * (actuator.height + wall);
            for half in &halves {
                assert!(near(of(half), 0.5 * (block - outside - section * wall)), "{}", of(half));
                let side =
                    half.corners.iter().map(|x| x[1]).fold(0.0, |a: f64, y| if y.abs() > a.abs() { y } else { a });
                assert!(half.corners.iter().all(|x| x[1] * side >= 0.0));
            }
            // What the parts leave free within the block: as much as the mesh has, and where the stem was the inlet.
            let silicone = block - of(&halves[0]) - of(&halves[1]) - of(&core);
            let mesh = pneuflex_mesh::build_actuator(
                &actuator,
                &pneuflex_mesh::MeshSize::uniform(3.0),
                pneuflex_mesh::ElementKind::Hex8,
            );
            assert!(near(silicone, 2.0 * mesh.unwrap().volume() - section * begin));
        }
    }

    #[test]
    fn what_has_no_core_or_no_walls_is_refused() {
        let mut actuator = Actuator::two_chambers();
        assert_eq!(Mould::new(&actuator, 0.0), Err(ExportError::Wall(0.0)));
        assert!(matches!(Mould::new(&actuator, f64::NAN), Err(ExportError::Wall(_))));
        actuator.channel.half_width = 0.0;
        assert_eq!(Mould::new(&actuator, 3.0), Err(ExportError::NoChannel));
    }
}
