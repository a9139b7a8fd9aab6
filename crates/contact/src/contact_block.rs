//! What touches what: points of a slave face and the face or obstacle that they touch.

use crate::averaging::Bounded;

/// A point of a slave face that touches a master face or an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Reference coordinates on the slave face.
    pub slave_xi: [f64; 2],
    /// Reference area that the point stands for, mm².
    pub area: f64,
    /// Reference coordinates of its foot on the master face; not used with an obstacle.
    pub master_xi: [f64; 2],
    /// Signed distance d, mm; negative is penetration.
    pub distance: f64,
    /// λ/k less what may still overlap, mm: the distance up to which the point is in contact; 0 for a plain penalty, and where gaps are averaged.
    pub shift: f64,
    /// Number of the slave point among all points of the model, see [`crate::ContactModel::num_points`]; 0 where gaps are averaged.
    pub number: usize,
    /// Traction λ − k d, or what the averages around it make of theirs, MPa.
    pub traction: f64,
    /// Traction in the tangent's geometric term, MPa. The search sets it to the traction; a solver may carry another one.
    pub carried: f64,
    /// Stiffness along the normal, N/mm³: k, or what the averages' bounded distances add where gaps are averaged.
    pub stiffness: f64,
}

impl ContactPoint {
    /// A point with the penalty stiffness `stiffness` of its own.
    pub(crate) fn with_penalty(self, stiffness: f64) -> Self {
        let traction = -stiffness * (self.distance - self.shift);
        Self { traction, carried: traction, stiffness, ..self }
    }

    /// Adds a share of an average's traction (MPa).
    pub(crate) fn add(&mut self, traction: f64, phi: Bounded) {
        self.traction += traction * phi.slope;
        self.carried += traction * phi.slope;
        self.stiffness -= traction * phi.curvature;
    }
}

/// What a slave face touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// A face of the surface pair's master surface.
    Face {
        /// Number of the surface pair, see [`crate::ContactModel::surface_pair`].
        surface_pair: usize,
        /// An index into the master's facets.
        face: usize,
    },
    /// The obstacle of this number.
    Obstacle(usize),
}

/// The touching points between a slave face and one master face or obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactBlock {
    /// What is touched.
    pub partner: Partner,
    /// Slave face, an index into the surface pair's slave facets or the obstacle's facets.
    pub slave_face: usize,
    /// Nodes of the slave face, then nodes of the master face.
    pub nodes: Vec<u32>,
    /// Touching points, in the order of the rule.
    pub points: Vec<ContactPoint>,
}
