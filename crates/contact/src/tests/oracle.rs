//! Brute force over all active sets.

use faer::prelude::*;
use steklov_algebra::{singular_values, solve_full_lu};

use crate::Problem;

/// The solution v of a problem with a positive definite stiffness, by trying every combination of contact or apart, and
/// stick or slip either way: linear systems in v and the multipliers of what is on, kept when all inequalities hold.
pub fn brute_force(problem: &Problem) -> Vec<f64> {
    // (first unknown, unknowns, direction, at, low, high, states to try)
    let mut rows = Vec::new();
    for node in &problem.nodes {
        for c in &node.conditions {
            if c.normal_weight > 0.0 {
                rows.push((node.first, node.unknowns, c.normal, c.gap, 0.0, f64::INFINITY, vec![0, 1]));
            }
            let high = if c.tangent_weight > 0.0 { c.tangent_weight * c.bound } else { 0.0 };
            let states = if high == 0.0 {
                vec![2]
            } else if high.is_infinite() {
                vec![0]
            } else {
                vec![0, 1, 2]
            };
            rows.push((node.first, node.unknowns, c.tangent, -c.slip_offset, -high, high, states));
        }
    }
    let combinations: usize = rows.iter().map(|r| r.6.len()).product();
    let m = problem.load.len();
    let no_pressure: Vec<[f64; 2]> = problem.nodes.iter().flat_map(|n| n.conditions.iter().map(|_| [0.0; 2])).collect();
    let mut best: Option<((f64, f64), Vec<f64>)> = None;
    for mut number in 0..combinations {
        let states: Vec<usize> = rows
            .iter()
            .map(|r| {
                let s = r.6[number % r.6.len()];
                number /= r.6.len();
                s
            })
            .collect(); // 0 on, 1 below, 2 above
        let on: Vec<usize> = (0..rows.len()).filter(|&i| states[i] == 0).collect();
        let size = m + on.len();
        let mut a = Mat::zeros(size, size);
        let mut b = Mat::zeros(size, 1);
        for i in 0..m {
            b[(i, 0)] = problem.load[i];
            for j in 0..m {
                a[(i, j)] = problem.stiffness[(i, j)];
            }
        }
        for (i, row) in rows.iter().enumerate() {
            let x = [f64::NAN, row.4, row.5][states[i]];
            for k in 0..row.1 {
                if let Some(p) = on.iter().position(|&o| o == i) {
                    a[(row.0 + k, m + p)] = row.2[k];
                    a[(m + p, row.0 + k)] = row.2[k];
                    b[(m + p, 0)] = row.3;
                } else {
                    b[(row.0 + k, 0)] -= x * row.2[k];
                }
            }
        }
        let singular = singular_values(a.as_ref()).unwrap();
        if singular[size - 1] < 1e-11 * singular[0] {
            continue; // dependent conditions: fewer of them carry the same forces
        }
        let z = solve_full_lu(a.as_ref(), b.as_ref());
        let (mut wrong, stress) = (0.0f64, (0..m).fold(0.0f64, |s, i| s.max(problem.load[i].abs())));
        for (i, row) in rows.iter().enumerate() {
            let s = (0..row.1).map(|k| row.2[k] * z[(row.0 + k, 0)]).sum::<f64>() - row.3;
            wrong = wrong.max(match states[i] {
                0 => {
                    let x = z[(m + on.iter().position(|&o| o == i).unwrap(), 0)];
                    (x - row.5).max(row.4 - x) / stress
                }
                1 => s,
                _ if row.5 == 0.0 => 0.0, // without friction either way of slip is right
                _ => -s,
            });
        }
        // forces of a huge bound that cancel hide their rounding from the inequalities, not from the energy
        let v: Vec<f64> = (0..m).map(|i| z[(i, 0)]).collect();
        let key = (wrong.max(1e-12), problem.energy(&v, &no_pressure));
        if best.as_ref().is_none_or(|b| key < b.0) {
            best = Some((key, v));
        }
    }
    let ((wrong, _), v) = best.expect("some combination is regular");
    assert!(wrong < 1e-9, "no combination satisfies all inequalities: the best misses by {wrong:e}");
    v
}

pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// All solutions `(v, λ)` of a problem of ordinary nodes under Coulomb's law: of each combination of apart, stick and slip
/// either way the linear system in v and λ, kept when all inequalities hold.
pub fn coulomb_solutions(problem: &Problem) -> Vec<(Vec<f64>, Vec<[f64; 2]>)> {
    let (n, m) = (problem.nodes.len(), problem.load.len());
    let stress = (0..m).fold(0.0f64, |s, i| s.max(problem.load[i].abs()));
    let mut found: Vec<(Vec<f64>, Vec<[f64; 2]>)> = Vec::new();
    for number in 0..4usize.pow(n as u32) {
        let states: Vec<usize> = (0..n).map(|i| number / 4usize.pow(i as u32) % 4).collect();
        let (mut a, mut b) = (Mat::<f64>::zeros(2 * m, 2 * m), Mat::<f64>::zeros(2 * m, 1));
        for i in 0..m {
            b[(i, 0)] = problem.load[i];
            (0..m).for_each(|j| a[(i, j)] = problem.stiffness[(i, j)]);
        }
        for (i, node) in problem.nodes.iter().enumerate() {
            let (c, normal, shear) = (&node.conditions[0], m + 2 * i, m + 2 * i + 1);
            a[(2 * i, normal)] = c.normal_weight;
            a[(2 * i + 1, shear)] = c.tangent_weight;
            match states[i] {
                0 => (a[(normal, normal)], a[(shear, shear)]) = (1.0, 1.0),
                state => {
                    (a[(normal, 2 * i)], b[(normal, 0)]) = (1.0, c.gap);
                    if state == 1 {
                        (a[(shear, 2 * i + 1)], b[(shear, 0)]) = (1.0, -c.slip_offset);
                    } else {
                        let sign = if state == 2 { 1.0 } else { -1.0 };
                        (a[(shear, shear)], a[(shear, normal)]) = (1.0, -sign * c.coefficient);
                    }
                }
            }
        }
        let singular = singular_values(a.as_ref()).unwrap();
        if singular[2 * m - 1] < 1e-11 * singular[0] {
            continue;
        }
        let z = solve_full_lu(a.as_ref(), b.as_ref());
        let right = problem.nodes.iter().enumerate().all(|(i, node)| {
            let (c, pressure, shear) = (&node.conditions[0], z[(m + 2 * i, 0)], z[(m + 2 * i + 1, 0)]);
            let slip = z[(2 * i + 1, 0)] + c.slip_offset;
            match states[i] {
                0 => z[(2 * i, 0)] <= c.gap + 1e-11,
                1 => pressure >= -1e-11 * stress && shear.abs() <= c.coefficient * pressure + 1e-11 * stress,
                2 => pressure >= -1e-11 * stress && slip >= -1e-11,
                _ => pressure >= -1e-11 * stress && slip <= 1e-11,
            }
        });
        let v: Vec<f64> = (0..m).map(|i| z[(i, 0)]).collect();
        if right && found.iter().all(|f| distance(&f.0, &v) > 1e-8) {
            found.push((v, (0..n).map(|i| [z[(m + 2 * i, 0)], z[(m + 2 * i + 1, 0)]]).collect()));
        }
    }
    found
}
