//! Where the von Mises stress is highest, in words.

use pneuflex::mesh::Actuator;
use pneuflex::post::penetration;

use super::Outcome;
use super::record::{Place, Places, on};
use super::solution::Solution;

/// Number of places listed.
const COUNT: usize = 10;

/// Two integration points nearer than this are one place, mm.
const APART: f64 = 1.5;

/// Part of the body a stress belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// The walls of a gap within a wall's thickness of where they touch.
    Contact {
        /// Gap, from 1.
        gap: usize,
    },
    /// Within about a wall's thickness of where the walls on either side of a gap stand on the base.
    RootBetween {
        /// Gap, from 1.
        gap: usize,
    },
    /// The same for the first or last wall of the row, which faces no other chamber.
    OuterRoot,
    /// The rest.
    Elsewhere,
}

/// The highest stress of every kind of region, MPa.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// In the contact area.
    pub contact: f64,
    /// At the roots between chambers.
    pub root_between: f64,
    /// At the roots of the row's first and last wall.
    pub outer_root: f64,
    /// In the rest.
    pub elsewhere: f64,
}

/// The ten highest places of a state, and the peak of every kind of region.
///
/// # Errors
/// Fields that cannot be read.
pub fn highest(solution: &Solution, actuator: &Actuator, pressure_kpa: f64) -> Outcome<(Places, Peaks)> {
    let displacement = solution.displacement(pressure_kpa)?;
    let touching = penetration::touching(&solution.problem, &displacement)?;
    let stress = solution.stress(pressure_kpa)?;
    let mut points: Vec<(f64, [f64; 3])> = stress.points.iter().map(|p| (p.von_mises, p.position)).collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut peaks = Peaks::default();
    let mut places: Vec<Place> = Vec::new();
    for (von_mises_mpa, at) in points {
        let region = region(actuator, &touching, at);
        let peak = match region {
            Region::Contact { .. } => &mut peaks.contact,
            Region::RootBetween { .. } => &mut peaks.root_between,
            Region::OuterRoot => &mut peaks.outer_root,
            Region::Elsewhere => &mut peaks.elsewhere,
        };
        *peak = peak.max(von_mises_mpa);
        let far = |p: &Place| (0..3).map(|d| (p.at[d] - at[d]).powi(2)).sum::<f64>() > APART * APART;
        if places.len() < COUNT && places.iter().all(far) {
            places.push(Place { von_mises_mpa, at, region: describe(actuator, region, at) });
        }
    }
    Ok((Places { mesh: on(solution.run.body, solution.run.mesh), places }, peaks))
}

/// The region of a reference position; `touching` are reference positions on slave walls.
fn region(actuator: &Actuator, touching: &[[f64; 3]], [x, y, z]: [f64; 3]) -> Region {
    let row = actuator.row();
    let wall = actuator.end_wall();
    // Gaps 0 and `chambers` lie before the first and behind the last chamber; a position belongs to that between the middles beside it.
    let gap = row.partition_point(|chamber| 0.5 * (chamber.start + chamber.end) <= x);
    let left = gap.checked_sub(1).and_then(|left| row.get(left));
    let (before, after) = match (left, row.get(gap)) {
        (Some(left), Some(right)) => (left.end, right.start),
        (Some(left), None) => (left.end, left.end),
        (None, Some(right)) => (right.start, right.start),
        (None, None) => return Region::Elsewhere,
    };
    let is_beside_gap = x > before - 1.25 * wall && x < after + 1.25 * wall;
    if !is_beside_gap {
        return Region::Elsewhere;
    }
    let is_between = gap > 0 && gap < row.len();
    let is_root = (z - actuator.base).abs() <= 1.25 * wall;
    let touches = |p: &&[f64; 3]| (p[0] - before).abs() < 0.5 * (after - before) && (p[1] - y).hypot(p[2] - z) <= wall;
    match (is_between, is_root) {
        (true, _) if touching.iter().any(|p| touches(&p)) => Region::Contact { gap },
        (true, true) => Region::RootBetween { gap },
        (false, true) => Region::OuterRoot,
        _ => Region::Elsewhere,
    }
}

fn describe(actuator: &Actuator, region: Region, [x, y, z]: [f64; 3]) -> String {
    let row = actuator.row();
    let chamber = row.partition_point(|chamber| chamber.start <= x).max(1);
    let Some(walls) = row.get(chamber - 1) else { return String::new() };
    match region {
        Region::Contact { gap } => format!("contact area of chambers {gap} and {}", gap + 1),
        Region::RootBetween { gap } => {
            let channel =
                if z < actuator.base && y <= actuator.channel.half_width { ", edge of the channel" } else { "" };
            format!("root between chambers {gap} and {}{channel}", gap + 1)
        }
        Region::OuterRoot => format!("root of the outer wall of chamber {chamber}"),
        Region::Elsewhere => {
            let inner_side = 0.5 * actuator.width - walls.side_wall;
            let what = if z >= actuator.height - 1.5 * walls.top_wall {
                "top wall"
            } else if y.abs() >= inner_side - 0.5 * walls.side_wall {
                "side wall"
            } else if z <= actuator.base + 0.5 {
                "base, cavity floor or channel"
            } else {
                "end wall"
            };
            format!("{what} of chamber {chamber}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_get_their_regions() {
        let actuator = Actuator::full();
        let touching = [[10.0, 0.0, 8.0]];
        let at = |x, y, z| region(&actuator, &touching, [x, y, z]);
        assert_eq!(at(10.0, 0.5, 8.5), Region::Contact { gap: 1 });
        assert_eq!(at(12.9, 0.0, 7.5), Region::Contact { gap: 1 });
        assert_eq!(at(20.0, 0.0, 8.0), Region::Elsewhere, "gap 2 is open there");
        assert_eq!(at(12.887, 0.887, 3.11), Region::RootBetween { gap: 1 });
        assert_eq!(at(19.11, 0.887, 3.11), Region::RootBetween { gap: 2 });
        assert_eq!(at(2.887, 2.3, 4.3), Region::OuterRoot);
        assert_eq!(at(79.1, 2.3, 4.3), Region::OuterRoot);
        assert_eq!(at(6.0, 0.5, 12.5), Region::Elsewhere);
        let two = Actuator::two_chambers();
        assert_eq!(region(&two, &[], [17.1, 0.9, 3.1]), Region::OuterRoot);
        assert_eq!(region(&two, &[], [0.5, 0.9, 4.1]), Region::OuterRoot);
        assert_eq!(region(&two, &[], [7.1, 0.9, 3.1]), Region::RootBetween { gap: 1 });
        assert_eq!(describe(&two, Region::Elsewhere, [13.0, 0.5, 12.5]), "top wall of chamber 2");
        assert!(describe(&two, Region::RootBetween { gap: 1 }, [7.1, 0.9, 3.1]).ends_with("edge of the channel"));
    }
}
