//! The JSON object of `solve --json` and `show --json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use steklov_problem::Units;

use crate::doubt::Doubt;
use crate::estimators::Estimators;
use crate::quantities::Quantities;

/// A result in numbers. Lengths, stresses and forces per thickness in the units of the scene.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Title of the scene.
    pub title: String,
    /// Names of the units of the scene; left out if they have none.
    #[serde(default, skip_serializing_if = "Units::are_unknown")]
    pub units: Units,
    /// Discretisation: "bem", "fem", "msfem", "fem-bem" or "msfem-bem".
    pub model: String,
    /// The result file.
    pub file: String,
    /// Whether the run reached its aim.
    pub converged: bool,
    /// solved, tolerance, max_dofs, max_steps, max_nodes, fine_grid, roundoff, solver, interrupted or failed.
    pub reason: String,
    /// The error of the step after the last one, or what the solver left undone and what to do about it; null unless that ended
    /// the run.
    #[serde(default)]
    pub failure: Option<String>,
    /// Displacement unknowns of the last mesh, held ones included.
    pub dofs: usize,
    /// Number of meshes solved.
    pub steps: usize,
    /// J = strain energy + spring energy - load work + friction work; around a hole under remote stress that of what the hole adds, as all
    /// energies.
    pub energy: f64,
    /// J of the spaces of one degree more, with the data themselves in place of their nodal values.
    pub energy_extrapolated: Option<f64>,
    /// How far the exact J may be from that.
    #[serde(default)]
    pub energy_uncertainty: Option<f64>,
    /// ½ a(u, u).
    pub strain_energy: f64,
    /// ½ ∫ K u·u of springs on sides, which is no part of the strain energy; left out without them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring_energy: Option<f64>,
    /// Work of tractions and body force, without that of reactions.
    pub load_work: f64,
    /// Σ D_i F_i |u_t,i| over the whole contact boundary.
    pub friction_work: f64,
    /// Estimated error ⟨S e, e⟩^½ in the energy norm, S with springs.
    pub estimate: Option<f64>,
    /// Estimate over (2 strain energy)^½.
    pub estimate_relative: Option<f64>,
    /// Why the estimate is not to be trusted, the words of [`Doubt`]; empty if it is.
    #[serde(default)]
    pub estimate_doubts: Vec<String>,
    /// Quantities with their error bars, by their paths.
    #[serde(default, skip_serializing_if = "Quantities::is_empty")]
    pub quantities: Quantities,
    /// Residual estimators; left out unless requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimators: Option<Estimators>,
    /// Iterations of the contact solver in the last step; 0 without contact.
    pub iterations: usize,
    /// Contact; null without a contact side.
    pub contact: Option<ContactSummary>,
    /// How well the contact conditions hold; null without a contact side.
    pub audit: Option<Audit>,
    /// The bodies, of a scene with several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodySummary>,
    /// The interfaces between them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub interfaces: Vec<InterfaceSummary>,
    /// Places where bodies lie in each other, after they have moved, because no interface looks for contact there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reach: Vec<ReachSummary>,
    /// Force on the body from each side that is held, in contact or on springs.
    pub reactions: BTreeMap<String, [f64; 2]>,
    /// The numbers that the scene asks for by names.
    #[serde(flatten)]
    pub named: Named,
    /// Results at the probe points.
    pub probe: Vec<Probe>,
    /// Corners, tips of cracks, ends of conditions and of joints, and jumps of data at which the stress is infinite. Left out
    /// without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub infinite_stress: Vec<[f64; 2]>,
    /// The largest von Mises stress of the bodies; left out where it is infinite or not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_von_mises: Option<f64>,
    /// Where it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_von_mises_at: Option<[f64; 2]>,
    /// Results along lines; left out without them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probe_lines: Vec<LineProbe>,
    /// Results along sides; left out without them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probe_sides: Vec<SideProbe>,
    /// The entries of the scene's `[expect]` beside the numbers of the result.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub expect: Vec<Expected>,
    /// Statistics; null for one outcome.
    pub stochastic: Option<serde_json::Value>,
    /// Finite elements only: the grid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<GridSummary>,
    /// Scenes with a medium around the body only: what happens far away.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exterior: Option<MediumSummary>,
    /// Wall seconds.
    pub seconds: SecondsSummary,
    /// Largest resident memory of the process.
    pub peak_memory_bytes: u64,
}

/// The numbers that a scene asks for by names; each group is left out if it is empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// Pressures at points of the boundary; NaN, in JSON null, where they are infinite.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "map_of_numbers_or_null")]
    pub pressure: BTreeMap<String, f64>,
    /// Mean displacements of sides.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub mean_displacement: BTreeMap<String, [f64; 2]>,
    /// Moments of reactions of sides, anticlockwise (force per thickness times length).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub moment: BTreeMap<String, f64>,
    /// ∫ w·t of reactions of sides (force per thickness).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub weighted_force: BTreeMap<String, f64>,
    /// Distances of two surfaces in the deformed state.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub opening: BTreeMap<String, f64>,
}

impl Named {
    /// Paths and numbers.
    pub fn numbers(&self) -> Vec<(String, f64)> {
        let groups = [
            ("pressure", &self.pressure),
            ("moment", &self.moment),
            ("weighted_force", &self.weighted_force),
            ("opening", &self.opening),
        ];
        let single = |(group, all): (&str, &BTreeMap<String, f64>)| {
            all.iter().map(|(name, value)| (format!("{group}.{name}"), *value)).collect::<Vec<_>>()
        };
        let mean = |(name, mean): (&String, &[f64; 2])| {
            [("x", mean[0]), ("y", mean[1])].map(|(i, value)| (format!("mean_displacement.{name}.{i}"), value))
        };
        groups.into_iter().flat_map(single).chain(self.mean_displacement.iter().flat_map(mean)).collect()
    }
}

/// Contact in numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactSummary {
    /// Length in contact: between the ends where they are located, else Σ D_i over nodes with λ_n,i > 1e-12 of the largest.
    pub length: f64,
    /// Part of it with |λ_t| < F_i.
    pub stick: f64,
    /// The rest.
    pub slip: f64,
    /// Largest nodal λ_n.
    pub max_pressure: f64,
    /// Whether the exact one is infinite, so that `max_pressure` grows with the mesh.
    pub max_pressure_unbounded: bool,
    /// Force of the obstacle on the body; between bodies the sum of the forces of all interfaces in contact.
    pub force: [f64; 2],
    /// Ends of contact, where adaptivity has located them.
    pub ends: Option<Vec<[f64; 2]>>,
    /// Coulomb friction only, and where the solver converged: factor by which changes of the pressure shrink in the fixed point of Tresca problems.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contraction: Option<f64>,
    /// γ of stabilised multipliers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stabilisation: Option<Stabilisation>,
}

/// One of several bodies in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodySummary {
    /// Its name.
    pub name: String,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Half of a(u, u).
    pub strain_energy: f64,
    /// Its part of the estimated error (energy norm); the squares of all are that of the whole.
    pub estimate: Option<f64>,
}

/// An interface between bodies in numbers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceSummary {
    /// Its name.
    pub name: String,
    /// "contact" or "tied".
    pub kind: String,
    /// The sides that carry the multipliers, and those that they face.
    pub sides: [Vec<String>; 2],
    /// Length in contact, or tied.
    pub length: f64,
    /// Part of it that sticks; null for ties.
    pub stick: Option<f64>,
    /// The rest; null for ties.
    pub slip: Option<f64>,
    /// Largest pressure: where `quantities` has its error bar that of the enriched spaces, else that of a node; null for ties.
    pub max_pressure: Option<f64>,
    /// Force on the body that is named first.
    pub force: [f64; 2],
    /// Ends of contact, where adaptivity has located them.
    pub ends: Option<Vec<[f64; 2]>>,
    /// How well the conditions of contact hold, over the scales of all interfaces: equilibrium is that of the whole problem, friction
    /// the excess of |λ_t| alone; null for ties.
    pub audit: Option<Audit>,
    /// The influence of the direction of contact; null for ties.
    #[serde(default)]
    pub normals: Option<NormalsSummary>,
}

/// How much the normals of the two sides of an interface differ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NormalsSummary {
    /// Largest angle between them where the sides press each other (radian).
    pub angle: f64,
    /// By how much J would differ, to first order, between contact along the normals of the one side and of the other, and for pairs that
    /// moved apart before they touched.
    pub energy_change: f64,
}

/// A place where a body lies in another one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReachSummary {
    /// Their names.
    pub bodies: [String; 2],
    /// The place, after the motion.
    pub point: [f64; 2],
    /// How deep (length).
    pub depth: f64,
}

/// γ = γ₀ h/p² of stabilised multipliers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stabilisation {
    /// γ₀ (1/stress).
    pub gamma: f64,
    /// The largest γ₀ of a coercive form on the last mesh.
    pub critical_gamma: f64,
}

/// The unbounded medium around a body, or around a hole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MediumSummary {
    /// "decaying" or "bounded".
    pub radiation: String,
    /// Resultant of the forces on the medium, the remote stress apart (force per thickness).
    pub resultant: [f64; 2],
    /// Whether it is below 1e-6 of the sum of absolute values. If not, the displacement grows as log(L/r).
    pub balanced: bool,
    /// Displacement at infinity, that of the remote stress apart; 0 for "decaying".
    pub constant: [f64; 2],
    /// Length L in log(L/r): without balance it selects a rigid translation.
    pub length: f64,
}

impl MediumSummary {
    /// `length` among the doubts: without balance displacements and energies, and with supports or contact also stresses and
    /// forces, are those of the length L.
    pub(crate) fn doubt(&self) -> Option<Doubt> {
        (!self.balanced).then_some(Doubt::Length)
    }
}

/// A body on a grid of rectangles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GridSummary {
    /// Fine cells along x and y over the bounding box.
    pub cells: [usize; 2],
    /// Displacement unknowns of all fine nodes.
    pub fine_dofs: usize,
    /// Multiscale basis; null for bilinear elements on all fine cells.
    pub basis: Option<String>,
    /// Coarse cells.
    pub coarse_cells: Option<usize>,
    /// Number of different patterns of moduli, each with one local problem.
    pub patterns: Option<usize>,
    /// Part of the estimate that coarse cells add to the fine grid's: energy norm of u_fine - u_multiscale. With a medium
    /// around the body also the body's share of the residual of the traction balance where both meet: two to three times the
    /// error inside of the body.
    pub estimate_multiscale: Option<f64>,
    /// Part of the estimate that the fine grid has itself: energy norm of u - u_fine.
    pub estimate_fine_grid: Option<f64>,
    /// Part of the estimate that the boundary elements of the medium around the body have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate_medium: Option<f64>,
    /// Boundary elements of that medium.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary_elements: Option<usize>,
    /// Largest Young's modulus over the smallest one.
    pub contrast: f64,
    /// The largest such ratio along an edge of a coarse cell; multiscale bases fail from about 100 on.
    pub crossing_contrast: Option<f64>,
    /// Middle of that edge.
    pub crossing_at: Option<[f64; 2]>,
    /// Share of the coarse edges with a ratio of 100 or more.
    pub crossing_share: Option<f64>,
}

/// The judge's measures, each relative to its scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Audit {
    /// max |S u + Bᵀλ - f| / (max |S u| + max |f|).
    pub equilibrium: f64,
    /// max (u_n - g)⁺ / (max |u| + max |g|).
    pub penetration: f64,
    /// max (-λ_n)⁺ / max |λ|.
    pub tension: f64,
    /// max λ_n |g - u_n| over the scales of both.
    pub complementarity: f64,
    /// Excess of |λ_t| over F and violation of the slip rule.
    pub friction: f64,
}

/// Displacement and stress at a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// The point.
    pub point: [f64; 2],
    /// Displacement.
    pub displacement: [f64; 2],
    /// σ_xx, σ_yy, σ_xy; NaN, in JSON null, where they are infinite.
    #[serde(deserialize_with = "numbers_or_null")]
    pub stress: [f64; 3],
    /// Von Mises stress; left out where stresses are infinite, and of outcomes of random input.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub von_mises: Option<f64>,
    /// The larger principal stress in the plane; left out where `von_mises` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_principal: Option<f64>,
    /// The smaller one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_principal: Option<f64>,
    /// Whether the point is a vertex at which stresses grow without bound; left out if not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stress_unbounded: bool,
}

impl Probe {
    /// Displacement and stress at a point.
    pub(crate) fn new(point: [f64; 2], displacement: [f64; 2], stress: [f64; 3]) -> Self {
        let [von_mises, max_principal, min_principal] = [None; 3];
        Self { point, displacement, stress, von_mises, max_principal, min_principal, stress_unbounded: false }
    }
}

/// Displacement and stress along a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LineProbe {
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// Its points in their order.
    pub points: Vec<LinePoint>,
}

/// Displacement and stress at a point of a line; NaN, in JSON null, where no body is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinePoint {
    /// Distance from the beginning of the line.
    pub s: f64,
    /// The point.
    pub point: [f64; 2],
    /// The body in which it lies, of several, or the medium around the body; of bodies that meet there the one that the scene has
    /// first. Left out where no body is, and for one body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Displacement.
    #[serde(deserialize_with = "numbers_or_null")]
    pub displacement: [f64; 2],
    /// σ_xx, σ_yy, σ_xy; NaN too where they are infinite.
    #[serde(deserialize_with = "numbers_or_null")]
    pub stress: [f64; 3],
    /// Von Mises stress.
    #[serde(deserialize_with = "number_or_null")]
    pub von_mises: f64,
    /// Whether the point is a vertex at which stresses grow without bound; left out if not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stress_unbounded: bool,
}

/// Displacement, traction and stress along a side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SideProbe {
    /// Name of the side.
    pub side: String,
    /// Its points, the body to the left: piece after piece, if it is in several. With boundary elements 2p + 1 in each element of degree p,
    /// both ends included, so that points between elements are there twice; on grids the middles of the sides of fine cells.
    pub points: Vec<SidePoint>,
}

/// Displacement, traction and stress at a point of a side, n out of the body and t the normal turned by +90 degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SidePoint {
    /// The piece of the side, from 0: pieces do not join each other.
    pub piece: usize,
    /// Length of the side, all pieces before included, up to the point.
    pub s: f64,
    /// The point.
    pub point: [f64; 2],
    /// n.
    pub normal: [f64; 2],
    /// Displacement u.
    pub displacement: [f64; 2],
    /// u·n.
    pub normal_displacement: f64,
    /// u·t.
    pub tangential_displacement: f64,
    /// n·σn, negative in compression; NaN, in JSON null, where stresses are infinite, as all that follow.
    #[serde(deserialize_with = "number_or_null")]
    pub normal_traction: f64,
    /// t·σn.
    #[serde(deserialize_with = "number_or_null")]
    pub tangential_traction: f64,
    /// t·σt, along the side; around a hole the hoop stress.
    #[serde(deserialize_with = "number_or_null")]
    pub hoop_stress: f64,
    /// σ_xx, σ_yy, σ_xy.
    #[serde(deserialize_with = "numbers_or_null")]
    pub stress: [f64; 3],
    /// Von Mises stress.
    #[serde(deserialize_with = "number_or_null")]
    pub von_mises: f64,
    /// Whether the point is a vertex at which stresses grow without bound; left out if not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stress_unbounded: bool,
}

/// Some numbers, NaN where there is null.
fn numbers_or_null<'de, D: serde::Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error>
where
    [Option<f64>; N]: Deserialize<'de>,
{
    Ok(<[Option<f64>; N]>::deserialize(from)?.map(|number| number.unwrap_or(f64::NAN)))
}

/// A number, NaN where there is null.
fn number_or_null<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Numbers by names, NaN where there is null.
fn map_of_numbers_or_null<'de, D: serde::Deserializer<'de>>(from: D) -> Result<BTreeMap<String, f64>, D::Error> {
    let numbers = BTreeMap::<String, Option<f64>>::deserialize(from)?;
    Ok(numbers.into_iter().map(|(name, number)| (name, number.unwrap_or(f64::NAN))).collect())
}

/// Wall seconds of the parts, summed over the steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SecondsSummary {
    /// All of it, reading the scene, outcomes of random input and writing the file included; in the file without writing it.
    pub total: f64,
    /// Meshes, loads, supports.
    pub set_up: f64,
    /// V, K, W, or the stiffness of a grid.
    pub assemble: f64,
    /// S and its condensation, or the factor of that stiffness.
    pub factorise: f64,
    /// Contact and back substitution.
    pub solve: f64,
    /// Error estimate.
    pub estimate: f64,
    /// Fields in the body and the result file; in the file without writing it.
    pub write: f64,
}

impl SecondsSummary {
    /// The sums over all steps: set-up, assembly, factorisation, solution, estimate.
    pub fn of_steps([set_up, assemble, factorise, solve, estimate]: [f64; 5]) -> Self {
        Self { set_up, assemble, factorise, solve, estimate, ..Self::default() }
    }
}

impl Summary {
    /// The number at a path of keys joined by points: `contact.force.y`, `probe.0.stress.xx`, `reactions.floor.x`.
    pub fn at(&self, path: &str) -> Option<f64> {
        Self::number_at(&serde_json::to_value(self).ok()?, path)
    }

    /// The number at a path of the object.
    pub(crate) fn number_at(root: &serde_json::Value, path: &str) -> Option<f64> {
        fn find(value: &serde_json::Value, keys: &[&str]) -> Option<f64> {
            match (keys.split_first(), value) {
                (None, _) => value.as_bool().map(|b| f64::from(u8::from(b))).or_else(|| value.as_f64()),
                (Some((key, rest)), serde_json::Value::Array(items)) => {
                    find(items.get(Summary::component(key)?)?, rest)
                }
                // names, as those of the sides of several bodies, may have points
                (Some(_), other) => (1..=keys.len()).find_map(|n| find(other.get(keys[..n].join("."))?, &keys[n..])),
            }
        }
        find(root, &path.split('.').collect::<Vec<_>>())
    }

    /// The place in a list that a key means: its number, or that of a component of a vector or tensor.
    pub(crate) fn component(key: &str) -> Option<usize> {
        match key {
            "x" | "xx" => Some(0),
            "y" | "yy" => Some(1),
            "xy" => Some(2),
            _ => key.parse().ok(),
        }
    }
}

/// Largest resident memory of this process so far, in bytes; 0 where the system does not tell.
pub fn peak_memory_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM:"));
    let kib = line.and_then(|l| l.split_whitespace().nth(1)).and_then(|n| n.parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}

/// Memory that the system can give, in bytes; None where it does not tell.
pub fn available_memory_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| 1024 * kib)
}

/// An entry of `[expect]` beside the number of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    /// Path in the JSON object.
    pub path: String,
    /// The number of the result; null where it has none.
    pub value: Option<f64>,
    /// What it is to be.
    pub expected: f64,
    /// How far it may be off.
    pub tol: f64,
    /// Whether it is not farther off.
    pub holds: bool,
}
