//! What is advised, and on which occasion: the one list of both, which the table of tried advice (`verification::advice`) goes through.
//! [`Vocabulary`](crate::vocabulary::Vocabulary) has the words.

use serde::Serialize;

/// Something that can be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Remedy {
    /// Stay below the load that was reached.
    SmallerLoad,
    /// Make thin walls thicker.
    ThickerWalls,
    /// Make what buckles thicker or shorter.
    Stockier,
    /// Constants that describe larger stretches.
    FittedConstants,
    /// Support the part.
    Hold,
    /// Let the part touch what holds it, at rest.
    TouchAtRest,
    /// Smaller load steps.
    SmallerSteps,
    /// Smaller elements.
    FinerMesh,
    /// Elements of second order.
    BetterElements,
    /// The isochoric invariant.
    Isochoric,
    /// Contact that is softer, or stiffer.
    OtherStiffness,
    /// Contact that is stiffer.
    StifferContact,
    /// A bound on the depth of the contact.
    PenetrationTolerance,
    /// Contact at many points of each face.
    MultiPoint,
    /// Contact of the body with itself.
    SelfContact,
    /// Obstacles that are stiffer.
    StifferObstacle,
    /// Obstacles that do not come to what supports hold.
    ClearOfSupports,
    /// A volume of air instead of its pressure.
    PumpVolume,
    /// A motion instead of a force.
    PrescribeMotion,
    /// A push along the motion that buckles.
    Imperfection,
    /// The arc length instead of the load parameter.
    ArcLength,
    /// A motion against dampers to the next stable shape.
    LetSnap,
    /// Less memory, or more of it.
    Memory,
    /// Mend the equations that the message names.
    Equations,
    /// A tolerance of the residual above the rounding.
    ResidualTolerance,
    /// Measure the errors on finer and finer meshes.
    ErrorBars,
    /// Better shapes of elements.
    BetterShapes,
    /// Model the whole body.
    WholeBody,
    /// Put a probe on the body.
    MoveProbe,
    /// Lengths in mm.
    Lengths,
    /// Moduli in MPa.
    Moduli,
    /// Densities in g/cm³.
    Densities,
    /// A bulk modulus of a stiff material's own.
    BulkModulus,
    /// Pressures in kPa.
    Pressures,
    /// Accelerations in mm/s².
    Accelerations,
}

/// What advice is given for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Occasion {
    /// A run ended for want of memory.
    OutOfMemory,
    /// The equations cannot be set up, or contradict each other.
    BadEquations,
    /// A tolerance of the residual is below the rounding.
    Rounding,
    /// The material has no stiffness left.
    NoStiffnessLeft,
    /// Only contact holds a part, and it does not.
    NotHeld,
    /// A body buckles.
    Buckling,
    /// A body is unstable where its first step leads.
    FirstStep,
    /// A motion of elements, which the body has not, is unstable.
    ElementMotion,
    /// A change of volume is unstable that the pressures of the elements do not see.
    VolumetricMotion,
    /// Air reached the greatest pressure that the body bears.
    GreatestPressure,
    /// Forces reached the greatest that the body bears.
    GreatestForce,
    /// The only equilibrium that is found lies on the other side of an obstacle.
    PassedThrough,
    /// Contact does not settle.
    UnsettledContact,
    /// An element turned inside out.
    InvertedElement,
    /// An end without a reason that is known.
    Unclear,
    /// Nothing holds a part; found before anything is solved.
    Free,
    /// A state beyond what the material's constants describe.
    BeyondConstants,
    /// A state with elements that are unstable.
    UnstableElements,
    /// Deep penetration of an obstacle.
    DeepObstacle,
    /// An obstacle that comes into what supports hold.
    HeldInObstacle,
    /// Deep penetration of walls.
    DeepContact,
    /// Deep penetration within faces whose gaps are closed on the mean.
    DeepAverages,
    /// Contact that was not solved to the depth asked for.
    UnmetTolerance,
    /// Walls that pass through each other where contact is switched off, or looked for at one point.
    NoContact,
    /// A body that has curled so far that it may overlap.
    Overlap,
    /// One linear element across a wall.
    LinearElements,
    /// A coarse mesh of an actuator.
    CoarseMesh,
    /// An actuator unlike those on which errors were measured.
    Unmeasured,
    /// Badly shaped elements.
    PoorShapes,
    /// Something that stands for two.
    Twofold,
    /// A probe beside the body.
    FarProbe,
    /// An unusual size.
    Size,
    /// An unusual modulus.
    Modulus,
    /// An unusual density.
    Density,
    /// A bulk modulus beyond all materials.
    Bulk,
    /// An unusual pressure.
    Pressure,
    /// An unusual acceleration.
    Acceleration,
    /// An actuator that hardly moves.
    HardlyMoves,
    /// States beyond a limit point, at which a body does not stay by itself.
    PastLimit,
    /// A body that buckled, and was followed.
    Buckled,
    /// A body that snapped.
    Snapped,
    /// A body that may have snapped in a load step.
    Jumped,
}

impl Occasion {
    /// All of them.
    pub const ALL: [Self; 42] = [
        Self::OutOfMemory,
        Self::BadEquations,
        Self::Rounding,
        Self::NoStiffnessLeft,
        Self::NotHeld,
        Self::Buckling,
        Self::FirstStep,
        Self::ElementMotion,
        Self::VolumetricMotion,
        Self::GreatestPressure,
        Self::GreatestForce,
        Self::PassedThrough,
        Self::UnsettledContact,
        Self::InvertedElement,
        Self::Unclear,
        Self::Free,
        Self::BeyondConstants,
        Self::UnstableElements,
        Self::DeepObstacle,
        Self::HeldInObstacle,
        Self::DeepContact,
        Self::DeepAverages,
        Self::UnmetTolerance,
        Self::NoContact,
        Self::Overlap,
        Self::LinearElements,
        Self::CoarseMesh,
        Self::Unmeasured,
        Self::PoorShapes,
        Self::Twofold,
        Self::FarProbe,
        Self::Size,
        Self::Modulus,
        Self::Density,
        Self::Bulk,
        Self::Pressure,
        Self::Acceleration,
        Self::HardlyMoves,
        Self::PastLimit,
        Self::Buckled,
        Self::Snapped,
        Self::Jumped,
    ];

    /// What helps, the best first. A remedy that a kind of file or problem has not is left out where advice is given.
    pub fn remedies(self) -> &'static [Remedy] {
        use Remedy as R;
        match self {
            Self::OutOfMemory => &[R::Memory],
            Self::BadEquations => &[R::Equations],
            Self::Rounding => &[R::ResidualTolerance],
            Self::NoStiffnessLeft => &[R::SmallerLoad, R::ThickerWalls, R::FittedConstants],
            Self::NotHeld => &[R::Hold, R::TouchAtRest],
            Self::Buckling => &[R::SmallerLoad, R::Stockier, R::Imperfection, R::LetSnap],
            Self::FirstStep => &[R::SmallerSteps],
            Self::ElementMotion => &[R::BetterElements, R::FinerMesh],
            Self::VolumetricMotion => &[R::Isochoric, R::BetterElements, R::FinerMesh],
            Self::GreatestPressure => &[R::SmallerLoad, R::ThickerWalls, R::PumpVolume, R::ArcLength],
            Self::GreatestForce => &[R::SmallerLoad, R::ThickerWalls, R::PrescribeMotion, R::ArcLength, R::LetSnap],
            Self::PassedThrough => &[R::SmallerSteps, R::OtherStiffness],
            Self::UnsettledContact => &[R::OtherStiffness],
            Self::InvertedElement => &[R::BetterElements, R::SmallerLoad],
            Self::Unclear => &[R::SmallerSteps, R::FinerMesh],
            Self::Free => &[R::Hold],
            Self::BeyondConstants => &[R::FittedConstants],
            Self::UnstableElements | Self::LinearElements => &[R::BetterElements, R::FinerMesh],
            Self::DeepObstacle => &[R::StifferObstacle],
            Self::HeldInObstacle => &[R::ClearOfSupports],
            Self::DeepContact => &[R::StifferContact, R::PenetrationTolerance, R::FinerMesh],
            Self::UnmetTolerance => &[R::StifferContact],
            Self::NoContact | Self::DeepAverages => &[R::MultiPoint],
            Self::Overlap => &[R::SelfContact],
            Self::CoarseMesh | Self::Unmeasured => &[R::FinerMesh, R::ErrorBars],
            Self::PoorShapes => &[R::BetterShapes],
            Self::Twofold => &[R::WholeBody],
            Self::FarProbe => &[R::MoveProbe],
            Self::Size => &[R::Lengths],
            Self::Modulus => &[R::Moduli],
            Self::Density => &[R::Densities],
            Self::Bulk => &[R::BulkModulus],
            Self::Pressure => &[R::Pressures],
            Self::Acceleration => &[R::Accelerations],
            Self::PastLimit | Self::Snapped => &[R::SmallerLoad],
            Self::Jumped => &[R::LetSnap],
            Self::Buckled => &[R::SmallerLoad, R::Stockier],
            Self::HardlyMoves => &[R::Moduli, R::Pressures],
        }
    }
}
