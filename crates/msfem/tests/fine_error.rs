//! The estimate of the fine grid's own error against known limits, finer grids and a smooth field.

use std::f64::consts::PI;

use crate::common::{Cantilever, bar, kind, strain, unless_held};
use proptest::prelude::*;
use steklov_elastic::Plane;
use steklov_msfem::{Elasticity, Elimination, Grid, HeterogeneousBody, Loads, bubble_indicators, nodal_indicators};
use steklov_quadrature::unit_uniform;

fn clamped(problem: &Cantilever) -> Vec<bool> {
    let grid = &problem.body.grid;
    (0..grid.dofs()).map(|u| grid.lattice(u / 2)[0] == 0).collect()
}

fn pull(_: usize, side: usize) -> [f64; 2] {
    if side == 1 { [0.0, -1.0] } else { [0.0; 2] }
}

fn estimate(problem: &Cantilever, u: &[f64]) -> f64 {
    bubble_indicators(&problem.body, &[], u, &unless_held(&problem.body, &clamped(problem), pull))
        .iter()
        .sum::<f64>()
        .sqrt()
}

fn work(problem: &Cantilever, u: &[f64]) -> f64 {
    u.iter().zip(&problem.load).map(|(u, f)| u * f).sum()
}

#[test]
fn the_bars_are_known_to_three_and_six_percent() {
    for (random, limit, percent) in [(false, 0.400_220, 3.0), (true, 0.321_68, 6.0)] {
        let problem = bar(random, 1);
        let fine = problem.fine();
        let error = (limit - work(&problem, &fine)).sqrt();
        let found = estimate(&problem, &fine);
        assert!((0.97..1.1).contains(&(found / error)), "{found} for {error}");
        assert!((100.0 * found / limit.sqrt() - percent).abs() < 0.5, "{found}");
    }
}

/// The modulus of cell (i, j).
type Moduli<'a> = &'a dyn Fn(usize, usize) -> f64;

/// The body with each cell cut into `parts` × `parts`.
fn cantilever(
    size: [f64; 2],
    cells: [usize; 2],
    young: Moduli<'_>,
    elasticity: Elasticity,
    parts: usize,
) -> Cantilever {
    let [nx, ny] = cells.map(|n| n * parts);
    let moduli = (0..nx * ny).map(|c| young(c / ny / parts, c % ny / parts)).collect();
    let mut problem = Cantilever::new(size, [nx, ny], moduli);
    problem.body = HeterogeneousBody::new(problem.body.grid.clone(), problem.body.young.clone(), elasticity).unwrap();
    problem
}

/// The estimate over the error, the limit extrapolated from grids of a half and a quarter of the spacing.
fn effectivity(size: [f64; 2], cells: [usize; 2], young: Moduli<'_>, elasticity: Elasticity) -> f64 {
    let problems = [1, 2, 4].map(|parts| cantilever(size, cells, young, elasticity, parts));
    let fields = problems.each_ref().map(Cantilever::fine);
    let [c1, c2, c4] = [0, 1, 2].map(|k| work(&problems[k], &fields[k]));
    let ratio = ((c4 - c2) / (c2 - c1)).clamp(0.25, 0.75);
    let limit = c4 + (c4 - c2) * ratio / (1.0 - ratio);
    estimate(&problems[0], &fields[0]) / (limit - c1).sqrt()
}

#[test]
fn materials_planes_and_laminates() {
    let plain = |_: usize, _: usize| 2000.0;
    let random = |i: usize, j: usize| 2000.0 + 1000.0 * unit_uniform(7, (16 * i + j) as u64);
    let law = |nu, plane| Elasticity::new(nu, plane).unwrap();
    let bars: [(Moduli<'_>, f64, Plane); 6] = [
        (&plain, 0.3, Plane::Stress),
        (&plain, 0.49, Plane::Stress),
        (&plain, 0.49, Plane::Strain),
        (&random, 0.3, Plane::Stress),
        (&random, 0.49, Plane::Strain),
        (&plain, 0.0, Plane::Strain),
    ];
    for (young, nu, plane) in bars {
        let found = effectivity([6.0, 1.0], [96, 16], young, law(nu, plane));
        assert!((0.95..1.15).contains(&found), "ν = {nu}, {plane:?}: {found}");
    }
    let straight = |i: usize, _: usize| if i % 8 < 4 { 10.0 } else { 1.0 };
    let diagonal = |i: usize, j: usize| if (i + 2 * j + 1) % 16 < 8 { 10.0 } else { 1.0 };
    for young in [&straight as Moduli<'_>, &diagonal] {
        let found = effectivity([1.0; 2], [32; 2], young, strain());
        assert!((0.9..1.15).contains(&found), "laminate: {found}");
    }
    // a board of random cells with stiff ones that meet at corners is beyond one level of bubbles
    let board = |i: usize, j: usize| if unit_uniform(3, (32 * i + j) as u64) < 0.5 { 1.0 } else { 100.0 };
    let found = effectivity([1.0; 2], [32; 2], &board, strain());
    assert!((0.5..0.9).contains(&found), "board: {found}");
}

#[test]
fn the_estimate_of_a_smooth_field_tends_to_its_error() {
    // u = (1, 1/2) sin πx sin πy on the unit square, held all around: ∫ f·u = π² (λ + 3μ)(1 + 1/4)/4
    for (aspect, nu) in [(1, 0.3), (4, 0.3), (1, 0.49)] {
        let elasticity = Elasticity::new(nu, Plane::Strain).unwrap();
        let [lambda, mu] = [elasticity.unit_stress([0.0, 1.0, 0.0])[0], elasticity.unit_stress([0.0, 0.0, 1.0])[2]];
        let force = |[x, y]: [f64; 2]| {
            let s = (PI * x).sin() * (PI * y).sin();
            let c = (PI * x).cos() * (PI * y).cos();
            [1.0, 0.5].map(|a| PI * PI * ((lambda + 3.0 * mu) * a * s - (lambda + mu) * (0.5 / a) * c))
        };
        let energy = PI * PI * (lambda + 3.0 * mu) * 1.25 / 4.0;
        let found = [8, 64].map(|n| {
            let grid = Grid::rectangle([1.0; 2], [aspect * n, n]).unwrap();
            let body = HeterogeneousBody::new(grid, vec![1.0; aspect * n * n], elasticity).unwrap();
            let mut loads = Loads::default();
            loads.set_body_force(&body, force).unwrap();
            let load = loads.nodal(&body);
            let held: Vec<bool> = (0..body.grid.dofs())
                .map(|u| {
                    let [i, j] = body.grid.lattice(u / 2);
                    i == 0 || j == 0 || i == aspect * n || j == n
                })
                .collect();
            let fixed: Vec<usize> = (0..held.len()).filter(|u| held[*u]).collect();
            let solver = Elimination::new(body.stiffness(), &body.elimination_order(), &[], &fixed).unwrap();
            let u = solver.expand(&solver.reduce(&load, &vec![0.0; fixed.len()]), &[]);
            let error = (energy - u.iter().zip(&load).map(|(u, f)| u * f).sum::<f64>()).sqrt();
            let eta = bubble_indicators(&body, &loads.body, &u, &unless_held(&body, &held, |_, _| [0.0; 2]))
                .iter()
                .sum::<f64>()
                .sqrt();
            eta / error
        });
        assert!((found[1] - 1.0).abs() < 0.012, "{found:?}");
        assert!((found[1] - 1.0).abs() < 0.6 * (found[0] - 1.0).abs(), "{found:?}");
    }
}

#[test]
fn both_estimates_together_are_that_of_a_multiscale_field() {
    for random in [false, true] {
        let (problem, limit) = (bar(random, 1), if random { 0.321_68 } else { 0.400_220 });
        let fine = problem.fine();
        let own = estimate(&problem, &fine);
        for cells in [16, 8, 4, 2] {
            for word in ["b", "c"] {
                let solved = problem.multiscale([cells; 2], kind(word, cells), false);
                let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
                // conforming fields: a(u, u_H) is the work of the load
                let error = (limit - work(&problem, &u)).sqrt();
                let bubbles = estimate(&problem, &u);
                let squared =
                    nodal_indicators(&problem.body, &solved.problem.mesh, &problem.load, &u, &clamped(&problem));
                let nodal = squared.iter().sum::<f64>().sqrt();
                let ratio = nodal.hypot(bubbles) / error;
                let twice = (bubbles * bubbles - own * own) / (nodal * nodal);
                assert!((1.4..2.4).contains(&ratio), "{word} {cells}: {ratio}");
                // what the bubbles see of the coarse edges is a third of h/H of what the nodes see
                assert!((0.25..0.4).contains(&(twice * cells as f64)), "{word} {cells}: {twice}");
            }
        }
    }
}

fn body(moduli: &[f64], elasticity: Elasticity) -> HeterogeneousBody {
    let grid = Grid::new([0.0; 2], [0.25, 0.5], [8, 6], |i, j| i < 5 || j < 2).unwrap();
    let young = (0..48).map(|c| moduli[c % moduli.len()]).collect();
    HeterogeneousBody::new(grid, young, elasticity).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn homogeneous_strain_is_exact(gradient in prop::array::uniform4(-1.0..1.0_f64), nu in -0.5..0.49_f64) {
        let body = body(&[3.0], Elasticity::new(nu, Plane::Strain).unwrap());
        let [a, b, c, d] = gradient;
        let u: Vec<f64> = (0..body.grid.nodes()).flat_map(|n| {
            let [x, y] = body.grid.point(n);
            [a * x + b * y, c * x + d * y]
        }).collect();
        let [xx, yy, xy] = body.elasticity.unit_stress([a, d, b + c]).map(|s| 3.0 * s);
        let exact = |_: usize, side: usize| [[-xy, -yy], [xx, xy], [xy, yy], [-xx, -xy]][side];
        let scale = xx * xx + yy * yy + xy * xy;
        prop_assert!(bubble_indicators(&body, &[], &u, &|cell, side| exact(cell, side).map(Some)).iter().sum::<f64>() <= 1e-24 * scale);
        // without the tractions there is an error, but for held sides
        prop_assert!(bubble_indicators(&body, &[], &u, &|_, _| [Some(0.0); 2]).iter().sum::<f64>() > 1e-4 * scale);
        prop_assert!(bubble_indicators(&body, &[], &u, &|_, _| [None; 2]).iter().sum::<f64>() <= 1e-24 * scale);
    }

    #[test]
    fn quadratic_fields_have_their_own_error(curvature in prop::array::uniform4(-1.0..1.0_f64), nu in 0.0..0.45_f64) {
        // u = (a x² + b y², c x² + d y²) lies in the bilinear functions and side bubbles; u_h its nodal values, u - u_h has
        // in each cell the energy of -(a hx² ξ(1-ξ) + b hy² η(1-η), ..), and all residuals are those of this field
        let body = body(&[2.0], Elasticity::new(nu, Plane::Stress).unwrap());
        let [a, b, c, d] = curvature;
        let u: Vec<f64> = (0..body.grid.nodes()).flat_map(|n| {
            let [x, y] = body.grid.point(n);
            [a * x * x + b * y * y, c * x * x + d * y * y]
        }).collect();
        let [h, k] = body.grid.spacing;
        let law = &body.elasticity;
        let [lambda, mu] = [law.unit_stress([0.0, 1.0, 0.0])[0], law.unit_stress([0.0, 0.0, 1.0])[2]];
        // div σ, and the means of σn: the stress is linear
        let e = 2.0;
        let f = [-e * 2.0 * ((lambda + 2.0 * mu) * a + mu * b), -e * 2.0 * ((lambda + 2.0 * mu) * d + mu * c)];
        let mut loads = Loads::default();
        loads.set_body_force(&body, |_| f).unwrap();
        let stress = |[x, y]: [f64; 2]| law.unit_stress([2.0 * a * x, 2.0 * d * y, 2.0 * b * y + 2.0 * c * x]).map(|s| e * s);
        let traction = |cell: usize, side: usize| {
            let [x, y] = body.grid.centre(cell);
            let middle = [[x, y - k / 2.0], [x + h / 2.0, y], [x, y + k / 2.0], [x - h / 2.0, y]][side];
            let [xx, yy, xy] = stress(middle);
            [[-xy, -yy], [xx, xy], [xy, yy], [-xx, -xy]][side]
        };
        let found = bubble_indicators(&body, &loads.body, &u, &|cell, side| traction(cell, side).map(Some));
        // ∫ (h (1-2ξ))² = h²/3 over the cell
        let area = h * k;
        let (xx, yy) = (a * a * h * h / 3.0, d * d * k * k / 3.0);
        let xy = (b * b * k * k + c * c * h * h) / 3.0;
        let wanted = e * area * ((lambda + 2.0 * mu) * (xx + yy) + mu * xy);
        for cell in body.grid.body_cells() {
            prop_assert!((found[cell] - wanted).abs() < 1e-10 * wanted, "{} for {wanted}", found[cell]);
        }
        prop_assert_eq!(found.iter().filter(|e| **e == 0.0).count(), 48 - body.grid.body_cells().count());
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits(seed in any::<u64>()) {
        let body = body(&[1.0, 7.0, 3.0, 40.0, 0.2], strain());
        let u: Vec<f64> = (0..body.grid.dofs()).map(|i| unit_uniform(seed, i as u64) - 0.5).collect();
        let held: Vec<bool> = (0..u.len()).map(|i| i % 3 == 0 || i % 7 < 4).collect();
        let all = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| bubble_indicators(&body, &[], &u, &unless_held(&body, &held, pull)))
        };
        prop_assert_eq!(all(1), all(3));
    }
}
