//! The sample decks: what they are understood as, and what becomes of them when they are damaged.

use std::fs;
use std::path::PathBuf;

use pneuflex_deck::read;
use pneuflex_model::Contact;
use pneuflex_model::load::Load;
use proptest::prelude::*;

const DECKS: [&str; 4] = ["cantilever", "blocks", "tube", ASSEMBLY];

/// With parts and instances, as Abaqus/CAE writes decks.
const ASSEMBLY: &str = "../../crates/deck/tests/data/assembly";

fn text(name: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/decks");
    fs::read_to_string(folder.join(format!("{name}.inp"))).unwrap()
}

fn summary(name: &str) -> String {
    let deck = read(&format!("{name}.inp"), text(name).into(), &mut |_| Err(String::new())).unwrap();
    let problem = &deck.problem;
    let mut lines = vec![
        deck.title.clone(),
        format!(
            "{} nodes, {} elements of {}, volume {:.3} mm3",
            problem.mesh.num_nodes(),
            problem.mesh.num_elements(),
            problem.formulation,
            problem.mesh.volume()
        ),
        format!("{:?}", deck.schedule),
        format!("material {:?}", problem.material),
    ];
    let regions =
        problem.regions.iter().map(|r| format!("region {} of {} elements, {:?}", r.name, r.elements.len(), r.material));
    lines.extend(regions);
    let supports = problem
        .supports
        .iter()
        .map(|s| format!("support {} of {} nodes, {:?}, {:?}", s.name, s.nodes.len(), s.axes, s.motion));
    lines.extend(supports);
    lines.extend(problem.loads.iter().map(|load| match load {
        Load::Force { nodes, force, curve } => format!("force {force:?} on {} nodes, {curve:?}", nodes.len()),
        Load::Pressure { facets, curve } => format!("pressure on {} faces, {curve:?}", facets.len()),
        Load::Traction { facets, traction, curve } => {
            format!("traction {traction:?} on {} faces, {curve:?}", facets.len())
        }
        Load::Gravity { elements, acceleration, curve } => {
            format!("gravity {acceleration:?} on {:?} elements, {curve:?}", elements.as_ref().map(Vec::len))
        }
    }));
    let pairs = problem
        .contact_pairs
        .iter()
        .map(|p| format!("contact {}, {} on {} faces", p.name, p.slave.len(), p.master.len()));
    lines.extend(pairs);
    let Contact { method, stiffness, .. } = problem.contact;
    lines.push(format!("Contact {{ method: {method:?}, stiffness: {stiffness:?} }}"));
    lines.extend(deck.notes.iter().map(ToString::to_string));
    lines.join("\n")
}

#[test]
fn sample_decks_are_understood() {
    insta::assert_snapshot!("cantilever", summary("cantilever"));
    insta::assert_snapshot!("blocks", summary("blocks"));
    insta::assert_snapshot!("tube", summary("tube"));
}

/// Numbers and words that a careless or hostile deck may have in place of an entry.
const HOSTILE: [&str; 14] = [
    "",
    "nan",
    "inf",
    "1e308",
    "-1e308",
    "1e-320",
    "-1",
    "0",
    "2147483647",
    "-2147483648",
    "99999999999",
    "ALL",
    "\"",
    "1.D",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn truncated_and_shuffled_decks_are_read_or_refused(
        which in 0..DECKS.len(), from in 0.0..1.0_f64, length in 0.0..1.0_f64, line in any::<prop::sample::Index>(),
    ) {
        let text = text(DECKS[which]);
        let mut lines: Vec<&str> = text.lines().collect();
        let moved = lines.remove(line.index(lines.len()));
        let start = (from * lines.len() as f64) as usize;
        let end = start + (length * (lines.len() - start) as f64) as usize;
        lines.drain(start..end);
        lines.insert(start, moved);
        let mut damaged = lines.join("\n");
        damaged.truncate(damaged.len() - damaged.len() / 100);
        let _ = read("a.inp", damaged.into(), &mut |_| Err(String::new()));
    }

    #[test]
    fn hostile_entries_are_read_or_refused(
        which in 0..DECKS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..HOSTILE.len()), 1..4),
    ) {
        let text = text(DECKS[which]);
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (line, field, hostile) in changes {
            // Half of the damage goes to the short part behind the mesh.
            let count = lines.len();
            let line = if hostile % 2 == 0 { count - 1 - line.index(count.min(80)) } else { line.index(count) };
            let mut fields: Vec<&str> = lines[line].split(',').collect();
            let at = field.index(fields.len());
            fields[at] = HOSTILE[hostile];
            lines[line] = fields.join(",");
        }
        if let Ok(deck) = read("a.inp", lines.join("\n").into(), &mut |_| Err(String::new())) {
            prop_assert!(deck.problem.mesh.nodes.iter().flatten().all(|x| x.is_finite()));
            let curves = deck.problem.loads.iter().map(|load| match load {
                Load::Force { curve, .. } | Load::Pressure { curve, .. } | Load::Traction { curve, .. } | Load::Gravity { curve, .. } => curve,
            });
            let motions = deck.problem.supports.iter().filter_map(|support| Some(&support.motion.as_ref()?.curve));
            for curve in curves.chain(motions) {
                prop_assert!(curve.corners().all(|at| at.0.is_finite() && curve.at(at).is_finite()));
            }
            prop_assert!(deck.schedule.times.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(deck.schedule.times.iter().all(|time| time.is_finite() && *time > 0.0));
        }
    }
}
