//! The smallest model that can answer a scene, chosen before anything is solved.
//!
//! ```
//! use steklov_plan::plan;
//! use steklov_plan::steklov_problem::steklov_bem_operators::{Loop, Polygon};
//! use steklov_plan::steklov_problem::steklov_elastic::{Material, Plane};
//! use steklov_plan::steklov_problem::{Condition, Scene};
//!
//! let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
//! let block = Polygon::new(Loop::straight(corners, sides), vec![])?;
//! let mut scene = Scene::new(block, Material::new(200.0, 0.3, Plane::Strain)?);
//! scene.problem.sides[0].condition = Condition::held();
//! scene.method.elements = Some(48);
//! scene.method.degree = 2;
//!
//! // n = 2 · 48 · p unknowns; V, K and W are 8 n² bytes each, and 24 n² (1/p + 1/p²) are for the estimate
//! let plan = plan(&scene);
//! assert_eq!((plan.model.as_str(), plan.cost.elements, plan.cost.dofs), ("bem", 48, 192));
//! assert_eq!(plan.cost.memory_bytes, 24 * 192 * 192 * 7 / 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod explain;
mod grid;
mod random;
mod refuse;
mod supports;

// the crates whose types appear in the interface
pub use {steklov_model, steklov_problem};

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{CutPlan, Mesh};
use steklov_contact::{MultiplierDegree, MultiplierMesh};
use steklov_coupling::Radiation;
use steklov_elastic::Plane;
use steklov_model::estimate::error_estimate::is_estimated;
use steklov_model::mesh::layout::{Layout, Sizes};
use steklov_model::run::memory::{Lack, memory_bytes};
use steklov_problem::{
    Drawn, Friction, Interface, Law, MULTIPLIER_MESHES, Method, Multiplier, Refine, Scene, Solver, facets,
};

/// The modelled parts with reasons, the parts left out, and the cost. A pure function of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Discretisation: "bem", "fem", "msfem", "fem-bem" or "msfem-bem".
    pub model: String,
    /// The modelled parts.
    pub modelled: Vec<Decision>,
    /// The parts left out.
    pub left_out: Vec<Decision>,
    /// The cost of the first mesh.
    pub cost: Cost,
}

/// The subject of the decision about the solver of contact.
const CONTACT_SOLVER: &str = "contact solver";

/// One choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// The subject of the decision.
    pub what: String,
    /// The choice.
    pub choice: String,
    /// The reason.
    pub why: String,
}

/// Size and cost of the first mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Boundary elements, or cells of the grid: coarse ones of multiscale elements.
    pub elements: usize,
    /// Displacement unknowns, held ones included.
    pub dofs: usize,
    /// Bytes of the matrices that are in memory at once.
    pub memory_bytes: u64,
    /// Floating point operations of the linear algebra.
    pub operations: f64,
}

pub use explain::explain;
pub use random::points;
pub use refuse::{refused, too_large_basis, too_many_dofs};

/// Chooses the model of a scene.
pub fn plan(scene: &Scene) -> Plan {
    plan_with_mesh(scene).0
}

/// The plan of a scene, and of boundary elements the first mesh: a run that begins with it does not look for cuts again.
pub fn plan_with_mesh(scene: &Scene) -> (Plan, Option<Layout>) {
    let (mut plan, layout) = match scene.is_on_grid() {
        true => (grid::plan(scene), None),
        false => {
            let (plan, layout) = boundary_plan(scene);
            (plan, Some(layout))
        }
    };
    plan.left_out.extend(scene.unused.iter().map(|name| {
        let (what, why) = match scene.parameters.contains_key(name) {
            true => ("parameter", "no expression uses it"),
            false => ("random input", "no datum uses it"),
        };
        Decision { what: what.into(), choice: name.clone(), why: why.into() }
    }));
    (plan, layout)
}

/// The subject of the decision when memory ends the refinement.
pub const NEXT_MESH: &str = "next mesh";

/// The subject of the decision about the moduli of a body on a grid.
pub const MODULI: &str = "Young's modulus";
/// The decision about Poisson's ratios that differ from cell to cell.
pub const RATIOS: &str = "Poisson's ratio";

/// The decision about the mesh for which memory is too small.
pub fn without_memory(lack: Lack) -> Decision {
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    let why = format!(
        "memory is the limit: its {} dofs need about {:.2} GiB, and {:.2} GiB were left; a given method.max_dofs \
         is tried whatever the memory",
        lack.dofs,
        gib(lack.needed),
        gib(lack.left)
    );
    Decision { what: NEXT_MESH.into(), choice: "none".into(), why }
}

/// The decision about the largest size of meshes.
pub fn largest_mesh(scene: &Scene) -> Decision {
    let Method { max_dofs, memory, .. } = scene.method;
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    let why = match (memory, max_dofs) {
        (_, Some(_)) => "method.max_dofs, whatever the memory".to_owned(),
        (None, None) => "method.max_dofs is not given".to_owned(),
        (Some(left), None) => format!(
            "method.max_dofs is not given; or fewer, where matrices would need more than the {:.1} GiB of memory that \
             are left now, {} dofs without an estimate, fewer with one",
            gib(left),
            (left as f64 / 24.0).sqrt() as u64
        ),
    };
    Decision { what: "largest mesh".into(), choice: format!("{} dofs", scene.method.max_dofs()), why }
}

/// The plane assumption in words.
pub(crate) fn plane(scene: &Scene) -> &'static str {
    match scene.body().material().plane {
        Plane::Strain => "plane strain",
        Plane::Stress => "plane stress",
    }
}

/// The plan of boundary elements, and the first mesh.
fn boundary_plan(scene: &Scene) -> (Plan, Layout) {
    let method = &scene.method;
    let (layout, planned) = Layout::planned(scene);
    let dofs = layout.dofs();
    let plane = match scene.body().material().plane {
        Plane::Strain => "plane strain",
        Plane::Stress => "plane stress, as plane strain with E(1+2ν)/(1+ν)² and ν/(1+ν)",
    };
    let mut modelled = vec![
        discretisation(scene),
        decision("plane", plane, "as the scene says"),
        elements(scene, &layout),
        degree(scene, &layout),
        refinement(method),
        decision(
            "length in log(L/r)",
            length_of_logarithm(scene, &layout),
            "the diameter keeps the single layer matrix positive definite at any size",
        ),
    ];
    modelled.extend(polygons_for_curves(scene));
    modelled.extend(scene.problem.joints().map(|interface| joint(scene, interface)));
    let mut left_out = Vec::new();
    cuts(&layout, planned, &mut modelled, &mut left_out);
    contact(scene, &mut modelled, &mut left_out);
    far_away(scene, &mut modelled, &mut left_out);
    supports::decide(scene, &mut modelled);
    body_forces(scene, &mut modelled, &mut left_out);
    random::decide(scene, &mut modelled, &mut left_out);
    let why = match scene.body().grid {
        Some(_) => {
            "the scene has one, but the material is the same everywhere: model = \"fem\" or \"msfem\" would use it"
        }
        None => "the material is the same everywhere",
    };
    left_out.push(decision("grid in the body", "none", why));
    let estimated = is_estimated(scene, dofs);
    if estimated {
        modelled.push(decision(
            "error estimate",
            "spaces of one degree more",
            "bubbles and top tractions on every element: indicators, and the energy of what they add",
        ));
    } else {
        left_out.push(decision(
            "error estimate",
            "none",
            "one large mesh: it would take several times the time and memory of the solution; any other refine has one",
        ));
    }
    (Plan { model: "bem".into(), modelled, left_out, cost: cost(scene, &layout, estimated) }, layout)
}

/// The length in the logarithm of the kernel.
fn length_of_logarithm(scene: &Scene, layout: &Layout) -> String {
    let outline = &scene.problem.outline;
    match layout.subdivision.mesh(outline) {
        _ if layout.cuts.is_some() => "that of each subdomain".to_owned(),
        Ok(mesh) => mesh.diameter().to_string(),
        Err(_) => outline.diameter().to_string(),
    }
}

fn decision(what: &str, choice: impl Into<String>, why: impl Into<String>) -> Decision {
    Decision { what: what.into(), choice: choice.into(), why: why.into() }
}

/// The decision about boundary elements and their unknowns.
fn discretisation(scene: &Scene) -> Decision {
    let (choice, why) = match (scene.is_inclusion(), scene.is_cavity()) {
        (true, _) => (
            "boundary elements inside and outside",
            "body and medium are homogeneous: unknowns where they meet only, the fields of both follow exactly",
        ),
        (false, false) => {
            ("boundary elements", "one homogeneous material: unknowns on the boundary only, the inside follows exactly")
        }
        (false, true) => (
            "boundary elements of the unbounded medium",
            "unknowns on the boundary of the holes only: the medium is neither cut off nor meshed",
        ),
    };
    decision("discretisation", choice, why)
}

/// The decision about the refinement of the mesh.
fn refinement(method: &Method) -> Decision {
    let theta = |auto: f64| format!("marks θ = {} of the squared error", method.marking.unwrap_or(auto));
    let (choice, why) = match method.refine {
        Refine::Hp => (
            "hp",
            format!(
                "{}; cuts towards corners, kinks of the data and ends of contact and stick, raises degrees elsewhere",
                theta(0.95)
            ),
        ),
        Refine::HpDecay => {
            ("hp-decay", format!("{}; degree or halving by the decay of Legendre coefficients", theta(0.5)))
        }
        Refine::H => ("h", format!("{}; halves", theta(0.5))),
        Refine::UniformH => ("uniform-h", "all elements are halved in each step".to_owned()),
        Refine::UniformP => ("uniform-p", "all degrees rise by one in each step".to_owned()),
        Refine::None => ("none", "one mesh is solved".to_owned()),
    };
    decision("refinement", choice, why)
}

/// The decision about an interface: the parts that it covers, and the side that carries its multipliers.
fn joint(scene: &Scene, interface: &Interface) -> Decision {
    let problem = &scene.problem;
    let names = |sides: &[usize]| sides.iter().map(|&s| problem.sides[s].name.as_str()).collect::<Vec<_>>().join(", ");
    let law = match &interface.law {
        Law::Tied(_) => "tied",
        Law::Contact(contact) => match contact.friction {
            Friction::None => "contact without friction",
            Friction::Tresca(_) => "contact with Tresca friction",
            Friction::Coulomb(_) => "contact with Coulomb friction",
        },
    };
    let spans = problem.spans(interface);
    let length: f64 = spans.iter().map(|span| problem.span_length(span)).sum();
    let looks = spans.iter().flat_map(|span| {
        let at = |k: usize| span.s[0] + (span.s[1] - span.s[0]) * (k as f64 + 0.5) / 64.0;
        (0..64).filter_map(move |k| problem.seen(interface, span.edge, at(k)))
    });
    let (low, high) = looks.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), seen| {
        (low.min(seen.distance), high.max(seen.distance))
    });
    let small = |d: f64| if d.abs() < 1e-12 * problem.outline.diameter() { 0.0 } else { d };
    let distance = match (small(low), small(high)) {
        (0.0, 0.0) => "they touch".to_owned(),
        (low, high) if matches!(interface.law, Law::Tied(_)) => {
            let near = problem.coincidence(interface);
            format!("{low:.3e} to {high:.3e} apart, which is nothing up to {near:.1e}")
        }
        (low, high) => format!("{low:.3e} to {high:.3e} apart"),
    };
    let (own, other) = (names(&interface.sides), names(problem.facing_sides(interface)));
    let nothing = match problem.facing_nothing(interface).as_slice() {
        [] => String::new(),
        sides => format!("; nothing faces {}", names(sides)),
    };
    Decision {
        what: "interface".into(),
        choice: format!("{law} of {own} and {other}"),
        why: format!(
            "{own} carries the multipliers and sees the other side over a length of {length:.6}; {distance}{nothing}"
        ),
    }
}

/// Adds the decisions about the forces on the bodies.
fn body_forces(scene: &Scene, modelled: &mut Vec<Decision>, left_out: &mut Vec<Decision>) {
    let several = scene.problem.has_several_bodies();
    let before = modelled.len();
    for body in &scene.problem.bodies {
        let Some([x, y]) = body.force.as_ref().filter(|_| body.force_gradient().is_some()) else { continue };
        let what = if several { format!("body force of {}", body.name) } else { "body force".to_owned() };
        let (choice, form) = match body.constant_force() {
            Some([x, y]) => (format!("({x}, {y})"), "constant"),
            None => (format!("({:?}, {:?})", x.text(), y.text()), "affine in x and y"),
        };
        modelled.push(decision(&what, choice, format!("{form}: carried by a particular solution on the boundary")));
    }
    if modelled.len() == before {
        left_out.push(decision("body force", "none", "the scene has none"));
    }
}

/// The degrees of the first mesh.
fn degree(scene: &Scene, layout: &Layout) -> Decision {
    let least = scene.method.degree;
    let degrees = layout.subdivision.edges.iter().flatten().map(|piece| piece.degree);
    match degrees.max().filter(|most| *most > least) {
        Some(most) => {
            let choice = format!("{least} to {most} for displacements, one less for tractions");
            decision(
                "degree",
                choice,
                "how far the solution continues beyond curves and free edges, into holes, decides",
            )
        }
        None => {
            let choice = format!("{least} for displacements, {} for tractions", least - 1);
            decision("degree", choice, "as the scene says")
        }
    }
}

/// Adds the decision about cuts: how many subdomains, and the cost of a mesh at the wanted error without cuts and with them.
fn cuts(layout: &Layout, planned: Result<CutPlan, String>, modelled: &mut Vec<Decision>, left_out: &mut Vec<Decision>) {
    const WHAT: &str = "subdomains";
    match planned {
        Err(why) => left_out.push(decision(WHAT, "none", why)),
        Ok(plan) => {
            let ([uncut, largest, skeleton], [before, after]) = (plan.unknowns, plan.cost);
            let gigabytes = plan.bytes.map(|bytes| bytes / 1e9);
            let why = format!(
                "a mesh at the wanted error has about {uncut} unknowns without cuts; with them at most {largest} in a subdomain and \
                 {skeleton} on cuts, {:.0} times fewer operations, {:.3} GB of matrices for {:.3} GB; on the first mesh {} on cuts",
                before / after,
                gigabytes[1],
                gigabytes[0],
                layout.dofs_on_cuts(),
            );
            let choice =
                format!("{}, {} of them different, along {} lines", plan.subdomains, plan.different, plan.lines.len());
            modelled.push(decision(WHAT, choice, why));
        }
    }
}

/// The cost of the first mesh of boundary elements.
fn cost(scene: &Scene, layout: &Layout, estimated: bool) -> Cost {
    let of = |[elements, dofs]: [usize; 2]| {
        let (n, x) = (dofs as f64, if estimated { 2.0 * elements as f64 } else { 0.0 });
        let own = n * n * (n * (1.0 / 3.0 + 1.0 + 1.0 + 1.0 / 3.0) + 6.0 * x);
        // the medium has matrices of its own, but one factorisation of the sum
        if scene.is_inclusion() { own + n * n * (n * (1.0 / 3.0 + 1.0 + 1.0) + 6.0 * x) } else { own }
    };
    let Sizes { pieces, fronts } = layout.sizes(&scene.problem);
    let of_fronts: f64 = fronts.into_iter().map(|n| (n as f64).powi(3) / 3.0).sum();
    Cost {
        elements: layout.subdivision.elements(),
        dofs: layout.dofs(),
        memory_bytes: memory_bytes(scene, layout),
        operations: of_fronts + pieces.into_iter().map(of).sum::<f64>(),
    }
}

/// Adds the decisions about the far field of an unbounded medium.
pub(crate) fn far_away(scene: &Scene, modelled: &mut Vec<Decision>, left_out: &mut Vec<Decision>) {
    let (Some(far), Some(radiation)) = (scene.far(), scene.problem.radiation_of_medium()) else { return };
    let (choice, why) = match radiation {
        Radiation::Decaying => (
            "the displacement decays",
            "with a net force it grows as log(L/r), and L, the diameter of the boundary, selects its constant",
        ),
        Radiation::Bounded => (
            "the displacement tends to a constant",
            "the forces on the boundary have no resultant; translations are free unless something holds them",
        ),
    };
    modelled.push(Decision { what: "at infinity".into(), choice: choice.into(), why: why.into() });
    let [xx, yy, xy] = far.remote_stress;
    let decision = match xx == 0.0 && yy == 0.0 && xy == 0.0 {
        true => (left_out, "none".to_owned(), "the scene has none"),
        false => (
            modelled,
            format!("xx {xx}, yy {yy}, xy {xy}"),
            "carried by a particular solution that is zero at the origin; energies are those of what is added to it",
        ),
    };
    let (list, choice, why) = decision;
    list.push(Decision { what: "remote stress".into(), choice, why: why.into() });
}

/// The decisions about straight edges that approximate curves, with the keys for the curves themselves.
fn polygons_for_curves(scene: &Scene) -> Vec<Decision> {
    let told = |found: &steklov_problem::Facets| {
        let side = &scene.problem.sides[found.side].name;
        let key = match found.curve {
            Drawn::Circle { centre: [x, y], radius } => {
                format!("`circle = {{ centre = [{x:.6}, {y:.6}], radius = {radius:.6} }}`")
            }
            Drawn::Arc { centre: [x, y] } => format!("`arcs = {{ {side} = {{ centre = [{x:.6}, {y:.6}] }} }}`"),
            Drawn::Smooth => "`ellipse`, `arcs` or `curves`".to_owned(),
        };
        let choice = format!("{} straight edges, which turn by {:.2}° each", found.edges, found.turn.to_degrees());
        let why = format!("\"{side}\" looks like a curve: each corner is a singular point; {key} has no corners");
        Decision { what: "facets".into(), choice, why }
    };
    facets(&scene.problem.outline).iter().map(told).collect()
}

/// The decision about the number of elements.
fn elements(scene: &Scene, layout: &Layout) -> Decision {
    let (number, wanted) = (layout.subdivision.elements(), scene.first_elements());
    let uniform = Mesh::uniform(&scene.problem.outline, wanted, scene.method.degree).len();
    let why = match (uniform > wanted, number > uniform) {
        _ if layout.cuts.is_some() => {
            "every edge needs one, kinks and jumps of the data and ends of cuts need vertices of their own"
        }
        (false, false) => "equal on an edge, the longest edges first",
        (true, false) => "every straight edge needs one",
        (false, true) => "the data have kinks or jumps, which need vertices of their own",
        (true, true) => "every straight edge needs one, and kinks and jumps of the data need vertices of their own",
    };
    if scene.problem.outline.is_curved() && wanted < scene.method.elements() {
        let why = "an outline with curves: few elements, whose degrees rise; edges and sharp turns need their own";
        return Decision { what: "elements".into(), choice: number.to_string(), why: why.into() };
    }
    let choice = if number > wanted { format!("{number} elements instead of {wanted}") } else { number.to_string() };
    Decision { what: "elements".into(), choice, why: why.into() }
}

pub(crate) fn contact(scene: &Scene, modelled: &mut Vec<Decision>, left_out: &mut Vec<Decision>) {
    let name = |side: usize| scene.problem.sides[side].name.as_str();
    let sides: Vec<(&str, &Friction)> = scene.contacts().map(|(side, c)| (name(side), &c.friction)).collect();
    if sides.is_empty() {
        let (what, choice, why) = ("contact", "no contact solver", "no side is in contact: one linear solve");
        left_out.push(Decision { what: what.into(), choice: choice.into(), why: why.into() });
        idle(&scene.method, left_out);
        return;
    }
    let laws: Vec<String> = sides
        .iter()
        .map(|(name, friction)| match friction {
            Friction::None => format!("{name} without friction"),
            Friction::Tresca(zero) | Friction::Coulomb(zero) if zero.constant() == Some(0.0) => {
                format!("{name} without friction, which is given as 0")
            }
            Friction::Tresca(bound) => format!("{name} with Tresca friction {}", bound.text()),
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
    if scene.method.multiplier == Multiplier::Stabilised {
        modelled.push(multipliers(&scene.method));
    }
    let coulomb = sides.iter().any(|(_, friction)| matches!(friction, Friction::Coulomb(_)));
    let (choice, why) = match scene.method.solver {
        Solver::Auto if coulomb => (
            "active sets, fixed point",
            "active sets under Coulomb's law from full stick, else from a fixed point of Tresca problems by interior points or by way of smaller coefficients",
        ),
        Solver::Auto => ("interior-point", "finds the contact sets on any mesh; active sets make them exact"),
        Solver::Newton => ("newton", "as the scene says"),
        Solver::ActiveSet => ("active-set", "as the scene says"),
        Solver::Uzawa if scene.method.multiplier == Multiplier::Stabilised => {
            ("uzawa", "as the scene says: it rarely reaches its criterion with stabilised multipliers")
        }
        Solver::Uzawa => ("uzawa", "as the scene says: a reference, slow, and only for supported bodies"),
    };
    modelled.push(Decision { what: CONTACT_SOLVER.into(), choice: choice.into(), why: why.into() });
}

/// Adds the settings of contact in a scene without contact.
fn idle(method: &Method, left_out: &mut Vec<Decision>) {
    let asked = [
        ("multipliers", "stabilised", method.multiplier == Multiplier::Stabilised),
        (CONTACT_SOLVER, "method.solver", method.solver != Solver::Auto),
    ];
    for (what, choice, _) in asked.into_iter().filter(|a| a.2) {
        let why = "the scene asks for it, but it has no effect without contact";
        left_out.push(Decision { what: what.into(), choice: choice.into(), why: why.into() });
    }
}

/// The decision about the space of stabilised multipliers and their γ.
fn multipliers(method: &Method) -> Decision {
    let mesh = MULTIPLIER_MESHES.iter().find(|m| m.1 == method.multiplier_mesh).map_or("", |m| m.0);
    let degree = match method.multiplier_degree {
        MultiplierDegree::Relative(_) => "auto".into(),
        MultiplierDegree::Fixed(q) => q.to_string(),
        MultiplierDegree::ContinuousLinear => "continuous".into(),
    };
    let gamma = method.gamma.map_or("auto".into(), |g| format!("{g:e}"));
    let low = method.multiplier_degree == MultiplierDegree::Fixed(0);
    let why = if method.refine == Refine::Hp && (low || matches!(method.multiplier_mesh, MultiplierMesh::Coarser(_))) {
        "as the scene says: hp refines more with a coarser mesh or degree 0, as the multipliers lag behind the displacements"
    } else {
        "as the scene says; auto: the degree of the displacements, half of the critical gamma of each mesh"
    };
    let choice = format!("mesh {mesh}, degree {degree}, gamma {gamma}");
    Decision { what: "multipliers".into(), choice, why: why.into() }
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
