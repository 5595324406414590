//! What a multiscale field lacks of the solution on the fine grid.

use rayon::prelude::*;

use crate::HeterogeneousBody;

/// Steps of conjugate gradients at most.
const MOST: usize = 400;
/// Steps whose gain of energy is compared with all of it.
const LAST: usize = 4;

/// c = u_h - u_H on the fine nodes (length), interleaved: K c = r = f - K u_H where nothing is held, 0 there.
///
/// `residual` is r, `held` says which fine unknowns are held, and `resist` what else resists each of them (stress), on the diagonal of K;
/// it may be empty. Conjugate gradients with the 2 × 2 blocks of the nodes stop when four
/// steps add less than `enough` of the energy ½ cᵀKc, which they approach from below. The residual of a multiscale field is on the
/// edges of coarse cells and c dies away from them, so that about as many steps are needed as fine cells lie across a coarse one,
/// times the root of the contrast between neighbours.
///
/// *Fails when* moduli differ by more than 10⁴ between neighbours: after 400 steps c is what was reached.
/// Cost: a product K u a step, 130 operations a cell.
pub fn fine_correction(
    body: &HeterogeneousBody,
    residual: &[f64],
    held: &[bool],
    resist: &[f64],
    enough: f64,
) -> Vec<f64> {
    let inverse: Vec<[[f64; 2]; 2]> =
        (0..body.grid.nodes()).into_par_iter().map(|node| inverse_block(body, node, held, resist)).collect();
    // z = B r, and r·z
    let precondition = |r: &[f64], z: &mut [f64]| {
        let mut size = 0.0;
        for ((r, z), [[a, b], [c, d]]) in r.chunks_exact(2).zip(z.chunks_exact_mut(2)).zip(&inverse) {
            (z[0], z[1]) = (a * r[0] + b * r[1], c * r[0] + d * r[1]);
            size += r[0] * z[0] + r[1] * z[1];
        }
        size
    };
    let mut r = residual.to_vec();
    let (mut c, mut z, mut product) = (vec![0.0; r.len()], vec![0.0; r.len()], vec![0.0; r.len()]);
    // held unknowns have no part in z and p
    let mut size = precondition(&r, &mut z);
    let mut p = z.clone();
    let mut gains: Vec<f64> = Vec::new();
    while size > 0.0 && gains.len() < MOST {
        body.multiply(&p, &mut product);
        product.iter_mut().zip(resist).zip(&p).for_each(|((q, d), p)| *q += d * p);
        let curvature: f64 = p.iter().zip(&product).map(|(p, q)| p * q).sum();
        if curvature <= 0.0 {
            break;
        }
        let step = size / curvature;
        for i in 0..c.len() {
            c[i] += step * p[i];
            r[i] -= step * product[i];
        }
        gains.push(step * size);
        let recent: f64 = gains[gains.len().saturating_sub(LAST)..].iter().sum();
        if gains.len() > LAST && recent <= enough * gains.iter().sum::<f64>() {
            break;
        }
        let next = precondition(&r, &mut z);
        let beta = next / size;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + beta * *p);
        size = next;
    }
    c
}

/// The inverse of the block of a node in K, 0 for held unknowns.
fn inverse_block(body: &HeterogeneousBody, node: usize, held: &[bool], resist: &[f64]) -> [[f64; 2]; 2] {
    let mut block = [[0.0; 2]; 2];
    let mut own = [[0.0; 8]; 8];
    for (cell, a) in body.around(node).into_iter().flatten() {
        let unit = body.unit_of(cell, &mut own);
        for (i, row) in block.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += body.young[cell] * unit[2 * a + i][2 * a + j];
            }
        }
    }
    (0..2).for_each(|i| block[i][i] += resist.get(2 * node + i).copied().unwrap_or_default());
    let [[a, b], [c, d]] = block;
    match [held[2 * node], held[2 * node + 1]] {
        [true, true] => [[0.0; 2]; 2],
        [true, false] => [[0.0, 0.0], [0.0, 1.0 / d]],
        [false, true] => [[1.0 / a, 0.0], [0.0, 0.0]],
        [false, false] => {
            let det = a * d - b * c;
            [[d / det, -b / det], [-c / det, a / det]]
        }
    }
}
