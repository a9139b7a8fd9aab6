//! Advice is tried: for every remedy of every occasion (`pneuflex::advice`) there is an input that gets the advice, and the same input changed
//! as the advice says, by the letter, which comes further, or to its end, or no longer gets the warning.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use pneuflex::advice::{Occasion, Remedy};
use pneuflex::mesh::lattice::Lattice;
use pneuflex::model::{Formulation, Problem};
use pneuflex::vocabulary::Vocabulary;
use pneuflex::{Change, Error, Solution, Study, template};

use crate::Effort;
use crate::relations::draw::Body;
use crate::relations::form::recorded;

/// Keys and values.
type Changes = &'static [(&'static str, &'static str)];

/// A block from the origin, fixed and loaded by the tables of a model file. Its sides are `x0`, `x1` and so on, `middle` is the line across the
/// middle of the upper side, `tip` the corner furthest away.
#[derive(Clone, Copy)]
struct Block {
    element: Formulation,
    size: [f64; 3],
    cells: [usize; 3],
    tables: &'static str,
}

/// An input.
#[derive(Clone, Copy)]
enum Input {
    /// The two chambers of `pneuflex new`.
    TwoChambers,
    /// A file below `fixtures`.
    File(&'static str),
    /// The same with parts of its text, and of the files beside it, replaced.
    Edited(&'static str, Changes),
    /// A model file around a block.
    Block(Block),
    /// A model file with an actuator.
    Actuator(&'static str),
}

use Input::{Actuator, Edited, File, TwoChambers};

/// How a remedy helps.
#[derive(Clone, Copy)]
enum Helps {
    /// The end is reached.
    ToTheEnd,
    /// It ends further on, by more than this share.
    Further(f64),
    /// It ends further on, by more than this share, for this reason.
    To(Occasion, f64),
    /// The warning is gone.
    Gone,
    /// The results are right, which they were not.
    Right(fn(&Solution) -> bool),
}

use Helps::{Further, Gone, Right, To, ToTheEnd};

/// An input that gets advice, and what follows from it.
struct Row {
    occasion: Occasion,
    remedy: Remedy,
    before: (Input, Changes),
    after: (Input, Changes),
    helps: Helps,
}

const fn row(
    occasion: Occasion,
    remedy: Remedy,
    before: (Input, Changes),
    after: (Input, Changes),
    helps: Helps,
) -> Row {
    Row { occasion, remedy, before, after, helps }
}

/// What takes long.
const SLOW: [Occasion; 6] = [
    Occasion::InvertedElement,
    Occasion::Overlap,
    Occasion::Unmeasured,
    Occasion::GreatestPressure,
    Occasion::Jumped,
    Occasion::LinearElements,
];

/// What cannot be tried here, and where it is.
const ELSEWHERE: [(Occasion, Remedy, &str); 3] = [
    (Occasion::OutOfMemory, Remedy::Memory, "it takes a machine's memory"),
    (Occasion::CoarseMesh, Remedy::ErrorBars, "the command is tried by the tests of the command line (converge)"),
    (Occasion::Unmeasured, Remedy::ErrorBars, "the command is tried by the tests of the command line (converge)"),
];

const fn block(element: Formulation, size: [f64; 3], cells: [usize; 3], tables: &'static str) -> Input {
    Input::Block(Block { element, size, cells, tables })
}

const RUBBER: &str = "[material]\nlaw = \"neo-hooke\"\nc10 = 0.1\nbulk_modulus = 50.0\ninvariant = \"isochoric\"\n[load]\ntimes = [1.0]\n";

/// A bar on its foot, pulled by a force.
const PULLED: &str = "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[force]]\nnodes = \"z1\"\ntotal = [0, 0, 0.5]\n";

/// A strut that is pushed along its axis.
const PUSHED: &str = "[[support]]\nnodes = \"x0\"\naxes = \"xyz\"\n[[force]]\nnodes = \"x1\"\ntotal = [-0.01, 0, 0]\n";

/// Beyond a limit point, for a few states.
const PAST: Changes = &[("solver.continuation", "arc-length"), ("solver.states_past_limit", "4")];

const fn pulled(element: Formulation, cells: [usize; 3]) -> Input {
    block(element, [1.0, 1.0, 2.0], cells, PULLED)
}

const STRUT: Input = block(Formulation::Hex20, [20.0, 2.0, 1.0], [8, 1, 1], PUSHED);

/// A third more than Euler's load; the same with leave to buckle, and less.
const STRAIGHT: Changes = &[MORE, ("solver.max_step", "0.2")];
const BUCKLES: Changes = &[MORE, ("solver.max_step", "0.2"), ("solver.imperfection", "0.1")];
const LESS: Changes = &[("force", "[{ nodes = \"x1\", total = [-0.0005, 0, 0] }]"), ("solver.imperfection", "0.1")];
const SNAPS: Changes = &[MORE, ("solver.max_step", "0.2"), ("solver.continuation", "damped")];
const RESTS: Changes = &[LESS[0], ("solver.continuation", "damped")];
/// A balloon that stiffens so much that it has another branch beyond its greatest pressure.
const STIFFENS: (&str, &str) = ("material", "{ law = \"yeoh\", c10 = 0.1, c20 = 0.0, c30 = 3e-4 }");
const JUMPS: Changes = &[STIFFENS, ("load.times", "[0.55, 0.62, 1.0]")];
const IS_HELD_BACK: Changes = &[JUMPS[0], JUMPS[1], ("solver.continuation", "damped")];
const MORE: (&str, &str) = ("force", "[{ nodes = \"x1\", total = [-0.0008, 0, 0] }]");

/// A flat membrane with clamped edges, blown up.
const fn membrane(thickness: f64) -> Input {
    block(
        Formulation::Hex27,
        [4.0, 4.0, thickness],
        [4, 4, 1],
        "[[support]]\nnodes = \"x0\"\naxes = \"xyz\"\n[[support]]\nnodes = \"x1\"\naxes = \"xyz\"\n[[support]]\nnodes = \"y0\"\naxes = \"xyz\"\n\
         [[support]]\nnodes = \"y1\"\naxes = \"xyz\"\n[[pressure]]\nfaces = \"z0\"\npressure_kpa = 100\n",
    )
}

/// A cantilever above a ball, which stands beside its middle.
macro_rules! over_ball {
    ($stiffness:literal, $force:literal) => {
        concat!(
            "[[support]]\nnodes = \"x0\"\naxes = \"xyz\"\n[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\nfaces = \"z0\"\n",
            "centre = [9.0, 0.5, -1.2]\nradius = 1.0\nstiffness = ",
            $stiffness,
            "\n",
            $force
        )
    };
}

const fn cantilever(cells: [usize; 3], tables: &'static str) -> Input {
    block(Formulation::Hex20, [10.0, 2.0, 1.0], cells, tables)
}

const COARSE: [usize; 3] = [5, 1, 1];

/// All sides of a cube but one are pulled.
const SWOLLEN: &str = "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[pressure]]\nfaces = \"z1\"\npressure_kpa = -800\n[[pressure]]\nfaces = \"x0\"\n\
    pressure_kpa = -800\n[[pressure]]\nfaces = \"x1\"\npressure_kpa = -800\n[[pressure]]\nfaces = \"y0\"\npressure_kpa = -800\n[[pressure]]\n\
    faces = \"y1\"\npressure_kpa = -800\n";

const fn swollen(element: Formulation, n: usize) -> Input {
    block(element, [1.0, 1.0, 1.0], [n, n, n], SWOLLEN)
}

const FULL: (&str, &str) = ("material.invariant", "full");
const STIFF_VOLUME: (&str, &str) = ("material.bulk_modulus", "500");

/// A flat disc between two plates that are pulled apart.
const CHIP: Input = block(
    Formulation::Hex8Q1p0,
    [4.0, 4.0, 0.5],
    [4, 4, 2],
    "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[support]]\nnodes = \"z1\"\naxes = \"xy\"\n[[force]]\nnodes = \"z1\"\ntotal = [0, 0, 40]\n",
);

/// Two chambers that hardly change their volume: rounding leaves much.
const STIFF: [(&str, &str); 3] =
    [("mesh.size", "4.5"), ("material.bulk_modulus", "1000000"), ("material.invariant", "isochoric")];

/// Two chambers on a mesh that is solved in a second.
const QUICK: [(&str, &str); 2] = [("mesh.size", "2"), ("mesh.element", "hex8-q1p0")];

/// A finer one, and a pressure at which walls touch.
const MILLIMETRE: (&str, &str) = ("mesh.size", "1");
const TOUCHING: (&str, &str) = ("load.pressure_kpa", "[35]");

/// Half of the depth that is warned of.
const TOLERANCE: (&str, &str) = ("contact.penetration_tolerance", "0.005");

/// A fifth of it.
const TIGHT: (&str, &str) = ("contact.penetration_tolerance", "0.002");

/// A material whose constants were fitted to small stretches alone.
const WEAK: Changes = &[WEAK_MATERIAL];
const WEAK_MATERIAL: (&str, &str) =
    ("material", "{ law = \"yeoh\", c10 = 0.1, c20 = -0.02, invariant = \"isochoric\", bulk_modulus = 50.0 }");

/// A body on a table, held sideways, that its load presses down.
macro_rules! on_table {
    ($height:literal, $more:literal) => {
        concat!(
            "[[support]]\nnodes = \"x0\"\naxes = \"x\"\n[[support]]\nnodes = \"y0\"\naxes = \"y\"\n[[obstacle]]\nname = \"table\"\n",
            "shape = \"plane\"\nnormal = [0, 0, 1]\nfaces = \"z0\"\npoint = [0, 0, ",
            $height,
            "]\n[[force]]\nnodes = \"z1\"\ntotal = [0, 0, -0.02]\n",
            $more
        )
    };
}

const fn cube(tables: &'static str) -> Input {
    block(Formulation::Hex20, [2.0, 2.0, 2.0], [1, 1, 1], tables)
}

/// A cube on its foot.
const FOOT: &str = "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n";

/// A cantilever that a table lifts by 0.4 mm at its end.
macro_rules! lifted {
    ($normal:literal) => {
        concat!(
            "[[support]]\nnodes = \"x0\"\naxes = \"xyz\"\n[[obstacle]]\nname = \"table\"\nshape = \"plane\"\nfaces = \"z0\"\n",
            "point = [10, 0, -0.1]\ndisplacement = [0, 0, 0.5]\nnormal = ",
            $normal,
            "\n"
        )
    };
}

/// A cube on its foot with equations for the motion of its tip.
macro_rules! with_tip {
    ($more:literal) => {
        concat!(
            "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[equation]]\nterms = [[\"tip\", \"z\", 1.0]]\nvalue = 0.1\n",
            $more
        )
    };
}

fn rows() -> Vec<Row> {
    use Occasion as O;
    use Remedy as R;
    let strut = (STRUT, &[] as Changes);
    let pushed = (PUSHED_CUBE, WEAK);
    let quick: Changes = &QUICK;
    let settles = |stiffness| (cantilever(COARSE, stiffness), &[] as Changes);
    let slips: (Input, Changes) = settles(over_ball!("0.02", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.01]\n"));
    let drops = settles(over_ball!("10000.0", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.3]\n"));
    let soft_ball = over_ball!("0.005", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.3]\n");
    let unclear = settles(soft_ball);
    let one_step: Changes = &[("solver.first_step", "1"), ("solver.max_step", "1"), ("solver.min_step", "1")];
    let small_steps: Changes =
        &[("solver.first_step", "0.0005"), ("solver.max_step", "0.001"), ("solver.min_step", "0.00000001")];
    let small_first: Changes =
        &[("solver.first_step", "0.01"), ("solver.max_step", "0.05"), ("solver.min_step", "0.0001")];
    let chip = (CHIP, &[STIFF_VOLUME, FULL] as Changes);
    let cube_of_sri = (swollen(Formulation::Hex8Sri, 3), &[STIFF_VOLUME, FULL] as Changes);
    let tet: Changes = &[("mesh", "{ element = \"tet10\", size = 8.0 }"), ("load.pressure_kpa", "[28.0]")];
    let inverted = "stops/tet10_inverted_landing.toml";
    vec![
        row(
            O::BadEquations,
            R::Equations,
            (cube(with_tip!("[[equation]]\nterms = [[\"tip\", \"z\", 2.0]]\nvalue = 0.3\n")), &[]),
            (cube(with_tip!("")), &[]),
            ToTheEnd,
        ),
        row(
            O::NoStiffnessLeft,
            R::SmallerLoad,
            pushed,
            (PUSHED_CUBE, &[WEAK_MATERIAL, ("force", "[{ nodes = \"z1\", total = [0.05, 0, 0] }]")]),
            ToTheEnd,
        ),
        row(
            O::NoStiffnessLeft,
            R::ThickerWalls,
            pushed,
            (block(Formulation::Hex8Q1p0, [1.5, 1.5, 1.0], [4, 4, 4], PUSHED_SIDEWAYS), WEAK),
            Further(0.5),
        ),
        row(O::NoStiffnessLeft, R::FittedConstants, pushed, (PUSHED_CUBE, &[]), Further(0.5)),
        row(
            O::NotHeld,
            R::Hold,
            (cube(on_table!("-10000.0", "")), &[]),
            (cube(on_table!("-10000.0", "[[support]]\nnodes = \"x1\"\naxes = \"xyz\"\n")), &[]),
            ToTheEnd,
        ),
        row(
            O::NotHeld,
            R::TouchAtRest,
            (cube(on_table!("-10000.0", "")), &[]),
            (cube(on_table!("0", "")), &[]),
            ToTheEnd,
        ),
        row(
            O::Buckling,
            R::SmallerLoad,
            strut,
            (STRUT, &[("force", "[{ nodes = \"x1\", total = [-0.0006, 0, 0] }]")]),
            ToTheEnd,
        ),
        row(
            O::Buckling,
            R::Stockier,
            strut,
            (block(Formulation::Hex20, [20.0, 2.0, 1.5], [8, 1, 1], PUSHED), &[]),
            Further(1.0),
        ),
        row(O::Buckling, R::Imperfection, (STRUT, STRAIGHT), (STRUT, BUCKLES), ToTheEnd),
        row(O::Buckling, R::LetSnap, (STRUT, STRAIGHT), (STRUT, SNAPS), ToTheEnd),
        row(
            O::Buckled,
            R::Stockier,
            (STRUT, BUCKLES),
            (block(Formulation::Hex20, [20.0, 2.0, 1.5], [8, 1, 1], PUSHED), BUCKLES),
            Gone,
        ),
        row(O::Buckled, R::SmallerLoad, (STRUT, BUCKLES), (STRUT, LESS), Gone),
        row(O::Snapped, R::SmallerLoad, (STRUT, SNAPS), (STRUT, RESTS), Gone),
        row(O::FirstStep, R::SmallerSteps, (STRUT, one_step), (STRUT, small_first), To(O::Buckling, 0.0)),
        row(
            O::ElementMotion,
            R::BetterElements,
            (pulled(Formulation::Hex8Q1p0, [1, 1, 1]), &[]),
            (pulled(Formulation::Hex27, [1, 1, 1]), &[]),
            Further(0.3),
        ),
        row(
            O::ElementMotion,
            R::FinerMesh,
            (pulled(Formulation::Hex8Q1p0, [1, 1, 1]), &[]),
            (pulled(Formulation::Hex8Q1p0, [3, 3, 3]), &[]),
            Further(0.5),
        ),
        row(
            O::VolumetricMotion,
            R::Isochoric,
            chip,
            (CHIP, &[STIFF_VOLUME, ("material.invariant", "isochoric")]),
            Further(0.5),
        ),
        row(
            O::VolumetricMotion,
            R::BetterElements,
            cube_of_sri,
            (swollen(Formulation::Hex27, 1), &[STIFF_VOLUME, FULL]),
            ToTheEnd,
        ),
        row(
            O::VolumetricMotion,
            R::FinerMesh,
            cube_of_sri,
            (swollen(Formulation::Hex8Sri, 6), &[STIFF_VOLUME, FULL]),
            Further(0.1),
        ),
        row(
            O::GreatestPressure,
            R::SmallerLoad,
            (membrane(0.2), &[]),
            (membrane(0.2), &[("pressure", "[{ faces = \"z0\", pressure_kpa = 35 }]")]),
            ToTheEnd,
        ),
        row(O::GreatestPressure, R::ThickerWalls, (membrane(0.2), &[]), (membrane(0.3), &[]), Further(0.3)),
        row(
            O::Rounding,
            R::ResidualTolerance,
            (TwoChambers, &[STIFF[0], STIFF[1], STIFF[2], QUICK[1], ("solver.residual_tolerance", "1e-13")]),
            (TwoChambers, &[STIFF[0], STIFF[1], STIFF[2], QUICK[1], ("solver.residual_tolerance", "1e-8")]),
            ToTheEnd,
        ),
        row(
            O::GreatestPressure,
            R::PumpVolume,
            (File("stops/balloon_pressure.toml"), &[]),
            (Edited("stops/balloon_pressure.toml", &[("pressure_kpa=20", "volume_mm3=1500")]), &[]),
            ToTheEnd,
        ),
        row(
            O::Jumped,
            R::LetSnap,
            (File("stops/balloon_pressure.toml"), JUMPS),
            (File("stops/balloon_pressure.toml"), IS_HELD_BACK),
            Gone,
        ),
        row(
            O::GreatestPressure,
            R::ArcLength,
            (File("stops/balloon_pressure.toml"), &[]),
            (File("stops/balloon_pressure.toml"), PAST),
            ToTheEnd,
        ),
        row(
            O::PastLimit,
            R::SmallerLoad,
            (File("stops/balloon_pressure.toml"), PAST),
            (Edited("stops/balloon_pressure.toml", &[("pressure_kpa=20", "pressure_kpa=11")]), PAST),
            Gone,
        ),
        row(O::GreatestForce, R::ArcLength, slips, (slips.0, PAST), ToTheEnd),
        row(O::GreatestForce, R::LetSnap, slips, (slips.0, &[("solver.continuation", "damped")]), ToTheEnd),
        row(
            O::GreatestForce,
            R::SmallerLoad,
            slips,
            (slips.0, &[("force", "[{ nodes = \"x1\", total = [0, 0, -0.002] }]")]),
            ToTheEnd,
        ),
        row(
            O::GreatestForce,
            R::ThickerWalls,
            slips,
            (
                block(
                    Formulation::Hex20,
                    [10.0, 2.0, 2.0],
                    COARSE,
                    over_ball!("0.02", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.01]\n"),
                ),
                &[],
            ),
            Further(0.5),
        ),
        row(
            O::GreatestForce,
            R::PrescribeMotion,
            slips,
            settles(over_ball!("0.02", "[[support]]\nnodes = \"x1\"\naxes = \"z\"\ndisplacement = [0, 0, -4]\n")),
            ToTheEnd,
        ),
        row(O::PassedThrough, R::SmallerSteps, (unclear.0, one_step), (unclear.0, small_steps), ToTheEnd),
        row(
            O::PassedThrough,
            R::OtherStiffness,
            drops,
            settles(over_ball!("5000.0", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.3]\n")),
            Further(0.3),
        ),
        row(
            O::UnsettledContact,
            R::OtherStiffness,
            settles(over_ball!("1.0", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.01]\n")),
            settles(over_ball!("0.5", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.01]\n")),
            ToTheEnd,
        ),
        row(
            O::UnsettledContact,
            R::OtherStiffness,
            settles(over_ball!("1.0", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.01]\n")),
            settles(over_ball!("2.0", "[[force]]\nnodes = \"x1\"\ntotal = [0, 0, -0.01]\n")),
            ToTheEnd,
        ),
        row(
            O::InvertedElement,
            R::BetterElements,
            (File(inverted), tet),
            (File(inverted), &[("mesh", "{ element = \"hex27\", size = 8.0 }"), ("load.pressure_kpa", "[28.0]")]),
            ToTheEnd,
        ),
        row(
            O::InvertedElement,
            R::SmallerLoad,
            (File(inverted), tet),
            (File(inverted), &[("mesh", "{ element = \"tet10\", size = 8.0 }"), ("load.pressure_kpa", "[27.0]")]),
            ToTheEnd,
        ),
        row(O::Unclear, R::SmallerSteps, unclear, (unclear.0, small_steps), ToTheEnd),
        row(O::Unclear, R::FinerMesh, unclear, (cantilever([10, 2, 2], soft_ball), &[]), ToTheEnd),
        row(
            O::Free,
            R::Hold,
            (File("stops/nothing_holds.inp"), &[]),
            (Edited("stops/nothing_holds.inp", &[("*STEP", "*BOUNDARY\nFOOT, 1, 3\n*STEP")]), &[]),
            ToTheEnd,
        ),
        row(O::Free, R::Hold, (cube(""), &[]), (cube(FOOT), &[]), ToTheEnd),
        row(O::BeyondConstants, R::FittedConstants, (SHEARED, WEAK), (SHEARED, &[]), Gone),
        row(
            O::UnstableElements,
            R::BetterElements,
            (drawn(Formulation::Hex8Q1p0, 2, DRAWN_LESS), &[]),
            (drawn(Formulation::Hex27, 2, DRAWN_LESS), &[]),
            Gone,
        ),
        row(
            O::UnstableElements,
            R::FinerMesh,
            (drawn(Formulation::Hex8Q1p0, 1, DRAWN), &[]),
            (drawn(Formulation::Hex8Q1p0, 5, DRAWN), &[]),
            Gone,
        ),
        row(
            O::DeepObstacle,
            R::StifferObstacle,
            (
                cube(on_table!("0", "")),
                &[(
                    "obstacle",
                    "[{ name = \"table\", shape = \"plane\", normal = [0, 0, 1], faces = \"z0\", point = [0, 0, 0], stiffness = 0.1 }]",
                )],
            ),
            (
                cube(on_table!("0", "")),
                &[(
                    "obstacle",
                    "[{ name = \"table\", shape = \"plane\", normal = [0, 0, 1], faces = \"z0\", point = [0, 0, 0], stiffness = 10.0 }]",
                )],
            ),
            Gone,
        ),
        row(
            O::HeldInObstacle,
            R::ClearOfSupports,
            (cantilever(COARSE, lifted!("[0, 0, 1]")), &[]),
            (cantilever(COARSE, lifted!("[-0.1, 0, 1]")), &[]),
            Gone,
        ),
        row(
            O::DeepContact,
            R::StifferContact,
            (TwoChambers, &[MILLIMETRE, QUICK[1], TOUCHING, ("contact.stiffness", "0.5")]),
            (TwoChambers, &[MILLIMETRE, QUICK[1], TOUCHING, ("contact.stiffness", "40")]),
            Gone,
        ),
        row(
            O::DeepContact,
            R::StifferContact,
            (Actuator(""), &[]),
            (Actuator("[[contact]]\nslave = \"gap_1_left\"\nmaster = \"gap_1_right\"\nstiffness = 100\n"), &[]),
            Gone,
        ),
        row(
            O::DeepContact,
            R::PenetrationTolerance,
            (TwoChambers, &[MILLIMETRE, QUICK[1], TOUCHING, ("contact.stiffness", "2")]),
            (TwoChambers, &[MILLIMETRE, QUICK[1], TOUCHING, ("contact.stiffness", "2"), TOLERANCE]),
            Gone,
        ),
        row(
            O::DeepContact,
            R::FinerMesh,
            (TwoChambers, &[QUICK[0], QUICK[1], TOUCHING, ("contact.stiffness", "40")]),
            (TwoChambers, &[MILLIMETRE, QUICK[1], TOUCHING, ("contact.stiffness", "40")]),
            Gone,
        ),
        row(
            O::DeepAverages,
            R::MultiPoint,
            (TwoChambers, &[QUICK[0], QUICK[1], ("contact.method", "mortar"), ("contact.stiffness", "40")]),
            (TwoChambers, &[QUICK[0], QUICK[1], ("contact.method", "multi-point"), ("contact.stiffness", "40")]),
            Gone,
        ),
        row(
            O::UnmetTolerance,
            R::StifferContact,
            (TwoChambers, &[QUICK[0], QUICK[1], ("contact.stiffness", "0.5"), TIGHT]),
            (TwoChambers, &[QUICK[0], QUICK[1], ("contact.stiffness", "4"), TIGHT]),
            Gone,
        ),
        row(
            O::NoContact,
            R::MultiPoint,
            (TwoChambers, &[QUICK[0], QUICK[1], ("contact.method", "single-point")]),
            (TwoChambers, &[QUICK[0], QUICK[1], ("contact.method", "multi-point"), ("contact.stiffness", "40")]),
            Gone,
        ),
        row(O::Overlap, R::SelfContact, (TwoChambers, CURLED), (TwoChambers, CURLED_AND_WATCHED), Gone),
        row(O::LinearElements, R::BetterElements, (TwoChambers, quick), (TwoChambers, &[("mesh.size", "3")]), Gone),
        row(
            O::LinearElements,
            R::FinerMesh,
            (TwoChambers, quick),
            (TwoChambers, &[("mesh.size", "0.5"), QUICK[1], ("load.pressure_kpa", "[0.1]")]),
            Gone,
        ),
        row(
            O::LinearElements,
            R::FinerMesh,
            (block(Formulation::Hex8Q1p0, [4.0, 1.0, 1.0], [4, 1, 1], FOOT), &[]),
            (block(Formulation::Hex8Q1p0, [4.0, 1.0, 1.0], [8, 2, 2], FOOT), &[]),
            Gone,
        ),
        row(
            O::CoarseMesh,
            R::FinerMesh,
            (TwoChambers, &[("mesh.resolution", "draft"), ("load.pressure_kpa", "[1]")]),
            (TwoChambers, &[("mesh.resolution", "standard"), ("load.pressure_kpa", "[1]")]),
            Gone,
        ),
        row(
            O::Unmeasured,
            R::FinerMesh,
            (File("accuracy/draft_wrong_sign.toml"), &[("load.pressure_kpa", "[5.7082]")]),
            (
                File("accuracy/draft_wrong_sign.toml"),
                &[("mesh.resolution", "standard"), ("load.pressure_kpa", "[5.7082]")],
            ),
            Right(|solution| {
                solution.states.iter().all(|state| state.end_face_angle_deg.is_some_and(|angle| angle > 0.0))
            }),
        ),
        row(
            O::PoorShapes,
            R::BetterShapes,
            (
                TwoChambers,
                &[("mesh", "{ element = \"tet10\", size = [9.0, 9.0, 0.4] }"), ("load.pressure_kpa", "[0.1]")],
            ),
            (
                TwoChambers,
                &[("mesh", "{ element = \"hex27\", size = [9.0, 9.0, 0.4] }"), ("load.pressure_kpa", "[0.1]")],
            ),
            Gone,
        ),
        row(O::Twofold, R::WholeBody, (Actuator(BESIDE), &[]), (Actuator(BESIDE), &[("actuator.part", "whole")]), Gone),
        row(
            O::FarProbe,
            R::MoveProbe,
            (TwoChambers, &[QUICK[0], QUICK[1], ("probe", "[{ name = \"tip\", at = [18.0, 0.0, -4.0] }]")]),
            (TwoChambers, &[QUICK[0], QUICK[1], ("probe", "[{ name = \"tip\", at = [18.0, 0.0, 0.0] }]")]),
            Gone,
        ),
        row(
            O::Size,
            R::Lengths,
            (block(Formulation::Hex20, [0.02, 0.02, 0.02], [1, 1, 1], FOOT), &[]),
            (block(Formulation::Hex20, [0.02, 0.02, 0.02], [1, 1, 1], FOOT), &[("model.scale", "1000")]),
            Gone,
        ),
        row(
            O::Modulus,
            R::Moduli,
            (cube(FOOT), &[("material.c10", "200")]),
            (cube(FOOT), &[("material.c10", "0.2")]),
            Gone,
        ),
        row(
            O::Density,
            R::Densities,
            (cube(FOOT), &[("material.density", "1.1e-9")]),
            (cube(FOOT), &[("material.density", "1.1")]),
            Gone,
        ),
        row(
            O::Bulk,
            R::BulkModulus,
            (cube(FOOT), &[("material", "{ c10 = 100.0, bulk_modulus = 400000.0 }")]),
            (cube(FOOT), &[("material", "{ c10 = 100.0, bulk_modulus = 600.0 }")]),
            Gone,
        ),
        row(
            O::Pressure,
            R::Pressures,
            (TwoChambers, &[QUICK[0], QUICK[1], ("load.pressure_kpa", "[0.05]")]),
            (TwoChambers, &[QUICK[0], QUICK[1], ("load.pressure_kpa", "[50]")]),
            Gone,
        ),
        row(
            O::Acceleration,
            R::Accelerations,
            (
                cube("[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[gravity]\nacceleration = [0, 0, -9.81]\n"),
                &[("material.density", "1.1")],
            ),
            (
                cube("[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[gravity]\nacceleration = [0, 0, -9810]\n"),
                &[("material.density", "1.1")],
            ),
            Gone,
        ),
        row(
            O::HardlyMoves,
            R::Moduli,
            (TwoChambers, &[QUICK[0], QUICK[1], ("material.c10", "271.2"), ("material.bulk_modulus", "1000000")]),
            (TwoChambers, quick),
            Gone,
        ),
        row(
            O::HardlyMoves,
            R::Pressures,
            (TwoChambers, &[QUICK[0], QUICK[1], ("load.pressure_kpa", "[0.05]")]),
            (TwoChambers, &[QUICK[0], QUICK[1], ("load.pressure_kpa", "[50]")]),
            Gone,
        ),
    ]
}

/// A cube on its foot whose upper side is pushed sideways.
const PUSHED_CUBE: Input = block(Formulation::Hex8Q1p0, [1.0, 1.0, 1.0], [4, 4, 4], PUSHED_SIDEWAYS);
const PUSHED_SIDEWAYS: &str =
    "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[force]]\nnodes = \"z1\"\ntotal = [0.4, 0, 0]\n";

/// A cube whose upper side is moved sideways, with its ends clamped.
const SHEARED: Input = block(
    Formulation::Hex8Q1p0,
    [1.0, 1.0, 1.0],
    [4, 4, 4],
    "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[support]]\nnodes = \"z1\"\naxes = \"xyz\"\ndisplacement = [0.84, 0, 0]\n",
);

/// A bar of n³ elements that supports draw.
const fn drawn(element: Formulation, n: usize, tables: &'static str) -> Input {
    block(element, [1.0, 1.0, 2.0], [n, n, n], tables)
}

/// To two and a half times its length.
const DRAWN: &str = "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[support]]\nnodes = \"z1\"\naxes = \"z\"\ndisplacement = [0, 0, 3]\n";

/// To less than twice its length.
const DRAWN_LESS: &str = "[[support]]\nnodes = \"z0\"\naxes = \"xyz\"\n[[support]]\nnodes = \"z1\"\naxes = \"z\"\ndisplacement = [0, 0, 1.8]\n";

/// A ball on one side of the plane of symmetry.
const BESIDE: &str = "[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\ncentre = [12.0, 6.0, -3.0]\nradius = 2.0\n";

/// Many chambers that curl through more than a turn.
const CURLED: Changes = &[
    ("mesh.size", "4"),
    QUICK[1],
    ("actuator.chambers", "30"),
    ("actuator.base", "3"),
    ("actuator.channel", "{ half_width = 1.0, bottom = 1.2, top = 1.8 }"),
    ("load.pressure_kpa", "[46]"),
    ("probe", "[]"),
];
const CURLED_AND_WATCHED: Changes =
    &[CURLED[0], CURLED[1], CURLED[2], CURLED[3], CURLED[4], CURLED[5], CURLED[6], ("contact.self_contact", "true")];

/// What came of a row.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The occasion and the remedy.
    pub name: String,
    /// What is wrong, if something is.
    pub verdict: Result<(), String>,
    /// How long it took.
    pub seconds: f64,
}

/// What becomes of an input.
struct Outcome {
    /// What advice is given for, and the advice.
    given: Vec<(Occasion, String)>,
    /// Where it ended.
    reached: f64,
    is_at_end: bool,
    solution: Option<Solution>,
    problem: Option<(Problem, Vocabulary)>,
}

/// Tries all advice, or what takes seconds.
pub fn run(effort: Effort, observe: &(dyn Fn(&Tried) + Sync)) -> Vec<Tried> {
    let rows = rows();
    let tried = |row: &Row| {
        let begin = Instant::now();
        let (name, verdict) = (format!("{:?}: {:?}", row.occasion, row.remedy), row.tried());
        let tried = Tried { name, verdict, seconds: begin.elapsed().as_secs_f64() };
        observe(&tried);
        tried
    };
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if effort == Effort::Quick && SLOW.contains(&row.occasion) {
                        continue;
                    }
                    let tried = tried(row);
                    found.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(tried);
                }
            });
        }
    });
    let mut found: Vec<Tried> = found.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    // A remedy that is given and was not tried may be useless.
    for occasion in Occasion::ALL {
        for &remedy in occasion.remedies() {
            let is_tried = rows.iter().any(|row| (row.occasion, row.remedy) == (occasion, remedy))
                || ELSEWHERE.iter().any(|(o, r, _)| (*o, *r) == (occasion, remedy));
            if !is_tried {
                let verdict = Err("no input shows that it helps".to_owned());
                found.push(Tried { name: format!("{occasion:?}: {remedy:?}"), verdict, seconds: 0.0 });
            }
        }
    }
    found
}

impl Row {
    fn tried(&self) -> Result<(), String> {
        let Self { occasion, remedy, before, after, helps } = self;
        let first = Outcome::of(before)?;
        let is_given = |outcome: &Outcome| outcome.given.iter().any(|(given, _)| given == occasion);
        let Some((_, advice)) = first.given.iter().find(|(given, _)| given == occasion) else {
            return Err(format!("the advice is not given, but {:?} at {}", first.given, first.reached));
        };
        if let Some((problem, vocabulary)) = &first.problem {
            let words = vocabulary.words(*remedy, *occasion, problem).unwrap_or_default();
            if words.is_empty() || !advice.contains(&words) {
                return Err(format!("the advice has not `{words}`: {advice}"));
            }
        }
        let second = Outcome::of(after)?;
        let Outcome { reached, is_at_end, solution, given, .. } = &second;
        let further = |share: f64| *reached > first.reached * (1.0 + share) && *reached > first.reached;
        let is_helped = match helps {
            ToTheEnd => *is_at_end && !first.is_at_end,
            Further(share) => *is_at_end || further(*share),
            To(reason, share) => further(*share) && given.iter().any(|(given, _)| given == reason),
            Gone => *is_at_end && !is_given(&second),
            Right(is_right) => {
                let right = |outcome: &Option<Solution>| outcome.as_ref().is_some_and(is_right);
                right(solution) && !right(&first.solution)
            }
        };
        let found = || format!("it does not help: {} before, {reached} after, with {given:?}", first.reached);
        if is_helped { Ok(()) } else { Err(found()) }
    }
}

impl Outcome {
    fn of((input, changes): &(Input, Changes)) -> Result<Self, String> {
        let study = input.study(changes).map_err(|error| error.to_string())?;
        let analysis = match study.build() {
            Ok(analysis) => analysis,
            // What nothing holds is refused.
            Err(Error::Input(errors))
                if errors
                    .iter()
                    .any(|error| error.to_string().contains("held") || error.to_string().contains("holds")) =>
            {
                let help = errors.iter().filter_map(|error| error.help()).collect();
                let given = vec![(Occasion::Free, help)];
                return Ok(Self { given, reached: 0.0, is_at_end: false, solution: None, problem: None });
            }
            Err(error) => return Err(error.to_string()),
        };
        let problem = Some((analysis.problem.clone(), analysis.vocabulary()));
        let (reached, solution, is_at_end, reason) = match analysis.run().threads(1).solve() {
            Ok(solution) => (f64::INFINITY, solution, true, None),
            Err(Error::NotConverged(ended) | Error::Setup(ended)) => {
                (ended.failure.reached.0, ended.reached, false, ended.reason)
            }
            Err(error) => return Err(error.to_string()),
        };
        let warnings = solution.warnings.iter().map(|warning| (warning.occasion, warning.advice.clone()));
        let given = reason.map(|reason| (reason.occasion, reason.advice)).into_iter().chain(warnings).collect();
        Ok(Self { given, reached, is_at_end, solution: Some(solution), problem })
    }
}

impl Input {
    fn study(&self, changes: Changes) -> Result<Study, Error> {
        let changes: Vec<Change> = changes.iter().map(|(key, value)| Change::new(*key, *value)).collect();
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
        let mut study = match self {
            TwoChambers => Study::from_text("case.toml", &template::two_chambers())?,
            File(name) => return Study::load_with(fixtures.join(name), changes),
            Edited(name, edits) => {
                let folder = fixtures.join(Path::new(name).parent().unwrap_or(Path::new("")));
                let text = std::fs::read_to_string(fixtures.join(name)).unwrap_or_default();
                let text = edits.iter().fold(text, |text, (from, to)| text.replacen(from, to, 1));
                let own = Path::new(name).file_name().unwrap_or_default().to_string_lossy().into_owned();
                let beside = std::fs::read_dir(folder).into_iter().flatten().flatten();
                let beside = beside.filter_map(|entry| {
                    let name = entry.file_name().to_string_lossy().into_owned();
                    std::fs::read(entry.path()).ok().map(|bytes| (name, bytes))
                });
                let files = beside.filter(|(name, _)| *name != own).chain([(own.clone(), text.into_bytes())]);
                Study::from_files(&own, files.collect::<Vec<_>>())?
            }
            Self::Block(block) => {
                let text = format!("[model]\nfile = \"body.json\"\n{RUBBER}{}", block.tables);
                let body = recorded(&block.body()).into_bytes();
                Study::from_files("block.toml", [("block.toml".into(), text.into_bytes()), ("body.json".into(), body)])?
            }
            Actuator(tables) => {
                let case = template::two_chambers();
                let start = case.find("[actuator]").unwrap_or_default();
                let actuator = case[start..].split("\n\n").next().unwrap_or_default();
                let text = format!(
                    "{actuator}\n[mesh]\nsize = 1.0\nelement = \"hex8-q1p0\"\n[load]\ntimes = [1.0]\n[[cavity]]\nname = \"air\"\n\
                     faces = \"cavity\"\npressure_kpa = 35\n{tables}"
                );
                Study::from_text("actuator.toml", &text)?
            }
        };
        study.set_all(changes)?;
        Ok(study)
    }
}

impl Block {
    fn body(&self) -> Body {
        let Self { element, size, cells, .. } = *self;
        let mut mesh = Lattice::uniform([0.0; 3], size, cells).mesh_all(element.element);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        for (side, name) in ["x0", "x1", "y0", "y1", "z0", "z1"].into_iter().enumerate() {
            let at = if side % 2 == 0 { 0.0 } else { size[side / 2] };
            let nodes = mesh.nodes.clone();
            let lies = |node: &u32| close(nodes[*node as usize][side / 2], at);
            let facets = mesh.boundary_facets().into_iter().filter(|facet| mesh.facet_nodes(*facet).iter().all(lies));
            let facets = facets.collect();
            mesh.facet_sets.insert(name.into(), facets);
        }
        let tip = mesh.select_nodes(|x| (0..3).all(|d| close(x[d], size[d])));
        mesh.node_sets.insert("tip".into(), tip);
        Body { mesh, formulation: element }
    }
}
