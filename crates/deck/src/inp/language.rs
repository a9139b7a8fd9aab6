//! Which keywords and parameters are understood, which are left out, which are refused and why.

/// Where a keyword may stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Region {
    /// Before the steps.
    Model,
    /// In a step.
    Step,
    /// In both.
    Both,
}

/// What becomes of a keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Treatment {
    /// Understood, with these parameters.
    Understood(Region, &'static [&'static str]),
    /// Left out with a note: it does not change what is solved.
    LeftOut,
    /// Refused for a reason.
    Refused(&'static str),
}

use Region::{Both, Model, Step};
use Treatment::{LeftOut, Refused, Understood};

const MESH: &str = "write nodes and elements out";
const SHAPES: &str = "only solids of hexahedra or tetrahedra are solved";
const PHYSICS: &str = "only static equilibria of hyperelastic solids are solved";
const TIES: &str = "surfaces and nodes are coupled by *TIE, *COUPLING, *RIGID BODY, *MPC and *EQUATION, or share nodes";

const FLUIDS: &str = "prescribe the pressure by *BOUNDARY, direction 8 of the reference node; a model file around the deck can pump a volume or an \
                      amount of gas in";

/// Keywords in capitals without blanks, as in `SOLIDSECTION`.
const KEYWORDS: &[(&str, Treatment)] = &[
    ("HEADING", Understood(Model, &[])),
    ("PART", Understood(Model, &["NAME"])),
    ("ENDPART", Understood(Model, &[])),
    ("ASSEMBLY", Understood(Model, &["NAME"])),
    ("ENDASSEMBLY", Understood(Model, &[])),
    ("INSTANCE", Understood(Model, &["NAME", "PART"])),
    ("ENDINSTANCE", Understood(Model, &[])),
    ("NODE", Understood(Model, &["NSET", "SYSTEM", "INPUT"])),
    ("ELEMENT", Understood(Model, &["TYPE", "ELSET", "INPUT"])),
    ("NSET", Understood(Model, &["NSET", "ELSET", "GENERATE", "INSTANCE", "UNSORTED", "INTERNAL", "INPUT"])),
    ("ELSET", Understood(Model, &["ELSET", "GENERATE", "INSTANCE", "UNSORTED", "INTERNAL", "INPUT"])),
    ("SURFACE", Understood(Model, &["NAME", "TYPE", "INTERNAL", "INPUT"])),
    ("MATERIAL", Understood(Model, &["NAME"])),
    (
        "HYPERELASTIC",
        Understood(
            Model,
            &["N", "NEOHOOKE", "YEOH", "MOONEY-RIVLIN", "POLYNOMIAL", "REDUCEDPOLYNOMIAL", "OGDEN", "MODULI"],
        ),
    ),
    ("ELASTIC", Understood(Model, &["TYPE", "MODULI"])),
    ("DENSITY", Understood(Model, &[])),
    ("SOLIDSECTION", Understood(Model, &["ELSET", "MATERIAL", "CONTROLS"])),
    ("BOUNDARY", Understood(Both, &["OP", "AMPLITUDE", "TYPE", "INPUT"])),
    ("EQUATION", Understood(Model, &["INPUT"])),
    ("TIE", Understood(Model, &["NAME", "ADJUST", "POSITIONTOLERANCE", "TYPE", "NOROTATION"])),
    ("RIGIDBODY", Understood(Model, &["NSET", "ELSET", "TIENSET", "PINNSET", "REFNODE", "ROTNODE"])),
    ("COUPLING", Understood(Model, &["CONSTRAINTNAME", "REFNODE", "SURFACE"])),
    ("KINEMATIC", Understood(Model, &[])),
    ("DISTRIBUTING", Understood(Model, &["WEIGHTINGMETHOD"])),
    ("MPC", Understood(Model, &["INPUT"])),
    ("AMPLITUDE", Understood(Model, &["NAME", "DEFINITION", "TIME", "VALUE", "INPUT"])),
    ("STEP", Understood(Model, &["NLGEOM", "INC", "NAME", "AMPLITUDE", "UNSYMM", "EXTRAPOLATION"])),
    ("STATIC", Understood(Step, &["DIRECT", "SOLVER", "STABILIZE", "FACTOR", "ALLSDTOL", "CONTINUE"])),
    ("ENDSTEP", Understood(Step, &[])),
    ("CLOAD", Understood(Step, &["OP", "AMPLITUDE", "INPUT"])),
    ("DLOAD", Understood(Step, &["OP", "AMPLITUDE", "INPUT"])),
    ("DSLOAD", Understood(Step, &["OP", "AMPLITUDE", "INPUT"])),
    ("SURFACEINTERACTION", Understood(Model, &["NAME"])),
    (
        "SURFACEBEHAVIOR",
        Understood(Model, &["PRESSURE-OVERCLOSURE", "DIRECT", "PENALTY", "NOSEPARATION", "AUGMENTEDLAGRANGE"]),
    ),
    ("FRICTION", Understood(Model, &["SLIPTOLERANCE"])),
    ("CONTACTPAIR", Understood(Model, &["INTERACTION", "TYPE", "SMALLSLIDING", "ADJUST", "EXTENSIONZONE", "CPSET"])),
    ("NODEFILE", LeftOut),
    ("ELFILE", LeftOut),
    ("NODEPRINT", LeftOut),
    ("ELPRINT", LeftOut),
    ("FACEPRINT", LeftOut),
    ("SECTIONPRINT", LeftOut),
    ("ENERGYPRINT", LeftOut),
    ("ENERGYFILE", LeftOut),
    ("CONTACTFILE", LeftOut),
    ("CONTACTPRINT", LeftOut),
    ("CONTACTOUTPUT", LeftOut),
    ("OUTPUT", LeftOut),
    ("NODEOUTPUT", LeftOut),
    ("ELEMENTOUTPUT", LeftOut),
    ("ENERGYOUTPUT", LeftOut),
    ("FILEFORMAT", LeftOut),
    ("FILEOUTPUT", LeftOut),
    ("TIMEPOINTS", LeftOut),
    ("MONITOR", LeftOut),
    ("PRINT", LeftOut),
    ("RESTART", LeftOut),
    ("PREPRINT", LeftOut),
    ("CONTROLS", LeftOut),
    ("CONTACTCONTROLS", LeftOut),
    ("SECTIONCONTROLS", LeftOut),
    ("SOLVERCONTROLS", LeftOut),
    ("PHYSICALCONSTANTS", LeftOut),
    ("NGEN", Refused(MESH)),
    ("NFILL", Refused(MESH)),
    ("NCOPY", Refused(MESH)),
    ("ELGEN", Refused(MESH)),
    ("ELCOPY", Refused(MESH)),
    ("SYSTEM", Refused(MESH)),
    ("TRANSFORM", Refused("supports and loads act along the global axes only")),
    ("ORIENTATION", Refused("materials are isotropic")),
    ("SHELLSECTION", Refused(SHAPES)),
    ("MEMBRANESECTION", Refused(SHAPES)),
    ("BEAMSECTION", Refused(SHAPES)),
    ("BEAMGENERALSECTION", Refused(SHAPES)),
    ("SURFACESECTION", Refused(SHAPES)),
    ("MASS", Refused(PHYSICS)),
    ("SPRING", Refused(SHAPES)),
    ("DASHPOT", Refused(PHYSICS)),
    ("GAP", Refused(SHAPES)),
    ("EMBEDDEDELEMENT", Refused(TIES)),
    ("SHELLTOSOLIDCOUPLING", Refused(TIES)),
    ("CONTACT", Refused("give pairs of surfaces by *CONTACT PAIR")),
    ("CONTACTINCLUSIONS", Refused("give pairs of surfaces by *CONTACT PAIR")),
    ("CLEARANCE", Refused("surfaces are taken where the nodes are")),
    ("MODELCHANGE", Refused("bodies and contact pairs are there from the beginning to the end")),
    ("FLUIDCAVITY", Understood(Model, &["NAME", "SURFACE", "REFNODE", "BEHAVIOR", "AMBIENTPRESSURE"])),
    ("FLUIDBEHAVIOR", Understood(Model, &["NAME"])),
    ("FLUIDDENSITY", Understood(Model, &[])),
    ("FLUIDBULKMODULUS", Understood(Model, &[])),
    ("MOLECULARWEIGHT", Understood(Model, &[])),
    ("CAPACITY", Understood(Model, &["TYPE"])),
    ("FLUIDFLUX", Refused(FLUIDS)),
    ("FLUIDEXCHANGE", Refused(FLUIDS)),
    ("FLUIDINFLATOR", Refused(FLUIDS)),
    ("INITIALCONDITIONS", Understood(Model, &["TYPE", "INPUT"])),
    // Nothing expands, and constants do not depend on it.
    ("TEMPERATURE", LeftOut),
    ("FIELD", Refused(PHYSICS)),
    ("EXPANSION", Refused(PHYSICS)),
    ("CONDUCTIVITY", Refused(PHYSICS)),
    ("SPECIFICHEAT", Refused(PHYSICS)),
    ("PLASTIC", Refused(PHYSICS)),
    ("CREEP", Refused(PHYSICS)),
    ("VISCOELASTIC", Refused(PHYSICS)),
    ("HYSTERESIS", Refused(PHYSICS)),
    ("MULLINSEFFECT", Refused(PHYSICS)),
    ("HYPERFOAM", Refused("laws are those of *HYPERELASTIC and isotropic *ELASTIC")),
    ("ANISOTROPICHYPERELASTIC", Refused("materials are isotropic")),
    ("USERMATERIAL", Refused("laws are those of *HYPERELASTIC and isotropic *ELASTIC")),
    ("UNIAXIALTESTDATA", Refused("give constants; `pneuflex fit` finds them from test curves")),
    ("BIAXIALTESTDATA", Refused("give constants; `pneuflex fit` finds them from test curves")),
    ("PLANARTESTDATA", Refused("give constants; `pneuflex fit` finds them from test curves")),
    ("VOLUMETRICTESTDATA", Refused("give constants; `pneuflex fit` finds them from test curves")),
    ("DYNAMIC", Refused(PHYSICS)),
    ("VISCO", Refused(PHYSICS)),
    ("FREQUENCY", Refused(PHYSICS)),
    ("BUCKLE", Refused(PHYSICS)),
    ("STEADYSTATEDYNAMICS", Refused(PHYSICS)),
    ("MODALDYNAMIC", Refused(PHYSICS)),
    ("HEATTRANSFER", Refused(PHYSICS)),
    ("COUPLEDTEMPERATURE-DISPLACEMENT", Refused(PHYSICS)),
    ("UNCOUPLEDTEMPERATURE-DISPLACEMENT", Refused(PHYSICS)),
    ("GEOSTATIC", Refused(PHYSICS)),
];

/// What becomes of a keyword; `None` if it is not known at all.
pub(super) fn treatment(keyword: &str) -> Option<Treatment> {
    KEYWORDS.iter().find(|(name, _)| *name == keyword).map(|(_, treatment)| *treatment)
}

/// All keywords that are understood or left out, for suggestions.
pub(super) fn candidates() -> impl Iterator<Item = &'static str> {
    KEYWORDS.iter().filter(|(_, treatment)| !matches!(treatment, Refused(_))).map(|(name, _)| *name)
}
