//! Random input of a problem: its names, their germs, and how to solve for all of their values.

use std::collections::BTreeMap;
use std::sync::Arc;

use steklov_expression::{Expression, FieldValue, RandomField, Value};
use steklov_stochastic::{Distribution, Variable};

/// Random input that a scene uses, and how it is treated. The expressions of the data say which data it moves
/// ([`Scene::uses`](super::Scene::uses), [`Scene::cuts`](super::Scene::cuts)): there is nothing to fill in.
///
/// ```compile_fail,E0560
/// # use steklov_problem::{Random, RandomConstants, Stochastic};
/// let (names, germs) = (vec![], vec![]);
/// let constants = RandomConstants::default();
/// Random { names, germs, constants, stochastic: Stochastic::default(), uses: Default::default() };
/// ```
#[derive(Debug, Clone)]
pub struct Random {
    /// The names, in the order of the scene.
    pub names: Vec<RandomName>,
    /// The independent germs of all of them: the directions of the stochastic problem.
    pub germs: Vec<Germ>,
    /// How to solve.
    pub stochastic: Stochastic,
    /// Numbers of the problem that are random.
    pub constants: RandomConstants,
}

/// Numbers of a problem that use random names: the expressions that give them.
#[derive(Debug, Clone, Default)]
pub struct RandomConstants {
    /// Young's modulus of the bodies with these numbers; a medium around a hole is body 0.
    pub young: BTreeMap<usize, Expression>,
    /// Stress xx, yy, xy far away.
    pub remote_stress: Option<[Expression; 3]>,
}

impl RandomConstants {
    /// The first body with a random modulus; 0 if there is none.
    pub fn first_young(&self) -> usize {
        self.young.keys().next().copied().unwrap_or(0)
    }
}

/// A direction of the stochastic problem.
#[derive(Debug, Clone)]
pub struct Germ {
    /// `xi`, or `rough 3` for the third mode of a field.
    pub label: String,
    /// Its law.
    pub variable: Variable,
}

/// A name in expressions.
#[derive(Debug, Clone)]
pub enum RandomName {
    /// A variable.
    Variable {
        /// The name.
        name: String,
        /// Its germ.
        germ: usize,
    },
    /// A field.
    Field {
        /// The field.
        field: Arc<RandomField>,
        /// Its first germ; there is one a mode.
        first: usize,
    },
}

/// Points at which the problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Galerkin in tensor products of polynomials on a stochastic mesh.
    Galerkin,
    /// Collocation at the same points.
    Collocation,
    /// Smolyak's sparse grid.
    Sparse,
    /// A sparse grid whose polynomials fresh outcomes correct, both as many as a tolerance needs.
    Corrected,
    /// Independent samples.
    MonteCarlo,
    /// Samples of differences between grids of a family.
    Multilevel,
}

/// `[stochastic]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Stochastic {
    /// Method.
    pub method: Sampling,
    /// Degree in each germ.
    pub degree: usize,
    /// Stochastic elements in each germ.
    pub elements: usize,
    /// Level of the sparse grid.
    pub level: usize,
    /// Whether the stochastic mesh is refined until `tolerance`.
    pub refine: bool,
    /// Largest contribution of the truncation in the germs to the relative error in the energy norm; of methods with fresh
    /// outcomes the standard errors of means over the deviations.
    pub tolerance: f64,
    /// Whether the refined mesh has the tolerance of what varies: the truncation over the deviation in the energy norm. Of
    /// Galerkin on a grid whether the degree is raised until the square of the truncation of each quantity over its deviation,
    /// which errors of means over deviations follow, is `tolerance`.
    pub of_deviation: bool,
    /// Most stochastic nodes.
    pub max_nodes: usize,
    /// Samples of Monte Carlo, and of the surrogate for quantiles.
    pub samples: usize,
    /// Seed of the samples.
    pub seed: u64,
    /// Probabilities of the quantiles.
    pub quantiles: Vec<f64>,
    /// Paths of the JSON object.
    pub quantities: Option<Vec<String>>,
}

impl Default for Stochastic {
    fn default() -> Self {
        Self {
            method: Sampling::Galerkin,
            degree: 3,
            elements: 1,
            level: 2,
            refine: false,
            tolerance: 1e-4,
            of_deviation: false,
            max_nodes: 10_000,
            samples: 10_000,
            seed: 1,
            quantiles: vec![0.05, 0.5, 0.95],
            quantities: None,
        }
    }
}

impl RandomName {
    /// The germ of a variable.
    pub fn variable(&self) -> Option<usize> {
        if let Self::Variable { germ, .. } = self { Some(*germ) } else { None }
    }

    /// The name.
    pub fn name(&self) -> &str {
        match self {
            Self::Variable { name, .. } => name,
            Self::Field { field, .. } => &field.name,
        }
    }
}

impl Random {
    /// Values of the names for these germs.
    pub fn values(&self, germs: &[f64]) -> BTreeMap<String, Value> {
        let value = |name: &RandomName| match name {
            RandomName::Variable { germ, .. } => Value::Constant(self.germs[*germ].variable.value(germs[*germ])),
            RandomName::Field { field, first } => {
                let germs = germs[*first..first + field.expansion.len()].to_vec();
                Value::Field(Arc::new(FieldValue::new(field.clone(), germs)))
            }
        };
        self.names.iter().map(|name| (name.name().to_owned(), value(name))).collect()
    }

    /// An outcome in words: the values of the names, the germs of fields.
    pub fn outcome_name(&self, germs: &[f64]) -> String {
        let value = |(g, xi): (&Germ, &f64)| format!("{} = {}", g.label, g.variable.value(*xi));
        let first: Vec<String> = self.germs.iter().zip(germs).take(NAMED).map(value).collect();
        let more = if germs.len() > NAMED { ", .." } else { "" };
        format!("{}{more}", first.join(", "))
    }

    /// The fields, each with its first germ.
    pub fn fields(&self) -> impl Iterator<Item = (&Arc<RandomField>, usize)> {
        self.names.iter().filter_map(|name| match name {
            RandomName::Field { field, first } => Some((field, *first)),
            RandomName::Variable { .. } => None,
        })
    }

    /// The germs of fields that are drawn as a whole: answers are no functions of them that polynomials could follow.
    pub fn drawn_germs(&self) -> Vec<usize> {
        self.fields().filter(|(field, _)| field.expansion.is_drawn()).map(|(_, first)| first).collect()
    }

    /// The germs of the nominal outcome: means of the variables, fields 0.
    pub fn nominal(&self) -> Vec<f64> {
        self.germs
            .iter()
            .map(|g| {
                let [low, high] = g.variable.germ_support();
                match g.variable.distribution() {
                    Distribution::Lognormal { .. } => g.variable.mean().ln().clamp(low, high),
                    _ => g.variable.mean(),
                }
            })
            .collect()
    }
}

/// Germs that messages name.
const NAMED: usize = 12;
