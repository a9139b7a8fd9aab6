//! Materials, sections.

use crate::support::{CUBES, MATERIAL, NODES, STEP, deck, errors, notes};
use pneuflex_deck::{Extent, read_extent};
use pneuflex_model::{Invariant, Law, Volumetric};

fn with(material: &str) -> String {
    format!("{NODES}{CUBES}*MATERIAL, NAME=A\n{material}*SOLID SECTION, ELSET=BODY, MATERIAL=a\n{STEP}")
}

#[test]
fn hyperelastic_constants_arrive() {
    let material = deck(&with("*HYPERELASTIC, YEOH\n0.2, 0.02, -0.001, 0.01, 0., 0.\n")).problem.material;
    assert_eq!((material.law, material.bulk_modulus), (Law::Yeoh { c10: 0.2, c20: 0.02, c30: -0.001 }, 200.0));
    assert_eq!((material.invariant, material.volumetric), (Invariant::Isochoric, Volumetric::Quadratic));
}

#[test]
fn linear_elasticity_keeps_its_moduli_at_rest() {
    let text = with("*DENSITY\n1.07E-9\n*ELASTIC\n3., 0.25\n");
    let material = deck(&text).problem.material;
    // G = E / 2(1+ν) = 2 C10, κ = E / 3(1−2ν).
    assert_eq!((material.law, material.bulk_modulus), (Law::NeoHooke { c10: 0.6 }, 2.0));
    assert!((material.density - 1.07).abs() < 1e-12);
    assert!(notes(&text)[1].starts_with("a.inp:28: *ELASTIC is solved as"), "{:?}", notes(&text));
}

#[test]
fn incompressible_materials_become_nearly_so() {
    let text = with("*HYPERELASTIC, NEO HOOKE\n0.2, 0.\n");
    assert!((deck(&text).problem.material.bulk_modulus - 400.0).abs() < 1e-12);
    assert!(notes(&text).iter().any(|note| note.contains("D1 is 0 or left out")));
    let text = with("*HYPERELASTIC, YEOH\n0.2, 0.02, 0., 0.01, 0.5, 0.\n");
    assert!(notes(&text).iter().any(|note| note.contains("only D1 is used")));
}

#[test]
fn sections_give_elements_their_materials() {
    let text = format!(
        "{NODES}{CUBES}*MATERIAL, NAME=Soft\n*HYPERELASTIC, NEO HOOKE\n0.1, 0.1\n*MATERIAL, NAME=HARD\n*DENSITY\n2e-9\n\
         *ELASTIC\n10., 0.3\n*SOLID SECTION, ELSET=RIGHT, MATERIAL=HARD\n1.\n*SOLID SECTION, ELSET=LEFT, MATERIAL=SOFT\n{STEP}"
    );
    let problem = deck(&text).problem;
    let (materials, of_element) = problem.materials();
    let c10 = |element: usize| match materials[usize::from(of_element[element])].law {
        Law::NeoHooke { c10 } => c10,
        _ => panic!(),
    };
    assert!((c10(0) - 0.1).abs() < 1e-15 && (c10(1) - 10.0 / 5.2).abs() < 1e-15);
    assert_eq!((problem.regions[0].name.as_str(), &problem.regions[0].elements), ("Soft", &vec![0]));
}

#[test]
fn what_cannot_be_is_told_by_line() {
    let wrong = |material: &str| errors(&with(material));
    let two =
        "a.inp:28: *HYPERELASTIC takes 2 constants for one temperature; constants by temperature are not supported";
    assert_eq!(wrong("*HYPERELASTIC, NEO HOOKE\n0.2, 0.01, 20.\n0.3, 0.01, 40.\n")[0], two.replace("28", "27"));
    assert!(wrong("*HYPERELASTIC, OGDEN, N=4\n1.\n")[0].contains("N=4 is not supported, only 1 to 3"));
    assert!(wrong("*HYPERELASTIC, ARRUDA-BOYCE\n1.\n")[0].contains("parameter \"ARRUDA-BOYCE\" is not supported"));
    assert!(wrong("*HYPERELASTIC, YEOH, OGDEN\n1.\n")[0].contains("has two laws"));
    assert!(wrong("*HYPERELASTIC, NEO HOOKE\n-0.2, 0.01\n")[0].contains("shear modulus at rest is -0.4"));
    assert!(wrong("*HYPERELASTIC, NEO HOOKE\n0.2, -1.\n")[0].contains("D1 = -1 must not be negative"));
    assert!(wrong("*HYPERELASTIC, NEO HOOKE\n")[0].contains("has no constants"));
    assert!(wrong("*ELASTIC\n3., 0.5\n")[0].contains("Poisson's ratio from -1 to less than 0.5"));
    assert!(wrong("*ELASTIC, TYPE=ORTHO\n3., 0.3\n")[0].contains("TYPE=\"ORTHO\" is not supported"));
    assert!(wrong("*DENSITY\n-1.\n*ELASTIC\n3., 0.3\n")[0].contains("greater than 0"));
    assert_eq!(wrong("*DENSITY\n1.\n"), ["a.inp:25: material \"A\" has no *HYPERELASTIC and no *ELASTIC"]);
    assert!(wrong("*ELASTIC\n3., 0.3\n*ELASTIC\n3., 0.3\n")[0].contains("material \"A\" has two laws"));
    assert!(wrong("*PLASTIC\n3.\n*ELASTIC\n3., 0.3\n")[0].contains("*PLASTIC is not supported: only static"));
    let deck = format!("{NODES}{CUBES}{MATERIAL}{STEP}");
    assert_eq!(
        errors(&deck.replace("*MATERIAL", "*ELSET, ELSET=X\n*MATERIAL").replace("NAME=RUBBER", "NAME=RUBER")),
        ["a.inp:29: there is no material \"RUBBER\"; did you mean RUBER?"]
    );
    assert_eq!(
        errors(&deck.replace("ELSET=BODY, MATERIAL", "ELSET=LEFT, MATERIAL")),
        ["a.inp:16: element 20 has no *SOLID SECTION"]
    );
    let twice = deck.replace("*STEP", "*SOLID SECTION, ELSET=LEFT, MATERIAL=RUBBER\n*STEP");
    assert_eq!(errors(&twice), ["a.inp:29: element 10 has a section already, in line 28"]);
    assert_eq!(
        errors(&deck.replace("*MATERIAL, NAME=RUBBER\n", ""))[0],
        "a.inp:25: *HYPERELASTIC must follow a *MATERIAL"
    );
}

/// A model file may bring materials and times: then a mesh is enough, but a deck with sections must have them all.
#[test]
fn a_mesh_alone_is_a_body() {
    let read = |text: String, extent| read_extent("a.inp", text.into(), &mut |_| Err(String::new()), extent);
    let mesh = format!("{NODES}{CUBES}");
    let said = read(mesh.clone(), Extent::Problem).unwrap_err();
    assert!(said.iter().any(|error| error.text.contains("no *STEP")), "{said:?}");
    let body = read(mesh.clone(), Extent::Body).unwrap();
    assert_eq!((body.problem.mesh.num_elements(), body.problem.regions.len()), (2, 0));
    assert!(body.schedule.times.is_empty());
    let half = MATERIAL.replace("ELSET=BODY", "ELSET=LEFT");
    assert!(
        read(format!("{mesh}{half}"), Extent::Body).unwrap_err()[0].text.contains("element 20 has no *SOLID SECTION")
    );
}
