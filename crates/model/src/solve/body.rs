//! A body on a mesh: its matrices, which no load changes, and its answer to loads.

use std::sync::Arc;

use faer::{Mat, Scale};
use steklov_algebra::Symmetric;
use steklov_bem_operators::{Assembly, BoundaryField, Cuts, Mesh, Space, legendre_decay};
use steklov_contact::{ContactBoundary, ContactError, Problem, Solution};
use steklov_elastic::RigidMotion;
use steklov_problem::{NamedQuantity, Scene};

use crate::data::body_load::{Particular, Particulars, energies_of};
use crate::data::joints::{Joint, TiedNode};
use crate::data::motions::work;
use crate::data::on_mesh::{Loads, OnMesh};
use crate::data::parts::{Assembled, Piece};
use crate::data::springs::Springs;
use crate::data::supports::{Held, Supports};
use crate::energies::Energies;
use crate::error::SolveError;
use crate::solve::contact::{CondensedBody, ContactFactors, ContactResult, solve_contact};
use crate::solve::equilibrium::{Equations, Residual, reactions};
use crate::solve::fields::Field;
use crate::solve::free_bodies::Loose;
use crate::solve::inclusion::Outside;
use crate::solve::rotations::{project_load_off, rigid_motions};
use crate::solve::solution::{Seconds, Solved, TieRow};
use crate::solve::stabilised::StabilisedContact;

/// The results of assembly and factorisation: enough to answer any loads, gaps, bounds and held values on the same supports.
pub struct Body {
    /// The mesh.
    pub mesh: Mesh,
    /// Its unknowns.
    pub space: Space,
    /// The points of all nodes: those of the space, and behind them those on cuts.
    pub points: Vec<[f64; 2]>,
    /// Number of elements, those of cuts included.
    pub(crate) elements: usize,
    /// Where the only body is cut into subdomains.
    pub(crate) cuts: Option<Arc<Cuts>>,
    /// The bodies one by one, or the subdomains of one that is cut, with their materials.
    pub pieces: Vec<Assembled>,
    /// S, the free unknowns eliminated; with a medium around the body the sum of both.
    pub condensation: Assembly,
    /// The medium around it, if there is one.
    pub outside: Option<Outside>,
    /// S_c of the contact unknowns, for the outcomes of random input; empty without contact, or when a scene without random input
    /// is solved.
    pub stiffness: Symmetric,
    /// Interfaces between bodies.
    pub(crate) joints: Vec<Joint>,
    /// The nodes that are tied to other bodies.
    pub(crate) tied: Vec<TiedNode>,
    /// Prescribed components of the nodes.
    pub(crate) held: Vec<Held>,
    /// Springs on sides; S contains them.
    pub springs: Springs,
    /// Largest entry of the diagonal of S without them.
    pub(crate) largest_diagonal: f64,
    /// Rigid motions of a single body that nothing resists and no load drives.
    pub free: Vec<RigidMotion>,
    /// The same of all bodies, nodal vectors.
    pub(crate) loose: Loose,
}

/// The loads and supports that act on a body.
pub struct Loading {
    pub(crate) loads: Loads,
    /// One entry for each body.
    pub(crate) particular: Vec<Option<Particular>>,
    pub(crate) boundary: Option<ContactBoundary>,
    /// Values of the held unknowns, in the order of the nodes.
    pub(crate) held: Vec<f64>,
    /// Whether the safety of a solution under Coulomb's law is judged.
    pub(crate) judged: bool,
    /// Whether contact may be solved again where the obstacle pushes the body off.
    pub(crate) liftable: bool,
    /// An answer with stabilised multipliers, which is then reported.
    pub(crate) stabilised: Option<StabilisedContact>,
    /// Nodal load of all.
    pub(crate) load: Vec<f64>,
    /// Load of the bubbles, less that of the particular solution.
    extra_load: Vec<f64>,
}

impl Loading {
    pub(crate) fn new(
        loads: Loads,
        particular: Vec<Option<Particular>>,
        boundary: Option<ContactBoundary>,
        held: Vec<f64>,
        bodies: &[Assembled],
    ) -> Self {
        let parts = || bodies.iter().map(|body| &body.piece.part);
        let past = |numbers: &[usize]| numbers.iter().max().map_or(0, |last| last + 1);
        let nodes = parts().map(|part| past(&part.nodes)).max().unwrap_or(0);
        let elements = parts().map(|part| past(&part.elements)).max().unwrap_or(0);
        let (mut load, mut extra_load) = (loads.nodal.clone(), loads.bubbles.clone());
        load.resize(2 * nodes, 0.0);
        extra_load.resize(2 * elements, 0.0);
        for (part, p) in parts().zip(&particular) {
            let Some(p) = p else { continue };
            part.add_to(&mut load, &p.load);
            let of_bubbles = p.solution.bubble_load(&part.mesh, &part.space);
            for ((e, sign), t) in part.elements.iter().zip(part.bubble_signs()).zip(of_bubbles.chunks_exact(2)) {
                (0..2).for_each(|i| extra_load[2 * e + i] -= sign * t[i]);
            }
        }
        Self { loads, particular, boundary, held, judged: true, liftable: true, stabilised: None, load, extra_load }
    }
}

/// Corrections of a body on springs: with soft springs the sum of both stiffnesses has few digits of theirs, while forces have
/// all.
const CORRECTIONS: usize = 2;
/// Steps of iterative refinement of a body that is cut: the first one gains all digits that a factor of the skeleton has, so
/// that few are needed even for a beam of 1000 times its thickness.
const REFINEMENTS: usize = 3;

/// The data of a solution that its estimate and the next mesh need besides the matrices of its [`Body`].
pub struct Factors {
    /// Nodal displacement without the particular solution and the motions that springs carry, of biorthogonal multipliers.
    pub homogeneous: Vec<f64>,
    /// Nodal displacement ξ of the medium around it.
    pub outside: Option<Vec<f64>>,
    /// J of that displacement.
    pub energy: f64,
    /// ‖u - u_b‖², energy norm, of the displacements of stabilised and biorthogonal multipliers; 0 if they are one.
    pub difference: f64,
    /// Load of the bubbles, less that of the particular solution and the pull of springs.
    pub extra_load: Vec<f64>,
    /// The part of each element's prescribed and spring tractions that its polynomials do not resolve, h/(p+2) ‖t
    /// - Π t‖² (stress² length²).
    pub unresolved: Vec<f64>,
    /// The condensed contact problem.
    pub contact: Option<ContactFactors>,
    /// How fast the Legendre coefficients of the displacement decay on the elements of cuts.
    pub(crate) decay_on_cuts: Vec<Option<f64>>,
}

impl Body {
    /// The same bodies with the moduli of a scene that differs from theirs in nothing else; no body is factorised again. Springs
    /// and a medium around the body stay as they are: scenes with them have no random modulus.
    pub(crate) fn with_moduli(&self, scene: &Scene) -> Result<Self, SolveError> {
        let of = |body: &Assembled| body.with_material(scene.problem.bodies[body.piece.body].material());
        let pieces: Vec<Assembled> = self.pieces.iter().map(of).collect();
        let factors: Vec<f64> = pieces.iter().map(|body| body.modulus).collect();
        let condensation = self.condensation.with_moduli(&factors)?;
        let stiffness = match (&self.pieces[..], &factors[..]) {
            _ if self.stiffness.size() == 0 => Mat::new().into(),
            ([before], [factor]) => (&*self.stiffness.full() * Scale(factor / before.modulus)).into(),
            _ => condensation.stiffness()?,
        };
        Ok(Self {
            largest_diagonal: condensation.largest_diagonal(),
            mesh: self.mesh.clone(),
            space: self.space.clone(),
            points: self.points.clone(),
            elements: self.elements,
            cuts: self.cuts.clone(),
            pieces,
            condensation,
            outside: None,
            stiffness,
            joints: self.joints.clone(),
            tied: self.tied.clone(),
            held: self.held.clone(),
            springs: self.springs.clone(),
            free: self.free.clone(),
            loose: self.loose.clone(),
        })
    }

    /// The elastic field of a nodal displacement.
    pub fn field<'b>(&'b self, displacement: &[f64]) -> Field {
        let of = |body: &'b Assembled| {
            let Assembled { piece: Piece { part, material, .. }, length, traction_map, .. } = body;
            let mut own = part.own(displacement);
            let carried = body.settle(&mut own);
            let motion = body.motion(&own);
            if let Some(motion) = &motion {
                own.iter_mut().zip(motion.nodal(&part.space.points)).for_each(|(u, r)| *u -= r);
            }
            let traction = body.traction(&own);
            let field = BoundaryField::new(&part.mesh, &part.space, material, &own, &traction, *length);
            (part, field.tending_to(traction_map.at_infinity(&own)).moved(RigidMotion::sum(carried, motion)))
        };
        Field::new(self.pieces.iter().map(of).collect(), self.cuts.clone(), self.mesh.len())
    }

    /// S u of the bodies alone, without springs.
    pub(crate) fn elastic_forces(&self, displacement: &[f64]) -> Vec<f64> {
        if self.cuts.is_some() {
            let mut forces = vec![0.0; displacement.len()];
            for (k, body) in self.pieces.iter().enumerate() {
                body.piece.part.add_to(&mut forces, &self.strain_forces(k, body.piece.part.own(displacement)));
            }
            return forces;
        }
        let settled = self.settled(displacement);
        let forces = self.condensation.multiply(&settled);
        if self.springs.is_empty() {
            return forces;
        }
        forces.iter().zip(self.pull(&settled)).map(|(f, pull)| f - pull).collect()
    }

    /// S_k u of a subdomain, u without its rigid motion: nothing large cancels where a long body moves far.
    fn strain_forces(&self, k: usize, mut own: Vec<f64>) -> Vec<f64> {
        let motions = rigid_motions(&self.pieces[k].piece.part.space.points);
        (0..2).for_each(|_| project_load_off(&mut own, &motions));
        let mut forces = self.condensation.multiply_body(k, &own);
        project_load_off(&mut forces, &motions);
        forces
    }

    /// A nodal displacement without the motions of bodies that springs carry: S of the bodies alone does not resist them.
    pub(crate) fn settled(&self, displacement: &[f64]) -> Vec<f64> {
        let mut settled = displacement.to_vec();
        for body in self.pieces.iter().filter(|body| body.carried.is_some()) {
            let mut own = body.piece.part.own(&settled);
            body.settle(&mut own);
            body.piece.part.set(&mut settled, &own);
        }
        settled
    }

    /// The forces of springs at the nodes.
    fn pull(&self, displacement: &[f64]) -> Vec<f64> {
        self.springs.pull(&self.space, self.mesh.len(), displacement).base
    }

    /// The same with springs.
    fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let elastic = self.elastic_forces(displacement);
        if self.springs.is_empty() {
            return elastic;
        }
        elastic.iter().zip(self.pull(displacement)).map(|(f, pull)| f + pull).collect()
    }

    /// The answer to the loads on the body; `solve` solves the condensed contact problem. No times are measured.
    ///
    /// # Errors
    /// Those of the contact solver; results that leave the range of floating point.
    pub(crate) fn answer(
        &self,
        scene: &Scene,
        mut given: Loading,
        solve: &mut dyn FnMut(&Problem) -> Result<Solution, ContactError>,
    ) -> Result<(Solved, Factors), SolveError> {
        let Self { mesh, space, .. } = self;
        let (companion, contact) = self.displacement(&mut given, solve)?;
        let (contact, contact_factors) = contact.unzip();
        let companion_friction = contact.as_ref().map_or(0.0, |c| c.friction_work);
        // adaptivity and the estimate rest on the companion, the solution with biorthogonal multipliers
        let (mut displacement, contact) = match (contact, given.stabilised.take()) {
            (Some(contact), Some(s)) => (s.displacement.clone(), Some(contact.with_stabilised(s))),
            (contact, _) => (companion.clone(), contact),
        };
        let forces = self.forces(&displacement);
        let supports = Supports { space, held: &self.held };
        let residual = self.residual(&forces, &given.load, &displacement, contact.as_ref());
        let contact = contact.map(|c| c.with_equilibrium(residual.relative));

        // forces have the springs of free motions in them: these are taken out after that
        let forces = if self.springs.is_empty() { forces } else { self.elastic_forces(&displacement) };
        let boundary = contact.as_ref().map(|c| &c.boundary);
        self.loose.take_out(&mut displacement, (mesh, space), boundary);
        let lift = contact.as_ref().and_then(|c| c.lift.as_ref()).map(|lift| lift.nodal(&self.points));
        let unlifted = lift.as_ref().map(|_| displacement.clone());
        displacement.iter_mut().zip(lift.iter().flatten()).for_each(|(u, r)| *u += r);

        let friction_work = contact.as_ref().map_or(0.0, |c| c.friction_work);
        let Fields { homogeneous, field, energies, strain_of_bodies } =
            self.fields(&given, &displacement, &forces, friction_work);
        let Energies { total, strain, load_work, .. } = energies;
        if [total, strain, load_work].iter().chain(&displacement).any(|v| !v.is_finite()) {
            return Err(SolveError::NotFinite { energy: total });
        }
        let (homogeneous, estimated, energy, difference) = match (&contact, unlifted) {
            (Some(ContactResult { stabilised: Some(_), .. }), _) => {
                let fields = self.fields(&given, &companion, &self.elastic_forces(&companion), companion_friction);
                let difference = self.squared_difference(&displacement, &companion);
                (fields.homogeneous, companion, fields.energies.total, difference)
            }
            // the estimate is that of the solution on its springs
            (_, Some(u)) => (self.fields(&given, &u, &forces, friction_work).homogeneous, u, total, 0.0),
            (_, None) => (homogeneous, displacement.clone(), total, 0.0),
        };
        let (data, pull) = (OnMesh { scene, mesh, space }, self.springs.pull(space, self.elements, &estimated).extra);
        let unresolved = data.unresolved_springs(&estimated)?;
        let particular = Particulars::new(&self.pieces, &given.particular);
        let of_corner = |e: usize, j: usize| data.traction_moment(&field, &particular, e, j);
        let pulled = self.springs.reactions(mesh, space, &displacement);
        let reactions = reactions(scene, (&supports, mesh), &residual.values, (contact.as_ref(), pulled), of_corner);
        let of_jump = self.outside.as_ref().map_or(0.0, |outside| outside.work_on_jump(&displacement));
        let reaction_work = self.work_of_forces(&given, &displacement, &forces) + of_jump;
        let works = self.works(&data, (&supports, &residual.values), (contact.as_ref(), &displacement), of_corner);
        let factors = Factors {
            homogeneous: self.settled(&homogeneous),
            outside: self.outside.as_ref().map(|outside| outside.displacement(&displacement)),
            energy,
            difference,
            extra_load: given.extra_load.iter().zip(pull).map(|(f, pull)| f - pull).collect(),
            unresolved: given.loads.unresolved.iter().zip(unresolved).map(|(t, k)| t + k).collect(),
            contact: contact_factors,
            decay_on_cuts: self.decay_on_cuts(&estimated),
        };
        let solved = Solved {
            strain_of_bodies,
            ties: self.tie_rows(scene, &residual.values),
            tie_forces: self.tie_forces(scene, &residual.values),
            around: self.outside.as_ref().and_then(|outside| outside.around(&data, &displacement, &given.loads.nodal)),
            displacement: displacement[..space.dofs()].to_vec(),
            field,
            particular,
            energies,
            contact,
            equilibrium: residual.relative,
            balanced: residual.balanced,
            reactions,
            works,
            reaction_work: reaction_work + 2.0 * energies.springs + energies.friction_work,
            over_outcomes: None,
            free_motions: self.free.clone(),
            seconds: Seconds::default(),
            mesh: mesh.clone(),
            space: space.clone(),
        };
        Ok((solved, factors))
    }

    /// The moments and weighted forces that the scene asks for, of the forces at nodes: zero for those between bodies.
    fn works(
        &self,
        data: &OnMesh<'_>,
        (supports, residual): (&Supports<'_>, &[f64]),
        (contact, displacement): (Option<&ContactResult>, &[f64]),
        traction: impl Fn(usize, usize) -> [f64; 2],
    ) -> Vec<f64> {
        let of = |quantity: &NamedQuantity| {
            let (side, w) = quantity.kind.weighted_side()?;
            let of_springs = self.springs.work(data, displacement, side, &w);
            let of_supports = supports.work((residual, side), (&self.mesh, &data.scene.problem.sides), &traction, &w);
            Some(of_springs + of_supports + contact.map_or(0.0, |c| c.work(side, &self.space.points, &w)))
        };
        data.scene.quantities.iter().filter_map(of).collect()
    }

    /// How fast the Legendre coefficients of a nodal displacement decay on the elements of cuts.
    fn decay_on_cuts(&self, displacement: &[f64]) -> Vec<Option<f64>> {
        let mut decay = vec![None; self.elements - self.mesh.len()];
        for part in self.pieces.iter().map(|body| &body.piece.part) {
            let own = part.own(displacement);
            for (local, &e) in part.elements.iter().enumerate().filter(|(_, e)| **e >= self.mesh.len()) {
                decay[e - self.mesh.len()] = legendre_decay(&part.mesh, &part.space, local, &own);
            }
        }
        decay
    }

    /// The residual of a displacement in the equations.
    fn residual(
        &self,
        forces: &[f64],
        load: &[f64],
        displacement: &[f64],
        contact: Option<&ContactResult>,
    ) -> Residual {
        let largest_diagonal = self.largest_diagonal;
        let springs = self.condensation.spring_forces(displacement);
        let forces: Vec<f64> = forces.iter().zip(springs).map(|(f, spring)| f - spring).collect();
        let equations = Equations { forces: &forces, load, displacement, largest_diagonal, contact, tied: &self.tied };
        let supports = Supports { space: &self.space, held: &self.held };
        equations.residual(|dof| dof, |dof| supports.is_held(dof))
    }

    /// The tractions of ties, from the residual of the equations.
    fn tie_rows(&self, scene: &Scene, residual: &[f64]) -> Vec<TieRow> {
        let (mut rows, mut nodes): (Vec<TieRow>, Vec<[usize; 2]>) = (Vec::new(), Vec::new());
        for tied in &self.tied {
            let (node, i) = (tied.relative.node, tied.dof % 2);
            // two nodes may be at one point: where a cut ends on another interface
            let at = nodes.iter().position(|of| *of == [node, tied.interface]).unwrap_or_else(|| {
                let name = scene.problem.interfaces()[tied.interface].name.clone();
                nodes.push([node, tied.interface]);
                let point = self.space.points[node];
                rows.push(TieRow { name, point, weight: tied.whole, traction: [0.0; 2] });
                rows.len() - 1
            });
            // beside a corner that a support holds in one component the other one has that length at the corner itself
            let row = &mut rows[at];
            row.weight = row.weight.min(tied.whole);
            row.traction[i] = residual[tied.dof] / tied.weight;
        }
        rows
    }

    /// The forces of ties on the bodies that carry their multipliers, by the names of all interfaces.
    fn tie_forces(&self, scene: &Scene, residual: &[f64]) -> Vec<(String, [f64; 2])> {
        let mut forces: Vec<(String, [f64; 2])> =
            scene.problem.interfaces().iter().map(|interface| (interface.name.clone(), [0.0; 2])).collect();
        for tied in &self.tied {
            forces[tied.interface].1[tied.dof % 2] += tied.whole * (residual[tied.dof] / tied.weight);
        }
        forces
    }

    /// The nodal displacement under the loads on the body, and its contact, whose boundary is taken out of `given`.
    fn displacement(
        &self,
        given: &mut Loading,
        solve: &mut dyn FnMut(&Problem) -> Result<Solution, ContactError>,
    ) -> Result<(Vec<f64>, Option<Contacted>), SolveError> {
        let Self { mesh, space, condensation, .. } = self;
        let condensed = condensation.load_held(&given.load, &given.held);
        let Some(boundary) = given.boundary.take() else {
            let mut displacement = condensation.expand(&condensed, &[]);
            let corrections = match (&self.cuts, self.springs.is_empty()) {
                (Some(_), _) => REFINEMENTS,
                (None, false) => CORRECTIONS,
                (None, true) => 0,
            };
            for _ in 0..corrections {
                let forces = self.forces(&displacement);
                let rest: Vec<f64> = given.load.iter().zip(forces).map(|(f, s)| f - s).collect();
                let correction = condensation.expand(&condensation.load_of_correction(&rest), &[]);
                displacement.iter_mut().zip(correction).for_each(|(u, c)| *u += c);
            }
            return Ok((displacement, None));
        };
        let body = CondensedBody {
            mesh,
            space,
            stiffness: &self.stiffness,
            load: &condensed.kept,
            expand: &|v| condensation.expand(&condensed, v),
            largest_diagonal: self.largest_diagonal,
            driven: &|motion| work(&self.points, &given.load, motion),
            free: &self.free,
            judged: given.judged,
            liftable: given.liftable && given.stabilised.is_none(),
        };
        let (displacement, result, factors) = solve_contact(&body, boundary, solve)?;
        Ok((displacement, Some((result, factors))))
    }

    /// ‖u - v‖², energy norm.
    fn squared_difference(&self, u: &[f64], v: &[f64]) -> f64 {
        let apart: Vec<f64> = u.iter().zip(v).map(|(a, b)| a - b).collect();
        let stiff = self.condensation.multiply(&apart);
        apart.iter().zip(&stiff).map(|(a, b)| a * b).sum::<f64>().max(0.0)
    }

    /// The elastic field of a nodal displacement and its energies; `forces` are S u of the bodies alone.
    fn fields(&self, given: &Loading, displacement: &[f64], forces: &[f64], friction_work: f64) -> Fields {
        let mut homogeneous = displacement.to_vec();
        for (body, p) in self.pieces.iter().zip(&given.particular) {
            let Some(p) = p else { continue };
            let part = &body.piece.part;
            let own: Vec<f64> = part.own(displacement).iter().zip(&p.displacement).map(|(u, p)| u - p).collect();
            part.set(&mut homogeneous, &own);
        }
        let field = self.field(&homogeneous);
        let mut counted = vec![false; self.points.len()];
        let mut of_body = |(k, (body, p)): (usize, (&Assembled, &Option<Particular>))| {
            let part = &body.piece.part;
            let u = part.own(displacement);
            let forces = match self.cuts {
                None => part.own(forces),
                Some(_) => self.strain_forces(k, u.clone()),
            };
            // a load on a node of several subdomains does work once
            let mut loads = vec![0.0; u.len()];
            for (local, &node) in part.nodes.iter().enumerate().filter(|(_, node)| **node < self.space.nodes()) {
                if !std::mem::replace(&mut counted[node], true) {
                    loads[2 * local..2 * local + 2].copy_from_slice(&given.loads.nodal[2 * node..2 * node + 2]);
                }
            }
            energies_of(&u, &forces, &loads, p.as_ref(), field.of_piece(k), &body.piece)
        };
        let of_bodies: Vec<Energies> =
            self.pieces.iter().zip(&given.particular).enumerate().map(&mut of_body).collect();
        let sum = |of: fn(&Energies) -> f64| of_bodies.iter().map(of).sum::<f64>();
        let springs = self.springs.energy(&self.space, displacement);
        let turned: f64 = given.loads.turning.iter().zip(&homogeneous).map(|(f, u)| f * u).sum();
        let mut energies = Energies {
            total: sum(|e| e.total) - turned + springs + friction_work,
            strain: sum(|e| e.strain),
            springs,
            load_work: sum(|e| e.load_work) + turned,
            friction_work,
        };
        if let Some(outside) = &self.outside {
            energies.strain = outside.strain_energy(displacement, &outside.displacement(displacement), forces);
            energies.total = energies.strain - energies.load_work + friction_work;
        }
        let strain_of_bodies = of_bodies.iter().map(|e| e.strain).collect();
        Fields { homogeneous, field, energies, strain_of_bodies }
    }
}

/// Contact, and its data for the estimate and the next mesh.
type Contacted = (ContactResult, ContactFactors);

/// The fields and energies of a nodal displacement.
struct Fields {
    /// It without the particular solution.
    homogeneous: Vec<f64>,
    /// The elastic field of that.
    field: Field,
    energies: Energies,
    /// Strain energy of each body.
    strain_of_bodies: Vec<f64>,
}
