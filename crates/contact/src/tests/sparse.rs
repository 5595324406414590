//! Stiffnesses that are sums of blocks: subdomains with contact nodes of their own, each sharing a free node with the next one.

use faer::Mat;
use proptest::collection::vec;
use proptest::prelude::*;
use steklov_algebra::{Lu, SparseSymmetric, Symmetric};

use super::oracle::distance;
use crate::proptest::{Friction, mixed};
use crate::{
    ContactNode, Frozen, Problem, Sets, Solution, Start, active_set, contraction, fixed_point, interior_point,
    kkt_in_body, newton, uzawa,
};

/// One problem in three ways.
#[derive(Debug)]
struct Ways {
    /// The sum of blocks, with the nodes that they share as free nodes.
    sparse: Problem,
    /// The same in full storage.
    full: Problem,
    /// The free nodes eliminated.
    condensed: Problem,
}

impl Ways {
    /// The nodes of a problem in so many blocks, with stiffnesses and loads of these numbers.
    fn new(problem: &Problem, blocks: usize, numbers: &[f64]) -> Self {
        let (m, mut number) = (problem.load.len(), numbers.iter().cycle());
        let size = problem.stiffness.norm_max();
        let mut unknowns: Vec<Vec<usize>> = vec![Vec::new(); blocks];
        for (k, node) in problem.nodes.iter().enumerate() {
            unknowns[k * blocks / problem.nodes.len()].extend(node.first..node.first + node.unknowns);
        }
        let shared = |k: usize| [m + 2 * k, m + 2 * k + 1];
        for k in 1..blocks {
            unknowns[k - 1].extend(shared(k - 1));
            unknowns[k].extend(shared(k - 1));
        }
        let all = m + 2 * (blocks - 1);
        let matrices: Vec<Mat<f64>> = unknowns
            .iter()
            .map(|own| {
                let n = own.len();
                let g = Mat::from_fn(n, n, |_, _| *number.next().expect("endless"));
                (&g * g.transpose() + Mat::<f64>::identity(n, n) * faer::Scale(0.1)) * faer::Scale(size / n as f64)
            })
            .collect();
        let blocks_of = unknowns.iter().zip(&matrices).map(|(own, matrix)| (own.as_slice(), matrix.as_ref()));
        let sum = Symmetric::Sparse(SparseSymmetric::sum(all, blocks_of).expect("memory for a few entries"));
        let free = |k: usize| ContactNode { first: shared(k)[0], unknowns: 2, conditions: Vec::new() };
        let nodes: Vec<ContactNode> = problem.nodes.iter().cloned().chain((0..blocks - 1).map(free)).collect();
        let more = number.by_ref().take(all - m).map(|x| x * size);
        let load: Vec<f64> = problem.load.iter().copied().chain(more).collect();
        let s = sum.full().into_owned();
        let condensed = condensed(&s, &load, problem);
        let full = Problem { stiffness: s.into(), load: load.clone(), nodes: nodes.clone() };
        Self { sparse: Problem { stiffness: sum, load, nodes }, full, condensed }
    }
}

/// The problem without the unknowns behind those of `problem`: S_CC - S_CF S_FF⁻¹ S_FC, f_C - S_CF S_FF⁻¹ f_F.
fn condensed(s: &Mat<f64>, load: &[f64], problem: &Problem) -> Problem {
    let (m, all) = (problem.load.len(), load.len());
    let coupling = s.submatrix(0, m, m, all - m);
    let through = coupling * Lu::new(s.submatrix(m, m, all - m, all - m)).inverse();
    let rest = Mat::from_fn(all - m, 1, |i, _| load[m + i]);
    let (less, pull) = (&through * coupling.transpose(), &through * rest);
    Problem {
        stiffness: Mat::from_fn(m, m, |i, j| s[(i, j)] - 0.5 * (less[(i, j)] + less[(j, i)])).into(),
        load: (0..m).map(|i| load[i] - pull[(i, 0)]).collect(),
        nodes: problem.nodes.clone(),
    }
}

fn ways(friction: Friction) -> impl Strategy<Value = Ways> {
    (mixed(9, friction), 1..5usize, vec(-1.0..1.0f64, 97))
        .prop_map(|(problem, blocks, numbers)| Ways::new(&problem, blocks.min(problem.nodes.len()), &numbers))
}

impl Ways {
    /// The largest difference of the contact displacements; gaps, and loads over stiffnesses, are near 1.
    fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let count = self.condensed.load.len();
        distance(&a[..count], &b[..count])
    }
}

type Solver<'a> = (&'a str, &'a dyn Fn(&Problem) -> Solution);

proptest! {
    #[test]
    fn a_sum_of_blocks_has_the_answer_of_the_full_and_of_the_condensed_matrix(of in ways(Friction::Tresca)) {
        let solvers: [Solver<'_>; 4] = [
            ("interior_point", &|p| interior_point(p).unwrap()),
            ("active_set", &|p| active_set(p, None).unwrap()),
            ("newton", &|p| newton(p, None).unwrap()),
            ("uzawa", &|p| uzawa(p, None, None).unwrap()),
        ];
        let reference = interior_point(&of.condensed).unwrap();
        for (name, solve) in solvers {
            for problem in [&of.sparse, &of.full, &of.condensed] {
                let answer = solve(problem);
                prop_assert!(answer.converged(), "{}", name);
                let off = of.apart(&answer.displacement, &reference.displacement);
                prop_assert!(off < 1e-8, "{name}: {off:e}");
                prop_assert!(kkt_in_body(problem, &answer, 1.0).worst() < 1e-8, "{name}");
                prop_assert_eq!(answer.multipliers.len(), reference.multipliers.len());
            }
        }
        // from the answer, and with the sets of the answer
        let answer = interior_point(&of.sparse).unwrap();
        let start = Start { displacement: &answer.displacement, multipliers: &answer.multipliers };
        let again = active_set(&of.sparse, Some(start)).unwrap();
        prop_assert!(again.converged() && of.apart(&again.displacement, &answer.displacement) < 1e-9);
        let sets = Sets::new(&of.sparse, &answer).unwrap();
        let frozen = Frozen::new(&of.sparse, &sets).unwrap().displacement();
        prop_assert!(of.apart(&frozen, &answer.displacement) < 1e-9);
    }

    #[test]
    fn so_it_is_with_coulombs_law(of in ways(Friction::Coulomb(0.2))) {
        let reference = fixed_point(&of.condensed, None).unwrap();
        for problem in [&of.sparse, &of.full] {
            for answer in [interior_point(problem).unwrap(), newton(problem, None).unwrap()] {
                if !answer.converged() || !reference.converged() {
                    continue;
                }
                let off = of.apart(&answer.displacement, &reference.displacement);
                prop_assert!(off < 1e-7, "{off:e}");
                let (a, b) = (contraction(problem, &answer).unwrap(), contraction(&of.condensed, &reference).unwrap());
                prop_assert!((a.factor - b.factor).abs() < 1e-6 * (1.0 + b.factor), "{a:?} {b:?}");
            }
        }
    }
}
