//! The unbounded medium around a body, or around a hole.

use steklov_bem_operators::{Domain, Edge, ParticularSolution};
use steklov_coupling::Radiation;
use steklov_elastic::{Material, RigidMotion};
use steklov_expression::Expression;

use super::grid_fit::without_medium_around;
use super::{
    BasisInput, Condition, DataError, DataErrorKind as Kind, FarField, Indicator, Interface, Law, Model, Other,
    Problem, Scene, Tie,
};

/// The medium around a body, and how both meet.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// Material of the medium.
    pub material: Material,
    /// Its far field.
    pub far: &'a FarField,
    /// How the displacement behaves there.
    pub radiation: Radiation,
    /// The jumps between body and medium.
    pub tie: &'a Tie,
}

impl Surroundings<'_> {
    /// The uniform field of the remote stress, zero at the origin.
    pub fn remote(&self) -> ParticularSolution {
        ParticularSolution::of_uniform_stress(self.far.remote_stress, [0.0; 2], &self.material)
    }
}

/// The name of a jump of the displacement.
pub(super) const DISPLACEMENT_JUMP: &str = "displacement jump";

impl Tie {
    /// The expressions of the jumps and their names.
    pub(super) fn jumps(&self) -> impl Iterator<Item = (&'static str, &Expression)> {
        let displacement = self.displacement_jump.iter().flatten().map(|e| (DISPLACEMENT_JUMP, e));
        let traction = self.traction_jump.iter().flatten().map(|e| ("traction jump", e));
        let stress = self.stress_jump.iter().flatten().map(|e| ("stress jump", e));
        displacement.chain(traction).chain(stress)
    }

    /// The expressions of the jumps.
    pub(super) fn expressions_mut(&mut self) -> impl Iterator<Item = &mut Expression> {
        let displacement = self.displacement_jump.iter_mut().flatten();
        displacement.chain(self.traction_jump.iter_mut().flatten()).chain(self.stress_jump.iter_mut().flatten())
    }

    /// The expressions of the traction jump t0, their names, and the direction in which each acts on a side with a normal.
    fn traction_jumps(&self) -> Vec<(&'static str, &Expression, Direction)> {
        let mut jumps: Vec<(&'static str, &Expression, Direction)> = Vec::new();
        if let Some([x, y]) = &self.traction_jump {
            jumps.push(("traction jump", x, |_| [1.0, 0.0]));
            jumps.push(("traction jump", y, |_| [0.0, 1.0]));
        }
        if let Some([xx, yy, xy]) = &self.stress_jump {
            jumps.push(("stress jump", xx, |[nx, _]| [nx, 0.0]));
            jumps.push(("stress jump", yy, |[_, ny]| [0.0, ny]));
            jumps.push(("stress jump", xy, |[nx, ny]| [ny, nx]));
        }
        jumps
    }

    /// Whether a jump is not zero.
    pub fn is_loaded(&self) -> bool {
        self.jumps().any(|(_, e)| e.constant() != Some(0.0))
    }
}

/// From the normal of a side to the direction in which a datum acts.
type Direction = fn([f64; 2]) -> [f64; 2];

impl Problem {
    /// How the displacement of a medium behaves far away; `None` for a bounded body. Unless it is stated, a medium that
    /// supports or obstacles hold is bounded there: they leave no net force, because with one their forces would depend on the
    /// length in its logarithm.
    pub fn radiation(&self, body: usize) -> Option<Radiation> {
        let far = self.bodies[body].far.as_ref()?;
        let touches = |side: usize| {
            let met = |interface: &Interface| interface.other == Other::Obstacle && interface.sides.contains(&side);
            self.interfaces.iter().any(met)
        };
        let holds = |side: usize| {
            self.body_of_side(side) == body
                && (matches!(self.sides[side].condition, Condition::Displacement { .. }) || touches(side))
        };
        let held = (0..self.sides.len()).any(holds);
        Some(far.at_infinity.unwrap_or(if held { Radiation::Bounded } else { Radiation::Decaying }))
    }

    /// The same for the medium among the bodies.
    pub fn radiation_of_medium(&self) -> Option<Radiation> {
        (0..self.bodies.len()).find_map(|body| self.radiation(body))
    }
}

impl Scene {
    /// Whether the body is a medium itself: the plane outside of holes.
    pub fn is_cavity(&self) -> bool {
        self.body().far.is_some()
    }

    /// Whether boundary elements are on both sides of the boundary of a body in a medium.
    pub fn is_inclusion(&self) -> bool {
        self.problem.tie().is_some() && !self.is_on_grid()
    }

    /// The domain of the boundary elements of a body.
    pub fn domain(&self, body: usize) -> Domain {
        match self.problem.radiation(body) {
            Some(Radiation::Bounded) => Domain::BoundedAtInfinity,
            _ => Domain::Interior,
        }
    }

    /// The far field of the medium; none without one.
    pub fn far(&self) -> Option<&FarField> {
        self.problem.bodies.iter().find_map(|body| body.far.as_ref())
    }

    /// Those of the rigid motions `free`, which the supports of a body leave free, that no medium resists either, the body
    /// itself or one around it: none if its displacement decays, translations if it is bounded at infinity.
    pub fn unresisted(&self, body: usize, free: Vec<RigidMotion>) -> Vec<RigidMotion> {
        let around = || self.problem.radiation_of_medium().filter(|_| !self.problem.has_several_bodies());
        match self.problem.radiation(body).or_else(around) {
            None => free,
            Some(Radiation::Decaying) => Vec::new(),
            Some(Radiation::Bounded) => free.into_iter().filter(|motion| motion.rotation == 0.0).collect(),
        }
    }

    /// The particular solution of the force on a body, or of the stress far from its holes, times a factor: zero at the centroid
    /// of the body, or at the origin.
    pub fn particular_solution(&self, body: usize) -> Option<ParticularSolution> {
        let (of_body, material) = (&self.problem.bodies[body], self.problem.bodies[body].material());
        if let (Some(force), Some(gradient)) = (&of_body.force, of_body.force_gradient()) {
            let centre = self.problem.outline.centroid_of_body(body);
            let force = force.each_ref().map(|f| f.eval(centre[0], centre[1], 0.0));
            return Some(ParticularSolution::of_affine_force(force, gradient, centre, &material));
        }
        let stress = of_body.far.as_ref()?.remote_stress;
        let stressed = stress != [0.0; 3];
        stressed.then(|| ParticularSolution::of_uniform_stress(stress, [0.0; 2], &material))
    }

    /// The uniform field of the medium around a body that belongs to the stress far away; none without that stress.
    pub fn remote_stress(&self) -> Option<ParticularSolution> {
        Some(self.surroundings().filter(|around| around.far.remote_stress != [0.0; 3])?.remote())
    }

    /// The medium around the body; none if there is none, or if the body is a medium itself.
    pub fn surroundings(&self) -> Option<Surroundings<'_>> {
        let (medium, tie) = (self.problem.medium()?, self.problem.tie()?);
        let far = medium.far.as_ref()?;
        Some(Surroundings {
            material: medium.material(),
            far,
            radiation: far.at_infinity.unwrap_or(Radiation::Decaying),
            tie,
        })
    }

    /// The expressions of the traction jump where a body meets the medium around it, their names, and the direction in which each
    /// acts on a side with a normal.
    pub fn traction_jumps(&self) -> Vec<(&'static str, &Expression, Direction)> {
        self.problem.tie().map_or(Vec::new(), Tie::traction_jumps)
    }

    /// The expressions of the jumps on an edge.
    pub fn jumps_on(&self, edge: &Edge) -> Vec<&Expression> {
        let tie = self.problem.tie().filter(|_| edge.loop_index == 0);
        let of_joint = self.problem.joint(edge.side).and_then(|interface| match &interface.law {
            Law::Tied(tie) => Some(tie),
            Law::Contact(_) => None,
        });
        let jumps = tie.into_iter().chain(of_joint).flat_map(Tie::jumps);
        jumps.map(|(_, expression)| expression).collect()
    }

    /// The edges on which the body meets the medium around it.
    pub fn interface(&self) -> impl Iterator<Item = (usize, &Edge)> {
        let meets = self.problem.tie().is_some();
        self.problem.outline.edges().iter().enumerate().filter(move |(_, edge)| meets && edge.loop_index == 0)
    }

    /// u0 = u - u_c at the edge parameter s of an edge of the interface, that of the remote stress included.
    pub fn displacement_jump(&self, edge: usize, s: f64) -> [f64; 2] {
        let Some(around) = self.surroundings() else { return [0.0; 2] };
        let edge = &self.problem.outline.edges()[edge];
        let ([x, y], s) = (edge.point(s), edge.drawn_fraction(s));
        let remote = around.remote().displacement([x, y]);
        match &around.tie.displacement_jump {
            Some(jump) => [0, 1].map(|i| remote[i] + jump[i].eval(x, y, s)),
            None => remote,
        }
    }

    /// t0 = σ(u)n - σ(u_c)n at the edge parameter s of an edge of the interface with normal n, that of the remote stress included.
    pub fn traction_jump(&self, edge: usize, s: f64, [nx, ny]: [f64; 2]) -> [f64; 2] {
        let Some(Surroundings { far, tie, .. }) = self.surroundings() else { return [0.0; 2] };
        let edge = &self.problem.outline.edges()[edge];
        let ([x, y], s) = (edge.point(s), edge.drawn_fraction(s));
        let [mut xx, mut yy, mut xy] = far.remote_stress;
        if let Some(jump) = &tie.stress_jump {
            let [a, b, c] = jump.each_ref().map(|jump| jump.eval(x, y, s));
            (xx, yy, xy) = (xx + a, yy + b, xy + c);
        }
        let of_stress = [xx * nx + xy * ny, xy * nx + yy * ny];
        match &tie.traction_jump {
            Some(jump) => [0, 1].map(|i| of_stress[i] + jump[i].eval(x, y, s)),
            None => of_stress,
        }
    }

    /// Whether the jumps have values wherever body and medium meet, and the displacement has one at each corner.
    pub(super) fn check_jumps(&self) -> Result<(), DataError> {
        for (side, what, jump) in self.problem.jumps_of_ties() {
            for edge in self.problem.outline.edges().iter().filter(|edge| edge.side == side) {
                self.check_along(edge, &self.problem.sides[side].name, what, jump)?;
            }
        }
        let Some(tie) = self.problem.tie() else { return Ok(()) };
        for (what, jump) in tie.jumps() {
            let mut ends = Vec::new();
            for (_, edge) in self.interface() {
                let largest = self.check_along(edge, &self.problem.sides[edge.side].name, what, jump)?;
                let [(a, s), (b, t)] = [(edge.start, 0.0), (edge.end, 1.0)];
                ends.push([jump.eval(a[0], a[1], s), jump.eval(b[0], b[1], t), largest]);
            }
            let largest = ends.iter().fold(0.0, |m: f64, [.., l]| m.max(*l));
            let apart = |k: &usize| (ends[*k][1] - ends[(k + 1) % ends.len()][0]).abs() > 1e-6 * largest;
            if let Some(k) = (0..ends.len()).find(apart).filter(|_| what == DISPLACEMENT_JUMP) {
                let [x, y] = self.problem.outline.edges()[k].end;
                let message = format!(
                    "the {what} is {} before and {} after the corner ({x}, {y}): expression {:?}",
                    ends[k][1],
                    ends[(k + 1) % ends.len()][0],
                    jump.text()
                );
                let help = "body and medium do not tear: write one continuous function of x and y";
                return Err(DataError::new(Kind::Data, jump.place, message, help));
            }
        }
        Ok(())
    }

    /// Refuses what a scene with a medium around the body cannot have.
    pub(super) fn check_exterior(&self) -> Result<(), DataError> {
        let refuse =
            |kind, key: &[&str], message: &str, help: &str| Err(DataError::at(kind, &[key.to_vec()], message, help));
        let model = self.model();
        let coupled = matches!(model, Model::FemBem | Model::MsfemBem);
        if self.problem.medium().is_none() {
            if coupled {
                let message = "there is no medium around the body";
                let help = "add a table [exterior] with young and poisson, or use \"fem\", \"msfem\" or \"auto\"";
                return refuse(Kind::Missing, &["method", "model"], message, help);
            }
            return Ok(());
        }
        if matches!(model, Model::Fem | Model::Msfem) {
            let message = "finite elements alone have no medium around the body";
            let help = "use \"auto\", \"fem-bem\" or \"msfem-bem\", or remove [exterior]";
            return refuse(Kind::Conflict, &["method", "model"], message, help);
        }
        if self.is_cavity() {
            if coupled {
                let message = "the scene has no [material] of a body: it is a hole in the medium of [exterior]";
                return refuse(
                    Kind::Conflict,
                    &["method", "model"],
                    message,
                    "use \"bem\" or \"auto\", or add [material]",
                );
            }
            if self.body().force.is_some() {
                let message = "an unbounded medium cannot carry a body force";
                let help = "give the stress that it makes as exterior.remote_stress, or load the sides of the hole";
                return refuse(Kind::Unsupported, &["body_force"], message, help);
            }
            return Ok(());
        }
        for (index, side) in self.problem.sides.iter().enumerate() {
            let key = ["sides", side.name.as_str()];
            let on_interface = self.interface().any(|(_, edge)| edge.side == index);
            let touched = self.problem.contact(index).is_some();
            match &side.condition {
                Condition::Free if !touched => {}
                _ if on_interface => {
                    let message = format!("side {:?} is where the body meets the medium of [exterior]", side.name);
                    let help = "remove it; jumps there are exterior.displacement_jump and traction_jump";
                    return refuse(Kind::Conflict, &key, &message, help);
                }
                Condition::Free | Condition::Displacement { .. } => {
                    let message = format!("side {:?} of a hole may be loaded, but not held or touched", side.name);
                    let help = "give it a traction or a pressure: the medium holds the body";
                    return refuse(Kind::Unsupported, &key, &message, help);
                }
                Condition::Traction(_) | Condition::Pressure(_) => {}
            }
        }
        if self.random.is_some() {
            let message = "random input of a body in a medium needs boundary elements: one material, no [grid] that is asked for, no \
                           stress_jump, and a force that is affine in x and y";
            let help = "give numbers to [material] and leave method.model at \"auto\", or leave out [random]";
            return refuse(Kind::Unsupported, &["random"], message, help);
        }
        if model == Model::Bem {
            let help = format!("{}; or use model = \"fem-bem\" with a [grid]", without_medium_around(self));
            if self.problem.outline.loops().len() > 1 {
                let message = "boundary elements of a body in a medium cannot have holes in the body";
                return refuse(Kind::Unsupported, &["body", "holes"], message, &help);
            }
            if self.body().force.is_some() {
                let message = "boundary elements of a body in a medium carry no body force";
                return refuse(Kind::Unsupported, &["body_force"], message, &help);
            }
            if self.method.indicator == Indicator::Residual {
                let message = "boundary elements of a body in a medium have no residual indicator";
                return refuse(Kind::Unsupported, &["method", "indicator"], message, "leave it at \"bubble\"");
            }
        }
        let conforming = |basis| !matches!(basis, BasisInput::Oversampled | BasisInput::Periodic);
        if model == Model::MsfemBem && self.body().grid.is_some_and(|grid| !conforming(grid.basis)) {
            let message = "the basis has no single displacement where the body meets the medium";
            let help = "take \"coupled\", \"oscillatory\", \"linear\" or \"q1\"";
            return refuse(Kind::Unsupported, &["grid", "basis"], message, help);
        }
        Ok(())
    }
}
