//! Errors of the solver, told with the text of the scene that causes them.

use steklov_bem_operators::BemError;
use steklov_contact::{ContactError, LEAST_GAMMA};
use steklov_coupling::{CouplingError, Radiation};
use steklov_expression::Expression;
use steklov_model::solve::SolveError;
use steklov_model::summary::available_memory_bytes;
use steklov_msfem::MsfemError;
use steklov_problem::{Condition, DataError, DataErrorKind, Friction, Model, Sampling, Scene};
use steklov_stochastic::StochasticError;

/// The error at its place in the scene; `Err` gives it back if no text of the scene is to blame.
pub(crate) fn explain(scene: &Scene, error: SolveError) -> Result<DataError, SolveError> {
    use DataErrorKind::{Conflict, Geometry, Unsupported, Value};
    let message = error.to_string();
    let at = |kind, keys: &[Vec<&str>], help: &str| Ok(DataError::at(kind, keys, message.clone(), help));
    let unbalanced = || {
        let keys = [vec!["exterior", "at_infinity"], vec!["exterior"]];
        at(
            Unsupported,
            &keys,
            "balance the loads, or set at_infinity = \"decaying\" for the displacement that grows as log r",
        )
    };
    let unequal = || {
        let keys = [vec!["exterior", "young"], vec!["exterior"]];
        at(Value, &keys, "too few digits are left of so unequal materials: hold or load the softer one alone")
    };
    match &error {
        SolveError::Bem(BemError::RigidMotion { .. }) if scene.is_inclusion() => unbalanced(),
        SolveError::Bem(BemError::StiffnessSingular { .. }) if scene.is_inclusion() => unequal(),
        SolveError::Data(error) => Ok((**error).clone()),
        SolveError::Observer(_) | SolveError::Interrupted | SolveError::Outcome { .. } => Err(error),
        SolveError::Msfem(error) => match **error {
            MsfemError::Memory { .. } => at(
                Value,
                &[vec!["grid"]],
                "take fewer cells, or model = \"msfem\", which never holds the fine grid as one matrix",
            ),
            MsfemError::Singular { .. } => at(
                Unsupported,
                &[vec!["material", "cells"], vec!["sides"]],
                "hold a side against all rigid motions; moduli that differ by more than 1e12 lose all digits",
            ),
            _ => at(Value, &[vec!["grid"], vec!["material"]], "change the grid or the moduli"),
        },
        SolveError::Coupling(error) => match **error {
            CouplingError::Unbalanced { .. } => unbalanced(),
            CouplingError::Outline { .. } => at(
                Geometry,
                &[vec!["body", "corners"]],
                "the outer boundary on the grid must be one curve that does not touch itself: take finer cells, or move corners apart",
            ),
            CouplingError::Contrast { .. } | CouplingError::Singular { .. } => unequal(),
            _ => at(Value, &[vec!["exterior"]], "change the grid or the materials"),
        },
        SolveError::Stochastic(StochasticError::NotCoercive { .. }) => at(
            Unsupported,
            &[vec!["stochastic", "method"], vec!["stochastic"]],
            "a modulus that is not affine in its germs couples the nodes, which a body that only contact holds does not allow: set \
             stochastic.method = \"collocation\", or hold a side",
        ),
        SolveError::Stochastic(_) => at(
            Value,
            &[vec!["stochastic"], vec!["random"]],
            "lower stochastic.degree or elements, or change the random input",
        ),
        SolveError::Incompatible { first, second, component, .. } => {
            let entry = if *component == 'x' { "0" } else { "1" };
            at(
                Conflict,
                &[vec!["sides", second, "displacement", entry], vec!["sides", first, "displacement", entry]],
                "give both sides the same value at their common point, or write \"free\" for this component on one of them",
            )
        }
        SolveError::Contact(ContactError::RigidMotion { resistance, .. }) if *resistance > 0.0 || is_coulomb(scene) => {
            at(
                Unsupported,
                &friction(scene),
                "raise the friction bound or coefficient, balance the loads, or hold this motion: displacement = [\"0\", \"free\"] on a side",
            )
        }
        SolveError::NotFinite { .. } => {
            at(Value, &loads(scene), "choose units in which lengths, loads and Young's modulus are nearer to 1")
        }
        SolveError::Bem(BemError::StiffnessSingular { .. }) if scene.material.poisson > 0.49999 => at(
            Value,
            &[vec!["material", "poisson"]],
            "so near to 1/2 the stiffness drowns in rounding errors: take a smaller ratio, as 0.4999999",
        ),
        SolveError::Bem(BemError::StiffnessSingular { .. }) if is_held_by_medium(scene) => at(
            Value,
            &[vec!["body", "corners"]],
            "the medium resists all rigid motions: too few digits are left between sides that nearly touch, or of materials or \
             lengths that are too unequal",
        ),
        SolveError::Bem(BemError::RigidMotion { .. } | BemError::StiffnessSingular { .. })
        | SolveError::Contact(ContactError::RigidMotion { .. } | ContactError::NotHeld { .. })
            if scene.exterior.is_some() =>
        {
            at(
                Unsupported,
                &[vec!["exterior", "at_infinity"], vec!["exterior"]],
                "balance the loads, hold a side, or set at_infinity = \"decaying\" for the displacement that grows as log r",
            )
        }
        SolveError::Bem(BemError::RigidMotion { .. } | BemError::StiffnessSingular { .. })
        | SolveError::Contact(ContactError::RigidMotion { .. } | ContactError::NotHeld { .. }) => at(
            Unsupported,
            &loads(scene),
            "hold a side: displacement = [\"0\", \"0\"], \"free\" for a component that may move; or change the loads so that \
             their force and moment vanish or press the body on its obstacle",
        ),
        SolveError::Contact(ContactError::NotCoercive { .. }) => at(
            Value,
            &[vec!["method", "solver"]],
            "uzawa is for bodies that are held: set solver = \"newton\", or hold a displacement",
        ),
        SolveError::Contact(ContactError::StabilisationNotCoercive { critical, .. }) => {
            let help = format!(
                "set gamma = \"auto\", or a number from {:.4e} to below {critical:.4e}, which depend on the mesh",
                LEAST_GAMMA * critical
            );
            at(Value, &[vec!["method", "gamma"], vec!["method"]], &help)
        }
        SolveError::Contact(ContactError::Inconsistent { .. }) => at(
            Value,
            &[vec!["method", "degree"], vec!["method", "elements"], vec!["method"]],
            "raise method.degree to 2 or more, or ask for more method.elements",
        ),
        SolveError::Contact(ContactError::Decomposition { .. }) => {
            at(Value, &[vec!["material", "young"]], "choose units in which lengths and Young's modulus are nearer to 1")
        }
        SolveError::Bem(_) | SolveError::Contact(_) => at(
            Value,
            &[vec!["body", "corners"]],
            "look for sides that nearly touch, very acute corners and very small or large lengths",
        ),
    }
}

/// Whether the medium around a body or a hole resists all rigid motions.
fn is_held_by_medium(scene: &Scene) -> bool {
    scene.exterior.as_ref().is_some_and(|exterior| exterior.radiation == Radiation::Decaying)
}

/// The refusal of a first mesh that is larger than the scene allows; none if it is not.
pub(crate) fn too_many_dofs(scene: &Scene, dofs: usize) -> Option<DataError> {
    if dofs <= scene.method.max_dofs {
        return None;
    }
    let message = format!("the first mesh has {dofs} dofs, more than method.max_dofs = {}", scene.method.max_dofs);
    let (keys, help) = match scene.model() {
        Model::Fem | Model::FemBem => (
            vec![vec!["method", "max_dofs"], vec!["grid"]],
            "set method.max_dofs higher, take fewer cells, or model = \"msfem\", whose unknowns are those of the coarse cells",
        ),
        Model::Msfem | Model::MsfemBem => {
            (vec![vec!["method", "max_dofs"], vec!["grid"]], "set method.max_dofs higher, or take fewer coarse cells")
        }
        _ => (
            vec![
                vec!["method", "max_dofs"],
                vec!["method", "elements"],
                vec!["method", "degree"],
                vec!["body", "corners"],
            ],
            "allow more dofs, or ask for fewer elements or a lower degree",
        ),
    };
    let message = if scene.is_on_grid() { message.replace("first mesh", "first grid") } else { message };
    Some(DataError::at(DataErrorKind::Value, &keys, message, help))
}

/// The refusal of a first mesh or a grid that does not fit into the memory that is left; none if it does, or the system does not tell.
pub(crate) fn too_much_memory(scene: &Scene, needed: u64) -> Option<DataError> {
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    if let Some(left) = scene.method.memory.filter(|left| needed > *left) {
        let message =
            format!("the first mesh needs about {:.1} GiB of memory, and {:.1} GiB are left", gib(needed), gib(left));
        let keys = [vec!["method", "elements"], vec!["method", "degree"], vec!["body", "corners"]];
        let help = "ask for fewer elements or a lower degree; with method.max_dofs given it is tried all the same";
        return Some(DataError::at(DataErrorKind::Value, &keys, message, help));
    }
    let available = available_memory_bytes().filter(|bytes| scene.grid.is_some() && needed > *bytes)?;
    let message =
        format!("the grid needs about {:.1} GiB of memory, and {:.1} GiB are left", gib(needed), gib(available));
    let help = "take fewer cells; or model = \"msfem\" with coarse cells of some 16 by 16 fine ones, which are solved one by one";
    Some(DataError::at(DataErrorKind::Value, &[vec!["grid"]], message, help))
}

/// The refusal of more stochastic nodes than are allowed; none if there are fewer.
pub(crate) fn too_many_points(scene: &Scene) -> Option<DataError> {
    let random = scene.random.as_ref()?;
    let (count, most) = (steklov_plan::points(random), random.stochastic.max_nodes);
    if random.stochastic.method == Sampling::MonteCarlo || count <= most as f64 {
        return None;
    }
    let count = if count < 1e15 { count.to_string() } else { format!("{count:e}") };
    let germs = random.germs.len();
    let message = format!("{germs} germ(s) make {count} stochastic nodes, more than stochastic.max_nodes = {most}");
    let (keys, help) = match random.stochastic.method {
        Sampling::Sparse => {
            (["max_nodes", "level"], "take a lower level, fewer modes, method = \"monte-carlo\", or allow more nodes")
        }
        _ => (
            ["max_nodes", "degree"],
            "take a lower degree, fewer modes, method = \"sparse\" or \"monte-carlo\", or allow more nodes",
        ),
    };
    let keys = keys.map(|key| vec!["stochastic", key]);
    Some(DataError::at(
        DataErrorKind::Value,
        &[&keys[..], &[vec!["stochastic"], vec!["random"]]].concat(),
        message,
        help,
    ))
}

/// Keys of the friction bounds and coefficients.
fn friction(scene: &Scene) -> Vec<Vec<&str>> {
    let law = |c: &Condition| match c {
        Condition::Contact { friction: Friction::Tresca(_), .. } => Some("tresca"),
        Condition::Contact { friction: Friction::Coulomb(_), .. } => Some("coulomb"),
        _ => None,
    };
    let sides = scene.sides.iter().filter_map(|s| Some((&s.name, law(&s.condition)?)));
    sides.map(|(name, law)| vec!["sides", name, "contact", "friction", law]).collect()
}

fn is_coulomb(scene: &Scene) -> bool {
    scene.sides.iter().any(|s| matches!(s.condition, Condition::Contact { friction: Friction::Coulomb(_), .. }))
}

/// Keys of what drives the body.
fn loads(scene: &Scene) -> Vec<Vec<&str>> {
    let loaded = |t: &[Expression; 2]| t.iter().any(|t| t.constant() != Some(0.0));
    let mut keys: Vec<_> = scene
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
