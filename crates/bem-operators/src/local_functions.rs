//! Functions on one element as Legendre coefficients: nodal ones and the bubble of an enrichment.

use crate::Space;
use crate::moments::LANES;

/// The functions of an element of one degree: the nodal ones from start to end, then, with an enrichment, the bubble
/// (P_(p+1) - P_(p-1))/(2p+1).
pub(crate) struct Local {
    /// Legendre coefficients of each function, one more than there are test degrees.
    pub(crate) values: Vec<f64>,
    /// Legendre coefficients of its derivative with respect to t.
    pub(crate) derivatives: Vec<f64>,
    /// The same, coefficient by coefficient: that of function i at m `stride` + i.
    pub(crate) transposed: Vec<f64>,
    pub(crate) stride: usize,
}

impl Local {
    pub(crate) fn new(space: &Space, e: usize, enriched: bool) -> Self {
        let basis = space.basis(e);
        let p = basis.degree;
        let top = p + usize::from(enriched);
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        for j in 0..=p {
            values.extend((0..=top).map(|n| if n <= p { basis.to_legendre[(n, j)] } else { 0.0 }));
            derivatives.extend((0..top).map(|n| if n < p { basis.derivative_to_legendre[(n, j)] } else { 0.0 }));
        }
        if enriched {
            let scale = 1.0 / (2 * p + 1) as f64;
            values.extend((0..=top).map(|n| match n {
                _ if n == p + 1 => scale,
                _ if n + 1 == p => -scale,
                _ => 0.0,
            }));
            derivatives.extend((0..top).map(|n| if n == p { 1.0 } else { 0.0 }));
        }
        let functions = values.len() / (top + 1);
        let stride = functions.next_multiple_of(LANES);
        let mut transposed = vec![0.0; stride * top];
        for (i, row) in derivatives.chunks_exact(top).enumerate() {
            row.iter().enumerate().for_each(|(m, d)| transposed[m * stride + i] = *d);
        }
        Self { values, derivatives, transposed, stride }
    }
}
