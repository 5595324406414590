//! The truncation error of polynomials in the germs, cell by cell and direction by direction, and how to refine.

use rayon::prelude::*;

use crate::{CellBasis, StochasticError, StochasticMesh};

/// Fall of the coefficients a degree above which answers count as not smooth: halving a cell divides the error of degree q by
/// 2^(q+1) for twice the nodes, a degree more divides it by 1/decay for (q+2)/(q+1) of them, which is less where the decay is
/// above 1/e.
const ROUGH: f64 = 1.0 / 3.0;
/// Degree from which a direction is split whatever its coefficients do.
const HIGH: usize = 15;
/// Largest number of nodes from which a root is found.
const SIDE: usize = 8;
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
    /// Whether splitting gains more than a higher degree.
    pub fn is_rough(&self, degree: usize) -> bool {
        self.decay > ROUGH || degree >= HIGH
    }
}

/// Estimates for every direction of a cell the error of the polynomials of degree q_d in its germ: the truncation term of the
/// a-posteriori estimate, ‖(I - π_kq) u‖², with the coefficients beyond q_d extrapolated.
///
/// The answers are expanded in the orthonormal polynomials of the cell; a_k is the sum of the squared norms of the coefficients
/// of degree k in germ d. Answers may be even or odd, so that degrees are taken in pairs:
///
/// ```text
/// error = (a_q + a_(q-1)) rest times the probability,   rest = min(r/(1-r), (q+1)/3),   decay = r^¼
/// q >= 4   r = (a_q + a_(q-1))/(a_(q-2) + a_(q-3))
/// q  = 3   r = max(a_3/a_1, (a_2/a_1)²)
/// q  = 2   r = max((a_2/a_1)², (a_1/a_0)²)
/// ```
/// which is exact for a_k = C r^(k/2). The coefficients of a kink fall like k^-4 where it is seen and leave up to (q+1)/3:
/// that is the rest of directions that are `kinked`, conditions changing between nodes (and for q = 2 no more than a_2 stands
/// for a_1). The mean a_0 shows the effect of a germ and not the decay of the coefficients: where only it could be compared
/// with, for q = 1, and for q = 2 or 3 if a_2 is above a_1, the rest is taken as 1 or more. Degree 0 shows nothing: its error
/// is infinite.
///
/// `energy` is the square of the norm of an answer. *Fails when*: the answer is even about the middle of a cell of degree 1,
/// or odd except for a large mean with degree 2; all nodes lie on one side of a kink next to an end of the cell. *Cost*: the
/// square of the number of nodes a component.
///
/// # Panics
/// If there is not an answer for each node and a `kinked` for each germ.
pub fn truncation(
    basis: &CellBasis,
    answers: &[Vec<f64>],
    kinked: &[bool],
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
    let degrees = basis.degrees();
    assert_eq!(kinked.len(), degrees.len(), "a word for each germ");
    let direction = |(q, &kinked): (usize, &bool)| {
        stride /= q + 1;
        let sum = |degree: usize| -> f64 {
            norms.iter().enumerate().filter(|(k, _)| (k / stride) % (q + 1) == degree).map(|(_, e)| e).sum()
        };
        let DirectionError { error, decay } = extrapolate(&(0..=q).map(sum).collect::<Vec<f64>>(), kinked);
        DirectionError { error: probability * error, decay }
    };
    degrees.into_iter().zip(kinked).map(direction).collect()
}

/// The continuation of a_0 .. a_q.
fn extrapolate(a: &[f64], kinked: bool) -> DirectionError {
    let q = a.len() - 1;
    let last = if q > 1 { a[q] + a[q - 1] } else { a[q] };
    if q == 0 {
        return DirectionError { error: f64::INFINITY, decay: 0.0 };
    }
    if last == 0.0 {
        return DirectionError { error: 0.0, decay: 0.0 };
    }
    let square = |x: f64| x * x;
    let falls = q > 3 || q > 1 && a[1] > a[2];
    // ratio for the error, and that for the decision
    let [r, seen] = match q {
        1 => [1.0, 0.0],
        2 if falls => [square(a[2] / a[1]).max(square(a[1] / a[0])), square(a[2] / a[1])],
        2 => [1.0, 0.0],
        3 if falls => [(a[3] / a[1]).max(square(a[2] / a[1])); 2],
        3 => [1.0, last / (a[1] + a[0])],
        _ => [last / (a[q - 2] + a[q - 3]); 2],
    };
    let most = ((q + 1) as f64 / 3.0).max(1.0);
    let rest = if kinked || r >= 1.0 { most } else { most.min(r / (1.0 - r)) };
    // a_1 of a linear answer with a kink does not come from the kink
    let last = if kinked && q == 2 { a[2] + a[1].min(a[2]) } else { last };
    DirectionError { error: last * rest, decay: seen.sqrt().sqrt() }
}

/// A germ of a direction between whose neighbouring nodes conditions change, the median of all: `events` are, for each node of
/// the cell, functions that change sign where their conditions do, each smooth on either side. None if none changes.
///
/// The root is that of the polynomial through up to eight nodes of the side that has more of them.
///
/// # Panics
/// If there are not events for each node.
pub fn changes(basis: &CellBasis, direction: usize, events: &[Vec<f64>]) -> Option<f64> {
    assert_eq!(events.len(), basis.points.len(), "events for each node");
    let degrees = basis.degrees();
    let n = degrees[direction] + 1;
    let stride: usize = degrees[direction + 1..].iter().map(|q| q + 1).product();
    let mut roots = Vec::new();
    for first in (0..events.len()).filter(|j| (j / stride).is_multiple_of(n)) {
        for event in 0..events[first].len() {
            let line: Vec<[f64; 2]> =
                (0..n).map(|k| first + k * stride).map(|j| [basis.points[j][direction], events[j][event]]).collect();
            let differ = |k: &usize| (line[*k][1] > 0.0) != (line[*k + 1][1] > 0.0);
            roots.extend((0..n - 1).filter(differ).map(|k| root(&line, k)));
        }
    }
    roots.sort_by(f64::total_cmp);
    roots.get(roots.len() / 2).copied()
}

/// Where the values change sign between points k and k+1.
fn root(line: &[[f64; 2]], k: usize) -> f64 {
    let alike = |i: usize, j: usize| (line[i][1] > 0.0) == (line[j][1] > 0.0);
    let before = (0..=k).rev().take_while(|&i| alike(i, k)).take(SIDE);
    let after = (k + 1..line.len()).take_while(|&i| alike(i, k + 1)).take(SIDE);
    let [before, after] = [before.collect::<Vec<_>>(), after.collect()];
    let side = if before.len() > after.len() { before } else { after };
    // Neville's scheme
    let value = |x: f64| {
        let mut p: Vec<f64> = side.iter().map(|&i| line[i][1]).collect();
        for d in 1..side.len() {
            for i in 0..side.len() - d {
                let [a, b] = [line[side[i]][0], line[side[i + d]][0]];
                p[i] = ((x - b) * p[i] - (x - a) * p[i + 1]) / (a - b);
            }
        }
        p[0]
    };
    let [mut low, mut high] = [line[k][0], line[k + 1][0]];
    let [a, b] = [value(low), value(high)];
    if (a > 0.0) == (b > 0.0) {
        // the polynomial does not reach the other side: the chord does
        let [a, b] = [line[k][1], line[k + 1][1]];
        return low + (high - low) * a / (a - b);
    }
    loop {
        let middle = 0.5 * (low + high);
        if !(low < middle && middle < high) {
            return middle;
        }
        if (value(middle) > 0.0) == (a > 0.0) { low = middle } else { high = middle }
    }
}

/// Refines the directions of cells that together have the part `share` of the squared error, the largest first: raises the
/// degree where answers are smooth, splits the others at `at(cell, direction)`, or in halves of equal probability.
///
/// Returns the cells to be solved again, the new ones included, rising.
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
    let (mut sum, mut raised, mut split) = (0.0, Vec::new(), Vec::<(usize, usize)>::new());
    for (cell, direction) in order {
        let one = errors[cell][direction];
        if one.error == 0.0 || one.error.is_finite() && sum >= share * total {
            break;
        }
        if one.error.is_finite() {
            sum += one.error;
        }
        if !one.is_rough(mesh.cells[cell].degree[direction]) {
            raised.push((cell, direction));
        } else if split.iter().all(|s| s.0 != cell) {
            // what else is rough in this cell waits for the parts
            split.push((cell, direction));
        }
    }
    let mut changed: Vec<usize> = raised.iter().chain(&split).map(|c| c.0).collect();
    // parts of a cell have its raised degrees
    for (cell, direction) in raised {
        mesh.raise(cell, direction)?;
    }
    for (cell, direction) in split {
        let cut = mesh.cut(cell, direction, at(cell, direction));
        changed.push(mesh.split(cell, direction, cut)?);
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
