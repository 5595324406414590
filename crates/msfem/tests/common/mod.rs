//! Problems of the reference file, solved by the crate.

use steklov_elastic::Plane;
use steklov_msfem::{Basis, CoarseMesh, Elasticity, Elimination, Extra, Grid, HeterogeneousBody, Loads, Multiscale};
use steklov_quadrature::unit_uniform;

/// A part of the reference file.
pub fn reference(key: &str) -> serde_json::Value {
    let text = include_str!("../data/multiscale.json");
    let all: serde_json::Value = serde_json::from_str(text).unwrap();
    all[key].clone()
}

pub fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

pub fn strain() -> Elasticity {
    Elasticity::new(0.3, Plane::Strain).unwrap()
}

/// A rectangle clamped on the left with the traction (0, -1) on the right, or the body force (0, -1).
pub struct Cantilever {
    pub body: HeterogeneousBody,
    pub loads: Loads,
    pub load: Vec<f64>,
}

impl Cantilever {
    pub fn new(size: [f64; 2], cells: [usize; 2], young: Vec<f64>) -> Self {
        let body = HeterogeneousBody::new(Grid::rectangle(size, cells).unwrap(), young, strain()).unwrap();
        let mut loads = Loads::default();
        let half = -body.grid.spacing[1] / 2.0;
        for (cell, side) in body.grid.boundary() {
            if side == 1 {
                loads.add_side(cell, side, [[0.0, half]; 2]);
            }
        }
        let load = loads.nodal(&body);
        Self { body, loads, load }
    }

    pub fn with_weight(size: [f64; 2], cells: [usize; 2], young: Vec<f64>) -> Self {
        let mut this = Self::new(size, cells, young);
        this.loads = Loads::default();
        this.loads.set_body_force(&this.body, |_| [0.0, -1.0]).unwrap();
        this.load = this.loads.nodal(&this.body);
        this
    }

    /// Displacement of the fine grid.
    pub fn fine(&self) -> Vec<f64> {
        let grid = &self.body.grid;
        let held: Vec<usize> =
            (0..grid.nodes()).filter(|&n| grid.lattice(n)[0] == 0).flat_map(|n| [2 * n, 2 * n + 1]).collect();
        let order = self.body.elimination_order();
        let solver = Elimination::new(self.body.stiffness(), &order, &[], &held).unwrap();
        let reduced = solver.reduce(&self.load, &vec![0.0; held.len()]);
        solver.expand(&reduced, &[])
    }

    /// The coarse problem with cells of `fine` fine cells, and its solution.
    pub fn multiscale(&self, fine: [usize; 2], basis: Basis, bubbles: bool) -> Solved<'_> {
        let mesh = CoarseMesh::uniform(&self.body.grid, fine).unwrap();
        self.on_mesh(mesh, basis, bubbles)
    }

    pub fn on_mesh(&self, mesh: CoarseMesh, basis: Basis, bubbles: bool) -> Solved<'_> {
        let mut problem = Multiscale::new(&self.body, mesh, basis).unwrap();
        let extra = Extra { bubbles, ..Extra::default() };
        let system = problem.assemble(&self.loads, &extra, &mut |_| true).unwrap();
        let clamped = |v: &usize| problem.mesh.vertices[*v][0] == 0;
        let held: Vec<usize> = (0..problem.mesh.vertices.len())
            .filter(clamped)
            .filter_map(|v| problem.unknown[v])
            .flat_map(|u| [u, u + 1])
            .collect();
        let order = problem.elimination_order();
        let solver = Elimination::new(system.stiffness, &order, &[], &held).unwrap();
        let reduced = solver.reduce(&system.load, &vec![0.0; held.len()]);
        let coarse = solver.expand(&reduced, &[]);
        let compliance = coarse.iter().zip(&system.load).map(|(u, f)| u * f).sum();
        Solved { extra, problem, coarse, compliance }
    }

    /// Broken energy and nodal l2 error of a coarse solution relative to the fine one.
    pub fn errors(&self, solved: &Solved<'_>, fine: &[f64]) -> [f64; 2] {
        let grid = &self.body.grid;
        let (mut energy, mut scale, mut l2, mut l2_scale) = (0.0, 0.0, 0.0, 0.0);
        let unit = self.body.elasticity.unit_stiffness(grid.spacing);
        solved
            .problem
            .downscale_cells(&solved.coarse, &self.loads, &solved.extra, &mut |_| true, |cell, field| {
                let coarse = solved.problem.mesh.cells[cell];
                let nodes: Vec<usize> = coarse.fine_nodes(grid).collect();
                let reference: Vec<f64> = nodes.iter().flat_map(|n| [fine[2 * n], fine[2 * n + 1]]).collect();
                let difference: Vec<f64> = field.iter().zip(&reference).map(|(a, b)| a - b).collect();
                // the form by itself, not by the crate
                let form = |cell: usize, u: &[f64; 8]| -> f64 {
                    let sum = |a: usize| (0..8).map(|b| u[a] * unit[a][b] * u[b]).sum::<f64>();
                    self.body.young[cell] * (0..8).map(sum).sum::<f64>()
                };
                energy += solved.problem.fine_values(cell, &difference).map(|(c, u)| form(c, &u)).sum::<f64>();
                scale += solved.problem.fine_values(cell, &reference).map(|(c, u)| form(c, &u)).sum::<f64>();
                l2 += difference.iter().map(|d| d * d).sum::<f64>();
                l2_scale += reference.iter().map(|d| d * d).sum::<f64>();
            })
            .unwrap();
        [(energy / scale).sqrt(), (l2 / l2_scale).sqrt()]
    }

    /// Von Mises stress at the centres of the cells.
    pub fn von_mises(&self, u: &[f64]) -> Vec<f64> {
        self.body.stresses(u).iter().map(|s| self.body.elasticity.von_mises(*s)).collect()
    }

    /// u_y at the middle of the right side.
    pub fn tip(&self, u: &[f64]) -> f64 {
        let [nx, ny] = self.body.grid.cells;
        u[2 * self.body.grid.node(nx, ny / 2).unwrap() + 1]
    }
}

pub struct Solved<'a> {
    pub problem: Multiscale<'a>,
    pub extra: Extra,
    pub coarse: Vec<f64>,
    pub compliance: f64,
}

/// Moduli of the bar: constant, or by the generator; each cell cut into `parts` × `parts`.
pub fn bar(random: bool, parts: usize) -> Cantilever {
    Cantilever::new([6.0, 1.0], [192 * parts, 32 * parts], bar_moduli(random, parts))
}

pub fn bar_moduli(random: bool, parts: usize) -> Vec<f64> {
    let ny = 32 * parts;
    let young = |c: usize| {
        let i = (c / ny / parts) * 32 + c % ny / parts;
        if random { 2000.0 + 1000.0 * unit_uniform(2014, i as u64) } else { 2000.0 }
    };
    (0..192 * parts * ny).map(young).collect()
}

/// The plate 2 × 1 with the masks of the reference file.
pub fn plate(name: &str, contrast: f64) -> Cantilever {
    let inside = |i: usize, j: usize| (4..12).contains(&(i % 16)) && (4..12).contains(&(j % 16));
    let mask = |i: usize, j: usize| match name {
        "inside" => inside(i, j),
        "crossing" => inside(i + 8, j + 8),
        "channel" => (5..9).contains(&(j % 16)) && (6..122).contains(&i),
        other => panic!("{other}"),
    };
    let young = |c: usize| if mask(c / 64, c % 64) { contrast } else { 1.0 };
    Cantilever::new([2.0, 1.0], [128, 64], (0..128 * 64).map(young).collect())
}

/// The meshes of the bar: name and fine cells a coarse cell.
pub const MESHES: [(&str, usize); 4] = [("12x2", 16), ("24x4", 8), ("48x8", 4), ("96x16", 2)];

pub fn kind(word: &str, fine: usize) -> Basis {
    match word {
        "q1" => Basis::Q1,
        "a" => Basis::Linear,
        "b" => Basis::Coupled,
        "c" => Basis::Oscillatory,
        "d" => Basis::Oversampled(fine),
        "e" => Basis::Periodic,
        other => panic!("unknown kind {other}"),
    }
}

#[track_caller]
pub fn close(what: &str, got: f64, wanted: f64, tolerance: f64) {
    assert!((got - wanted).abs() <= tolerance * wanted.abs(), "{what}: {got} instead of {wanted}");
}

/// A given traction on sides of which not both ends are held, component by component.
pub fn unless_held(
    body: &HeterogeneousBody,
    held: &[bool],
    traction: impl Fn(usize, usize) -> [f64; 2] + Sync,
) -> impl Fn(usize, usize) -> [Option<f64>; 2] + Sync {
    move |cell, side| {
        let nodes = body.grid.cell_nodes(cell);
        let given = traction(cell, side);
        let is_held = |k: usize| [side, (side + 1) % 4].iter().all(|&a| held[2 * nodes[a] + k]);
        [0, 1].map(|k| (!is_held(k)).then_some(given[k]))
    }
}
