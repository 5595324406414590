//! Contact problems of a unit square, solved, with their residuals.

use faer::{Col, Mat};
use num_complex::Complex64;
use steklov_bem_operators::{
    BoundaryField, BoundaryResidual, Condensation, Datum, Domain, Loop, Mesh, Operators, ParticularSolution, Partition,
    Polygon, Site, Space, Steklov, add_load, boundary_residuals, side_moments,
};
use steklov_contact::{
    ContactResidual, ContactSolution, Multiplier, Problem, SideData, Solution, contact_boundary, contact_residuals,
    newton,
};
use steklov_elastic::{Material, Plane};

type Vector = [f64; 2];
type OfPoint<T> = Box<dyn Fn(&Site) -> T + Sync>;

fn turned(angle: f64, [x, y]: Vector) -> Vector {
    [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos()]
}

/// The unit square about the origin, turned; the floor is its first side.
pub fn square(angle: f64) -> Polygon {
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|x| turned(angle, x)).to_vec();
    let sides = ["floor", "right", "top", "left"].map(String::from).to_vec();
    Polygon::new(Loop::straight(corners, sides), Vec::new()).expect("a square")
}

/// Elastic field in the frame of the square: a linear one (a translation and a gradient), the one of the potential
/// φ = curved e^z, and the particular one of a body force.
#[derive(Clone, Copy)]
pub struct Field {
    pub material: Material,
    pub shift: Vector,
    pub gradient: [Vector; 2],
    pub curved: f64,
    pub body_force: Option<ParticularSolution>,
}

impl Field {
    /// 2μ (u + iv) = κφ - z conj(φ').
    fn displacement(&self, x: Vector) -> Vector {
        let z = Complex64::new(x[0], x[1]);
        let e = self.curved * z.exp();
        let w = (self.material.kappa() * e - z * e.conj()) / (2.0 * self.material.mu());
        let particular = self.body_force.map_or([0.0; 2], |b| b.displacement(x));
        let linear = |i: usize| self.shift[i] + self.gradient[i][0] * x[0] + self.gradient[i][1] * x[1];
        [linear(0) + w.re + particular[0], linear(1) + w.im + particular[1]]
    }

    /// σ_xx + σ_yy = 4 Re φ', σ_yy - σ_xx + 2iσ_xy = 2 conj(z) φ''.
    fn stress(&self, x: Vector) -> [f64; 3] {
        let z = Complex64::new(x[0], x[1]);
        let e = self.curved * z.exp();
        let (sum, difference) = (4.0 * e.re, 2.0 * z.conj() * e);
        let curved = [(sum - difference.re) / 2.0, (sum + difference.re) / 2.0, difference.im / 2.0];
        let (linear, particular) =
            (self.material.stress(self.gradient), self.body_force.map_or([0.0; 3], |b| b.stress(x)));
        [0, 1, 2].map(|i| curved[i] + linear[i] + particular[i])
    }

    fn traction(&self, x: Vector, n: Vector) -> Vector {
        let [xx, yy, xy] = self.stress(x);
        [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]]
    }
}

/// A square in contact along its floor; the other sides are held or loaded.
pub struct Case {
    mesh: Mesh,
    material: Material,
    body_force: Option<ParticularSolution>,
    held: [bool; 4],
    displacement: Box<dyn Fn(Vector) -> Vector>,
    traction: OfPoint<Vector>,
    gap: OfPoint<f64>,
    bound: OfPoint<f64>,
}

pub struct Solved {
    mesh: Mesh,
    space: Space,
    stiffness: Mat<f64>,
    displacement: Vec<f64>,
    field: BoundaryField,
    pub solution: Solution,
    pub contact: Vec<ContactResidual>,
    pub boundary: Vec<BoundaryResidual>,
}

impl Case {
    /// The square turned by `angle`, such that the field solves it: g = u_n, F = λ_t on the floor (or `bound`).
    pub fn of_field(mesh: Mesh, field: Field, angle: f64, held: [bool; 4], bound: Option<f64>) -> Self {
        let back = move |x: Vector| turned(-angle, x);
        let normals: Vec<Vector> = (0..mesh.len()).map(|e| back(mesh.normal(e, 0.0))).collect();
        Self {
            mesh,
            material: field.material,
            body_force: field.body_force,
            held,
            displacement: Box::new(move |x| turned(angle, field.displacement(back(x)))),
            traction: Box::new(move |x| turned(angle, field.traction(back(x.point), normals[x.element]))),
            gap: Box::new(move |x| -field.displacement(back(x.point))[1]),
            bound: Box::new(move |x| bound.unwrap_or_else(|| field.stress(back(x.point))[2])),
        }
    }

    /// Problem 2.7 of the thesis: a block on a rigid floor, held by friction alone.
    pub fn block(mesh: Mesh) -> Self {
        let sides = mesh.side.clone();
        let traction = move |site: &Site| {
            let [x, y] = site.point;
            let side = [-400.0 * x.signum() * (-10.0 * (y + 0.3).powi(2)).exp(), 10.0].map(|f| f * (0.25 - y * y));
            if sides[site.element] == 2 { [0.0, -500.0 * (0.25 - x * x).powi(2)] } else { side }
        };
        Self {
            mesh,
            material: Material::new(200.0, 0.3, Plane::Strain).expect("valid"),
            body_force: None,
            held: [false; 4],
            displacement: Box::new(|_| [0.0; 2]),
            traction: Box::new(traction),
            gap: Box::new(|_| 0.0),
            bound: Box::new(|_| 0.3),
        }
    }

    pub fn solve(self) -> Solved {
        let Self { mesh, material, body_force, held: holds, .. } = self;
        let space = Space::new(&mesh);
        let kinks = |_: usize| Vec::new();
        let mut load = vec![0.0; space.dofs()];
        for side in (1..4).filter(|&side| !holds[side]) {
            for (i, direction) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
                let value = |x: &Site| (self.traction)(x)[i];
                let datum = Datum { name: "traction", value: &value, kinks: &kinks, rounding: None };
                add_load(&mut load, &space, &side_moments(&mesh, &space, side, &datum).expect("smooth"), |_| direction);
            }
        }
        let nodal = space.interpolate(&self.displacement);
        let mut held = vec![None; space.nodes()];
        for e in (0..mesh.len()).filter(|&e| holds[mesh.side[e]]) {
            space.element_nodes(e).for_each(|node| held[node] = Some([nodal[2 * node], nodal[2 * node + 1]]));
        }
        let sides = [SideData {
            side: 0,
            gap: Datum { name: "gap", value: &self.gap, kinks: &kinks, rounding: None },
            bound: Some(Datum { name: "bound", value: &self.bound, kinks: &kinks, rounding: None }),
            coefficient: None,
            beyond: None,
        }];
        let boundary = contact_boundary(&mesh, &space, &sides, &|i| held[i].map_or([None; 2], |u| u.map(Some)));
        let boundary = boundary.expect("a floor");

        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let length = operators.length;
        let Steklov { matrix: stiffness, traction: map } = Steklov::new(operators, Domain::Interior).expect("S");
        let particular = body_force.map_or(vec![0.0; space.dofs()], |b| space.interpolate(|x| b.displacement(x)));
        if let Some(b) = body_force {
            let elastic = &stiffness * Col::from_fn(particular.len(), |i| particular[i]);
            let known = b.traction_load(&mesh, &space);
            (0..load.len()).for_each(|i| load[i] += elastic[i] - known[i]);
        }
        let known = held.iter().enumerate().filter_map(|(i, u)| u.map(|u| [(2 * i, u[0]), (2 * i + 1, u[1])]));
        let partition = Partition { kept: boundary.kept(), held: known.flatten().collect(), frames: boundary.frames() };
        let condensation = Condensation::new(stiffness.clone(), &partition, &[]).expect("held");
        let condensed = condensation.load(&load);
        let problem = Problem {
            stiffness: condensation.stiffness().expect("no fault").into(),
            load: condensed.kept.clone(),
            nodes: boundary.contact.clone(),
        };
        let solution = newton(&problem, None).expect("a solution");
        let displacement = condensation.expand(&condensed, &solution.displacement);
        let homogeneous: Vec<f64> = displacement.iter().zip(&particular).map(|(u, p)| u - p).collect();
        let field = BoundaryField::new(&mesh, &space, &material, &homogeneous, &map.apply(&homogeneous), length);

        let given = |x: &Site| {
            let side = mesh.side[x.element];
            let p = body_force.map_or([0.0; 2], |b| b.traction(x.point, mesh.normal(x.element, x.t)));
            let t = (self.traction)(x);
            if side == 0 || holds[side] { [None; 2] } else { [Some(t[0] - p[0]), Some(t[1] - p[1])] }
        };
        let rest = boundary_residuals(&mesh, &field, &given).expect("finite");
        let answer = ContactSolution {
            mesh: &mesh,
            space: &space,
            displacement: &displacement,
            multiplier: Multiplier::Biorthogonal(&boundary, &solution.multipliers),
            field: &field,
            body_force: body_force.as_ref(),
        };
        let contact = contact_residuals(&answer, &sides).expect("finite");
        Solved { contact, boundary: rest, mesh, space, stiffness, displacement, field, solution }
    }
}

impl Solved {
    /// η: the root of all residuals.
    pub fn indicator(&self) -> f64 {
        let contact: f64 = self.contact.iter().map(ContactResidual::total).sum();
        let rest: f64 = self.boundary.iter().map(BoundaryResidual::total).sum();
        (contact + rest).sqrt()
    }

    /// (uᵀ S u)^½ of a displacement.
    fn norm(&self, u: &[f64]) -> f64 {
        let u = Col::from_fn(u.len(), |i| u[i]);
        (u.transpose() * &self.stiffness * &u).sqrt()
    }

    /// (uᵀ S u)^½ of the solution.
    pub fn size(&self) -> f64 {
        self.norm(&self.displacement)
    }

    /// Energy norm of the difference to a solution on a uniform mesh whose elements this one divides.
    pub fn distance(&self, coarse: &Self) -> f64 {
        let parts = self.mesh.len() / coarse.mesh.len();
        let mut difference = self.displacement.clone();
        for e in 0..self.mesh.len() {
            for (node, &t) in self.space.element_nodes(e).zip(&self.space.basis(e).nodes) {
                if t < 1.0 {
                    let t = ((e % parts) as f64 + (t + 1.0) / 2.0) / parts as f64 * 2.0 - 1.0;
                    let u = coarse.field.trace(e / parts, t).displacement;
                    (0..2).for_each(|i| difference[2 * node + i] -= u[i]);
                }
            }
        }
        self.norm(&difference)
    }
}
