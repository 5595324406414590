//! Outcomes between the outermost nodes of stochastic cells and their ends: contact, slip and values that no node sees.

use steklov_contact::Solution;
use steklov_stochastic::{CellBasis, StochasticMesh, solve_points};

use super::events::Unanimous;
use super::jumps::Overlooked;
use super::outcomes::{Answer, Outcomes};
use super::watch::OutcomesWatch;

use crate::error::SolveError;

/// Part of the probability of a cell beyond which a germ without bounds is not examined.
const RARE: f64 = 1e-4;
/// Part of a cell by which the places are inside of its ends: data may jump there.
const INSIDE: f64 = 1e-9;
/// Most germs of which all corners are tried, by polynomials.
const CORNERS: usize = 10;

/// The difference of an outcome from the polynomials of its cell.
pub(super) struct Residual {
    /// Square of the norm: of displacements or of stresses, in the energy norms of the mean modulus, whichever is larger.
    pub(super) squared: f64,
    /// Squares of the truncations of the quantities.
    pub(super) quantities: Vec<f64>,
}

/// The error of polynomials in one direction of a cell.
pub(super) struct Miss {
    pub(super) direction: usize,
    /// Germ at which to split.
    pub(super) at: Option<f64>,
    /// Whether contact or stick change where no node sees it.
    pub(super) event: bool,
    /// ∫ of the squared residual over the cell, about.
    pub(super) residual: Residual,
}

/// Residual of the outcome at a germ of a cell.
pub(super) fn residual(
    outcomes: &Outcomes<'_>,
    basis: &CellBasis,
    nodes: &[Answer],
    germ: &[f64],
    outcome: &Answer,
) -> Residual {
    let mut theta = vec![0.0; nodes.len()];
    basis.evaluate(germ, &mut theta);
    let apart = |of: &dyn Fn(&Answer) -> &Vec<f64>| -> Vec<f64> {
        let mut apart = of(outcome).clone();
        for (t, node) in theta.iter().zip(nodes) {
            apart.iter_mut().zip(of(node)).for_each(|(a, u)| *a -= t * u);
        }
        apart
    };
    let mean = mean_modulus(nodes);
    let strains = mean * outcomes.energy(&apart(&|a| &a.displacement));
    let stresses = outcomes.energy(&apart(&|a| &a.stressed)) / mean;
    let quantities = apart(&|a| &a.quantities).iter().map(|q| q * q).collect();
    Residual { squared: strains.max(stresses).max(0.0), quantities }
}

/// Mean of E/E₀ over answers.
pub(super) fn mean_modulus(answers: &[Answer]) -> f64 {
    answers.iter().map(|a| a.modulus).sum::<f64>() / answers.len() as f64
}

/// A place at which a cell is examined.
struct Place {
    /// Index of the cell among the examined ones.
    cell: usize,
    direction: usize,
    germ: Vec<f64>,
    kind: Kind,
}

/// Why a place is examined.
enum Kind {
    /// It is the end of the direction.
    End,
    /// A corner at which polynomials foresee an event.
    Corner,
    /// Data are there as at no node: in this part of the cell, that begins at this germ.
    Data { share: f64, at: Option<f64> },
}

/// An examined cell.
pub(super) struct Looked<'a> {
    /// Its index in the mesh.
    pub(super) cell: usize,
    pub(super) basis: &'a CellBasis,
    pub(super) nodes: &'a [Answer],
}

/// The result of looking at cells.
pub(super) struct Look {
    /// The misses of each cell.
    pub(super) misses: Vec<Vec<Miss>>,
    /// Part of the probability of each in which kinks and jumps of data are neither found nor excluded.
    pub(super) undecided: Vec<f64>,
    /// Outcomes that were solved.
    pub(super) outcomes: usize,
}

/// Solves outcomes at both ends of each direction of cells, the other germs in their middle, at the corner where polynomials put
/// an event that no node sees, and where data are as at no node.
///
/// A residual R at an end counts as R²/p_(q+1)², as for an error of the next degree; where contact or stick change on the way
/// there, as a kink at the place of the change: half of R² in the part beyond.
pub(super) fn look(
    outcomes: &Outcomes<'_>,
    mesh: &StochasticMesh,
    cells: &[Looked<'_>],
    watch: &OutcomesWatch<'_>,
) -> Result<Look, SolveError> {
    let inside = |[a, b]: [f64; 2]| [a + INSIDE * (b - a), b - INSIDE * (b - a)];
    let ends: Vec<Vec<[f64; 2]>> =
        cells.iter().map(|c| mesh.ends(c.cell, RARE).into_iter().map(inside).collect()).collect();
    let middles: Vec<Vec<f64>> = cells.iter().map(|c| middle(c.basis)).collect();
    let (places, undecided) = places(outcomes, mesh, cells, &ends, &middles);
    let answers = solve_points(places.len(), |i, warm: &mut Option<Solution>| {
        watch.check()?;
        outcomes.answer(&places[i].germ, warm)
    })?;
    let mut misses: Vec<Vec<Miss>> = cells.iter().map(|_| Vec::new()).collect();
    let mut first = 0;
    for (k, cell) in cells.iter().enumerate() {
        let count = places[first..].iter().take_while(|p| p.cell == k).count();
        let (own, answers) = (&places[first..first + count], &answers[first..first + count]);
        first += count;
        let unanimous = Unanimous::new(cell.basis, cell.nodes, answers);
        for (i, (place, answer)) in own.iter().zip(answers).enumerate() {
            let mut residual = residual(outcomes, cell.basis, cell.nodes, &place.germ, answer);
            let is_end = matches!(place.kind, Kind::End);
            let outermost = if is_end { outermost(cell.basis, &middles[k], place) } else { 0.0 };
            let change = unanimous.change(i, &middles[k], &place.germ, outermost);
            let on_way = |t: f64, d: usize| middles[k][d] + t * (place.germ[d] - middles[k][d]);
            let share = |d: usize, from: f64| beyond(mesh, cell.cell, d, from, place.germ[d]);
            let (part, at) = match (&place.kind, change) {
                (Kind::Data { share, at }, _) => (*share, *at),
                (Kind::End, Some(t)) => {
                    let at = on_way(t, place.direction);
                    (0.5 * share(place.direction, at), Some(at))
                }
                (Kind::Corner, Some(t)) => {
                    let part = (0..middles[k].len()).map(|d| share(d, on_way(t, d))).product::<f64>();
                    (0.5 * part, Some(on_way(t, place.direction)))
                }
                (Kind::End, None) => {
                    let next = cell.basis.next_polynomial(place.direction, place.germ[place.direction]);
                    (next.powi(-2), None)
                }
                (Kind::Corner, None) => continue,
            };
            let weight = part * mesh.probability(cell.cell);
            residual.squared *= weight;
            residual.quantities.iter_mut().for_each(|q| *q *= weight);
            misses[k].push(Miss { direction: place.direction, at, event: at.is_some(), residual });
        }
    }
    Ok(Look { misses, undecided, outcomes: places.len() })
}

/// The places at which cells are examined, and the part of each in which data are neither found nor excluded.
fn places(
    outcomes: &Outcomes<'_>,
    mesh: &StochasticMesh,
    cells: &[Looked<'_>],
    ends: &[Vec<[f64; 2]>],
    middles: &[Vec<f64>],
) -> (Vec<Place>, Vec<f64>) {
    let mut undecided = Vec::new();
    let mut places: Vec<Place> = Vec::new();
    for (k, cell) in cells.iter().enumerate() {
        let degrees = cell.basis.degrees();
        // degree 0 has no other polynomial to compare with: its error is infinite anyway
        for direction in (0..degrees.len()).filter(|&d| degrees[d] > 0) {
            for end in ends[k][direction] {
                let mut germ = middles[k].clone();
                germ[direction] = end;
                places.push(Place { cell: k, direction, germ, kind: Kind::End });
            }
        }
        if (2..=CORNERS).contains(&degrees.len()) && degrees.iter().all(|q| *q > 0) {
            places.extend(corner(cell, &ends[k], &middles[k]).map(|(d, germ)| Place {
                cell: k,
                direction: d,
                germ,
                kind: Kind::Corner,
            }));
        }
        let seen = outcomes.data.seen(&cell.basis.points);
        let open = outcomes.data.open(&seen, &ends[k], &mesh.variables);
        undecided.push(open.undecided);
        for Overlooked { germ, share, cut } in open.found {
            let (direction, at) = cut.map_or((0, None), |(d, at)| (d, Some(at)));
            places.push(Place { cell: k, direction, germ, kind: Kind::Data { share, at } });
        }
    }
    (places, undecided)
}

/// Mean of the nodes.
fn middle(basis: &CellBasis) -> Vec<f64> {
    let sum: f64 = basis.weights.iter().sum();
    let mean = |d: usize| basis.weights.iter().zip(&basis.points).map(|(w, p)| w * p[d]).sum::<f64>() / sum;
    (0..basis.degrees().len()).map(mean).collect()
}

/// Part of the way from the middle to an end at which the outermost node is.
fn outermost(basis: &CellBasis, middle: &[f64], place: &Place) -> f64 {
    let (d, middle) = (place.direction, middle[place.direction]);
    basis.points.iter().map(|p| (p[d] - middle) / (place.germ[d] - middle)).fold(0.0, f64::max)
}

/// Part of the probability of a cell between a germ and an end of one direction, and the part beyond it.
fn beyond(mesh: &StochasticMesh, cell: usize, direction: usize, from: f64, end: f64) -> f64 {
    let variable = &mesh.variables[direction];
    let [a, b] = mesh.cells[cell].bounds[direction];
    let part = if end > from { [from, b] } else { [a, from] };
    variable.probability(part) / variable.probability([a, b])
}

/// The corner at which polynomials put an event of no node farthest beyond its change, and the direction that does most for it.
fn corner(cell: &Looked<'_>, ends: &[[f64; 2]], middle: &[f64]) -> Option<(usize, Vec<f64>)> {
    let unanimous = Unanimous::new(cell.basis, cell.nodes, &[]);
    let (mut most, mut found) = (0.0, None);
    for corner in 0..1usize << ends.len() {
        let germ: Vec<f64> = ends.iter().enumerate().map(|(d, e)| e[corner >> d & 1]).collect();
        let beyond = unanimous.beyond(&germ);
        if beyond > most {
            (most, found) = (beyond, Some(germ));
        }
    }
    let germ = found?;
    // without it the event is least far beyond, or not at all
    let without = |d: usize| {
        let mut germ = germ.clone();
        germ[d] = middle[d];
        unanimous.beyond(&germ)
    };
    let left: Vec<f64> = (0..germ.len()).map(without).collect();
    let direction = (0..germ.len()).min_by(|&a, &b| left[a].total_cmp(&left[b]))?;
    Some((direction, germ))
}
