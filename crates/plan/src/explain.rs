//! Errors of the solver, told with the keys of the scene that cause them.

use steklov_bem_operators::BemError;
use steklov_contact::{ContactError, LEAST_GAMMA};
use steklov_coupling::{CouplingError, Radiation};
use steklov_expression::Expression;
use steklov_model::error::SolveError;
use steklov_msfem::MsfemError;
use steklov_problem::DataErrorKind::{Conflict, Geometry, Unsupported, Value};
use steklov_problem::{Condition, Contact, DataError, DataErrorKind, Friction, Scene};
use steklov_stochastic::StochasticError;

/// What is told of an error: its sort, the keys of the scene that it is about, and the remedy.
type Blame<'a> = (DataErrorKind, Vec<Vec<&'a str>>, String);

fn blame<'a>(kind: DataErrorKind, keys: &[&[&'a str]], help: &str) -> Blame<'a> {
    (kind, keys.iter().map(|path| path.to_vec()).collect(), help.to_owned())
}

/// The error with the keys of the scene that it is about, and the remedy.
///
/// # Errors
/// The error itself, if the scene is not to blame: it was interrupted, or its observer failed.
pub fn explain(scene: &Scene, error: SolveError) -> Result<DataError, SolveError> {
    let (kind, keys, help) = match &error {
        SolveError::Data(error) => return Ok((**error).clone()),
        SolveError::Observer(_) | SolveError::Elsewhere | SolveError::Interrupted | SolveError::Outcome { .. } => {
            return Err(error);
        }
        SolveError::Msfem(error) => of_grid(error),
        SolveError::Coupling(error) => of_coupling(error),
        SolveError::Stochastic(error) => of_outcomes(error),
        SolveError::Bem(error) => of_boundary(scene, error),
        SolveError::Contact(error) => of_contact(scene, error),
        SolveError::Incompatible { first, second, component, .. } => {
            let entry = if *component == 'x' { "0" } else { "1" };
            blame(
                Conflict,
                &[&["sides", second, "displacement", entry], &["sides", first, "displacement", entry]],
                "give both sides the same value at their common point, or write \"free\" for this component on one of them",
            )
        }
        SolveError::Loose { .. } => blame(
            Unsupported,
            &[&["interface"], &["sides"]],
            "hold a displacement of these bodies, tie a side, give an interface friction, or balance the loads",
        ),
        SolveError::Thin { .. } => blame(
            Geometry,
            &[&["body", "corners"], &["body"]],
            "take a thicker or a shorter part of the body, hold one of its long sides, or solve it as a beam by other means",
        ),
        SolveError::NotFinite { .. } => {
            (Value, loads(scene), "choose units in which lengths, loads and Young's modulus are nearer to 1".to_owned())
        }
    };
    Ok(DataError::at(kind, &keys, error.to_string(), help))
}

/// A grid that cannot be solved.
fn of_grid(error: &MsfemError) -> Blame<'static> {
    match error {
        MsfemError::Memory { .. } => blame(
            Value,
            &[&["grid"]],
            "take fewer cells, or model = \"msfem\", which never holds the fine grid as one matrix",
        ),
        MsfemError::Singular { .. } => blame(
            Unsupported,
            &[&["material", "cells"], &["sides"]],
            "hold a side against all rigid motions; moduli that differ by more than 1e12 lose all digits",
        ),
        _ => blame(Value, &[&["grid"], &["material"]], "change the grid or the moduli"),
    }
}

/// Loads that a medium cannot carry.
fn unbalanced() -> Blame<'static> {
    blame(
        Unsupported,
        &[&["exterior", "at_infinity"], &["exterior"]],
        "balance the loads, or set at_infinity = \"decaying\" for the displacement that grows as log r",
    )
}

/// Materials of body and medium that are too different.
fn unequal() -> Blame<'static> {
    blame(
        Value,
        &[&["exterior", "young"], &["exterior"]],
        "too few digits are left of so unequal materials: hold or load the softer one alone",
    )
}

/// A medium around a grid.
fn of_coupling(error: &CouplingError) -> Blame<'static> {
    match error {
        CouplingError::Unbalanced { .. } => unbalanced(),
        CouplingError::Outline { .. } => blame(
            Geometry,
            &[&["body", "corners"]],
            "the outer boundary on the grid must be one curve that does not touch itself: take finer cells, or move corners apart",
        ),
        CouplingError::Contrast { .. } | CouplingError::Singular { .. } => unequal(),
        _ => blame(Value, &[&["exterior"]], "change the grid or the materials"),
    }
}

/// Random input.
fn of_outcomes(error: &StochasticError) -> Blame<'static> {
    match error {
        StochasticError::NotCoercive { .. } => blame(
            Unsupported,
            &[&["stochastic", "method"], &["stochastic"]],
            "a modulus that is not affine in its germs couples the nodes, which a body that only contact holds does not allow: set \
             stochastic.method = \"collocation\", or hold a side",
        ),
        _ => blame(
            Value,
            &[&["stochastic"], &["random"]],
            "lower stochastic.degree or elements, or change the random input",
        ),
    }
}

/// Boundary elements.
fn of_boundary<'a>(scene: &'a Scene, error: &BemError) -> Blame<'a> {
    match error {
        BemError::RigidMotion { .. } if scene.is_inclusion() => unbalanced(),
        BemError::StiffnessSingular { .. } if scene.is_inclusion() => unequal(),
        BemError::StiffnessSingular { .. } if scene.body().material().poisson > 0.49999 => blame(
            Value,
            &[&["material", "poisson"]],
            "so near to 1/2 the stiffness drowns in rounding errors: take a smaller ratio, as 0.4999999",
        ),
        BemError::StiffnessSingular { .. } if is_held_by_medium(scene) => blame(
            Value,
            &[&["body", "corners"]],
            "the medium resists all rigid motions: too few digits are left between sides that nearly touch, or of materials or \
             lengths that are too unequal",
        ),
        BemError::RigidMotion { .. } | BemError::StiffnessSingular { .. } => moves(scene),
        _ => shape(),
    }
}

/// A body that moves as a whole.
fn moves(scene: &Scene) -> Blame<'_> {
    if scene.problem.medium().is_some() {
        return blame(
            Unsupported,
            &[&["exterior", "at_infinity"], &["exterior"]],
            "balance the loads, hold a side, or set at_infinity = \"decaying\" for the displacement that grows as log r",
        );
    }
    let help = "hold a side: displacement = [\"0\", \"0\"], \"free\" for a component that may move; or change the loads so that \
                their force and moment vanish or press the body on its obstacle";
    (Unsupported, loads(scene), help.to_owned())
}

/// Corners and sides that numerics cannot take.
fn shape() -> Blame<'static> {
    blame(
        Value,
        &[&["body", "corners"]],
        "look for sides that nearly touch, very acute corners and very small or large lengths",
    )
}

/// Contact.
fn of_contact<'a>(scene: &'a Scene, error: &ContactError) -> Blame<'a> {
    match error {
        ContactError::RigidMotion { motion, .. } if pulls_off(scene, |x| motion.at(x)) => {
            let help = "the loads pull the body off its obstacle, which holds nothing along its normal: a pressure is positive in \
                        compression, a traction has the direction of its force; turn its sign to press the body on its obstacle, or \
                        hold a side: displacement = [\"free\", \"0\"]";
            (Unsupported, loads(scene), help.to_owned())
        }
        ContactError::RigidMotion { resistance, .. } if *resistance > 0.0 || is_coulomb(scene) => {
            let help = "hold this motion, as by displacement = [\"0\", \"free\"] on a side, balance the loads, or raise the friction \
                        bound or coefficient, which is too little for them";
            (Unsupported, friction(scene), help.to_owned())
        }
        ContactError::RigidMotion { .. } | ContactError::NotHeld { .. } => moves(scene),
        ContactError::NotCoercive { .. } => blame(
            Value,
            &[&["method", "solver"]],
            "uzawa is for bodies that are held: set solver = \"newton\", or hold a displacement",
        ),
        ContactError::StabilisationNotCoercive { critical, .. } => {
            let help = format!(
                "set gamma = \"auto\", or a number from {:.4e} to below {critical:.4e}, which depend on the mesh",
                LEAST_GAMMA * critical
            );
            blame(Value, &[&["method", "gamma"], &["method"]], &help)
        }
        ContactError::Inconsistent { .. } => blame(
            Value,
            &[&["method", "degree"], &["method", "elements"], &["method"]],
            "raise method.degree to 2 or more, or ask for more method.elements",
        ),
        ContactError::Supports { remedy, .. } => blame(Value, &[&["interface"], &["sides"]], remedy),
        ContactError::Decomposition { .. } => {
            blame(Value, &[&["material", "young"]], "choose units in which lengths and Young's modulus are nearer to 1")
        }
        _ => shape(),
    }
}

/// Whether a motion leaves the sides in contact along their normals.
fn pulls_off(scene: &Scene, motion: impl Fn([f64; 2]) -> [f64; 2]) -> bool {
    let sides: Vec<usize> = scene.contacts().map(|(side, _)| side).collect();
    let mut edges = scene.problem.outline.edges().iter().filter(|edge| sides.contains(&edge.side)).peekable();
    edges.peek().is_some()
        && edges.all(|edge| {
            let (r, t) = (motion(edge.point(0.5)), edge.tangent(0.5));
            let (along, across) = (r[0] * t[0] + r[1] * t[1], r[1] * t[0] - r[0] * t[1]);
            across > 0.0 && along.abs() < 1e-6 * across
        })
}

/// Whether the medium around a body or a hole resists all rigid motions.
fn is_held_by_medium(scene: &Scene) -> bool {
    scene.problem.radiation_of_medium() == Some(Radiation::Decaying)
}

/// Keys of the friction bounds and coefficients.
fn friction(scene: &Scene) -> Vec<Vec<&str>> {
    let law = |(side, contact): (usize, &Contact)| {
        let law = match contact.friction {
            Friction::None => return None,
            Friction::Tresca(_) => "tresca",
            Friction::Coulomb(_) => "coulomb",
        };
        Some(vec!["sides", &scene.problem.sides[side].name, "contact", "friction", law])
    };
    scene.contacts().filter_map(law).collect()
}

fn is_coulomb(scene: &Scene) -> bool {
    scene.contacts().any(|(_, contact)| contact.friction.coefficient().is_some())
}

/// Keys of what drives the body.
fn loads(scene: &Scene) -> Vec<Vec<&str>> {
    let loaded = |t: &[Expression; 2]| t.iter().any(|t| t.constant() != Some(0.0));
    let mut keys: Vec<_> = scene
        .problem
        .sides
        .iter()
        .filter_map(|side| match &side.condition {
            Condition::Traction(t) | Condition::Displacement { traction: Some(t), .. } if loaded(t) => {
                Some(vec!["sides", &side.name, "traction"])
            }
            Condition::Pressure(_) => Some(vec!["sides", &side.name, "pressure"]),
            _ => None,
        })
        .collect();
    keys.extend([vec!["body_force", "value"], vec!["sides"]]);
    keys
}
