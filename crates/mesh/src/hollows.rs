//! The hollow spaces of a body: closed shells inside of it, and chambers that open to the outside through an inlet only.
//!
//! Where a chamber ends is where its inlet does. A mouth is a plane rim between two smooth parts of the surface that, cut along it, falls into
//! two pieces, one of which encloses a void once a disc closes it; behind the rim the walls stand around the disc (they do not lie in it); the
//! chamber is wider than its mouth (else it is a blind hole); and from the mouth one sees the outside. Of mouths of one chamber the outermost
//! counts. Where a mouth is not of this kind, a point says where it is.

use std::collections::{BTreeMap, BTreeSet};

use crate::mesh::{Facet, Mesh};
use crate::skin::{FacePlace, Skin};
use crate::vector::{Vec3, bounds, cross, dot, longest_axis, norm, ray_meets, sub};

/// Parts of the surface are smooth up to this angle between neighbouring faces, degrees.
const SMOOTH: f64 = 30.0;

/// How far the nodes of a plane rim are from the plane, relative to its radius.
const FLAT: f64 = 0.02;

/// The normal of a wall behind a rim is not along that of the disc: largest cosine of the angle between them.
const UPRIGHT: f64 = 0.95;

/// How far a point may lie before or behind the disc of a rim that it means, relative to the rim's radius.
const CLOSE: f64 = 0.3;

/// Share of a rim's length behind which such walls stand; a mouth may be notched.
const AROUND: f64 = 0.8;

/// A chamber is this many times as wide as its mouth.
const WIDER: f64 = 1.2;

/// Volumes smaller than this are none, relative to the cube of the rim's radius.
const SMALL: f64 = 1e-9;

/// Faces that are looked at in all for mouths; more would take minutes.
const MOST_WORK: usize = 300_000_000;

/// A hollow space.
#[derive(Clone, Debug, PartialEq)]
pub struct Hollow {
    /// Its walls.
    pub facets: Vec<Facet>,
    /// Volume at rest, mm³; a disc closes the mouth.
    pub volume: f64,
    /// Where it opens; `None` for a closed one.
    pub mouth: Option<Mouth>,
}

/// Where a chamber opens to the outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mouth {
    /// The middle of its rim, mm.
    pub centre: [f64; 3],
    /// Area of the disc that closes it, mm².
    pub area: f64,
}

/// Why no chamber opens where one should.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoMouth {
    /// The middle of the nearest rim, mm.
    pub nearest: Option<[f64; 3]>,
}

/// A closed line of edges on the surface.
struct Rim {
    /// Edges by their numbers in the skin.
    edges: Vec<usize>,
    centre: Vec3,
    /// Largest distance of its nodes from the centre.
    radius: f64,
    /// Area of the fan around the centre with its normal.
    area: Vec3,
    is_flat: bool,
}

impl Rim {
    /// Whether a point lies in its disc, or close before or behind it.
    fn is_closed_at(&self, point: Vec3) -> bool {
        let off = sub(point, self.centre);
        let size = norm(self.area);
        size > 0.0 && norm(off) <= self.radius && dot(off, self.area).abs() <= CLOSE * self.radius * size
    }
}

/// What a rim cuts off.
struct Piece {
    /// Faces by their numbers in the skin.
    faces: Vec<usize>,
    volume: f64,
    rim: usize,
}

impl Mesh {
    /// The hollow spaces in the order in which they lie along the body's longest axis, and whether all rims could be looked at. `inlets` are
    /// points in mouths; where there are some, open chambers are those behind them.
    ///
    /// # Errors
    /// [`NoMouth`] for an inlet beside which no chamber opens, with its number.
    pub fn hollows(&self, inlets: &[[f64; 3]]) -> Result<(Vec<Hollow>, bool), (usize, NoMouth)> {
        let skin = self.skin();
        let shells = skin.pieces(|_| true);
        let mut volumes = vec![0.0; shells.iter().max().map_or(0, |last| last + 1)];
        shells.iter().zip(&skin.places).for_each(|(&shell, place)| volumes[shell] += place.volume);
        let mut found: Vec<(Vec<usize>, f64, Option<Mouth>)> = Vec::new();
        for (shell, volume) in volumes.iter().enumerate().filter(|(_, volume)| **volume < 0.0) {
            found.push(((0..shells.len()).filter(|&face| shells[face] == shell).collect(), -volume, None));
        }
        let opening = Opening { mesh: self, skin: &skin, is_outer: shells.iter().map(|&s| volumes[s] > 0.0).collect() };
        let rims = opening.rims();
        let (pieces, is_complete) = match inlets {
            [] => opening.behind_mouths(&rims),
            points => {
                let mut pieces = Vec::new();
                let mut all = rims;
                for (number, &point) in points.iter().enumerate() {
                    pieces.push(opening.behind(point, &mut all).map_err(|none| (number, none))?);
                }
                let with_mouths = pieces.into_iter().map(|piece| (mouth(&all[piece.rim]), piece)).collect();
                (with_mouths, true)
            }
        };
        found.extend(pieces.into_iter().map(|(mouth, piece)| (piece.faces, piece.volume, Some(mouth))));
        let longest = self.longest_axis();
        let along = |faces: &[usize]| {
            let area: f64 = faces.iter().map(|&face| skin.places[face].area).sum();
            faces.iter().map(|&face| skin.places[face].area * skin.places[face].centre[longest]).sum::<f64>() / area
        };
        found.sort_by(|a, b| along(&a.0).total_cmp(&along(&b.0)));
        let chamber = |(faces, volume, mouth): (Vec<usize>, f64, Option<Mouth>)| {
            let mut facets: Vec<Facet> = faces.into_iter().map(|face| skin.facets[face]).collect();
            facets.sort_unstable();
            Hollow { facets, volume, mouth }
        };
        Ok((found.into_iter().map(chamber).collect(), is_complete))
    }

    /// The axis along which the body is longest: 0, 1, 2 for x, y, z.
    pub fn longest_axis(&self) -> usize {
        bounds(self.nodes.iter().copied()).map_or(0, longest_axis)
    }
}

fn mouth(rim: &Rim) -> Mouth {
    Mouth { centre: rim.centre, area: norm(rim.area) }
}

/// The surface of which mouths are looked for.
struct Opening<'a> {
    mesh: &'a Mesh,
    skin: &'a Skin,
    /// Whether a face belongs to an outer shell.
    is_outer: Vec<bool>,
}

impl Opening<'_> {
    /// Closed lines between smooth parts of the surface.
    fn rims(&self) -> Vec<Rim> {
        let skin = self.skin;
        let part = skin.pieces(|edge| skin.angle(edge) <= SMOOTH);
        let mut of_part: Vec<Vec<usize>> = vec![Vec::new(); part.iter().max().map_or(0, |last| last + 1)];
        for (number, edge) in skin.edges.iter().enumerate() {
            let [one, other] = edge.faces.map(|face| part[face]);
            if one != other && self.is_outer[edge.faces[0]] {
                of_part[one].push(number);
                of_part[other].push(number);
            }
        }
        let mut known: BTreeSet<Vec<usize>> = BTreeSet::new();
        let lines = of_part.iter().flat_map(|edges| self.closed_lines(edges)).filter(|line| known.insert(line.clone()));
        lines.map(|line| self.rim(line)).collect()
    }

    /// Connected lines of edges at all of whose nodes two edges meet.
    fn closed_lines(&self, edges: &[usize]) -> Vec<Vec<usize>> {
        let mut at_node: Vec<(u32, usize)> =
            edges.iter().flat_map(|&edge| self.skin.edges[edge].ends.map(|node| (node, edge))).collect();
        at_node.sort_unstable();
        let meeting = |node: u32| {
            let first = at_node.partition_point(|(other, _)| *other < node);
            at_node[first..].iter().take_while(move |(other, _)| *other == node).map(|(_, edge)| *edge)
        };
        let mut is_done: BTreeSet<usize> = BTreeSet::new();
        let mut found = Vec::new();
        for &first in edges {
            if !is_done.insert(first) {
                continue;
            }
            let (mut line, mut waiting, mut is_simple) = (vec![first], vec![first], true);
            while let Some(edge) = waiting.pop() {
                for node in self.skin.edges[edge].ends {
                    is_simple &= meeting(node).count() == 2;
                    for next in meeting(node) {
                        if is_done.insert(next) {
                            line.push(next);
                            waiting.push(next);
                        }
                    }
                }
            }
            if is_simple {
                line.sort_unstable();
                found.push(line);
            }
        }
        found
    }

    fn ends(&self, edge: usize) -> [Vec3; 2] {
        self.skin.edges[edge].ends.map(|node| self.mesh.nodes[node as usize])
    }

    fn rim(&self, edges: Vec<usize>) -> Rim {
        let (mut centre, mut length) = ([0.0; 3], 0.0);
        for &edge in &edges {
            let [a, b] = self.ends(edge);
            let along = norm(sub(b, a));
            length += along;
            (0..3).for_each(|d| centre[d] += 0.5 * along * (a[d] + b[d]));
        }
        let centre = centre.map(|t| t / length);
        let radius = edges.iter().flat_map(|&edge| self.ends(edge)).map(|x| norm(sub(x, centre))).fold(0.0, f64::max);
        let area = self.fan(&edges, centre);
        let size = norm(area);
        let is_flat = size > 0.0
            && edges.iter().flat_map(|&edge| self.ends(edge)).all(|x| {
                let off = dot(sub(x, centre), area) / size;
                off.abs() <= FLAT * radius
            });
        Rim { edges, centre, radius, area, is_flat }
    }

    /// Sum of the areas with normals of the triangles between a closed line and a point, the line followed in one direction.
    fn fan(&self, edges: &[usize], centre: Vec3) -> Vec3 {
        let mut beside: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for [a, b] in edges.iter().map(|&edge| self.skin.edges[edge].ends) {
            beside.entry(a).or_default().push(b);
            beside.entry(b).or_default().push(a);
        }
        let Some((&start, _)) = beside.first_key_value() else { return [0.0; 3] };
        let (mut sum, mut from, mut at) = ([0.0; 3], u32::MAX, start);
        loop {
            let next = beside.get(&at).and_then(|two| two.iter().copied().find(|&node| node != from));
            let Some(to) = next else { return sum };
            let [a, b] = [at, to].map(|node| sub(self.mesh.nodes[node as usize], centre));
            let area = cross(a, b);
            (0..3).for_each(|d| sum[d] += 0.5 * area[d]);
            (from, at) = (at, to);
            if at == start {
                return sum;
            }
        }
    }

    /// The piece of the surface that a rim cuts off and that encloses a void once the rim is closed; `None` if it cuts off none. `work` counts
    /// faces.
    fn piece(&self, number: usize, rim: &Rim, work: &mut usize) -> Option<Piece> {
        let cut: BTreeSet<usize> = rim.edges.iter().copied().collect();
        let first = &self.skin.edges[*rim.edges.first()?];
        // From both sides in turn, so that the smaller piece ends the search.
        let mut reached: [BTreeSet<usize>; 2] = first.faces.map(|face| BTreeSet::from([face]));
        let mut waiting = first.faces.map(|face| vec![face]);
        let smaller = loop {
            let mut ended = None;
            for side in 0..2 {
                let Some(face) = waiting[side].pop() else {
                    ended = Some(side);
                    break;
                };
                *work += 1;
                for &edge in self.skin.edges_of[face].iter().filter(|edge| !cut.contains(edge)) {
                    let next = self.skin.edges[edge].beyond(face);
                    if reached[1 - side].contains(&next) {
                        return None;
                    }
                    if reached[side].insert(next) {
                        waiting[side].push(next);
                    }
                }
            }
            if let Some(side) = ended {
                break side;
            }
        };
        let mut faces: Vec<usize> = reached[smaller].iter().copied().collect();
        let mut volume = self.closed_volume(&faces, rim, &cut);
        if volume >= -SMALL * rim.radius.powi(3) {
            // The other side, whole.
            let of_shell = self.rest_of_shell(&reached[smaller], first.faces[1 - smaller], &cut);
            *work += of_shell.len();
            faces = of_shell;
            volume = self.closed_volume(&faces, rim, &cut);
        }
        // Not what rounding makes of a flat piece.
        (volume < -SMALL * rim.radius.powi(3)).then_some(Piece { faces, volume: -volume, rim: number })
    }

    fn rest_of_shell(&self, other: &BTreeSet<usize>, from: usize, cut: &BTreeSet<usize>) -> Vec<usize> {
        let (mut reached, mut waiting) = (BTreeSet::from([from]), vec![from]);
        while let Some(face) = waiting.pop() {
            for &edge in self.skin.edges_of[face].iter().filter(|edge| !cut.contains(edge)) {
                let next = self.skin.edges[edge].beyond(face);
                if !other.contains(&next) && reached.insert(next) {
                    waiting.push(next);
                }
            }
        }
        reached.into_iter().collect()
    }

    /// Volume in a piece of the surface once a fan closes its rim; negative for a void.
    fn closed_volume(&self, faces: &[usize], rim: &Rim, cut: &BTreeSet<usize>) -> f64 {
        // About the rim's centre the fan has no volume of its own: ⅓ ∫ (x − c)·n dA.
        let members: BTreeSet<usize> = faces.iter().copied().collect();
        let open = cut.iter().filter(|&&edge| self.skin.edges[edge].faces.iter().any(|face| members.contains(face)));
        if open.count() != cut.len() {
            return 0.0;
        }
        let places = || faces.iter().map(|&face| &self.skin.places[face]);
        let about = |place: &FacePlace| place.area * dot(place.normal, rim.centre) / 3.0;
        places().map(|place| place.volume - about(place)).sum()
    }

    /// Whether the walls of a piece stand around the disc in its rim: else the disc lies in a wall.
    fn stands_around(&self, piece: &Piece, rim: &Rim) -> bool {
        let members: BTreeSet<usize> = piece.faces.iter().copied().collect();
        let axis = rim.area.map(|t| t / norm(rim.area));
        // Lengths of the rim's edges, and of those behind which a wall looks at the disc's centre and does not lie in the disc's plane.
        let (mut whole, mut around) = (0.0, 0.0);
        for &edge in &rim.edges {
            let [a, b] = self.ends(edge);
            let length = norm(sub(a, b));
            let to_centre: Vec3 = std::array::from_fn(|d| rim.centre[d] - 0.5 * (a[d] + b[d]));
            let wall = self.skin.edges[edge].faces.into_iter().find(|face| members.contains(face));
            let normal = wall.map_or([0.0; 3], |face| self.skin.places[face].normal);
            let looks_in = dot(normal, to_centre) > 1e-3 * norm(to_centre);
            whole += length;
            around += if looks_in && dot(normal, axis).abs() < UPRIGHT { length } else { 0.0 };
        }
        around > AROUND * whole
    }

    /// Whether a piece is wider than its rim, and the rim is a mouth to the outside.
    fn is_chamber(&self, piece: &Piece, rim: &Rim) -> bool {
        let axis = rim.area.map(|t| t / norm(rim.area));
        let from_axis = |x: Vec3| {
            let off = sub(x, rim.centre);
            let along = dot(off, axis);
            norm(std::array::from_fn(|d| off[d] - along * axis[d]))
        };
        let width = piece.faces.iter().map(|&face| from_axis(self.skin.places[face].centre)).fold(0.0, f64::max);
        width > WIDER * rim.radius && self.stands_around(piece, rim) && self.sees_outside(rim, self.outward(piece, rim))
    }

    /// The normal of a rim's disc that points away from a piece.
    fn outward(&self, piece: &Piece, rim: &Rim) -> Vec3 {
        let axis = rim.area.map(|t| t / norm(rim.area));
        let members: BTreeSet<usize> = piece.faces.iter().copied().collect();
        let beside =
            rim.edges.iter().flat_map(|&edge| self.skin.edges[edge].faces).filter(|face| members.contains(face));
        let side: f64 = beside.map(|face| dot(sub(self.skin.places[face].centre, rim.centre), axis)).sum();
        if side > 0.0 { axis.map(|t| -t) } else { axis }
    }

    /// Whether nothing of the body lies before a mouth.
    fn sees_outside(&self, rim: &Rim, direction: Vec3) -> bool {
        // From just before the disc.
        let from: Vec3 = std::array::from_fn(|d| rim.centre[d] + 1e-3 * rim.radius * direction[d]);
        let meets = |&facet: &Facet| {
            let corners = self.mesh.face_kind(facet).num_corners();
            let nodes = self.mesh.facet_nodes(facet);
            let x = |i: usize| self.mesh.nodes[nodes[i] as usize];
            (1..corners - 1)
                .any(|i| ray_meets(from, direction, [x(0), x(i), x(i + 1)]).is_some_and(|along| along > 0.0))
        };
        !self.skin.facets.iter().any(meets)
    }

    /// Chambers behind mouths that are found by themselves, none of which is a part of another one.
    fn behind_mouths(&self, rims: &[Rim]) -> (Vec<(Mouth, Piece)>, bool) {
        let mut work = 0;
        let mut found: Vec<Piece> = Vec::new();
        for (number, rim) in rims.iter().enumerate().filter(|(_, rim)| rim.is_flat) {
            if work > MOST_WORK {
                return (Vec::new(), false);
            }
            found.extend(self.piece(number, rim, &mut work).filter(|piece| self.is_chamber(piece, rim)));
        }
        found.sort_by(|a, b| b.volume.total_cmp(&a.volume).then(a.rim.cmp(&b.rim)));
        let mut taken: BTreeSet<usize> = BTreeSet::new();
        let mut kept = Vec::new();
        for piece in found {
            if piece.faces.iter().all(|face| !taken.contains(face)) {
                taken.extend(&piece.faces);
                kept.push((mouth(&rims[piece.rim]), piece));
            }
        }
        (kept, true)
    }

    /// The chamber whose mouth is at a point: behind a rim between smooth parts, or else behind a cut through the surface along an axis, whose
    /// rim is added.
    fn behind(&self, point: [f64; 3], rims: &mut Vec<Rim>) -> Result<Piece, NoMouth> {
        let mut order: Vec<(f64, usize)> =
            rims.iter().enumerate().map(|(number, rim)| (norm(sub(rim.centre, point)), number)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut work = 0;
        let mut best: Option<Piece> = None;
        for &(_, number) in order.iter().filter(|(_, number)| rims[*number].is_closed_at(point)) {
            let piece = self.piece(number, &rims[number], &mut work);
            let Some(piece) = piece.filter(|piece| self.stands_around(piece, &rims[number])) else { continue };
            // Of rims around one middle the inner one, whose disc lies in no wall.
            if best.as_ref().is_none_or(|known| rims[number].radius < rims[known.rim].radius) {
                best = Some(piece);
            }
        }
        if let Some(piece) = best {
            return Ok(piece);
        }
        let cuts = self.cuts(point);
        let first = rims.len();
        rims.extend(cuts);
        let pieces: Vec<Piece> =
            (first..rims.len()).filter_map(|number| self.piece(number, &rims[number], &mut work)).collect();
        let smallest = pieces.into_iter().min_by(|a, b| norm(rims[a.rim].area).total_cmp(&norm(rims[b.rim].area)));
        smallest.ok_or(NoMouth { nearest: order.first().map(|&(_, number)| rims[number].centre) })
    }

    /// Closed lines of edges around a point along which planes normal to the axes, moved a little to either side, divide the surface.
    fn cuts(&self, point: [f64; 3]) -> Vec<Rim> {
        let mut found = Vec::new();
        for axis in 0..3 {
            let height = |face: usize| self.skin.places[face].centre[axis] - point[axis];
            for side in [-1.0, 1.0] {
                let is_behind = |face: usize| side * height(face) > 1e-9 * (1.0 + point[axis].abs());
                let crossing: Vec<usize> = (self.skin.edges.iter().enumerate())
                    .filter(|(_, edge)| self.is_outer[edge.faces[0]])
                    .filter(|(_, edge)| is_behind(edge.faces[0]) != is_behind(edge.faces[1]))
                    .map(|(number, _)| number)
                    .collect();
                let rims = self.closed_lines(&crossing).into_iter().map(|line| self.rim(line));
                // A line that follows the plane; others run along it.
                let is_along = |rim: &Rim| rim.area[axis].abs() > UPRIGHT * norm(rim.area);
                found.extend(rims.filter(|rim| norm(sub(rim.centre, point)) <= rim.radius && is_along(rim)));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;
    use crate::lattice::Lattice;

    /// A block of unit cells that is hollow where `is_hollow` holds.
    fn body(kind: ElementKind, cells: [usize; 3], is_hollow: impl Fn([usize; 3]) -> bool) -> Mesh {
        Lattice::uniform([0.0; 3], cells.map(|n| n as f64), cells).mesh(kind, |cell| !is_hollow(cell)).mesh
    }

    fn within(cell: [usize; 3], low: [usize; 3], high: [usize; 3]) -> bool {
        (0..3).all(|d| (low[d]..high[d]).contains(&cell[d]))
    }

    #[test]
    fn closed_shells_are_found_along_the_longest_axis() {
        for kind in [ElementKind::Hex8, ElementKind::Tet10, ElementKind::Hex27, ElementKind::Wedge21] {
            let mesh =
                body(kind, [3, 3, 7], |cell| within(cell, [1; 3], [2, 2, 3]) || within(cell, [1, 1, 4], [2, 2, 5]));
            let (found, is_complete) = mesh.hollows(&[]).unwrap();
            assert!(is_complete);
            let volumes: Vec<f64> = found.iter().map(|chamber| (1e9 * chamber.volume).round() / 1e9).collect();
            assert_eq!(volumes, [2.0, 1.0], "{kind:?}");
            assert!(found.iter().all(|chamber| chamber.mouth.is_none()));
        }
    }

    /// A chamber of 3 × 3 × 3 with a bore to the upper side, a closed one beside it, a blind hole and a notch, which are none.
    #[test]
    fn chambers_behind_an_inlet_are_found_and_blind_holes_are_not() {
        let hollow = |cell: [usize; 3]| {
            within(cell, [1, 1, 1], [4, 4, 4])
                || within(cell, [2, 2, 4], [3, 3, 6])
                || within(cell, [5, 1, 1], [6, 2, 2])
                || within(cell, [7, 2, 2], [8, 3, 6])
                || within(cell, [9, 0, 4], [10, 5, 6])
        };
        for kind in [ElementKind::Hex8, ElementKind::Tet10] {
            let mesh = body(kind, [12, 5, 6], hollow);
            let (found, _) = mesh.hollows(&[]).unwrap();
            assert_eq!(found.len(), 2, "{kind:?}");
            let (open, closed) = (&found[0], &found[1]);
            assert!((open.volume - 29.0).abs() < 1e-9 && (closed.volume - 1.0).abs() < 1e-9, "{}", open.volume);
            let mouth = open.mouth.unwrap();
            assert!((mouth.area - 1.0).abs() < 1e-12 && norm(sub(mouth.centre, [2.5, 2.5, 6.0])) < 1e-12);
            // A point makes a chamber of the blind hole.
            let (found, _) = mesh.hollows(&[[7.5, 2.5, 6.0]]).unwrap();
            assert_eq!(found.len(), 2);
            assert!((found[1].volume - 4.0).abs() < 1e-9);
            let none = mesh.hollows(&[[2.5, 2.5, 6.0], [12.0, 2.5, 3.0]]).unwrap_err();
            assert_eq!(none.0, 1);
            assert!(none.1.nearest.is_some());
        }
    }

    /// Two chambers with a channel between them and one bore to the outside are one; the mouth of a bore that is rounded is cut where the point is.
    #[test]
    fn chambers_that_a_channel_joins_are_one_and_a_round_mouth_is_cut() {
        let hollow = |cell: [usize; 3]| {
            within(cell, [2, 1, 1], [5, 4, 4])
                || within(cell, [6, 1, 1], [9, 4, 4])
                || within(cell, [0, 2, 2], [9, 3, 3])
        };
        let mesh = body(ElementKind::Hex8, [10, 5, 5], hollow);
        let (found, _) = mesh.hollows(&[]).unwrap();
        assert_eq!(found.len(), 1);
        assert!((found[0].volume - (54.0 + 3.0)).abs() < 1e-9, "{}", found[0].volume);
        // At the point in the middle of the bore's wall: no rim is there.
        let (found, _) = mesh.hollows(&[[1.0, 2.5, 2.5]]).unwrap();
        assert!((found[0].volume - (54.0 + 2.0)).abs() < 1e-9, "{}", found[0].volume);
    }

    #[test]
    fn a_solid_body_and_a_pipe_have_no_chamber() {
        for hollow in [[0, 0], [1, 2]] {
            let mesh =
                body(ElementKind::Hex8, [6, 3, 3], |cell| (hollow[0]..hollow[1]).contains(&cell[1]) && cell[2] == 1);
            assert_eq!(mesh.hollows(&[]).unwrap().0, []);
        }
    }
}
