//! The correction that enriched spaces add to a solution: S₊e = r on the displacements that the supports and the contact sets
//! leave free.

use steklov_bem_operators::{Assembly, Enriched, Space};
use steklov_contact::{ContactBubble, Frozen};
use steklov_elastic::plane::{dot, solve2};
use steklov_problem::Condition;

use crate::data::on_mesh::OnMesh;
use crate::data::springs::Springs;
use crate::estimate::elastic::Elastic;
use crate::estimate::interface_residual::FacingLoad;

/// Reduction of the squared energy of the residual at which the correction is good enough for the estimate of the error.
pub(crate) const ENOUGH: f64 = 1e-4;
/// The same for quantities, which converge at twice the rate of the energy norm.
pub(crate) const ENOUGH_FOR_QUANTITIES: f64 = 1e-10;
/// Steps of conjugate gradients at most.
const STEPS: usize = 40;

/// The directions in which the bubble of an element is free.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) directions: [[f64; 2]; 2],
    pub(crate) free: [bool; 2],
}

impl Frame {
    const FREE: Self = Self { directions: [[1.0, 0.0], [0.0, 1.0]], free: [true; 2] };

    /// x = A⁻¹ρ in the free directions.
    pub(crate) fn solve(&self, a: [[f64; 2]; 2], rho: [f64; 2]) -> [f64; 2] {
        let [d, t] = self.directions;
        let one = |x: [f64; 2]| x.map(|c| c * dot(x, rho) / dot(x, a.map(|row| dot(row, x))));
        match self.free {
            [false, false] => [0.0; 2],
            [true, false] => one(d),
            [false, true] => one(t),
            [true, true] => solve2(a, rho),
        }
    }

    /// ρᵀA⁻¹ρ in the free directions.
    pub(crate) fn energy(&self, a: [[f64; 2]; 2], rho: [f64; 2]) -> f64 {
        let x = self.solve(a, rho);
        dot(x, rho).max(0.0)
    }
}

/// The free directions of every bubble: all except those that are held and those that the contact state prescribes. Another
/// body gives way.
pub(crate) fn frames(
    data: &OnMesh<'_>,
    elements: usize,
    bubbles: &[ContactBubble],
    facing: &[FacingLoad],
) -> Vec<Frame> {
    let mesh = data.mesh;
    let mut frames: Vec<Frame> = (0..mesh.len())
        .map(|e| match &data.scene.problem.sides[mesh.side[e]].condition {
            Condition::Displacement { values, .. } => {
                Frame { free: [values[0].is_none(), values[1].is_none()], ..Frame::FREE }
            }
            _ => Frame::FREE,
        })
        .collect();
    // those of cuts
    frames.resize(elements, Frame::FREE);
    for bubble in bubbles {
        let e = bubble.element;
        frames[e] = Frame { directions: data.contact_frame(e), free: bubble.free };
    }
    for FacingLoad { element, .. } in facing {
        frames[*element].free = [true; 2];
    }
    frames
}

/// S₊ on the displacements that the supports and the contact sets leave free, and S with single bubbles as its preconditioner.
pub(crate) struct System<'a> {
    pub(crate) condensation: &'a Assembly,
    pub(crate) elastic: &'a Elastic<'a>,
    pub(crate) frozen: Option<&'a Frozen<'a>>,
    pub(crate) frames: &'a [Frame],
    /// The springs, whose part in S₊ is added here; S has their part on the nodes.
    pub(crate) springs: &'a Springs,
    pub(crate) space: &'a Space,
    /// ⟨S₊ b, b⟩ of each bubble.
    pub(crate) blocks: Vec<[[f64; 2]; 2]>,
}

impl System<'_> {
    pub(crate) fn multiply(&self, v: &Enriched) -> Enriched {
        let mut all = self.elastic.multiply(v, self.condensation.multiply(&v.base));
        if !self.springs.is_empty() {
            let both: Vec<f64> = v.base.iter().chain(&v.extra).copied().collect();
            all.add(1.0, &self.springs.pull(self.space, self.frames.len(), &both));
            // S has the part of the nodes on the nodes
            let of_nodes = self.springs.pull(self.space, self.frames.len(), &v.base).base;
            all.base.iter_mut().zip(of_nodes).for_each(|(f, pull)| *f -= pull);
        }
        all
    }

    /// u of Su = r on the nodes, in the directions that are free.
    pub(crate) fn solve_base(&self, r: &[f64]) -> Vec<f64> {
        let load = self.condensation.load_of_correction(r);
        let kept = self.frozen.map_or(Vec::new(), |f| f.correction(&load.kept));
        self.condensation.expand(&load, &kept)
    }

    fn precondition(&self, r: &Enriched) -> Enriched {
        let base = self.solve_base(&r.base);
        let extra = (0..self.frames.len()).flat_map(|e| {
            let rho = [r.extra[2 * e], r.extra[2 * e + 1]];
            self.frames[e].solve(self.blocks[e], rho)
        });
        Enriched { base, extra: extra.collect() }
    }

    /// ⟨S₊e, e⟩ and e of S₊e = r, by conjugate gradients until a step adds less than `enough` of that energy, and r - S₊e.
    pub(crate) fn correction(&self, r: &Enriched, enough: f64) -> (f64, Enriched, Enriched) {
        let mut e = Enriched { base: vec![0.0; r.base.len()], extra: vec![0.0; r.extra.len()] };
        let mut r = r.clone();
        let mut z = self.precondition(&r);
        let mut p = z.clone();
        let mut rz = r.dot(&z);
        let mut energy = 0.0;
        for _ in 0..STEPS {
            let s = self.multiply(&p);
            let step = rz / p.dot(&s);
            if rz <= 0.0 || !step.is_finite() {
                break;
            }
            energy += step * rz;
            e.add(step, &p);
            r.add(-step, &s);
            if step * rz <= enough * energy {
                break;
            }
            z = self.precondition(&r);
            let next = r.dot(&z);
            let mut direction = z.clone();
            direction.add(next / rz, &p);
            (p, rz) = (direction, next);
        }
        (energy, e, r)
    }
}
