//! Why there is no solution.

use steklov_bem_operators::BemError;
use steklov_contact::ContactError;
use steklov_problem::DataError;

/// Why a run stopped without a result.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The scene's data cannot be used.
    #[error(transparent)]
    Data(#[from] Box<DataError>),
    /// The boundary element part failed.
    #[error(transparent)]
    Bem(#[from] BemError),
    /// The contact part failed.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The finite element part failed.
    #[error(transparent)]
    Msfem(Box<steklov_msfem::MsfemError>),
    /// Body and medium could not be joined.
    #[error(transparent)]
    Coupling(Box<steklov_coupling::CouplingError>),
    /// Two held sides want different displacements where they meet.
    #[error(
        "sides \"{first}\" and \"{second}\" hold the point ({}, {}) at different displacements {component} = {a} and {b}: \
         make them equal there, or free one of them",
        .point[0],
        .point[1]
    )]
    Incompatible {
        /// One side.
        first: String,
        /// The other side.
        second: String,
        /// The common point.
        point: [f64; 2],
        /// x or y.
        component: char,
        /// Value on the first side.
        a: f64,
        /// Value on the second side.
        b: f64,
    },
    /// Bodies that nothing holds against a motion which the loads drive.
    #[error(
        "nothing holds {bodies} against a motion on which the loads do work {work:.3e} (of a scale of {scale:.3e}), interfaces without \
         friction slide"
    )]
    Loose {
        /// Names of the bodies that move.
        bodies: String,
        /// Work of the loads on the motion.
        work: f64,
        /// Its scale.
        scale: f64,
    },
    /// A body so thin that its stiffness has no digits left.
    #[error(
        "rounding leaves no digit of the stiffness: the body is {thickness:.3e} thick over a length of {length:.3e}, and the cube of \
         that ratio, by which it bends more easily than its elements, takes {digits} of the 16 digits of a number, short elements \
         the others"
    )]
    Thin {
        /// Its thickness.
        thickness: f64,
        /// Diameter of that body.
        length: f64,
        /// Digits that bending takes.
        digits: f64,
    },
    /// Displacements, energies or errors beyond the range of floating point.
    #[error(
        "the displacements, the energy ({energy}) or its estimated error leave the range of floating point numbers"
    )]
    NotFinite {
        /// J as computed.
        energy: f64,
    },
    /// The random input cannot be treated.
    #[error(transparent)]
    Stochastic(#[from] steklov_stochastic::StochasticError),
    /// An outcome of the random input has no solution.
    #[error("for {outcome}: {error}")]
    Outcome {
        /// Its germs.
        outcome: String,
        /// What is wrong.
        #[source]
        error: Box<SolveError>,
    },
    /// The observer failed, as in storing what it was given.
    #[error(transparent)]
    Observer(Box<dyn std::error::Error + Send + Sync>),
    /// Outcomes that another program answered are not of the mesh of this one.
    #[error(
        "the answers of another program are of another mesh: give both the same version of steklov, and set method.max_dofs"
    )]
    Elsewhere,
    /// The user stopped the run.
    #[error("interrupted before a step was finished: nothing was stored")]
    Interrupted,
}

impl From<DataError> for SolveError {
    fn from(error: DataError) -> Self {
        Self::Data(Box::new(error))
    }
}

impl From<steklov_msfem::MsfemError> for SolveError {
    fn from(error: steklov_msfem::MsfemError) -> Self {
        Self::Msfem(Box::new(error))
    }
}

impl From<steklov_coupling::CouplingError> for SolveError {
    fn from(error: steklov_coupling::CouplingError) -> Self {
        Self::Coupling(Box::new(error))
    }
}
