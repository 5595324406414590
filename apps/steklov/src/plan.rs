//! The least model that can answer a scene, chosen before anything is solved.

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{Mesh, RigidMotion, free_motions};

use crate::adapt::Layout;
use crate::estimate::is_estimated;
use crate::scene::{Condition, Friction, Multiplier, Refine, Scene, Solver};

/// What is modelled and why, what is left out, what it costs. A pure function of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Discretisation: "bem".
    pub model: String,
    /// What is modelled.
    pub modelled: Vec<Decision>,
    /// What is left out.
    pub left_out: Vec<Decision>,
    /// What the first mesh costs.
    pub cost: Cost,
}

/// What is decided about where the plan names the solver of contact.
pub const CONTACT_SOLVER: &str = "contact solver";

/// One choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// What is decided about.
    pub what: String,
    /// What was chosen.
    pub choice: String,
    /// Why.
    pub why: String,
}

/// Size and cost of the first mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Elements.
    pub elements: usize,
    /// Displacement unknowns, held ones included.
    pub dofs: usize,
    /// Bytes of the matrices that are held at once.
    pub memory_bytes: u64,
    /// Floating point operations of the dense algebra.
    pub operations: f64,
}

/// Chooses the model of a scene.
pub fn plan(scene: &Scene) -> Plan {
    let method = &scene.method;
    let mesh = first_mesh(scene);
    let dofs = 2 * mesh.degree.iter().sum::<usize>();
    let mut modelled = Vec::new();
    let mut left_out = Vec::new();
    let decision = |what: &str, choice: String, why: &str| Decision { what: what.into(), choice, why: why.into() };

    modelled.push(decision(
        "discretisation",
        "boundary elements".into(),
        "one homogeneous material: unknowns on the boundary only, the inside follows exactly",
    ));
    let plane = match scene.material.plane {
        steklov_bem_operators::Plane::Strain => "plane strain",
        steklov_bem_operators::Plane::Stress => "plane stress, as plane strain with E(1+2ν)/(1+ν)² and ν/(1+ν)",
    };
    modelled.push(decision("plane", plane.into(), "as the scene says"));
    if mesh.len() > method.elements {
        let choice = format!("{} elements instead of {}", mesh.len(), method.elements);
        modelled.push(decision("elements", choice, "every straight edge needs one"));
    } else {
        modelled.push(decision("elements", mesh.len().to_string(), "equal on an edge, the longest edges first"));
    }
    modelled.push(decision(
        "degree",
        format!("{} for displacements, {} for tractions", method.degree, method.degree - 1),
        "as the scene says",
    ));
    let theta = |auto: f64| format!("marks θ = {} of the squared error", method.marking.unwrap_or(auto));
    modelled.push(match method.refine {
        Refine::Hp => decision(
            "refinement",
            "hp".into(),
            &format!(
                "{}; cuts towards corners, kinks of the data and ends of contact and stick, raises degrees elsewhere",
                theta(0.95)
            ),
        ),
        Refine::HpDecay => decision(
            "refinement",
            "hp-decay".into(),
            &format!("{}; degree or halving by the decay of Legendre coefficients", theta(0.5)),
        ),
        Refine::H => decision("refinement", "h".into(), &format!("{}; halves", theta(0.5))),
        Refine::UniformH => decision("refinement", "uniform-h".into(), "all elements are halved in each step"),
        Refine::UniformP => decision("refinement", "uniform-p".into(), "all degrees rise by one in each step"),
        Refine::None => decision("refinement", "none".into(), "one mesh is solved"),
    });
    modelled.push(decision(
        "length in log(L/r)",
        format!("{}", mesh.diameter()),
        "the diameter keeps the single layer matrix positive definite at any size",
    ));
    contact(scene, &mut modelled, &mut left_out);
    let free = free_of_supports(scene);
    if free.is_empty() {
        modelled.push(decision("supports", "hold all rigid motions".into(), "held displacements"));
    } else {
        modelled.push(decision(
            "supports",
            format!("leave {} free", RigidMotion::names(&free)),
            "contact or friction must hold it, or the loads must be balanced",
        ));
    }
    match scene.body_force {
        Some([x, y]) => modelled.push(decision(
            "body force",
            format!("({x}, {y})"),
            "constant: carried by a particular solution on the boundary",
        )),
        None => left_out.push(decision("body force", "none".into(), "the scene has none")),
    }
    left_out.push(decision("random input", "one solve".into(), "no random name is used"));
    left_out.push(decision("grid in the body", "none".into(), "the material is the same everywhere"));
    let estimated = is_estimated(scene, dofs);
    if estimated {
        modelled.push(decision(
            "error estimate",
            "spaces of one degree more".into(),
            "bubbles and top tractions on every element: indicators, and the energy of what they add",
        ));
    } else {
        left_out.push(decision(
            "error estimate",
            "none".into(),
            "one large mesh: it would take several times the time and memory of the solution; any other refine has one",
        ));
    }

    let (n, x) = (dofs as f64, if estimated { 2.0 * mesh.len() as f64 } else { 0.0 });
    let cost = Cost {
        elements: mesh.len(),
        dofs,
        memory_bytes: (8.0 * (3.0 * n * n + 4.0 * n * x + 3.0 * x * x)) as u64,
        operations: n * n * (n * (1.0 / 3.0 + 1.0 + 1.0 + 1.0 / 3.0) + 6.0 * x),
    };
    Plan { model: "bem".into(), modelled, left_out, cost }
}

fn contact(scene: &Scene, modelled: &mut Vec<Decision>, left_out: &mut Vec<Decision>) {
    let sides: Vec<(&str, &Friction)> = scene
        .sides
        .iter()
        .filter_map(|s| match &s.condition {
            Condition::Contact { friction, .. } => Some((s.name.as_str(), friction)),
            _ => None,
        })
        .collect();
    if sides.is_empty() {
        let (what, choice, why) = ("contact", "no contact solver", "no side is in contact: one linear solve");
        left_out.push(Decision { what: what.into(), choice: choice.into(), why: why.into() });
        return;
    }
    let laws: Vec<String> = sides
        .iter()
        .map(|(name, friction)| match friction {
            Friction::Tresca(bound) => format!("{name} with Tresca friction {}", bound.text()),
            Friction::None => format!("{name} without friction"),
            Friction::Coulomb(mu) => format!("{name} with Coulomb friction {}", mu.text()),
        })
        .collect();
    modelled.push(Decision {
        what: "contact".into(),
        choice: laws.join(", "),
        why: match scene.method.multiplier {
            Multiplier::Biorthogonal => {
                "biorthogonal multipliers: conditions node by node, all other unknowns eliminated".into()
            }
            Multiplier::Stabilised => {
                "stabilised multipliers on a mesh of their own, biorthogonal ones beside them for meshes and estimate"
                    .into()
            }
        },
    });
    let coulomb = sides.iter().any(|(_, friction)| matches!(friction, Friction::Coulomb(_)));
    let (choice, why) = match scene.method.solver {
        Solver::Auto if coulomb => (
            "active sets, fixed point",
            "active sets under Coulomb's law from full stick, else from a fixed point of Tresca problems by interior points",
        ),
        Solver::Auto => ("interior-point", "finds the contact sets on any mesh; active sets make them exact"),
        Solver::Newton => ("newton", "as the scene says"),
        Solver::ActiveSet => ("active-set", "as the scene says"),
        Solver::Uzawa => ("uzawa", "as the scene says: a reference, slow, and only for supported bodies"),
    };
    modelled.push(Decision { what: CONTACT_SOLVER.into(), choice: choice.into(), why: why.into() });
}

/// The mesh of the first step.
pub fn first_mesh(scene: &Scene) -> Mesh {
    let uniform = || Mesh::uniform(&scene.polygon, scene.method.elements, scene.method.degree);
    Layout::first(scene).subdivision.mesh(&scene.polygon).unwrap_or_else(|_| uniform())
}

/// Rigid motions that the held sides leave free.
fn free_of_supports(scene: &Scene) -> Vec<RigidMotion> {
    let mut constraints = Vec::new();
    let edges = scene.polygon.edges();
    for edge in edges {
        if let Condition::Displacement { values, .. } = &scene.sides[edge.side].condition {
            for (value, direction) in values.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                if value.is_some() {
                    constraints.extend([edge.start, edge.end].map(|x| (x, direction)));
                }
            }
        }
    }
    let corners: Vec<[f64; 2]> = edges.iter().map(|e| e.start).collect();
    free_motions(&corners, &constraints)
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let width = self.modelled.iter().chain(&self.left_out).map(|d| d.what.chars().count()).max().unwrap_or(0);
        let lines = |f: &mut std::fmt::Formatter<'_>, decisions: &[Decision]| {
            decisions.iter().try_for_each(|d| writeln!(f, "  {:width$}  {} ({})", d.what, d.choice, d.why))
        };
        writeln!(f, "modelled")?;
        lines(f, &self.modelled)?;
        writeln!(f, "left out")?;
        lines(f, &self.left_out)?;
        let Cost { elements, dofs, memory_bytes, operations } = &self.cost;
        let memory = *memory_bytes as f64 / f64::from(1 << 20);
        write!(
            f,
            "first mesh\n  {elements} elements, {dofs} dofs, {memory:.1} MiB of matrices, {:.2} Gflop",
            operations / 1e9
        )
    }
}
