//! Equations that are affine in the germs: against the full matrix, and against closed forms of a single spring.

use faer::Mat;
use proptest::prelude::*;
use steklov_algebra::Lu;
use steklov_stochastic::{AffineFamily, AffineSolution, Recurrence, StochasticError, TotalDegree, Variable, uniform};

/// Matrices K_0, K_1, .. and loads.
struct Owned {
    matrices: Vec<Mat<f64>>,
    loads: Vec<Vec<f64>>,
}

impl Owned {
    /// K_0 = I + A Aᵀ and symmetric K_m with Σ_m |ξ_m - E ξ_m| |K_m| ≤ `part` of K_0's smallest eigenvalue, from a seed.
    fn random(seed: u64, size: usize, variables: &[Variable], part: f64) -> Self {
        let number = |k: usize, i: usize, j: usize| 2.0 * uniform(seed, (i * size + j) as u64, k as u64) - 1.0;
        let square = Mat::from_fn(size, size, |i, j| number(0, i, j));
        let mean = &square * square.transpose();
        let mut matrices = vec![Mat::from_fn(size, size, |i, j| mean[(i, j)] + f64::from(u8::from(i == j)))];
        for (m, variable) in variables.iter().enumerate() {
            let [low, high] = variable.germ_support();
            let reach = (high - variable.mean()).max(variable.mean() - low);
            // rows of a symmetric matrix bound its eigenvalues
            let scale = part / (reach * (variables.len() * size) as f64);
            let entry = |i: usize, j: usize| scale * number(m + 1, i.min(j), i.max(j));
            matrices.push(Mat::from_fn(size, size, entry));
        }
        let load = |k: usize| (0..size).map(|i| number(100 + k, i, 0)).collect();
        Self { matrices, loads: (0..=variables.len()).map(load).collect() }
    }

    fn solve(&self, basis: &TotalDegree, tolerance: f64) -> Result<AffineSolution, StochasticError> {
        let n = self.matrices[0].nrows();
        let factor = Lu::new(self.matrices[0].as_ref());
        let product = |vectors: &[&[f64]], out: &mut [f64]| {
            for (i, out) in out.iter_mut().enumerate() {
                let of = |(k, v): (&Mat<f64>, &&[f64])| (0..n).map(|j| k[(i, j)] * v[j]).sum::<f64>();
                *out = self.matrices.iter().zip(vectors).map(of).sum();
            }
        };
        let solve = |columns: &mut [f64]| {
            for column in columns.chunks_mut(n) {
                let x = factor.solve(Mat::from_fn(n, 1, |i, _| column[i]).as_ref());
                (0..n).for_each(|i| column[i] = x[(i, 0)]);
            }
        };
        basis.solve(&AffineFamily { product: &product, solve: &solve, loads: self.loads.clone() }, tolerance)
    }

    /// The full system, its products with germs by Gauss rules of all of them.
    fn dense(&self, basis: &TotalDegree, variables: &[Variable]) -> Vec<f64> {
        let (n, count) = (self.matrices[0].nrows(), basis.degrees().len());
        let (points, weights) = tensor(variables, basis.degree() + 2);
        let mut full = Mat::<f64>::zeros(n * count, n * count);
        let mut load = Mat::<f64>::zeros(n * count, 1);
        for (point, w) in points.iter().zip(&weights) {
            let psi = basis.values(point);
            let off: Vec<f64> = point.iter().zip(variables).map(|(x, v)| x - v.mean()).collect();
            let at =
                |of: &dyn Fn(usize) -> f64| of(0) + off.iter().enumerate().map(|(m, x)| x * of(m + 1)).sum::<f64>();
            let k = Mat::from_fn(n, n, |i, j| at(&|m| self.matrices[m][(i, j)]));
            let f: Vec<f64> = (0..n).map(|i| at(&|m| self.loads[m][i])).collect();
            for a in 0..count {
                (0..n).for_each(|i| load[(a * n + i, 0)] += w * psi[a] * f[i]);
                for b in 0..count {
                    let part = w * psi[a] * psi[b];
                    (0..n * n).for_each(|e| full[(a * n + e / n, b * n + e % n)] += part * k[(e / n, e % n)]);
                }
            }
        }
        let x = Lu::new(full.as_ref()).solve(load.as_ref());
        (0..n * count).map(|i| x[(i, 0)]).collect()
    }
}

/// Products of Gauss rules.
fn tensor(variables: &[Variable], n: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
    let (mut points, mut weights) = (vec![Vec::new()], vec![1.0]);
    for v in variables {
        let rule = Recurrence::new(v, v.germ_support(), n).unwrap().gauss(n).unwrap();
        let both = |p: &Vec<f64>| rule.points.iter().map(|x| [&p[..], &[*x]].concat()).collect::<Vec<_>>();
        points = points.iter().flat_map(both).collect();
        weights = weights.iter().flat_map(|w| rule.weights.iter().map(move |v| w * v)).collect();
    }
    (points, weights)
}

fn variables(count: usize) -> Vec<Variable> {
    let all = [
        Variable::uniform(-1.0, 1.0).unwrap(),
        Variable::beta(2.0, 5.0, 1.0, 4.0).unwrap(),
        Variable::uniform(3.0, 7.0).unwrap(),
    ];
    all[..count].to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn blocks_are_those_of_the_full_matrix(seed in 0u64..1 << 40, size in 1usize..6, germs in 1usize..4, degree in 0usize..4) {
        let variables = variables(germs);
        let basis = TotalDegree::new(&variables, degree).unwrap();
        let owned = Owned::random(seed, size, &variables, 0.9);
        let solved = owned.solve(&basis, 1e-14).unwrap();
        let dense = owned.dense(&basis, &variables);
        let scale = dense.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let off = solved.blocks.iter().zip(&dense).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        prop_assert!(off < 1e-10 * scale, "seed {seed}: off by {:e}", off / scale);
        prop_assert!(solved.residual <= 1e-14 && solved.iterations <= 40, "{} iterations", solved.iterations);
    }
}

/// A spring 1 + s ξ under a unit load: moments of Galerkin of degree p are those of the Gauss rule of p + 1 points, because
/// e_0ᵀ f(J) e_0 is that rule of f, J the Jacobi matrix of the density.
#[test]
fn a_spring_has_the_moments_of_a_gauss_rule() {
    for (variable, s) in [(variables(1)[0].clone(), 0.9), (variables(2)[1].clone(), 0.3)] {
        for degree in 1..8 {
            let basis = TotalDegree::new(std::slice::from_ref(&variable), degree).unwrap();
            let matrices = [1.0, s].map(|k| Mat::from_fn(1, 1, |_, _| k)).to_vec();
            let owned = Owned { matrices, loads: vec![vec![1.0], vec![]] };
            let u = owned.solve(&basis, 1e-15).unwrap().blocks;
            let rule =
                Recurrence::new(&variable, variable.germ_support(), degree + 1).unwrap().gauss(degree + 1).unwrap();
            let moment = |k: i32| -> f64 {
                let at = |x: f64| (1.0 + s * (x - variable.mean())).powi(-k);
                rule.points.iter().zip(&rule.weights).map(|(&x, w)| w * at(x)).sum()
            };
            let variance: f64 = u[1..].iter().map(|c| c * c).sum();
            assert!((u[0] - moment(1)).abs() < 1e-13, "degree {degree}: mean {} {}", u[0], moment(1));
            assert!((variance - (moment(2) - moment(1).powi(2))).abs() < 1e-12, "degree {degree}: variance {variance}");
        }
    }
}

/// And they go to the exact ones: artanh(s)/s and 1/(1 - s²) for a germ uniform on [-1, 1].
#[test]
fn degrees_lead_to_the_exact_moments() {
    let (variable, s) = (variables(1), 0.5f64);
    let owned =
        Owned { matrices: [1.0, s].map(|k| Mat::from_fn(1, 1, |_, _| k)).to_vec(), loads: vec![vec![1.0], vec![]] };
    let u = owned.solve(&TotalDegree::new(&variable, 16).unwrap(), 1e-15).unwrap().blocks;
    let (mean, square) = (s.atanh() / s, 1.0 / (1.0 - s * s));
    assert!((u[0] - mean).abs() < 1e-14, "{}", u[0]);
    assert!((u.iter().map(|c| c * c).sum::<f64>() - square).abs() < 1e-13);
}

/// A load that is affine beside a fixed spring comes back as its own polynomial, and all of its variance is the germ's.
#[test]
fn affine_loads_are_polynomials_of_degree_one() {
    let variables = variables(3);
    let basis = TotalDegree::new(&variables, 2).unwrap();
    let matrices = [2.0, 0.0, 0.0, 0.0].map(|k| Mat::from_fn(1, 1, |_, _| k)).to_vec();
    let owned = Owned { matrices, loads: vec![vec![6.0], vec![], vec![4.0], vec![]] };
    let u = owned.solve(&basis, 1e-14).unwrap().blocks;
    let value = |germ: &[f64]| basis.values(germ).iter().zip(&u).map(|(p, c)| p * c).sum::<f64>();
    for germ in [[0.0, 1.5, 4.0], [0.7, 3.9, 6.0]] {
        let wanted = 3.0 + 2.0 * (germ[1] - variables[1].mean());
        assert!((value(&germ) - wanted).abs() < 1e-13, "{germ:?}: {}", value(&germ));
    }
    assert_eq!(basis.effects(&u), [0.0, 1.0, 0.0]);
}

#[test]
fn impossible_families_are_refused() {
    let basis = TotalDegree::new(&variables(1), 3).unwrap();
    let family = |s: f64, loads: Vec<Vec<f64>>| Owned {
        matrices: [1.0, s].map(|k| Mat::from_fn(1, 1, |_, _| k)).to_vec(),
        loads,
    };
    let number = |r: Result<AffineSolution, StochasticError>| matches!(r, Err(StochasticError::Number { .. }));
    assert!(number(family(2.0, vec![vec![1.0], vec![]]).solve(&basis, 1e-10)), "1 + 2 ξ is negative");
    assert!(number(family(0.5, vec![vec![f64::NAN], vec![]]).solve(&basis, 1e-10)));
    let fewer = family(0.5, vec![vec![1.0]]).solve(&basis, 1e-10);
    assert!(matches!(fewer, Err(StochasticError::Inconsistent { .. })));
    assert!(matches!(TotalDegree::new(&vec![variables(1)[0].clone(); 40], 8), Err(StochasticError::Number { .. })));
}

/// The same bits with one thread and with three.
#[test]
fn threads_do_not_change_bits() {
    let variables = variables(3);
    let basis = TotalDegree::new(&variables, 3).unwrap();
    let owned = Owned::random(7, 30, &variables, 0.9);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| owned.solve(&basis, 1e-10).unwrap().blocks)
    };
    assert_eq!(with(1), with(3));
}
