//! `*FLUID CAVITY`: what fills it, and its pressure by direction 8 of its reference node.

use pneuflex_model::load::{Control, Gas};
use pneuflex_model::{Curve, LoadParameter};

use crate::support::{cubes, deck, errors, notes};

const SURFACE: &str = "*SURFACE, NAME=TOP\nRIGHT, S2\n*NODE, NSET=RP\n99, 0., 0., 0.\n";
const LIQUID: &str = "*FLUID BEHAVIOR, NAME=WATER\n*FLUID DENSITY\n1.E-9\n*FLUID BULK MODULUS\n2000.\n";
const AIR: &str = "*FLUID BEHAVIOR, NAME=AIR\n*MOLECULAR WEIGHT\n28.9\n*CAPACITY, TYPE=POLYNOMIAL\n29.\n";

fn with(fluid: &str, cavity: &str, step: &str) -> String {
    cubes(&format!("{SURFACE}{fluid}*FLUID CAVITY, NAME=INSIDE, SURFACE=TOP, REF NODE={cavity}\n"), step)
}

fn control(text: &str) -> Control {
    let deck = deck(text);
    let [cavity] = &deck.problem.cavities[..] else { panic!("{:?}", deck.problem.cavities) };
    assert_eq!((cavity.name.as_str(), &cavity.facets), ("INSIDE", &deck.problem.mesh.facet_set("TOP").to_vec()));
    // The reference node is no node of the body.
    assert_eq!(deck.problem.mesh.num_nodes(), 12);
    cavity.control.clone()
}

#[test]
fn pressures_are_prescribed_at_reference_nodes() {
    for (name, target) in [("99", "99"), ("RP", "99"), ("99", "RP")] {
        let step = format!("*BOUNDARY\n{target}, 8, 8, 0.05\n");
        let Control::Pressure(curve) = control(&with(LIQUID, &format!("{name}, BEHAVIOR=WATER"), &step)) else {
            panic!("no pressure")
        };
        assert_eq!([0.0, 0.5, 1.0].map(|t| curve.at(LoadParameter(t))), [0.0, 0.025, 0.05]);
    }
}

#[test]
fn closed_cavities_keep_their_liquid_or_their_gas() {
    let water = with(LIQUID, "RP, BEHAVIOR=water", "");
    assert_eq!(control(&water), Control::Volume(Curve::ZERO));
    let said = notes(&water);
    assert!(said.iter().any(|note| note.contains("*FLUID BULK MODULUS is left out")), "{said:?}");
    assert!(said.iter().any(|note| note.contains("its volume stays what it is")), "{said:?}");
    let gas = Gas { atmosphere: 0.1, exponent: 1.0, amount: Curve::constant(1.0) };
    assert_eq!(control(&with(AIR, "RP, BEHAVIOR=AIR, AMBIENT PRESSURE=0.1", "")), Control::Gas(gas));
}

#[test]
fn what_is_not_understood_is_refused() {
    let cases = [
        (with(AIR, "RP, BEHAVIOR=AIR", ""), "needs AMBIENT PRESSURE"),
        (
            with(AIR, "RP, BEHAVIOR=AIRE, AMBIENT PRESSURE=0.1", ""),
            "there is no *FLUID BEHAVIOR \"AIRE\"; did you mean AIR?",
        ),
        (
            with("*FLUID BEHAVIOR, NAME=AIR\n", "RP, BEHAVIOR=AIR", ""),
            "needs *FLUID DENSITY (a liquid) or *MOLECULAR WEIGHT (a gas)",
        ),
        (with(LIQUID, "RP, BEHAVIOR=WATER", "*BOUNDARY\n98, 8, 8, 0.05\n"), "is the reference node of none"),
        (
            with(LIQUID, "RP, BEHAVIOR=WATER", "*BOUNDARY\nRP, 8, 9, 0.05\n"),
            "takes a reference node, 8, 8 and a pressure",
        ),
        (
            with(LIQUID, "RP, BEHAVIOR=WATER", "*FLUID FLUX\nRP, 1.\n"),
            "*FLUID FLUX is not supported: prescribe the pressure",
        ),
        (
            with(LIQUID, "RP, BEHAVIOR=WATER", "*BOUNDARY\nRP, 8, 8, 0.05\n*BOUNDARY\nRP, 8, 8, 0.06\n"),
            "prescribed once a step",
        ),
        (
            with(LIQUID, "RP, BEHAVIOR=WATER", "*END STEP\n*STEP, NLGEOM\n*STATIC\n*BOUNDARY\nRP, 8, 8, 0.05\n"),
            "from the first one on",
        ),
        (
            with(
                LIQUID,
                "RP, BEHAVIOR=WATER",
                "*BOUNDARY\nRP, 8, 8, 0.05\n*END STEP\n*STEP, NLGEOM\n*STATIC\n*BOUNDARY, OP=NEW\nCLAMP, 1, 3\n",
            ),
            "lets go of the pressure of cavity INSIDE",
        ),
        (
            with("", "RP, BEHAVIOR=WATER", "").replace("*FLUID CAVITY", "*FLUID DENSITY\n1.\n*FLUID CAVITY"),
            "must follow a *FLUID BEHAVIOR",
        ),
    ];
    for (text, expected) in cases {
        let found = errors(&text);
        assert!(found.iter().any(|error| error.contains(expected)), "{expected}: {found:?}");
    }
}
