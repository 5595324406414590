//! How a problem is to be solved, and what its result must be.

use steklov_contact::{MultiplierDegree, MultiplierMesh};

/// Requested discretisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// The least one that the scene needs.
    Auto,
    /// Boundary elements.
    Bem,
    /// Finite elements on a grid.
    Fem,
    /// Multiscale finite elements.
    Msfem,
    /// Finite elements, boundary elements around them.
    FemBem,
    /// Multiscale finite elements, boundary elements around them.
    MsfemBem,
}

impl Model {
    /// The word of the scene file.
    pub fn word(self) -> &'static str {
        MODELS.iter().find(|(_, model)| *model == self).map_or("", |(word, _)| word)
    }
}

/// How the mesh is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refine {
    /// Adaptive in h and p.
    Hp,
    /// Adaptive in h and p by the decay of Legendre coefficients.
    HpDecay,
    /// Adaptive in h.
    H,
    /// All elements halved.
    UniformH,
    /// All degrees raised.
    UniformP,
    /// One mesh.
    None,
}

/// Whether a body is cut into subdomains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cutting {
    /// Where it costs less.
    Auto,
    /// Never.
    None,
}

/// Error indicator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Indicator {
    /// Hierarchical bubbles.
    Bubble,
    /// Residuals.
    Residual,
}

/// Multiplier space of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Multiplier {
    /// Dual basis.
    Biorthogonal,
    /// Stabilised mixed form.
    Stabilised,
}

/// Solver of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// Interior point, polished by active sets.
    Auto,
    /// Semi-smooth Newton.
    Newton,
    /// Active set.
    ActiveSet,
    /// Uzawa.
    Uzawa,
}

/// Everything of `[method]`, defaults filled in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// Discretisation.
    pub model: Model,
    /// Wanted relative error in the energy norm, in (0, 1), if it is given.
    pub tolerance: Option<f64>,
    /// Refinement.
    pub refine: Refine,
    /// Elements of the first mesh, at least 1, if they are given.
    pub elements: Option<usize>,
    /// Degree of the first mesh, 1 to 64.
    pub degree: usize,
    /// Largest number of displacement unknowns, if it is given.
    pub max_dofs: Option<usize>,
    /// Bytes that the matrices of a mesh may take; no limit if None.
    pub memory: Option<u64>,
    /// Largest number of adaptive steps.
    pub max_steps: usize,
    /// Whether the body is cut into subdomains.
    pub cuts: Cutting,
    /// Indicator of the error.
    pub indicator: Indicator,
    /// Whether the residual estimators are reported as numbers, whatever steers the refinement.
    pub estimators: bool,
    /// Dörfler's θ in (0, 1]; `None` is auto.
    pub marking: Option<f64>,
    /// δ in (0, 1] of the h-or-p decision.
    pub smoothness: f64,
    /// Multiplier space.
    pub multiplier: Multiplier,
    /// γ₀ > 0 (1/stress) of the stabilisation; `None` is auto.
    pub gamma: Option<f64>,
    /// Mesh of stabilised multipliers.
    pub multiplier_mesh: MultiplierMesh,
    /// Degree of stabilised multipliers.
    pub multiplier_degree: MultiplierDegree,
    /// Solver of contact.
    pub solver: Solver,
}

impl Default for Method {
    fn default() -> Self {
        Self {
            model: Model::Auto,
            tolerance: None,
            refine: Refine::Hp,
            elements: None,
            degree: 1,
            max_dofs: None,
            memory: None,
            max_steps: 60,
            cuts: Cutting::Auto,
            indicator: Indicator::Bubble,
            estimators: false,
            marking: None,
            smoothness: 0.6,
            multiplier: Multiplier::Biorthogonal,
            gamma: None,
            multiplier_mesh: MultiplierMesh::Same,
            multiplier_degree: MultiplierDegree::Relative(0),
            solver: Solver::Auto,
        }
    }
}

impl Method {
    /// Wanted relative error in the energy norm.
    pub fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(1e-3)
    }

    /// Elements of the first mesh.
    pub fn elements(&self) -> usize {
        self.elements.unwrap_or(16)
    }

    /// Whether residuals are computed: where they steer the refinement they are reported too.
    pub fn has_residuals(&self) -> bool {
        self.estimators || self.indicator == Indicator::Residual
    }

    /// Largest number of displacement unknowns.
    pub fn max_dofs(&self) -> usize {
        self.max_dofs.unwrap_or(20_000)
    }
}

/// A number that a result must have.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// Path in the JSON object, its keys joined by points: `contact.force.y`.
    pub path: String,
    /// The number.
    pub value: f64,
    /// How far the result may be from it.
    pub tol: f64,
    /// Where the number comes from.
    pub source: String,
}

/// Every discretisation and its word.
pub const MODELS: [(&str, Model); 6] = [
    ("auto", Model::Auto),
    ("bem", Model::Bem),
    ("fem", Model::Fem),
    ("msfem", Model::Msfem),
    ("fem-bem", Model::FemBem),
    ("msfem-bem", Model::MsfemBem),
];

/// Every mesh of stabilised multipliers and its word.
pub const MULTIPLIER_MESHES: [(&str, MultiplierMesh); 4] = [
    ("same", MultiplierMesh::Same),
    ("coarser", MultiplierMesh::Coarser(2)),
    ("finer", MultiplierMesh::Finer(2)),
    ("shifted", MultiplierMesh::Shifted),
];

/// Every refinement and its word.
pub const REFINES: [(&str, Refine); 6] = [
    ("hp", Refine::Hp),
    ("hp-decay", Refine::HpDecay),
    ("h", Refine::H),
    ("uniform-h", Refine::UniformH),
    ("uniform-p", Refine::UniformP),
    ("none", Refine::None),
];

/// Every solver of contact and its word.
pub const SOLVERS: [(&str, Solver); 4] =
    [("auto", Solver::Auto), ("newton", Solver::Newton), ("active-set", Solver::ActiveSet), ("uzawa", Solver::Uzawa)];

/// Every choice about cuts and its word.
pub const CUTTINGS: [(&str, Cutting); 2] = [("auto", Cutting::Auto), ("none", Cutting::None)];

/// Every indicator and its word.
pub const INDICATORS: [(&str, Indicator); 2] = [("bubble", Indicator::Bubble), ("residual", Indicator::Residual)];

/// Every space of multipliers and its word.
pub const MULTIPLIERS: [(&str, Multiplier); 2] =
    [("biorthogonal", Multiplier::Biorthogonal), ("stabilised", Multiplier::Stabilised)];
