//! What is refused before it is solved: it would not fit into memory, or has more unknowns than are allowed.

use steklov_model::summary::available_memory_bytes;
use steklov_problem::DataErrorKind::Value;
use steklov_problem::{DataError, Model, Sampling, Scene};

use crate::{Cost, points};

/// The refusal of a scene of this cost: more unknowns or stochastic nodes than the scene allows, or more memory than is left. None if it
/// may be solved, or the system does not tell its memory.
pub fn refused(scene: &Scene, cost: &Cost) -> Option<DataError> {
    too_many_dofs(scene, cost.dofs)
        .or_else(|| too_much_memory(scene, cost.memory_bytes))
        .or_else(|| too_many_points(scene))
}

/// The refusal of a first mesh that is larger than the scene allows; none if it is not.
pub fn too_many_dofs(scene: &Scene, dofs: usize) -> Option<DataError> {
    if dofs <= scene.method.max_dofs() {
        return None;
    }
    let message = format!("the first mesh has {dofs} dofs, more than method.max_dofs = {}", scene.method.max_dofs());
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
    Some(DataError::at(Value, &keys, message, help))
}

/// The refusal of a first mesh or a grid that does not fit into the memory that is left; none if it does, or the system does not tell.
fn too_much_memory(scene: &Scene, needed: u64) -> Option<DataError> {
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    if let Some(left) = scene.method.memory.filter(|left| needed > *left) {
        let message =
            format!("the first mesh needs about {:.1} GiB of memory, and {:.1} GiB are left", gib(needed), gib(left));
        let keys = [vec!["method", "elements"], vec!["method", "degree"], vec!["body", "corners"]];
        let help = "ask for fewer elements or a lower degree; with method.max_dofs given it is tried all the same";
        return Some(DataError::at(Value, &keys, message, help));
    }
    let available = available_memory_bytes().filter(|bytes| scene.body().grid.is_some() && needed > *bytes)?;
    let message =
        format!("the grid needs about {:.1} GiB of memory, and {:.1} GiB are left", gib(needed), gib(available));
    let help = "take fewer cells; or model = \"msfem\" with coarse cells of some 16 by 16 fine ones, which are solved one by one";
    Some(DataError::at(Value, &[vec!["grid"]], message, help))
}

/// Bytes that storing the basis of a grid takes for each fine unknown: its rows of K and P, and copies on their way into the file.
const STORED: u64 = 1000;

/// The refusal of a basis that cannot be stored; none if it can, or the system does not tell.
pub fn too_large_basis(scene: &Scene) -> Option<DataError> {
    let grid = scene.body().grid.as_ref().filter(|_| scene.is_multiscale())?;
    let needed = 2 * STORED * grid.cells().iter().map(|n| *n as u64).product::<u64>();
    let available = available_memory_bytes().filter(|bytes| needed > *bytes)?;
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    let message =
        format!("--save basis needs about {:.1} GiB of memory, and {:.1} GiB are left", gib(needed), gib(available));
    Some(DataError::at(Value, &[vec!["grid"]], message, "take fewer cells, or leave basis out of --save"))
}

/// The refusal of more stochastic nodes than are allowed; none if there are fewer.
fn too_many_points(scene: &Scene) -> Option<DataError> {
    let random = scene.random.as_ref()?;
    let (count, most) = (points(scene, random), random.stochastic.max_nodes);
    if random.stochastic.method == Sampling::MonteCarlo || count <= most as f64 {
        return None;
    }
    let count = match count {
        f64::INFINITY => "far too many".to_owned(),
        count if count < 1e15 => count.to_string(),
        count => format!("{count:e}"),
    };
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
    Some(DataError::at(Value, &[&keys[..], &[vec!["stochastic"], vec!["random"]]].concat(), message, help))
}
