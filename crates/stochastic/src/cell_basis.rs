//! Tensor Lagrange basis of a stochastic cell.

use crate::stochastic_mesh::MOST;
use crate::{Recurrence, StochasticCell, StochasticError, Variable};
use faer::Mat;
use steklov_quadrature::Rule;

/// Gauss points of [`CellBasis::mass`] beyond the q+1 of the basis, in each direction.
const EXTRA: usize = 6;
/// Largest rounding error of products of orthonormal polynomials.
const ORTHONORMAL: f64 = 1e-8;

/// Where the nodes of a cell's basis are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nodes {
    /// The Gauss points of the density in the cell: M_E is diagonal for E affine in each germ.
    Gauss,
    /// Its Lobatto points, which include the ends of the cell; M_E is full. A direction of degree 0 has no Lobatto rule: its
    /// node is the Gauss point, the mean.
    Lobatto,
}

/// θ_j, the products of the Lagrange polynomials of degree q_d at q_d + 1 nodes in each direction d; the nodes of the last
/// direction run fastest.
///
/// ∫ .. ρ is over the cell with the density of the germs, so that ∫ρ is the cell's probability.
///
/// Source: Issaoui (2014), section 4.2.
#[derive(Debug, Clone)]
pub struct CellBasis {
    /// Nodes (germs).
    pub points: Vec<Vec<f64>>,
    /// D_j = ∫ θ_j ρ > 0, with the probability of the cell.
    pub weights: Vec<f64>,
    axes: Vec<Axis>,
}

/// Basis in one direction.
#[derive(Debug, Clone)]
struct Axis {
    /// Recurrence to degree q + `EXTRA`, for over-integration.
    recurrence: Recurrence,
    /// Nodes; weights sum to 1.
    rule: Rule,
    /// A quarter of the spread of the nodes, 1 for a single one: products of their distances over it stay near 1.
    unit: f64,
    /// 1/Π_{k≠j} of the distances of the nodes over `unit`.
    barycentric: Vec<f64>,
    /// p_k at node j in row k, column j.
    polynomials: Mat<f64>,
    /// Σ_j w_j p_q(x_j)² of the highest degree, which is 1 for Gauss nodes, more for Lobatto nodes; 1 for the lower ones.
    top: f64,
}

impl CellBasis {
    /// Basis of a cell.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for a cell of other directions than the variables; [`StochasticError::Number`]
    /// for a degree above 249, more than a million nodes, or Lobatto nodes in an unbounded direction;
    /// [`StochasticError::NoProbability`] for a cell without.
    pub fn new(variables: &[Variable], cell: &StochasticCell, nodes: Nodes) -> Result<Self, StochasticError> {
        let directions = variables.len();
        if cell.bounds.len() != directions || cell.degree.len() != directions {
            return Err(StochasticError::Inconsistent {
                what: format!(
                    "a cell with {} bounds and {} degrees for {directions} variables",
                    cell.bounds.len(),
                    cell.degree.len()
                ),
            });
        }
        let count = cell.degree.iter().map(|&q| q as f64 + 1.0).product::<f64>();
        if count > MOST as f64 {
            return Err(StochasticError::Number {
                what: "the number of nodes of a stochastic cell".into(),
                value: count,
                wanted: "at most 1e6: lower its degrees, or use Smolyak points or samples",
            });
        }
        let axes: Result<Vec<_>, _> =
            (0..directions).map(|d| Axis::new(&variables[d], cell.bounds[d], cell.degree[d], nodes)).collect();
        Ok(Self::of(axes?))
    }

    fn of(axes: Vec<Axis>) -> Self {
        let probability: f64 = axes.iter().map(|axis| axis.recurrence.probability).product();
        let rules: Vec<&Rule> = axes.iter().map(|axis| &axis.rule).collect();
        let (points, mut weights) = tensor(&rules);
        weights.iter_mut().for_each(|w| *w *= probability);
        Self { points, weights, axes }
    }

    /// Recurrence and rule of each direction: all else follows from them.
    pub fn axes(&self) -> impl ExactSizeIterator<Item = (&Recurrence, &Rule)> {
        self.axes.iter().map(|axis| (&axis.recurrence, &axis.rule))
    }

    /// The basis of a recurrence and a rule for each direction.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] unless each recurrence has six coefficients more than its rule points, and the rule
    /// makes the orthonormal polynomials orthonormal as far as its degree 2n-1 (Gauss) or 2n-3 (Lobatto) goes, to 1e-8;
    /// [`StochasticError::Number`] for more than a million nodes.
    pub fn from_axes(axes: Vec<(Recurrence, Rule)>) -> Result<Self, StochasticError> {
        let count = axes.iter().map(|(_, rule)| rule.len() as f64).product::<f64>();
        if count > MOST as f64 {
            let what = "the number of nodes of a stochastic cell".into();
            return Err(StochasticError::Number { what, value: count, wanted: "at most 1e6" });
        }
        for (d, (recurrence, rule)) in axes.iter().enumerate() {
            recurrence.check()?;
            check_rule(recurrence, rule)
                .map_err(|what| StochasticError::Inconsistent { what: format!("the rule of direction {d} {what}") })?;
        }
        Ok(Self::of(axes.into_iter().map(|(recurrence, rule)| Axis::of(recurrence, rule)).collect()))
    }

    /// θ_j(germ) in `values[j]`; polynomials go on outside of the cell.
    ///
    /// # Panics
    /// If `germ` does not have a number for each direction or `values` one for each node.
    pub fn evaluate(&self, germ: &[f64], values: &mut [f64]) {
        assert_eq!((germ.len(), values.len()), (self.axes.len(), self.points.len()), "directions and nodes");
        values[0] = 1.0;
        let mut filled = 1;
        for (axis, &x) in self.axes.iter().zip(germ) {
            let own = axis.lagrange(x);
            for i in (0..filled).rev() {
                let before = values[i];
                for (j, l) in own.iter().enumerate() {
                    values[i * own.len() + j] = before * l;
                }
            }
            filled *= own.len();
        }
    }

    /// Points of integration of [`Self::mass`] in each direction, weights sum to 1.
    fn mass_rules(&self) -> Result<Vec<Rule>, StochasticError> {
        self.axes.iter().map(|axis| axis.recurrence.gauss(axis.recurrence.alpha.len())).collect()
    }

    /// The points and weights of integration of [`Self::mass`] for each direction (the weights sum to the probability of the
    /// cell in this direction), and the Lagrange polynomials at the points: points × nodes of the direction. θ_j is their
    /// product over the directions.
    ///
    /// # Errors
    /// [`StochasticError`] if a rule cannot be computed.
    pub fn mass_axes(&self) -> Result<Vec<(Rule, Mat<f64>)>, StochasticError> {
        let of = |(axis, mut rule): (&Axis, Rule)| {
            rule.weights.iter_mut().for_each(|w| *w *= axis.recurrence.probability);
            let values: Vec<Vec<f64>> = rule.points.iter().map(|&x| axis.lagrange(x)).collect();
            let values = Mat::from_fn(rule.len(), axis.rule.len(), |i, j| values[i][j]);
            (rule, values)
        };
        Ok(self.axes.iter().zip(self.mass_rules()?).map(of).collect())
    }

    /// (M_E)_jk = ∫ E θ_j θ_k ρ for a function E of the germs, symmetric; exact for polynomials E to degree 13 in each
    /// germ.
    ///
    /// Cost: the square of the number of nodes times Π_d (q_d + 7) points of integration.
    ///
    /// # Errors
    /// [`StochasticError::Number`] for more than 1e8 points of integration: use fewer directions. [`StochasticError`] if a
    /// germ has no quadrature rule of the degree needed.
    pub fn mass(&self, coefficient: &dyn Fn(&[f64]) -> f64) -> Result<Mat<f64>, StochasticError> {
        let rules = self.mass_rules()?;
        let count = rules.iter().map(|rule| rule.len() as f64).product::<f64>();
        if count > 100.0 * MOST as f64 {
            return Err(StochasticError::Number {
                what: "the number of points that integrate a mass matrix".into(),
                value: count,
                wanted: "at most 1e8: use fewer directions",
            });
        }
        let probability: f64 = self.axes.iter().map(|axis| axis.recurrence.probability).product();
        let n = self.points.len();
        let mut mass = Mat::zeros(n, n);
        let mut theta = vec![0.0; n];
        let mut index = vec![0; rules.len()];
        let mut germ = vec![0.0; rules.len()];
        loop {
            let mut weight = probability;
            for (d, rule) in rules.iter().enumerate() {
                germ[d] = rule.points[index[d]];
                weight *= rule.weights[index[d]];
            }
            self.evaluate(&germ, &mut theta);
            weight *= coefficient(&germ);
            for k in 0..n {
                let factor = weight * theta[k];
                for j in 0..=k {
                    mass[(j, k)] += factor * theta[j];
                }
            }
            let Some(d) = (0..rules.len()).rev().find(|&d| index[d] + 1 < rules[d].len()) else { break };
            index[d] += 1;
            index[d + 1..].fill(0);
        }
        for k in 0..n {
            for j in 0..k {
                mass[(k, j)] = mass[(j, k)];
            }
        }
        Ok(mass)
    }

    /// Degree in each direction.
    pub fn degrees(&self) -> Vec<usize> {
        self.axes.iter().map(|axis| axis.rule.len() - 1).collect()
    }

    /// Coefficients, in the order of the nodes, of Σ_j u_j θ_j in the products of the orthonormal polynomials of the cell:
    /// their squares sum to ∫ (Σ_j u_j θ_j)² ρ over the cell's probability.
    ///
    /// # Panics
    /// If `values` does not have a number u_j for each node.
    pub fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        assert_eq!(values.len(), self.points.len(), "a number for each node");
        let mut result = values.to_vec();
        let mut stride = values.len();
        for axis in &self.axes {
            let n = axis.rule.len();
            stride /= n;
            let square = |k: usize| if k + 1 == n { axis.top } else { 1.0 };
            let transform = |k: usize, j: usize| axis.rule.weights[j] * axis.polynomials[(k, j)] / square(k);
            let old = std::mem::take(&mut result);
            let entry = |i: usize| {
                let (k, start) = ((i / stride) % n, i - (i / stride) % n * stride);
                (0..n).map(|j| transform(k, j) * old[start + j * stride]).sum()
            };
            result = (0..old.len()).map(entry).collect();
        }
        result
    }

    /// The orthonormal polynomial of degree q_d + 1 of a direction at a germ: the value of an error of the next degree there
    /// over its root mean square in the cell.
    ///
    /// # Panics
    /// If the direction is not there.
    pub fn next_polynomial(&self, direction: usize, germ: f64) -> f64 {
        let Axis { rule, recurrence, .. } = &self.axes[direction];
        let mut values = vec![0.0; rule.len() + 1];
        recurrence.evaluate(germ, &mut values);
        values[rule.len()]
    }
}

impl Axis {
    fn new(variable: &Variable, bounds: [f64; 2], degree: usize, nodes: Nodes) -> Result<Self, StochasticError> {
        let n = degree + 1;
        let recurrence = Recurrence::new(variable, bounds, n + EXTRA)?;
        let gauss = nodes == Nodes::Gauss || degree == 0;
        let rule = if gauss { recurrence.gauss(n)? } else { recurrence.lobatto(n)? };
        Ok(Self::of(recurrence, rule))
    }

    fn of(recurrence: Recurrence, rule: Rule) -> Self {
        let (n, degree) = (rule.len(), rule.len() - 1);
        let gauss = rule.degree == 2 * n - 1;
        let unit = if degree == 0 { 1.0 } else { 0.25 * (rule.points[n - 1] - rule.points[0]) };
        let product = |j: usize| -> f64 {
            let factors = (0..n).filter(|&k| k != j).map(|k| (rule.points[j] - rule.points[k]) / unit);
            factors.product()
        };
        let barycentric = (0..n).map(|j| 1.0 / product(j)).collect();
        let mut polynomials = Mat::zeros(n, n);
        for (j, &x) in rule.points.iter().enumerate() {
            recurrence.evaluate(x, polynomials.col_as_slice_mut(j));
        }
        let squares = (0..n).map(|j| rule.weights[j] * polynomials[(degree, j)] * polynomials[(degree, j)]);
        let top = if gauss { 1.0 } else { squares.sum() };
        Self { recurrence, rule, unit, barycentric, polynomials, top }
    }

    /// Lagrange polynomials at a germ, by the first barycentric formula: the second one loses digits beyond the outermost
    /// nodes, where points of integration are.
    ///
    /// Source: Webb, Trefethen and Gonnet (2012).
    fn lagrange(&self, x: f64) -> Vec<f64> {
        let nodes = &self.rule.points;
        if let Some(at) = nodes.iter().position(|&node| node == x) {
            return (0..nodes.len()).map(|j| if j == at { 1.0 } else { 0.0 }).collect();
        }
        let all: f64 = nodes.iter().map(|node| (x - node) / self.unit).product();
        nodes.iter().zip(&self.barycentric).map(|(node, b)| all * b * (self.unit / (x - node))).collect()
    }
}

/// Checks by the products of its orthonormal polynomials that a rule is a Gauss or Lobatto rule of a recurrence; else says
/// what is wrong.
fn check_rule(recurrence: &Recurrence, rule: &Rule) -> Result<(), String> {
    let n = rule.len();
    if n == 0 || rule.weights.len() != n || recurrence.alpha.len() != n + EXTRA {
        let (weights, coefficients) = (rule.weights.len(), recurrence.alpha.len());
        return Err(format!("has {n} points and {weights} weights, its recurrence {coefficients} coefficients"));
    }
    if rule.degree != 2 * n - 1 && (n < 2 || rule.degree != 2 * n - 3) {
        return Err(format!("of {n} points has the degree {}, neither Gauss nor Lobatto", rule.degree));
    }
    if let Some(w) = rule.weights.iter().find(|w| !(**w > 0.0 && w.is_finite())) {
        return Err(format!("has the weight {w}"));
    }
    let [low, high] = recurrence.interval;
    if !rule.points.windows(2).all(|x| x[0] < x[1]) || !rule.points.iter().all(|x| (low..=high).contains(x)) {
        return Err(format!("has points that do not rise inside of [{low}, {high}]"));
    }
    if rule.degree != 2 * n - 1 && [rule.points[0], rule.points[n - 1]] != recurrence.interval {
        return Err(format!("is a Lobatto rule whose points do not end at {low} and {high}"));
    }
    let mut values = vec![vec![0.0; n + 1]; n];
    rule.points.iter().zip(&mut values).for_each(|(x, values)| recurrence.evaluate(*x, values));
    for (j, k) in (0..n).flat_map(|j| (j..=n).map(move |k| (j, k))).filter(|(j, k)| j + k <= rule.degree) {
        let terms = values.iter().zip(&rule.weights).map(|(p, w)| w * p[j] * p[k]);
        let (product, wanted) = (terms.sum::<f64>(), if j == k { 1.0 } else { 0.0 });
        if product.is_nan() || (product - wanted).abs() > ORTHONORMAL {
            return Err(format!("makes {product} of the polynomials of degrees {j} and {k}, not {wanted}"));
        }
    }
    Ok(())
}

/// Points and weights of a product of rules, the last one fastest.
pub(crate) fn tensor(rules: &[&Rule]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let (mut points, mut weights) = (vec![vec![]], vec![1.0]);
    for rule in rules {
        let extended = |point: &Vec<f64>, x: f64| point.iter().copied().chain([x]).collect::<Vec<f64>>();
        points = points.iter().flat_map(|p| rule.points.iter().map(|&x| extended(p, x)).collect::<Vec<_>>()).collect();
        weights = weights.iter().flat_map(|v| rule.weights.iter().map(move |w| v * w)).collect();
    }
    (points, weights)
}
