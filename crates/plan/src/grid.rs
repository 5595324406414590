//! The plan of a scene on a grid.

use steklov_elastic::RigidMotion;
use steklov_problem::{
    BasisInput, CellModuli, GridInput, Indicator, Refine, Scene, Surroundings, bounding_box, grid_of,
};

use super::{Cost, Decision, MODULI, Plan, RATIOS, contact, decision, far_away, plane, random};

/// Bytes for the moduli, the fields and the result of a fine cell.
const BYTES_OF_CELL: f64 = 200.0;

/// The plan of a scene on a grid, with or without a medium around the body, and its cost.
pub(crate) fn plan(scene: &Scene) -> Plan {
    let (mut modelled, mut left_out) = (Vec::new(), Vec::new());
    let multiscale = scene.is_multiscale();
    let in_medium = scene.problem.medium().is_some();
    let Some(input) = &scene.body().grid else { unreachable!("a scene without a grid is refused where it is read") };
    modelled.push(discretisation(scene, input));
    modelled.push(decision("plane", plane(scene), "as the scene says"));
    modelled.extend(moduli(scene));
    if multiscale {
        modelled.push(basis(input));
    }
    let conforming = !multiscale || !matches!(input.basis, BasisInput::Oversampled | BasisInput::Periodic);
    modelled.push(refinement(scene, conforming));
    if let Some(around) = scene.surroundings() {
        modelled.extend(medium(scene, around));
        far_away(scene, &mut modelled, &mut left_out);
    }
    contact(scene, &mut modelled, &mut left_out);
    let free = scene.free_of_supports(None);
    modelled.push(if in_medium {
        decision("supports", "none is needed", "the medium holds the body")
    } else if free.is_empty() {
        decision("supports", "hold all rigid motions", "held displacements")
    } else {
        let why = "contact or friction must hold it, or the loads must be balanced";
        decision("supports", format!("leave {} free", RigidMotion::names(&free)), why)
    });
    match &scene.body().force {
        Some([x, y]) => modelled.push(decision(
            "body force",
            format!("({}, {})", x.text(), y.text()),
            if multiscale {
                "integrated on the fine cells; its response inside of coarse cells is added"
            } else {
                "integrated on the cells"
            },
        )),
        None => left_out.push(decision("body force", "none", "the scene has none")),
    }
    random::decide(scene, &mut modelled, &mut left_out);
    if conforming { &mut modelled } else { &mut left_out }.push(estimate(multiscale, conforming));
    if in_medium {
        let (choice, why) = match scene.method.indicator {
            Indicator::Bubble => ("two more degrees of the traction", "on each boundary element for itself"),
            Indicator::Residual => {
                ("residuals", "balance of tractions and equation of the medium: 3 to 10 times the error")
            }
        };
        modelled.push(decision("error of the medium", choice, why));
    }
    Plan { model: scene.model().word().into(), modelled, left_out, cost: cost(scene, input) }
}

/// The decision about the elements.
fn discretisation(scene: &Scene, input: &GridInput) -> Decision {
    let multiscale = scene.is_multiscale();
    let why = match (scene.body().cells(), multiscale) {
        (Some(_), true) => "the modulus differs from cell to cell: local problems make a basis that knows it",
        (Some(_), false) => "the modulus differs from cell to cell",
        (None, _) if scene.body().force_gradient().is_none() && scene.body().force.is_some() => {
            "the body force differs from place to place, and not as a + b*x + c*y"
        }
        (None, _) => "as the scene says; boundary elements would do for one material",
    };
    let [[mx, my], [fx, fy]] = [input.coarse, input.fine];
    if multiscale {
        let choice = format!("multiscale elements, {mx} by {my} coarse cells of {fx} by {fy} fine ones");
        decision("discretisation", choice, why)
    } else {
        decision("discretisation", format!("bilinear elements, {} by {} cells", mx * fx, my * fy), why)
    }
}

/// The decision about the refinement of the grid.
fn refinement(scene: &Scene, conforming: bool) -> Decision {
    match (scene.method.refine, scene.is_multiscale()) {
        (Refine::None, _) => decision("refinement", "none", "one grid is solved"),
        (refine, false) => decision(
            "refinement",
            "uniform-h",
            format!(
                "{}all cells are halved in each step; the moduli stay those of their cells",
                asked(refine, Refine::UniformH)
            ),
        ),
        (refine @ (Refine::UniformH | Refine::UniformP), true) => decision(
            "refinement",
            "uniform-h",
            format!(
                "{}all coarse cells are split in each step, down to the fine ones",
                asked(refine, Refine::UniformH)
            ),
        ),
        (refine, true) if !conforming => decision(
            "refinement",
            "uniform-h",
            format!(
                "{}without an estimate all coarse cells are split in each step, down to the fine ones",
                asked(refine, Refine::H)
            ),
        ),
        (refine, true) => decision(
            "refinement",
            "h",
            format!(
                "{}splits coarse cells, marks \u{3b8} = {} of the squared error; ends where the fine grid's own error outweighs",
                asked(refine, Refine::H),
                scene.method.marking.unwrap_or(steklov_model::grid::MARKING)
            ),
        ),
    }
}

/// The decisions about the medium around the body and its boundary elements.
fn medium(scene: &Scene, around: Surroundings<'_>) -> [Decision; 2] {
    let medium = decision(
        "medium around",
        format!(
            "boundary elements, Young's modulus {}, Poisson's ratio {}",
            around.material.young, around.material.poisson
        ),
        "unbounded: it is neither cut off nor meshed; the inside of the body is eliminated down to where both meet",
    );
    let elements = if scene.method.elements.is_some() {
        let choice = format!("{} or more of degree {}", scene.method.elements(), scene.method.degree);
        decision("boundary elements", choice, "as the scene says; the displacement of the body is projected on them")
    } else {
        let choice = format!("one between each two points of the body's trace, degree {}", scene.method.degree);
        decision(
            "boundary elements",
            choice,
            "they take its displacement as it is; adaptive steps halve them where their error is",
        )
    };
    [medium, elements]
}

/// The decision about the error estimate.
fn estimate(multiscale: bool, conforming: bool) -> Decision {
    if !conforming {
        return decision("error estimate", "none", "the basis does not conform: no residual sees its whole error");
    }
    let (choice, why) = if multiscale {
        (
            "nodal residuals of coarse cells, side bubbles of fine ones",
            "both parts are told apart: that of the coarse cells, and that of the fine grid itself",
        )
    } else {
        ("side bubbles", "residuals against quadratic functions on the sides of cells")
    };
    decision("error estimate", choice, why)
}

/// The note if the requested refinement is not available.
fn asked(refine: Refine, known: Refine) -> &'static str {
    if refine == known { "" } else { "the degree is one; " }
}

/// The decisions about Young's moduli, and about Poisson's ratios that differ.
fn moduli(scene: &Scene) -> Vec<Decision> {
    let Some(cells) = scene.body().cells() else {
        return vec![decision(MODULI, scene.body().material().young.to_string(), "the same in all cells")];
    };
    let told = |what: &str, values: &CellModuli| {
        let text = match values {
            CellModuli::Uniform { low, high, seed } => format!("random in [{low}, {high}], seed {seed}"),
            CellModuli::Table { source, order, .. } => format!("{source}: {}", order.words()),
            CellModuli::Expression(value) => value.text().to_owned(),
        };
        let why = match values.constant() {
            Some(_) => "the same in all cells".to_owned(),
            None => format!("constant in cells of the size {}", cells.size),
        };
        decision(what, text, why)
    };
    std::iter::once(told(MODULI, &cells.young)).chain(cells.poisson.as_ref().map(|p| told(RATIOS, p))).collect()
}

fn basis(input: &GridInput) -> Decision {
    let (word, why) = match input.basis {
        BasisInput::Linear => ("linear", "one component linear on the edges of coarse cells, the other one dropped"),
        BasisInput::Coupled => ("coupled", "linear on the edges of coarse cells; the best of all such bases"),
        BasisInput::Oscillatory => ("oscillatory", "follows the moduli along the edges of coarse cells"),
        BasisInput::Oversampled => ("oversampled", "from larger cells: less resonance, but it does not conform"),
        BasisInput::Periodic => ("periodic", "for periodic media and their homogenised tensor; it does not conform"),
        BasisInput::Q1 => ("q1", "coarse bilinear elements, to compare with"),
    };
    decision("basis", word, why)
}

/// Size and cost of the first grid. A factor on a grid of n unknowns has about 8.5 n log₂ n entries and takes 90 n^(3/2)
/// operations.
fn cost(scene: &Scene, input: &GridInput) -> Cost {
    let unknowns = |cells: [usize; 2]| 2 * (cells[0] + 1) * (cells[1] + 1);
    let [fine, coarse] = match grid_of(scene) {
        Ok(grid) => {
            let inside = |cells: [usize; 2], step: [usize; 2]| {
                let mut nodes = std::collections::HashSet::new();
                let mut count = 0;
                for i in 0..cells[0] {
                    for j in (0..cells[1]).filter(|&j| grid.inside(i * step[0], j * step[1])) {
                        count += 1;
                        nodes.extend([[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]);
                    }
                }
                (count, 2 * nodes.len())
            };
            let fine = (grid.body_cells().count(), grid.dofs());
            [fine, if scene.is_multiscale() { inside(input.coarse, input.fine) } else { fine }]
        }
        Err(_) => [input.cells(), input.coarse].map(|cells| (cells[0] * cells[1], unknowns(cells))),
    };
    let factor = |n: f64| 8.0 * 8.5 * n * n.log2();
    let solve = |n: f64| 90.0 * n.powf(1.5);
    let (cells, n) = (fine.0 as f64, coarse.1 as f64);
    let local = if scene.is_multiscale() {
        let [m, k] = input.fine.map(|m| m as f64);
        // kept bases, and the local problem of each of two threads: structure, factor, fields
        let one = 2.0 * m * k;
        let local = 400.0 * m * k + 2.0 * (factor(one.max(2.0)) + 400.0 * one);
        (coarse.0 as f64 * 128.0 * (m + 1.0) * (k + 1.0)).min(128e6) + local
    } else {
        0.0
    };
    let basis =
        if scene.is_multiscale() { 2e3 * (input.fine[0] * input.fine[1]) as f64 * coarse.0 as f64 } else { 0.0 };
    // V, K, W, their factors, and the reduced stiffness
    let boundary = if scene.problem.medium().is_some() { interface_unknowns(scene, input) } else { 0.0 };
    Cost {
        elements: coarse.0,
        dofs: coarse.1,
        memory_bytes: (factor(n) + 300.0 * n + BYTES_OF_CELL * cells + local + 56.0 * boundary.powi(2)) as u64,
        operations: solve(n) + basis * (input.fine[0] as f64).max(1.0) + 2.7 * boundary.powi(3),
    }
}

/// Unknowns of the boundary elements of the medium around the body.
fn interface_unknowns(scene: &Scene, input: &GridInput) -> f64 {
    let degree = 2 * scene.method.degree;
    if scene.method.elements.is_some() {
        return (degree * scene.method.elements()) as f64;
    }
    let cells = if scene.is_multiscale() { input.coarse } else { input.cells() };
    let (_, size) = bounding_box(&scene.problem.outline);
    let sides = scene.interface().map(|(_, edge)| {
        let k = usize::from(edge.start[0] == edge.end[0]);
        (edge.length() / size[k] * cells[k] as f64).round()
    });
    degree as f64 * sides.sum::<f64>()
}
