//! Volumes, places and sets of the generated body, in closed form and against bodies put together by hand.

use super::*;
use crate::element::ElementKind;
use crate::grading::MeshSize;
use crate::lattice::Lattice;
use crate::mesh::{Facet, Mesh};
use crate::shape;

fn size(h: f64) -> MeshSize {
    MeshSize::uniform(h)
}

#[test]
fn the_grid_is_the_whole_box() {
    let half = Actuator::two_chambers();
    assert_eq!(half.estimate_grid(&size(1.0), &Cuts::default()), 18.0 * 10.0 * 13.0);
    let whole = Actuator { part: Part::Whole, ..half };
    assert_eq!(whole.estimate_grid(&size(0.5), &Cuts::default()), 36.0 * 40.0 * 26.0);
}

/// Volume enclosed by a facet set and the planes that cut it: ∮ x n_x dS over the facets.
fn signed_volume(mesh: &Mesh, set: &str) -> f64 {
    let mut volume = 0.0;
    for &facet in mesh.facet_set(set) {
        let nodes = mesh.facet_nodes(facet);
        for (xi, w) in (mesh.face_kind(facet).rule)() {
            let shape = shape::evaluate_face(mesh.face_kind(facet), xi);
            let mut point = [0.0; 3];
            let mut tangent = [[0.0; 3]; 2];
            for (i, &n) in nodes.iter().enumerate() {
                for d in 0..3 {
                    point[d] += shape.values[i] * mesh.nodes[n as usize][d];
                    for a in 0..2 {
                        tangent[a][d] += shape.gradients[i][a] * mesh.nodes[n as usize][d];
                    }
                }
            }
            volume += w * point[0] * (tangent[0][1] * tangent[1][2] - tangent[0][2] * tangent[1][1]);
        }
    }
    volume
}

#[test]
fn default_half_models_have_the_volumes_of_the_theory() {
    for kind in ElementKind::ALL {
        // Fine meshes only of what has few nodes.
        for &h in if kind == ElementKind::Hex8 { &[1.0, 2.0, 4.5][..] } else { &[4.5] } {
            let two = build_actuator(&Actuator::two_chambers(), &size(h), kind).unwrap();
            assert!((two.volume() - 1268.0).abs() < 1e-8, "{kind:?} at {h}: {}", two.volume());
            let full = build_actuator(&Actuator::full(), &size(h), kind).unwrap();
            assert!((full.volume() - 5460.0).abs() < 1e-8, "{kind:?} at {h}: {}", full.volume());
        }
    }
}

#[test]
fn whole_model_is_twice_the_half() {
    let whole = Actuator { part: Part::Whole, ..Actuator::two_chambers() };
    let mesh = build_actuator(&whole, &size(1.0), ElementKind::Hex8).unwrap();
    assert!((mesh.volume() - 2536.0).abs() < 1e-9);
    assert!(mesh.node_set("symmetry").is_empty());
    let half = build_actuator(&Actuator::two_chambers(), &size(1.0), ElementKind::Hex8).unwrap();
    assert_eq!(mesh.num_elements(), 2 * half.num_elements());
}

#[test]
fn cavity_facets_enclose_the_air() {
    // Facet normals point out of the solid, into the air: the sum has the opposite sign of the air volume.
    let mesh = build_actuator(&Actuator::two_chambers(), &size(1.0), ElementKind::Hex20).unwrap();
    let air = 2.0 * 6.0 * 9.0 * 8.0 + 16.0 + 12.0;
    assert!((signed_volume(&mesh, "cavity") + air).abs() < 1e-9);
}

/// Single-point contact pairs the facets in the order of the sets: through the gap, they must coincide.
#[test]
fn walls_of_a_gap_correspond_facet_by_facet() {
    for kind in ElementKind::ALL {
        let mesh = build_actuator(&Actuator::two_chambers(), &size(3.0), kind).unwrap();
        let [left, right] = ["gap_1_left", "gap_1_right"].map(|set| mesh.facet_set(set));
        assert_eq!(left.len(), right.len());
        for (&a, &b) in left.iter().zip(right) {
            let across = |facet: Facet| -> Vec<[u64; 2]> {
                let nodes = mesh.facet_nodes(facet);
                let mut seen: Vec<_> =
                    nodes.iter().map(|&n| mesh.nodes[n as usize]).map(|x| [x[1], x[2]].map(f64::to_bits)).collect();
                seen.sort_unstable();
                seen
            };
            assert_eq!(across(a), across(b), "{kind:?}");
        }
    }
}

#[test]
fn walls_of_every_gap_face_each_other() {
    let mesh = build_actuator(&Actuator::full(), &size(1.0), ElementKind::Hex8).unwrap();
    let actuator = Actuator::full();
    for i in 1..actuator.chambers {
        for (side, x) in [("left", 0.0), ("right", 2.0)] {
            let facets = mesh.facet_set(&format!("gap_{i}_{side}"));
            assert_eq!(facets.len(), 10 * 9);
            let plane = actuator.row()[i - 1].end + x;
            for &facet in facets {
                for n in mesh.facet_nodes(facet) {
                    assert!((mesh.nodes[n as usize][0] - plane).abs() < 1e-12);
                }
            }
        }
    }
    assert!(mesh.facet_set("gap_8_left").is_empty());
}

/// Together with the clamp and the plane of symmetry the outer faces enclose the body with its air.
#[test]
fn outer_facets_enclose_body_and_air() {
    for kind in ElementKind::ALL {
        for actuator in [Actuator::two_chambers(), Actuator { part: Part::Whole, ..Actuator::full() }] {
            let mesh = build_actuator(&actuator, &size(4.5), kind).unwrap();
            // On the clamp x is 0, and the normal of the plane of symmetry has no x: neither adds to the volume.
            let enclosed = signed_volume(&mesh, "outer");
            let air = -signed_volume(&mesh, "cavity");
            assert!((enclosed - air - mesh.volume()).abs() < 1e-8, "{kind:?}: {enclosed} {air}");
        }
    }
}

/// Without a channel every chamber has air of its own.
#[test]
fn cavities_that_nothing_joins_are_surfaces_of_their_own() {
    let joined = build_actuator(&Actuator::full(), &size(2.0), ElementKind::Hex8).unwrap();
    assert!(joined.facet_sets.keys().all(|name| !name.starts_with("cavity_")));
    for part in [Part::Half, Part::Whole] {
        let mut actuator = Actuator { chambers: 3, part, ..Actuator::full() };
        actuator.channel.half_width = 0.0;
        let sides = if part == Part::Half { 1.0 } else { 2.0 };
        for kind in ElementKind::ALL {
            let mesh = build_actuator(&actuator, &size(2.0), kind).unwrap();
            let mut all: Vec<Facet> = Vec::new();
            for i in 1..=3 {
                let name = format!("cavity_{i}");
                assert!((signed_volume(&mesh, &name) + sides * 6.0 * 9.0 * 8.0).abs() < 1e-9, "{kind:?} {name}");
                all.extend(mesh.facet_set(&name));
            }
            all.sort_unstable();
            assert_eq!(all, mesh.facet_set("cavity"), "{kind:?}");
            assert!(mesh.facet_set("cavity_4").is_empty());
        }
    }
}

/// A solid block with cavities: its volume in closed form, and no walls that could touch.
#[test]
fn chambers_without_gaps_are_a_block_with_cavities() {
    for kind in ElementKind::ALL {
        for half_width in [0.0, 1.0] {
            for h in [0.7, 2.0, 4.5] {
                for edge in [0.9, f64::INFINITY] {
                    let mut block = Actuator { chambers: 3, gap: 0.0.into(), flange: 0.3, ..Actuator::two_chambers() };
                    block.channel.half_width = half_width;
                    let size = MeshSize { edge, ..MeshSize::uniform(h) };
                    // Fine meshes only of what has few nodes.
                    if h < 3.0 && kind != ElementKind::Hex8 {
                        continue;
                    }
                    let mesh = build_actuator(&block, &size, kind).unwrap();
                    // A block of 24 mm and flanges in the base, less three cavities and the channel between the outer end walls: 22 mm of
                    // 1 mm², and 1 mm² more below each cavity's floor.
                    let air = 3.0 * 6.0 * 9.0 * 8.0 + if half_width > 0.0 { 22.0 + 3.0 * 6.0 } else { 0.0 };
                    let solid = 24.0 * 10.0 * 13.0 + 2.0 * 0.3 * 10.0 * 4.0 - air;
                    assert!((mesh.volume() - solid).abs() < 1e-8, "{kind:?} {h} {edge}: {} {solid}", mesh.volume());
                    assert!((signed_volume(&mesh, "cavity") + air).abs() < 1e-8, "{kind:?} {h}");
                    assert!(mesh.facet_sets.keys().all(|name| !name.starts_with("gap_")));
                    let enclosed = signed_volume(&mesh, "outer");
                    assert!((enclosed - air - solid).abs() < 1e-8, "{kind:?}: {enclosed}");
                    if kind == ElementKind::Hex8 {
                        assert_eq!(mesh.num_elements() as f64, block.estimate_cells(&size, &Cuts::default()));
                    }
                }
            }
        }
    }
    assert_eq!((Actuator { gap: 0.0.into(), ..Actuator::full() }.gaps(), Actuator::full().gaps()), (0, 7));
    // A gap that no mesh has is refused, not closed without a word.
    let gap_of = |chamber_length: f64, gap: f64| {
        Actuator { chamber_length: chamber_length.into(), gap: gap.into(), ..Actuator::two_chambers() }.validate()
    };
    assert!(gap_of(8.0, 1e-6).is_ok() && gap_of(800.0, 0.0).is_ok());
    assert_eq!(gap_of(800.0, 1e-6).unwrap_err().key, "gap");
}

/// The wall that two chambers share is one wall: as many elements as were asked for, and none that only half of it gets.
#[test]
fn a_shared_wall_is_one_wall() {
    let block = Actuator { gap: 0.0.into(), ..Actuator::two_chambers() };
    let mesh = build_actuator(&block, &MeshSize { wall_elements: 3, ..size(6.0) }, ElementKind::Hex8).unwrap();
    let mut lines: Vec<f64> = mesh.nodes.iter().map(|x| x[0]).filter(|x| (6.9..9.1).contains(x)).collect();
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    assert_eq!(lines.len(), 4, "{lines:?}");
}

#[test]
fn deeper_cavity_floor_takes_its_volume_from_the_base() {
    let deep = Actuator { cavity_floor: Some(2.0), ..Actuator::two_chambers() };
    let mesh = build_actuator(&deep, &size(1.0), ElementKind::Hex8).unwrap();
    // 2 mm × 6 mm × 9 mm more air per chamber, less the part of the channel that was already there.
    assert!((mesh.volume() - (1268.0 - 2.0 * (6.0 * 9.0 * 2.0 - 12.0))).abs() < 1e-9);
}

#[test]
fn named_node_sets_lie_where_they_should() {
    let mesh = build_actuator(&Actuator::full(), &size(1.0), ElementKind::Hex8).unwrap();
    assert_eq!(mesh.node_set("clamp").len(), 11 * 5);
    assert_eq!(mesh.node_set("bottom_centreline").len(), 83);
    assert_eq!(mesh.node_set("end_face").len(), 11 * 5);
    assert_eq!(mesh.facet_set("bottom").len(), 82 * 10);
    assert!(mesh.node_set("symmetry").iter().all(|&n| mesh.nodes[n as usize][1] == 0.0));
    let estimate = Actuator::full().estimate_cells(&size(1.0), &Cuts::default());
    assert_eq!(estimate as usize, mesh.num_elements());
}

#[test]
fn wall_elements_refine_walls_only() {
    let fine = MeshSize { wall_elements: 2, ..MeshSize::uniform(2.0) };
    let mesh = build_actuator(&Actuator::two_chambers(), &fine, ElementKind::Hex8).unwrap();
    assert!((mesh.volume() - 1268.0).abs() < 1e-9);
    assert!(mesh.select_nodes(|x| (x[0] - 0.5).abs() < 1e-12).len() > 10);
    assert!(mesh.select_nodes(|x| (x[0] - 1.5).abs() < 1e-12).is_empty());
}

#[test]
fn faces_of_elements_lie_in_cuts_and_nothing_else_changes() {
    let actuator = Actuator::two_chambers();
    let graded = MeshSize { edge: 2.8, ..MeshSize::uniform(6.0) };
    let plain = build_actuator(&actuator, &graded, ElementKind::Hex8).unwrap();
    let cut = |corners| {
        let mut cuts = Cuts::default();
        cuts.add_box(corners);
        let estimate = actuator.estimate_cells(&graded, &cuts);
        let mesh = build_actuator_with(&actuator, &graded, ElementKind::Hex8, &cuts).unwrap();
        assert!((mesh.volume() - plain.volume()).abs() < 1e-9);
        assert_eq!(mesh.num_elements() as f64, estimate);
        mesh
    };
    let layer = cut([[-1.0, -10.0, 0.0], [18.0, 10.0, 0.7]]);
    let at = |mesh: &Mesh, z: f64| mesh.select_nodes(|x| (x[2] - z).abs() < 1e-12).len();
    assert!(at(&plain, 0.7) == 0 && at(&layer, 0.7) == at(&layer, 0.0));
    assert_eq!(layer.facet_set("gap_1_left").len(), layer.facet_set("gap_1_right").len());
    // Planes of the body itself, and what is as good as one.
    assert_eq!(cut([[0.0, 0.0, 0.0], [8.0, 9.0, 4.0]]), plain);
    assert_eq!(cut([[0.0, 0.0, 2.005], [8.0, 9.0, 3.995]]), plain);
}

#[test]
fn impossible_lengths_are_named() {
    type Change = fn(&mut Actuator);
    let cases: [(&str, Change); 9] = [
        ("chambers", |a| a.chambers = 0),
        ("cavity_length", |a| a.cavity_length = 8.0.into()),
        ("gap", |a| a.gap = (-1.0).into()),
        ("base", |a| a.base = f64::NAN),
        ("side_wall", |a| a.side_wall = 10.0.into()),
        ("top_wall", |a| a.top_wall = 9.5.into()),
        ("cavity_floor", |a| a.cavity_floor = Some(12.5)),
        ("channel.half_width", |a| a.channel.half_width = 9.5),
        ("channel.top", |a| a.channel.top = 1.0),
    ];
    for (key, change) in cases {
        let mut actuator = Actuator::two_chambers();
        change(&mut actuator);
        assert_eq!(actuator.validate().unwrap_err().key, key);
    }
}

/// Three chambers that have nothing in common but width and height, without a channel; half model.
fn different() -> Actuator {
    let mut actuator = Actuator {
        chambers: 3,
        chamber_length: [8.0, 6.0, 9.3].into(),
        cavity_length: [6.0, 4.5, 7.0].into(),
        gap: [2.0, 0.7].into(),
        flange: 1.1,
        side_wall: [1.0, 2.0, 1.5].into(),
        top_wall: [1.0, 0.8, 2.2].into(),
        ..Actuator::two_chambers()
    };
    actuator.channel.half_width = 0.0;
    actuator
}

/// Volumes of the cavities of the half, mm³.
fn cavities(actuator: &Actuator) -> Vec<f64> {
    let of = |i: usize| {
        let inside = (0.5 * actuator.width - actuator.side_wall.at(i), actuator.height - 4.0 - actuator.top_wall.at(i));
        actuator.cavity_length.at(i) * inside.0 * inside.1
    };
    (0..actuator.chambers).map(of).collect()
}

/// Chambers that differ have the volumes of silicone and air that their lengths say, whatever the elements and their sizes.
#[test]
fn chambers_that_differ_have_the_volumes_of_their_lengths() {
    let outer = 8.0 + 6.0 + 9.3;
    for part in [Part::Half, Part::Whole] {
        let sides = if part == Part::Half { 1.0 } else { 2.0 };
        let actuator = Actuator { part, ..different() };
        let air: Vec<f64> = cavities(&actuator).into_iter().map(|volume| sides * volume).collect();
        assert_eq!(air, [6.0 * 9.0 * 8.0, 4.5 * 8.0 * 8.2, 7.0 * 8.5 * 6.8].map(|volume| sides * volume));
        let length = 2.0 * 1.1 + outer + 2.7;
        let solid = sides * (length * 10.0 * 4.0 + outer * 10.0 * 9.0) - air.iter().sum::<f64>();
        for kind in ElementKind::ALL {
            for size in [size(2.0), size(4.5), MeshSize { edge: 0.9, ..size(6.0) }] {
                // Fine meshes only of what has few nodes.
                if size.size[0] < 3.0 && kind != ElementKind::Hex8 {
                    continue;
                }
                let mesh = build_actuator(&actuator, &size, kind).unwrap();
                assert!((mesh.volume() - solid).abs() < 1e-8 * solid, "{kind:?}: {} {solid}", mesh.volume());
                for (i, air) in air.iter().enumerate() {
                    let found = -signed_volume(&mesh, &format!("cavity_{}", i + 1));
                    assert!((found - air).abs() < 1e-8 * air, "{kind:?}, cavity {}: {found} {air}", i + 1);
                }
                if kind == ElementKind::Hex8 {
                    assert_eq!(mesh.num_elements() as f64, actuator.estimate_cells(&size, &Cuts::default()));
                }
            }
        }
    }
}

/// The same body put together by hand, from boxes whose corners are written down, on the lines of its mesh.
#[test]
fn chambers_that_differ_are_where_their_lengths_put_them() {
    let actuator = different();
    let mesh = build_actuator(&actuator, &MeshSize { edge: 1.0, ..size(5.0) }, ElementKind::Hex8).unwrap();
    let lines = std::array::from_fn(|d| {
        let mut lines: Vec<f64> = mesh.nodes.iter().map(|x| x[d]).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        lines
    });
    let chambers = [
        ([1.1, 9.1], [2.1, 8.1], 9.0, 12.0),
        ([11.1, 17.1], [11.85, 16.35], 8.0, 12.2),
        ([17.8, 27.1], [18.95, 25.95], 8.5, 10.8),
    ];
    let lattice = Lattice { lines };
    let is_solid = |cell| {
        let [x, y, z] = lattice.centre(cell);
        let within = |[low, high]: [f64; 2]| x > low && x < high;
        let is_air = |(_, cavity, side, top)| within(cavity) && y < side && z > 4.0 && z < top;
        (z < 4.0 || chambers.iter().any(|chamber| within(chamber.0))) && !chambers.into_iter().any(is_air)
    };
    let by_hand = lattice.mesh(ElementKind::Hex8, is_solid).mesh;
    assert_eq!((&mesh.nodes, &mesh.connectivity), (&by_hand.nodes, &by_hand.connectivity));
    // And the lines are where they have to be.
    for (d, planes) in [
        vec![0.0, 1.1, 2.1, 8.1, 9.1, 11.1, 11.85, 16.35, 17.1, 17.8, 18.95, 25.95, 27.1, 28.2],
        vec![0.0, 8.0, 8.5, 9.0, 10.0],
        vec![0.0, 4.0, 10.8, 12.0, 12.2, 13.0],
    ]
    .into_iter()
    .enumerate()
    {
        let is_there = |at: &f64| lattice.lines[d].iter().any(|line| (line - at).abs() < 1e-12);
        assert!(planes.iter().all(is_there), "{d}: {:?}", lattice.lines[d]);
    }
}

/// Where the walls of gaps are, and which of them there are: an entry of 0 is a wall that two chambers share.
#[test]
fn gaps_keep_their_numbers_beside_a_shared_wall() {
    let actuator = Actuator { chambers: 4, gap: [2.0, 0.0, 0.5].into(), ..Actuator::two_chambers() };
    assert_eq!(actuator.gaps(), 2);
    for kind in ElementKind::ALL {
        let mesh = build_actuator(&actuator, &size(4.5), kind).unwrap();
        for (set, plane) in [("gap_1_left", 8.0), ("gap_1_right", 10.0), ("gap_3_left", 26.0), ("gap_3_right", 26.5)] {
            let facets = mesh.facet_set(set);
            assert!(!facets.is_empty(), "{kind:?} {set}");
            for node in facets.iter().flat_map(|&facet| mesh.facet_nodes(facet)) {
                assert!((mesh.nodes[node as usize][0] - plane).abs() < 1e-12, "{kind:?} {set}");
            }
        }
        let walls: Vec<&String> = mesh.facet_sets.keys().filter(|name| name.starts_with("gap_")).collect();
        assert_eq!(walls.len(), 4, "{walls:?}");
        // 34.5 mm of base, four chambers on it, their cavities, and the channel between the outer end walls with what it has below them.
        let solid = 34.5 * 10.0 * 4.0 + 32.0 * 10.0 * 9.0 - 4.0 * 6.0 * 9.0 * 8.0 - 32.5 - 4.0 * 6.0;
        assert!((mesh.volume() - solid).abs() < 1e-8, "{kind:?}: {} {solid}", mesh.volume());
        let air = -signed_volume(&mesh, "cavity");
        assert!((signed_volume(&mesh, "outer") - air - solid).abs() < 1e-8, "{kind:?}");
    }
}

/// A list of equal entries is the number, to the last bit.
#[test]
fn equal_entries_are_the_number() {
    for part in [Part::Half, Part::Whole] {
        for gap in [0.0, 0.7] {
            let number = Actuator {
                chambers: 7,
                chamber_length: 8.1.into(),
                cavity_length: 6.3.into(),
                gap: gap.into(),
                flange: 0.1,
                side_wall: 1.3.into(),
                top_wall: 0.9.into(),
                part,
                ..Actuator::two_chambers()
            };
            let list = Actuator {
                chamber_length: [8.1; 7].into(),
                cavity_length: [6.3; 7].into(),
                gap: [gap; 6].into(),
                side_wall: [1.3; 7].into(),
                top_wall: [0.9; 7].into(),
                ..number.clone()
            };
            let graded = MeshSize { edge: 1.1, ..size(6.0) };
            let [a, b] =
                [&number, &list].map(|actuator| build_actuator(actuator, &graded, ElementKind::Hex20).unwrap());
            assert_eq!(a, b);
            assert_eq!((number.length(), number.thinnest_wall()), (list.length(), list.thinnest_wall()));
            assert_eq!(list.first_varied(), None);
        }
    }
    assert_eq!(different().first_varied(), Some("chamber_length"));
}

/// The thinnest wall gets the elements that were asked for, and every thicker one as many at least.
#[test]
fn walls_of_different_chambers_have_their_elements() {
    for part in [Part::Half, Part::Whole] {
        let actuator = Actuator { part, ..different() };
        let mesh = build_actuator(&actuator, &MeshSize { wall_elements: 3, ..size(6.0) }, ElementKind::Hex8).unwrap();
        let between = |d: usize, low: f64, high: f64| {
            let mut lines: Vec<f64> =
                mesh.nodes.iter().map(|x| x[d]).filter(|x| *x > low - 1e-9 && *x < high + 1e-9).collect();
            lines.sort_by(f64::total_cmp);
            lines.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
            lines.len() - 1
        };
        assert_eq!((between(1, 9.0, 10.0), between(2, 13.0 - 0.8, 13.0)), (3, 3));
        assert!(between(1, 8.0, 10.0) > 3 && between(2, 13.0 - 2.2, 13.0) > 4);
        if part == Part::Whole {
            assert_eq!(between(1, -10.0, -9.0), 3);
        }
    }
}

#[test]
fn wrong_entries_of_lists_are_named() {
    type Change = fn(&mut Actuator);
    let cases: [(&str, &str, Change); 11] = [
        ("gap", "a list with 2 entries, one for each of the gaps between 3 chambers: this one has 3", |a| {
            a.gap = [1.0; 3].into()
        }),
        ("side_wall", "a list with 3 entries, one for each of 3 chambers: this one has 0", |a| {
            a.side_wall = vec![].into()
        }),
        ("gap[2]", "at least 0", |a| a.gap = [1.0, -1.0].into()),
        ("gap[1]", "a billionth of the body", |a| (a.chamber_length, a.gap) = (800.0.into(), [1e-6, 1.0].into())),
        ("chamber_length[3]", "greater than 0", |a| a.chamber_length = [8.0, 8.0, f64::NAN].into()),
        ("cavity_length[2]", "less than 6 mm", |a| a.cavity_length = [4.0, 6.0, 4.0].into()),
        ("cavity_length", "less than 6 mm", |a| a.cavity_length = 6.0.into()),
        ("top_wall[1]", "less than 9 mm", |a| a.top_wall = [9.0, 1.0, 1.0].into()),
        ("cavity_floor", "less than 10.8 mm", |a| a.cavity_floor = Some(11.0)),
        ("channel.half_width", "less than 8 mm", |a| a.channel.half_width = 8.5),
        ("top_wall[3]", "must be equal to top_wall[1] = 1, or differ", |a| a.top_wall = [1.0, 2.0, 1.001].into()),
    ];
    for (key, words, change) in cases {
        let mut actuator = different();
        change(&mut actuator);
        let error = actuator.validate().unwrap_err();
        assert!(error.key == key && error.allowed.contains(words), "{error}");
    }
    // What rounding leaves is equal, and one chamber has no gap.
    let rounded = Actuator { top_wall: [0.3, 0.1 + 0.2, 0.3].into(), ..different() };
    assert!(rounded.validate().is_ok());
    let one = Actuator { chambers: 1, gap: vec![].into(), ..Actuator::two_chambers() };
    let mesh = build_actuator(&one, &size(2.0), ElementKind::Hex8).unwrap();
    assert_eq!(one.gaps(), 0);
    assert_eq!(
        mesh,
        build_actuator(&Actuator { chambers: 1, ..Actuator::two_chambers() }, &size(2.0), ElementKind::Hex8).unwrap()
    );
}

#[test]
fn every_length_per_chamber_is_known_by_its_key() {
    assert_eq!(Actuator::full().per_chamber().map(|(key, _)| key), LENGTHS_PER_CHAMBER);
}

/// Where both bodies have the same numbers of elements, the moved mesh is the other body's own.
#[test]
fn a_mesh_follows_to_other_lengths() {
    let base = Actuator { chambers: 3, flange: 2.0, ..Actuator::two_chambers() };
    let channel = Channel { top: 3.1, ..base.channel.clone() };
    let other = Actuator {
        gap: 2.1.into(),
        side_wall: 1.05.into(),
        base: 4.2,
        cavity_length: [6.1, 6.0, 5.9].into(),
        channel,
        ..base.clone()
    };
    for kind in [ElementKind::Hex27, ElementKind::Tet15] {
        let [mesh, wanted] = [&base, &other].map(|actuator| build_actuator(actuator, &size(20.0), kind).unwrap());
        let moved = base.mesh_moved_to(&other, &Cuts::default(), &mesh).unwrap();
        assert_eq!((&moved.facet_sets, &moved.connectivity), (&wanted.facet_sets, &wanted.connectivity));
        let largest = |a: &Mesh, b: &Mesh| {
            let pairs = a.nodes.as_flattened().iter().zip(b.nodes.as_flattened());
            pairs.fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs()))
        };
        assert!(largest(&moved, &wanted) < 1e-12 && largest(&mesh, &wanted) > 0.1);
    }
    let mesh = build_actuator(&base, &size(20.0), ElementKind::Hex8).unwrap();
    let refused = |other: Actuator| base.mesh_moved_to(&other, &Cuts::default(), &mesh).unwrap_err();
    // One chamber's side wall, where those of all chambers are one plane of nodes; a floor that leaves the top of the base.
    let uneven = Actuator { side_wall: [1.0, 1.01, 1.0].into(), ..base.clone() };
    assert_eq!(refused(uneven), NotMovable::Planes { axis: 'y' });
    assert_eq!(refused(Actuator { cavity_floor: Some(4.1), ..base.clone() }), NotMovable::Planes { axis: 'z' });
    assert!(matches!(refused(Actuator { base: -1.0, ..base.clone() }), NotMovable::Geometry(_)));
}
