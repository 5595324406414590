//! Whether the data at a vertex leave the stress bounded where no exponent makes it infinite.
//!
//! ```text
//! tractions, changes of prescribed displacements and of gaps with r, jumps of both in ties, shears of Tresca's friction: on the rays of
//! the wedge they are constant to first order; if no stress that is constant with r bears them, it grows like log(1/r)
//! ```
//! The traction of a spring is in proportion to a displacement that is not known here: any one is looked at.

use steklov_elastic::plane::{dot, turned};
use steklov_elastic::{Datum, Face, Joint, Wedge};
use steklov_expression::{Expression, OnEdge, Track};
use steklov_problem::{Condition, Contact, Friction, Interface, Law, Scene, Tie};

use crate::answer::wedges::{Ray, nearest_row};
use crate::solve::contact_rows::ContactRow;

/// Distance from the vertex at which data are looked at, as part of the edge.
const NEAR: f64 = 1e-6;
/// Part of the data that is their rounding.
const SMALL: f64 = 1e-4;
/// Parts of an edge between which its data are sampled for their size.
const PARTS: u32 = 32;

/// What the data of springs are multiplied by.
#[derive(Clone, Copy)]
enum Given {
    /// All but springs.
    Data,
    /// Springs for a displacement along x or y.
    Springs([f64; 2]),
}

/// A ray between two bodies, with the interface that joins them.
pub(crate) struct Between<'a> {
    /// The ray of the side that carries the multipliers.
    pub own: Ray,
    /// None of the medium around a body.
    pub interface: Option<&'a Interface>,
    /// Whether the side belongs to the body before the ray, counter-clockwise.
    pub is_before: bool,
}

/// What is known at the rays of a wedge.
pub(crate) struct AtVertex<'a> {
    pub scene: &'a Scene,
    pub rows: &'a [ContactRow],
    /// Whether slopes of gaps count.
    pub has_gaps: bool,
}

impl AtVertex<'_> {
    /// Whether the data of a wedge, whose faces lie along rays, let the stress grow like a logarithm: None if not, else whether the
    /// pressure grows so too.
    pub fn logarithm(&self, wedge: &Wedge, faces: Option<[Ray; 2]>, joints: &[Between<'_>]) -> Option<bool> {
        let all = [Given::Data, Given::Springs([1.0, 0.0]), Given::Springs([0.0, 1.0])];
        let has_springs = self.scene.problem.has_springs();
        let found = all[..if has_springs { 3 } else { 1 }].iter().filter_map(|given| {
            let mut size = 0.0f64;
            let mut of = |f: &dyn Fn(f64) -> Datum, ray: Ray, mu: f64| {
                size = (0..=PARTS).map(|i| norm(f(f64::from(i) / f64::from(PARTS)), mu)).fold(size, f64::max);
                ray.limit(f)
            };
            let mu = wedge.sectors.iter().map(|s| s.mu).fold(0.0, f64::max);
            let mut own = [Datum::default(); 2];
            if let Some((rays, kinds)) = faces.zip(wedge.faces) {
                for k in 0..2 {
                    own[k] = of(&|s| self.of_face(rays[k], s, k == 0, kinds[k], *given), rays[k], mu);
                }
            }
            let joint = |(k, between): (usize, &Between<'_>)| {
                let sliding = matches!(wedge.joints.get(k), Some(Joint::Sliding(_)));
                of(&|s| self.of_joint(between, s, sliding, *given), between.own, mu)
            };
            let joints: Vec<Datum> = joints.iter().enumerate().map(joint).collect();
            wedge.logarithm(own, &joints, SMALL * size)
        });
        found.reduce(|a, b| a || b)
    }

    /// The data on a face, at an edge parameter.
    fn of_face(&self, ray: Ray, s: f64, is_first: bool, face: Face, given: Given) -> Datum {
        let problem = &self.scene.problem;
        let edge = &problem.outline.edges()[ray.edge];
        let axes = self.axes(ray, s);
        let sign = if is_first { -1.0 } else { 1.0 };
        let pulled = |t: [f64; 2]| Datum { traction: axes.map(|axis| sign * dot(t, axis)), ..Datum::default() };
        let at = |datum: &Expression| self.value(ray, datum, s);
        let side = &problem.sides[edge.side];
        if let Given::Springs(u) = given {
            let Some(springs) = &side.springs else { return Datum::default() };
            let directions = springs.directions(edge.normal(s));
            let parts =
                springs.stiffnesses().into_iter().zip(directions).map(|(k, d)| d.map(|x| at(k) * dot(d, u) * x));
            return pulled(parts.fold([0.0; 2], |sum, t| [sum[0] + t[0], sum[1] + t[1]]));
        }
        if let Some(contact) = self.scene.contact(edge.side).filter(|_| problem.joint(edge.side).is_none()) {
            let shear = self.shear(ray, contact);
            let closed = face != Face::Free;
            let gap = if closed && self.has_gaps { self.slope(ray, &contact.gap, s) } else { 0.0 };
            return Datum { displacement: [0.0, sign * gap], traction: [shear, 0.0] };
        }
        match &side.condition {
            Condition::Free => Datum::default(),
            Condition::Traction(t) => pulled([at(&t[0]), at(&t[1])]),
            Condition::Pressure(q) => pulled(edge.normal(s).map(|n| -at(q) * n)),
            Condition::Displacement { values, traction } => {
                let slope = |value: &Option<Expression>| value.as_ref().map_or(0.0, |v| self.slope(ray, v, s));
                let changes = [slope(&values[0]), slope(&values[1])];
                let pulled = pulled(traction.as_ref().map_or([0.0; 2], |t| [at(&t[0]), at(&t[1])]));
                Datum { displacement: axes.map(|axis| dot(changes, axis)), ..pulled }
            }
        }
    }

    /// The jumps at a joint, of the body before it less the one behind.
    fn of_joint(&self, between: &Between<'_>, s: f64, sliding: bool, given: Given) -> Datum {
        if matches!(given, Given::Springs(_)) {
            return Datum::default();
        }
        let ray = between.own;
        let axes = self.axes(ray, s);
        let side = if between.is_before { 1.0 } else { -1.0 };
        let tie = match between.interface.map(|interface| &interface.law) {
            Some(Law::Contact(contact)) => {
                let shear = if sliding { self.shear(ray, contact) } else { 0.0 };
                let gap = if self.has_gaps { self.slope(ray, &contact.gap, s) } else { 0.0 };
                return Datum { displacement: [0.0, gap], traction: [shear, 0.0] };
            }
            Some(Law::Tied(tie)) => Some(tie),
            None => self.scene.problem.tie(),
        };
        let Some(tie) = tie else { return Datum::default() };
        let changes =
            tie.displacement_jump.as_ref().map_or([0.0; 2], |jump| jump.each_ref().map(|v| self.slope(ray, v, s)));
        // t = ±σ e_θ of the body before, as its normal is e_θ, and of the one behind
        let pulled = self.traction_jump(tie, ray, s);
        Datum { displacement: axes.map(|axis| side * dot(changes, axis)), traction: axes.map(|axis| dot(pulled, axis)) }
    }

    fn traction_jump(&self, tie: &Tie, ray: Ray, s: f64) -> [f64; 2] {
        let at = |datum: &Expression| self.value(ray, datum, s);
        let [x, y] = self.scene.problem.outline.edges()[ray.edge].normal(s);
        let mut pulled = tie.traction_jump.as_ref().map_or([0.0; 2], |jump| jump.each_ref().map(at));
        if let Some([xx, yy, xy]) = tie.stress_jump.as_ref().map(|jump| jump.each_ref().map(at)) {
            pulled = [pulled[0] + xx * x + xy * y, pulled[1] + xy * x + yy * y];
        }
        pulled
    }

    /// λ_t of Tresca's law at the node next to the vertex.
    fn shear(&self, ray: Ray, contact: &Contact) -> f64 {
        if !matches!(contact.friction, Friction::Tresca(_)) {
            return 0.0;
        }
        nearest_row(self.scene, self.rows, ray).map_or(0.0, |row| row.shear)
    }

    /// The unit vectors along the ray and turned from it by +90 degrees.
    fn axes(&self, ray: Ray, s: f64) -> [[f64; 2]; 2] {
        let edge = &self.scene.problem.outline.edges()[ray.edge];
        let forward = ray.rising != edge.reversed;
        let along = edge.tangent(s).map(|x| if forward { x } else { -x });
        [along, turned(along)]
    }

    fn value(&self, ray: Ray, datum: &Expression, s: f64) -> f64 {
        let (x, y, s) = OnEdge::new(&self.scene.problem.outline.edges()[ray.edge], datum).at(s);
        datum.eval(x, y, s)
    }

    /// The change of a datum with the length along the ray.
    fn slope(&self, ray: Ray, datum: &Expression, s: f64) -> f64 {
        if datum.constant().is_some() {
            return 0.0;
        }
        let step = if ray.rising { NEAR } else { -NEAR };
        // inside of the edge
        let s = if (0.0..=1.0).contains(&(s + step)) { s } else { s - step };
        let length = self.scene.problem.outline.edges()[ray.edge].length();
        (self.value(ray, datum, s + step) - self.value(ray, datum, s)) / (NEAR * length)
    }
}

impl Ray {
    /// The limit of data at the beginning of the ray.
    fn limit(self, f: &dyn Fn(f64) -> Datum) -> Datum {
        let step = if self.rising { NEAR } else { -NEAR };
        let [near, far] = [1.0, 2.0].map(|steps| f(self.s + steps * step));
        let beyond = |a: [f64; 2], b: [f64; 2]| [2.0 * a[0] - b[0], 2.0 * a[1] - b[1]];
        Datum {
            displacement: beyond(near.displacement, far.displacement),
            traction: beyond(near.traction, far.traction),
        }
    }
}

/// The size of data as stresses.
fn norm(datum: Datum, mu: f64) -> f64 {
    let [u, v] = datum.displacement;
    let [t, s] = datum.traction;
    (2.0 * mu * u.hypot(v)).max(t.hypot(s))
}
