//! The scene's data on a mesh: prescribed displacements, loads, gaps and friction bounds.

use steklov_bem_operators::{
    BemError, Datum, Location, Mesh, ParticularSolution, Site, Space, add_load, side_moments, side_moments_and_squares,
};
use steklov_contact::oscillation;
use steklov_elastic::Material;
use steklov_elastic::plane::dot;
use steklov_expression::{Expression, Piece};
use steklov_problem::{Condition, DataError, Interface, Law, Scene, Tie};
use steklov_quadrature::{LobattoBasis, legendre_p};

use crate::data::body_load::Particulars;
use crate::data::supports::Held;
use crate::error::SolveError;

/// A scene on a mesh.
pub struct OnMesh<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The elements.
    pub mesh: &'a Mesh,
    /// Their nodes.
    pub space: &'a Space,
}

/// Integrals of the tractions and pressures.
#[derive(Debug, Clone)]
pub struct Loads {
    /// ∫ t·φ of the nodal functions, interleaved.
    pub nodal: Vec<f64>,
    /// ∫ t·b of the bubbles, two for each element.
    pub bubbles: Vec<f64>,
    /// h/(p+2) ‖t - Π_(p+1) t‖² of each element (force²): divided by E* the energy of the part that its degree, raised by one,
    /// does not resolve.
    pub unresolved: Vec<f64>,
    /// What the nodal loads lack of the work on rotations of bodies with curves; empty for nothing.
    pub turning: Vec<f64>,
}

impl Loads {
    /// The integrals of the tractions times a factor.
    pub fn scale(&mut self, factor: f64) {
        self.nodal.iter_mut().chain(&mut self.bubbles).chain(&mut self.turning).for_each(|t| *t *= factor);
        self.unresolved.iter_mut().for_each(|t| *t *= factor * factor);
    }
}

/// The factor of an expression at a point.
pub type Factor<'a> = &'a (dyn Fn(&Site) -> f64 + Sync);

/// The callback for each traction: side, name, expression, its factor, direction on an element.
pub type OfTraction<'a> =
    dyn FnMut(usize, &str, &Expression, Factor<'_>, &dyn Fn(usize) -> [f64; 2]) -> Result<(), SolveError> + 'a;

/// The name of a jump of the traction across a tie.
pub(crate) const TRACTION_JUMP: &str = "traction jump";

/// Data that change within less than these parts of an edge and of an element are integrated separately.
const NARROW: f64 = 1.0 / 128.0;
const NARROW_IN_ELEMENT: f64 = 1.0 / 8.0;
/// Changes below this part of the largest value do not count.
const SMALL: f64 = 1e-3;
/// Rounding error of the resolved part, relative to ∫ t².
const ROUNDING: f64 = 1e-14;

/// An element of degree 1 and the moments of its traction against the functions of its ends.
pub type SideLoad = (usize, [[f64; 2]; 2]);

impl OnMesh<'_> {
    /// The material of the body of an element.
    pub(crate) fn material_of(&self, e: usize) -> Material {
        let problem = &self.scene.problem;
        problem.body_of(&problem.outline.edges()[self.mesh.edge[e]]).material()
    }

    /// Prescribed displacement of every node.
    ///
    /// # Errors
    /// [`SolveError::Data`] for a displacement without a finite value or with a pole on its side,
    /// [`SolveError::Incompatible`] if two sides hold a common point at different displacements: make them equal there, or
    /// free one of them.
    pub fn held(&self) -> Result<Vec<Held>, SolveError> {
        let (mesh, space) = (self.mesh, self.space);
        let mut held = vec![Held::default(); space.nodes()];
        for (index, side) in self.scene.problem.sides.iter().enumerate() {
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            for expression in values.iter().flatten().filter(|e| e.constant().is_none()) {
                // only for its errors: the nodes alone do not see a pole between them
                let function = self.function(expression);
                let moments = side_moments(mesh, space, index, &function.datum("displacement"));
                moments.map_err(|error| self.located(error, expression))?;
            }
        }
        let mut prescribed = Vec::new();
        for e in 0..mesh.len() {
            let side = &self.scene.problem.sides[mesh.side[e]];
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            for (j, node) in space.element_nodes(e).enumerate() {
                let site = Site::new(mesh, e, space.basis(e).nodes[j]);
                for (component, value) in values.iter().enumerate() {
                    let Some(expression) = value else { continue };
                    let at = (site.point[0], site.point[1], self.mesh.arc_fraction(site.element, site.t));
                    let value = self.scene.check_value(&side.name, "displacement", expression, at)?;
                    prescribed.push((node, component, value, mesh.side[e]));
                }
            }
        }
        let largest = prescribed.iter().fold(0.0, |m: f64, p| m.max(p.2.abs()));
        for (node, component, value, side) in prescribed {
            // where two sides hold a node they must agree up to rounding
            let (first_value, first) = *held[node].components[component].get_or_insert((value, side));
            if (first_value - value).abs() > 1e-9 * largest {
                let name = |side: usize| mesh.side_names[side].clone();
                return Err(SolveError::Incompatible {
                    first: name(first),
                    second: name(side),
                    point: space.points[node],
                    component: ['x', 'y'][component],
                    a: first_value,
                    b: value,
                });
            }
        }
        Ok(held)
    }

    /// The tractions and pressures, and, if a medium is around the body, the jump of the traction with that of the remote
    /// stress.
    ///
    /// # Errors
    /// [`SolveError::Data`] for a traction, a pressure or a jump that is not finite or cannot be integrated: correct its
    /// expression.
    pub fn load(&self) -> Result<Loads, SolveError> {
        let mut unresolved = vec![0.0; self.mesh.len()];
        let (mut load, mut extra) = (vec![0.0; self.space.dofs()], vec![0.0; 2 * self.mesh.len()]);
        let raised = Space::new(&self.mesh.raised(&vec![true; self.mesh.len()]));
        self.each_traction(&mut |index, name, expression, factor, direction| {
            let followed = self.followed(&raised, index, name, expression, factor)?;
            let mut moments = Vec::with_capacity(followed.len());
            for Followed { element: e, moments: of_element, bubble, rest } in followed {
                let d = direction(e);
                unresolved[e] += rest * dot(d, d);
                (0..2).for_each(|i| extra[2 * e + i] += d[i] * bubble);
                moments.push((e, of_element));
            }
            add_load(&mut load, self.space, &moments, direction);
            Ok(())
        })?;
        if let Some(remote) = self.scene.remote_stress() {
            load.iter_mut().zip(remote.traction_load(self.mesh, self.space)).for_each(|(f, t)| *f += t);
            extra.iter_mut().zip(remote.bubble_load(self.mesh, self.space)).for_each(|(f, t)| *f += t);
        }
        Ok(Loads { nodal: load, bubbles: extra, unresolved, turning: Vec::new() })
    }

    /// ∫ of a datum over each element of a side.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub(crate) fn integrals(
        &self,
        side: usize,
        name: &str,
        expression: &Expression,
        factor: Factor<'_>,
    ) -> Result<Vec<(usize, f64)>, SolveError> {
        let function = self.times(expression, factor);
        let found = side_moments(self.mesh, self.space, side, &function.datum(name));
        let moments = found.map_err(|error| self.located(error, expression))?;
        // the nodal functions add up to 1
        Ok(moments.into_iter().map(|(e, moments)| (e, moments.iter().sum())).collect())
    }

    /// The part of a datum that the elements of a side resolve; `raised` has their degrees plus one.
    pub(crate) fn followed(
        &self,
        raised: &Space,
        side: usize,
        name: &str,
        expression: &Expression,
        factor: Factor<'_>,
    ) -> Result<Vec<Followed>, SolveError> {
        let function = self.times(expression, factor);
        let found = side_moments_and_squares(self.mesh, raised, side, &function.datum(name));
        let (moments, squares) = found.map_err(|error| self.located(error, expression))?;
        let of = |((element, mut moments), square): ((usize, Vec<f64>), f64)| {
            let (bubble, followed) = to_hierarchical(self.space.basis(element), raised.basis(element), &mut moments);
            let (h, p) = (self.mesh.length(element), self.space.degree(element));
            let rest = h / (p + 2) as f64 * (square - followed / h - ROUNDING * square).max(0.0);
            Followed { element, moments, bubble, rest }
        };
        Ok(moments.into_iter().zip(squares).map(of).collect())
    }

    /// Adds the part of the friction bounds that elements which may slip do not resolve, under Coulomb's law for the largest
    /// pressure.
    ///
    /// # Errors
    /// [`SolveError::Data`] for a friction bound or coefficient that is not finite or cannot be integrated: correct its
    /// expression.
    pub fn add_unresolved_bounds(
        &self,
        unresolved: &mut [f64],
        pressure: f64,
        slips: &dyn Fn(usize) -> bool,
    ) -> Result<(), SolveError> {
        let sides = self.contact_sides();
        let bounds = sides.iter().flat_map(|s| {
            [(s.index, "friction bound", s.bound, 1.0), (s.index, "friction coefficient", s.coefficient, pressure)]
        });
        let raised = Space::new(&self.mesh.raised(&vec![true; self.mesh.len()]));
        for (side, name, bound, factor) in bounds {
            let Some(bound) = bound.filter(|b| b.constant().is_none()) else { continue };
            for part in
                self.followed(&raised, side, name, bound, &|_| 1.0)?.into_iter().filter(|part| slips(part.element))
            {
                unresolved[part.element] += part.rest * factor * factor;
            }
        }
        Ok(())
    }

    /// Moments of tractions, pressures and jumps of the traction on each element of degree 1, without the remote stress; an
    /// element with several data appears several times.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn side_loads(&self) -> Result<Vec<SideLoad>, SolveError> {
        let mut loads = Vec::new();
        self.each_traction(&mut |index, name, expression, _, direction| {
            let function = self.function(expression);
            let moments = side_moments(self.mesh, self.space, index, &function.datum(name));
            for (e, moments) in moments.map_err(|error| self.located(error, expression))? {
                let d = direction(e);
                loads.push((e, [moments[0], moments[1]].map(|m| d.map(|d| d * m))));
            }
            Ok(())
        })?;
        Ok(loads)
    }

    /// The components of the traction (stress) that the condition of its side gives at the reference coordinate t of element
    /// e, with that of springs at the displacement u; none for held components and where sides meet something.
    pub fn given_traction(&self, e: usize, t: f64, u: [f64; 2]) -> [Option<f64>; 2] {
        let (problem, side, site) = (&self.scene.problem, self.mesh.side[e], Site::new(self.mesh, e, t));
        let meets =
            |interface: &Interface| interface.sides.contains(&side) || problem.facing_sides(interface).contains(&side);
        if problem.interfaces().iter().any(meets) {
            return [None; 2];
        }
        let value = |expression: &Expression| self.value(expression, &site);
        let given = match &problem.sides[side].condition {
            Condition::Free => [Some(0.0); 2],
            Condition::Traction(traction) => traction.each_ref().map(|t| Some(value(t))),
            Condition::Pressure(pressure) => self.mesh.normal(e, t).map(|n| Some(-value(pressure) * n)),
            Condition::Displacement { values, traction } => [0, 1].map(|i| {
                let given = || traction.as_ref().map_or(0.0, |traction| value(&traction[i]));
                values[i].is_none().then(given)
            }),
        };
        let pull = problem.sides[side].springs.as_ref().map_or([0.0; 2], |springs| {
            let directions = springs.directions(self.mesh.normal(e, t));
            let of = |(k, d): (&Expression, [f64; 2])| d.map(|c| value(k) * dot(d, u) * c);
            springs.stiffnesses().into_iter().zip(directions).map(of).fold([0.0; 2], |s, f| [s[0] + f[0], s[1] + f[1]])
        });
        [0, 1].map(|i| given[i].map(|t| t - pull[i]))
    }

    /// Calls `call` with the side, name, expression and direction on each element of every traction, pressure and jump of the
    /// traction.
    ///
    /// # Errors
    /// The first error of `call`, which ends the calls; it has none of its own.
    pub fn each_traction(&self, call: &mut OfTraction<'_>) -> Result<(), SolveError> {
        for (index, side) in self.scene.problem.sides.iter().enumerate() {
            match &side.condition {
                Condition::Traction(traction) | Condition::Displacement { traction: Some(traction), .. } => {
                    for (expression, direction) in traction.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                        if expression.constant() != Some(0.0) {
                            call(index, "traction", expression, &|_| 1.0, &|_| direction)?;
                        }
                    }
                }
                Condition::Pressure(pressure) => {
                    self.along_normals(index, "pressure", pressure, &|_, n| n.map(|n| -n), call)?;
                }
                _ => {}
            }
        }
        for interface in self.scene.problem.joints() {
            let Law::Tied(Tie { traction_jump: Some(jump), .. }) = &interface.law else { continue };
            let tied = |site: &Site| {
                let seen = self.scene.problem.seen(interface, self.mesh.edge[site.element], site.s);
                f64::from(u8::from(seen.is_some()))
            };
            for (expression, direction) in jump.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                for &side in interface.sides.iter().filter(|_| expression.constant() != Some(0.0)) {
                    call(side, TRACTION_JUMP, expression, &tied, &|_| direction)?;
                }
            }
        }
        let edges = self.scene.problem.outline.edges();
        for (name, expression, direction) in self.scene.traction_jumps() {
            for side in self.interface_sides() {
                let of = |e: usize, n: [f64; 2]| match edges[self.mesh.edge[e]].loop_index {
                    0 => direction(n),
                    _ => [0.0; 2],
                };
                self.along_normals(side, name, expression, &of, call)?;
            }
        }
        Ok(())
    }

    /// Calls `call` with a datum times a direction that follows from the normal: once for straight elements, for x and for y
    /// on curved ones.
    fn along_normals(
        &self,
        side: usize,
        name: &str,
        expression: &Expression,
        of: &(dyn Fn(usize, [f64; 2]) -> [f64; 2] + Sync),
        call: &mut OfTraction<'_>,
    ) -> Result<(), SolveError> {
        let straight = |e: usize| self.mesh.is_line(e);
        let on_side = || (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == side);
        if on_side().any(straight) {
            let direction = |e: usize| if straight(e) { of(e, self.mesh.normal(e, 0.0)) } else { [0.0; 2] };
            call(side, name, expression, &|_| 1.0, &direction)?;
        }
        if on_side().all(straight) {
            return Ok(());
        }
        for i in 0..2 {
            let factor = |site: &Site| of(site.element, self.mesh.normal(site.element, site.t))[i];
            let direction = |e: usize| [0, 1].map(|k| if k == i && !straight(e) { 1.0 } else { 0.0 });
            call(side, name, expression, &factor, &direction)?;
        }
        Ok(())
    }

    /// ‖w‖ ‖dw/ds‖ of the held displacements less their interpolants, summed over the components: (element, length²).
    ///
    /// # Errors
    /// [`SolveError`] for a displacement that is not finite or cannot be integrated along an element: correct its expression.
    pub fn held_oscillation(&self, particular: &Particulars) -> Result<Vec<(usize, f64)>, SolveError> {
        let mut found = Vec::new();
        for (index, side) in self.scene.problem.sides.iter().enumerate() {
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            let body = self.particular_of_side(particular, index);
            for (expression, direction) in values.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                let Some(expression) = expression else { continue };
                if expression.constant().is_some() && body.is_none() {
                    continue;
                }
                let function = self.less_particular(expression, body, |_| direction);
                for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == index) {
                    found.push((e, oscillation(self.mesh, self.space, e, &function.datum("displacement"))?));
                }
            }
        }
        Ok(found)
    }

    /// The particular solution of the body of a side.
    pub(crate) fn particular_of_side<'p>(
        &self,
        particular: &'p Particulars,
        side: usize,
    ) -> Option<&'p ParticularSolution> {
        particular.of(self.mesh.side.iter().position(|&of| of == side)?)
    }

    /// An expression less the particular solution along a direction.
    pub(crate) fn less_particular<'e>(
        &'e self,
        expression: &'e Expression,
        body: Option<&'e ParticularSolution>,
        direction: impl Fn(&Site) -> [f64; 2] + Sync + 'e,
    ) -> Function<'e> {
        let plain = self.function(expression);
        let Some(body) = body else { return plain };
        let value = move |site: &Site| {
            let (u, d) = (body.displacement(site.point), direction(site));
            (plain.value)(site) - u[0] * d[0] - u[1] * d[1]
        };
        Function { value: Box::new(value), ..plain }
    }

    /// The value of an expression at a point of the boundary.
    pub(crate) fn value(&self, expression: &Expression, site: &Site) -> f64 {
        let s = if expression.uses_edge() { self.mesh.arc_fraction(site.element, site.t) } else { site.s };
        expression.eval(site.point[0], site.point[1], s)
    }

    pub(crate) fn function<'e>(&'e self, expression: &'e Expression) -> Function<'e> {
        Function {
            value: Box::new(move |site: &Site| self.value(expression, site)),
            kinks: Box::new(move |e: usize| self.breaks(expression, e)),
            rounding: None,
        }
    }

    /// An expression times a factor.
    fn times<'e>(&'e self, expression: &'e Expression, factor: Factor<'e>) -> Function<'e> {
        let plain = self.function(expression);
        Function { value: Box::new(move |site: &Site| (plain.value)(site) * factor(site)), ..plain }
    }

    /// Whether an expression changes within a small part of an element, or is not known there.
    pub fn is_narrow(&self, expression: &Expression, e: usize) -> bool {
        let [a, b] = self.mesh.span[e];
        let (low, high) = (a.min(b), a.max(b));
        let along = expression.along(&self.scene.problem.outline.edges()[self.mesh.edge[e]]);
        let inside = |p: &&Piece| p.ends[0] < high && p.ends[1] > low;
        let unknown = along.survey.pieces.iter().filter(inside).any(|p| !p.known);
        unknown || !along.survey.narrow([low, high], NARROW_IN_ELEMENT * (high - low), SMALL).is_empty()
    }

    /// Reference coordinates inside of an element at which an expression has kinks, and those that separate features too
    /// narrow for rules over the whole element.
    fn breaks(&self, expression: &Expression, e: usize) -> Vec<f64> {
        if expression.constant().is_some() {
            return Vec::new();
        }
        let [a, b] = self.mesh.span[e];
        let along = expression.along(&self.scene.problem.outline.edges()[self.mesh.edge[e]]);
        let (low, high) = (a.min(b), a.max(b));
        let kinks = along.kinks.iter().copied().filter(|s| low < *s && *s < high);
        let narrow = along.survey.narrow([low, high], NARROW.min(NARROW_IN_ELEMENT * (high - low)), SMALL);
        let mut breaks: Vec<f64> = kinks.chain(narrow).map(|s| (2.0 * s - a - b) / (b - a)).collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    /// An error of the numerics about an expression, with the place of the expression in the scene.
    pub fn located(&self, error: BemError, expression: &Expression) -> SolveError {
        match &error {
            BemError::DataNotFinite { name, side, point, .. } => {
                let Location::Boundary { s, .. } = self.scene.problem.outline.contains(*point) else {
                    return error.into();
                };
                match self.scene.check_value(side, name, expression, (point[0], point[1], s)) {
                    Err(error) => error.into(),
                    // rounding of s or of the point: the value was not finite all the same
                    Ok(_) => DataError::of_values(expression, &error.to_string()).into(),
                }
            }
            BemError::DataRough { .. } => DataError::of_values(expression, &error.to_string()).into(),
            _ => error.into(),
        }
    }
}

/// Turns moments against the nodal functions of degree p+1 into those against the nodal functions of degree p; returns the
/// moment against the bubble (P_(p+1) - P_(p-1))/(2p+1), and Σ (2k+1) m_k² of those against P_0, .., P_(p+1): the length of
/// the element times the square of the part of the datum that degree p+1 resolves.
fn to_hierarchical(basis: &LobattoBasis, raised: &LobattoBasis, moments: &mut Vec<f64>) -> (f64, f64) {
    let p = basis.degree;
    let (mut phi, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
    let (mut nodal, mut against) = (vec![0.0; p + 1], vec![0.0; p + 2]);
    for (&t, &moment) in raised.nodes.iter().zip(moments.iter()) {
        basis.evaluate(t, &mut phi);
        legendre_p(t, &mut legendre);
        nodal.iter_mut().zip(&phi).for_each(|(sum, phi)| *sum += phi * moment);
        against.iter_mut().zip(&legendre).for_each(|(sum, p)| *sum += p * moment);
    }
    *moments = nodal;
    let followed = against.iter().enumerate().map(|(k, m)| (2 * k + 1) as f64 * m * m).sum();
    ((against[p + 1] - against[p - 1]) / (2 * p + 1) as f64, followed)
}

/// The part of a datum that an element resolves.
pub(crate) struct Followed {
    pub(crate) element: usize,
    /// Against its nodal functions.
    moments: Vec<f64>,
    /// Against its bubble.
    bubble: f64,
    /// h/(p+2) ‖t - Π_(p+1) t‖² of the rest.
    pub(crate) rest: f64,
}

/// Values at points of the boundary.
pub(crate) type AtSites<'a> = Box<dyn Fn(&Site) -> f64 + Sync + 'a>;

/// An expression as a datum of the numerics.
pub(crate) struct Function<'a> {
    pub(crate) value: AtSites<'a>,
    pub(crate) kinks: Box<dyn Fn(usize) -> Vec<f64> + Sync + 'a>,
    /// As [`Datum::rounding`].
    pub(crate) rounding: Option<AtSites<'a>>,
}

impl Function<'_> {
    pub(crate) fn datum<'a>(&'a self, name: &'a str) -> Datum<'a> {
        Datum { name, value: &*self.value, kinks: &*self.kinks, rounding: self.rounding.as_deref() }
    }
}
