//! What the truncation of polynomials in the germs leaves out, cell by cell and direction by direction, and how to refine.

use rayon::prelude::*;

use crate::{CellBasis, StochasticError, StochasticMesh};

/// Fall of the coefficients a degree above which answers count as not smooth.
const ROUGH: f64 = 0.25;
/// Degree from which a direction is split whatever its coefficients do.
const HIGH: usize = 15;
/// A cell is not cut closer to its ends than this part of its probability.
const EDGE: f64 = 1e-3;

/// The truncation of the polynomials in one direction of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionError {
    /// Estimated ∫ ‖u - u_kq‖² ρ over the cell that higher degrees in this direction would remove.
    pub error: f64,
    /// Factor by which the norm of the coefficients falls a degree.
    pub decay: f64,
}

impl DirectionError {
    /// Whether splitting does more than a higher degree.
    pub fn is_rough(&self, degree: usize) -> bool {
        self.decay > ROUGH || degree >= HIGH
    }
}

/// Estimates for every direction of a cell the error of the polynomials of degree q_d in its germ: the truncation term of the
/// a-posteriori estimate, ‖(I - π_kq) u‖², with the coefficients beyond q_d extrapolated.
///
/// The answers are expanded in the orthonormal polynomials of the cell; a_k is the sum of the squared norms of the coefficients of
/// degree k in germ d. As answers may be even or odd, the larger of a_q, a_(q-1) is compared with the larger of a_(q-2), a_(q-3): with
/// ρ² their ratio (ρ the ratio of a_1 and a_0 below degree 3), what follows is a ρ/(1-ρ). Where ρ > 1/2 the answer is not smooth and
/// a (q+1) is taken, the sum that follows coefficients of a kink. Degree 0 tells nothing of itself: its error is infinite.
///
/// `energy` is the square of the norm of an answer. *Fails when*: the degree is below 3 and the answer has a kink. *Cost*: the
/// square of the number of nodes a component.
///
/// # Panics
/// If there is not an answer for each node.
pub fn truncation(
    basis: &CellBasis,
    answers: &[Vec<f64>],
    energy: &(dyn Fn(&[f64]) -> f64 + Sync),
) -> Vec<DirectionError> {
    assert_eq!(answers.len(), basis.points.len(), "an answer for each node");
    let components = answers.first().map_or(0, Vec::len);
    let by_component: Vec<Vec<f64>> = (0..components)
        .into_par_iter()
        .map(|i| basis.coefficients(&answers.iter().map(|u| u[i]).collect::<Vec<f64>>()))
        .collect();
    let norms: Vec<f64> = (0..answers.len())
        .into_par_iter()
        .map(|k| energy(&by_component.iter().map(|c| c[k]).collect::<Vec<f64>>()).max(0.0))
        .collect();
    let probability: f64 = basis.weights.iter().sum();
    let mut stride = answers.len();
    let direction = |q: usize| {
        stride /= q + 1;
        let a = |degree: usize| -> f64 {
            norms.iter().enumerate().filter(|(k, _)| (k / stride) % (q + 1) == degree).map(|(_, e)| e).sum()
        };
        let (top, rho) = match q {
            0 => return DirectionError { error: f64::INFINITY, decay: 0.0 },
            1 => (a(1), a(1) / a(0)),
            2 => (a(1).max(a(2)), a(1).max(a(2)) / a(0)),
            _ => {
                let top = a(q).max(a(q - 1));
                (top, (top / a(q - 2).max(a(q - 3))).sqrt())
            }
        };
        let rho = if top == 0.0 { 0.0 } else { rho };
        let rest = if rho <= 0.5 { rho / (1.0 - rho) } else { (q + 1) as f64 };
        DirectionError { error: probability * top * rest, decay: rho.sqrt() }
    };
    basis.degrees().into_iter().map(direction).collect()
}

/// A germ of a direction between whose neighbouring nodes conditions change, the median of all: `events` are, for each node of
/// the cell, functions that change sign where their conditions do. None if none changes.
///
/// # Panics
/// If there are not events for each node.
pub fn changes(basis: &CellBasis, direction: usize, events: &[Vec<f64>]) -> Option<f64> {
    assert_eq!(events.len(), basis.points.len(), "events for each node");
    let degrees = basis.degrees();
    let n = degrees[direction] + 1;
    let stride: usize = degrees[direction + 1..].iter().map(|q| q + 1).product();
    let mut roots = Vec::new();
    for j in (0..events.len()).filter(|j| (j / stride) % n + 1 < n) {
        let next = j + stride;
        let (x, y) = (basis.points[j][direction], basis.points[next][direction]);
        for (&a, &b) in events[j].iter().zip(&events[next]) {
            if (a > 0.0) != (b > 0.0) {
                roots.push(x + (y - x) * a / (a - b));
            }
        }
    }
    roots.sort_by(f64::total_cmp);
    roots.get(roots.len() / 2).copied()
}

/// Refines the directions of cells that have together the part `share` of the squared error, the largest first: raises the
/// degree where answers are smooth, splits the others at `at(cell, direction)`, or in halves of equal probability.
///
/// Gives back the cells that are to be solved again, the new ones included, rising.
///
/// # Errors
/// Those of [`StochasticMesh::split`].
pub fn refine(
    mesh: &mut StochasticMesh,
    errors: &[Vec<DirectionError>],
    share: f64,
    at: &dyn Fn(usize, usize) -> Option<f64>,
) -> Result<Vec<usize>, StochasticError> {
    let mut order: Vec<(usize, usize)> =
        errors.iter().enumerate().flat_map(|(c, e)| (0..e.len()).map(move |d| (c, d))).collect();
    order.sort_by(|a, b| errors[b.0][b.1].error.total_cmp(&errors[a.0][a.1].error));
    let total: f64 = errors.iter().flatten().map(|e| e.error).filter(|e| e.is_finite()).sum();
    let (mut sum, mut split, mut changed) = (0.0, Vec::new(), Vec::new());
    for (cell, direction) in order {
        let one = errors[cell][direction];
        if one.error == 0.0 || one.error.is_finite() && sum >= share * total {
            break;
        }
        if one.error.is_finite() {
            sum += one.error;
        }
        changed.push(cell);
        if !one.is_rough(mesh.cells[cell].degree[direction]) {
            mesh.raise(cell, direction)?;
        } else if !split.contains(&cell) {
            // what else is marked of this cell waits for the parts
            let cut = mesh.cut(cell, direction, at(cell, direction));
            changed.push(mesh.split(cell, direction, cut)?);
            split.push(cell);
        }
    }
    changed.sort_unstable();
    changed.dedup();
    Ok(changed)
}

impl StochasticMesh {
    /// Where to split: at `wanted`, but not next to the ends of the cell, or in the middle of its probability.
    fn cut(&self, cell: usize, direction: usize, wanted: Option<f64>) -> f64 {
        let variable = &self.variables[direction];
        let [a, b] = self.cells[cell].bounds[direction];
        let below = variable.probability([variable.germ_support()[0], a]);
        let inside = variable.probability([a, b]);
        let quantile = |part: f64| variable.quantile(below + part * inside);
        let (low, high) = (quantile(EDGE), quantile(1.0 - EDGE));
        wanted.map_or(quantile(0.5), |w| w.clamp(low, high))
    }
}
