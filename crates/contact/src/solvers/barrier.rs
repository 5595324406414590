//! The interior point method's view of a problem: lines with complementary pairs, their Newton system and a step.
//!
//! With v = fixed + E y on the lines of infinite friction, every other kink of weight D is a line
//!
//! ```text
//! d·y - at = Σ σ s,   λ = bound - σ z,   s ≥ 0, z ≥ 0, s z = 0,   Eᵀ S E y + Σ D λ d = Eᵀ (f - S fixed)
//! ```
//! with one pair (s, z) for each finite bound of λ: s is how far y lies above (σ = 1) or below (σ = -1) the line, z how far
//! λ is from the bound of that side.

use steklov_algebra::Symmetric;
use steklov_elastic::plane::{dot, norm};

use crate::Problem;
use crate::solvers::free::Free;
use crate::solvers::law::{Branch, Kink, Law, Piece};
use crate::solvers::linear::largest;
use crate::solvers::newton_matrix::NewtonMatrix;

/// Added to the diagonal of the Newton matrix, relative to its largest entry in S: without it a motion that neither
/// stiffness nor barrier holds would have no step. More of it where that does not make the matrix definite.
const PROXIMAL: [f64; 3] = [1e-10, 1e-8, 1e-6];
/// Fraction of the way to the nearest bound that a step takes.
const TO_BOUNDARY: f64 = 0.995;
/// Products s z tend to zero in proportion to D to this power: 0 is a barrier that is an integral over the contact
/// boundary, -1 a sum over the nodes. The first lets short elements become clear too early, the second too late.
const SHARE: f64 = -0.25;
/// Centrality corrections of a step, each for a step longer by `REACH`; products within `SPREAD` of their target will do.
const CORRECTIONS: usize = 3;
const REACH: f64 = 0.1;
const SPREAD: f64 = 10.0;
/// A direction whose free part is smaller than this counts as none.
const FREE: f64 = 1e-12;

/// A kink in the free unknowns of its node, `first .. first + unknowns`.
struct Line {
    node: usize,
    kink: usize,
    first: usize,
    unknowns: usize,
    direction: [f64; 2],
    at: f64,
    /// D (length): forces are weight times stress.
    weight: f64,
    /// Its node's stiffness along it (stress over length).
    stiffness: f64,
}

impl Line {
    fn along(&self, y: &[f64]) -> f64 {
        (0..self.unknowns).map(|i| self.direction[i] * y[self.first + i]).sum()
    }

    fn add(&self, force: f64, to: &mut [f64]) {
        (0..self.unknowns).for_each(|i| to[self.first + i] += force * self.direction[i]);
    }
}

/// The pair of one finite bound of a line.
#[derive(Debug, Clone, Copy)]
struct Pair {
    line: usize,
    /// 1 for the side above the line, -1 below.
    sign: f64,
    /// λ on that side (stress).
    bound: f64,
    /// s (length).
    slack: f64,
    /// z (stress).
    force: f64,
}

/// A point strictly inside all bounds.
pub(crate) struct Point {
    y: Vec<f64>,
    /// One pair for each line, in their order.
    pairs: Vec<Pair>,
}

/// The residuals of a point in the equations.
pub(crate) struct Residual {
    /// Eᵀ (f - S v) - Σ D λ d.
    force: Vec<f64>,
    /// d·y - at - Σ σ s of each line.
    length: Vec<f64>,
    /// Mean product s z, relative.
    pub gap: f64,
    /// The largest entry of both vectors, relative.
    pub feasibility: f64,
}

/// A Newton direction.
struct Direction {
    y: Vec<f64>,
    slack: Vec<f64>,
    force: Vec<f64>,
}

/// A problem as lines and pairs.
pub(crate) struct Barrier {
    free: Free,
    stiffness: Symmetric,
    load: Vec<f64>,
    lines: Vec<Line>,
    /// Largest diagonal entry of the stiffness.
    largest: f64,
    /// Size of the slacks and of the forces z.
    scale: (f64, f64),
    newton: NewtonMatrix,
}

impl Barrier {
    /// The problem's barrier and a first point: the body on springs towards its lines, moved away from all bounds by the size
    /// of the result. No point if nothing moves the body.
    pub fn new(problem: &Problem, laws: &[Law]) -> (Self, Option<Point>) {
        let hard: Vec<Piece> = laws.iter().map(hard_lines).collect();
        let free = Free::new(problem, laws, &hard);
        let elastic = problem.stiffness.times(&free.fixed);
        let rest: Vec<f64> = problem.load.iter().zip(&elastic).map(|(f, s)| f - s).collect();
        let (stiffness, load) = (free.stiffness(&problem.stiffness), free.project(&rest));
        let largest = largest((0..problem.load.len()).map(|i| problem.stiffness[(i, i)]));
        let lines = lines(problem, laws, &free, &stiffness, largest);
        let newton = NewtonMatrix::new(&stiffness);
        let mut barrier = Self { free, newton, stiffness, load, lines, largest, scale: (0.0, 0.0) };
        let start = barrier.start(laws);
        (barrier, start)
    }

    fn start(&mut self, laws: &[Law]) -> Option<Point> {
        let weights: f64 = self.lines.iter().map(|l| l.weight * dot(l.direction, l.direction)).sum();
        let spring = self.largest / weights;
        let kink = |line: &Line| laws[line.node].kinks[line.kink];
        // an open gap does not pull
        let target = |line: &Line| if kink(line).high.is_infinite() { line.at.min(0.0) } else { line.at };
        let mut y = self.load.clone();
        self.lines.iter().for_each(|l| l.add(spring * l.weight * target(l), &mut y));
        if self.lines.is_empty() || !self.factorise(&vec![1.0 / spring; self.lines.len()]) {
            return None;
        }
        self.newton.solve(&mut y);
        let length = largest(self.lines.iter().map(|l| l.along(&y) - target(l)));
        if length == 0.0 || !length.is_finite() {
            return None;
        }
        let stress = spring * length;
        self.scale = (length, stress);
        let mut pairs = Vec::new();
        for (number, line) in self.lines.iter().enumerate() {
            let (kink, at, wanted) = (kink(line), line.along(&y) - line.at, spring * (line.along(&y) - target(line)));
            if kink.high.is_infinite() {
                let slack = length.max(-at);
                pairs.push(Pair {
                    line: number,
                    sign: -1.0,
                    bound: 0.0,
                    slack,
                    force: wanted.max(stress * length / slack),
                });
            } else {
                let bound = kink.high / line.weight;
                let lambda = wanted.clamp(-0.5 * bound, 0.5 * bound);
                let away = length * (stress / bound).min(1.0);
                for (sign, bound) in [(1.0, bound), (-1.0, -bound)] {
                    let slack = away + (sign * at).clamp(0.0, away);
                    pairs.push(Pair { line: number, sign, bound, slack, force: sign * (bound - lambda) });
                }
            }
        }
        Some(Point { y, pairs })
    }

    /// The residuals of `point` in the equations.
    pub fn residual(&self, point: &Point) -> Residual {
        let elastic = self.stiffness.times(&point.y);
        let mut force: Vec<f64> = self.load.iter().zip(&elastic).map(|(f, s)| f - s).collect();
        let mut length: Vec<f64> = self.lines.iter().map(|l| l.along(&point.y) - l.at).collect();
        point.pairs.iter().for_each(|p| length[p.line] -= p.sign * p.slack);
        for (line, lambda) in self.lines.iter().zip(self.stresses(point)) {
            line.add(-line.weight * lambda, &mut force);
        }
        let scale = largest(self.load.iter().copied()) + largest(elastic);
        let (f, l) = (largest(force.iter().copied()), largest(length.iter().copied()));
        let feasibility = (f / scale.max(f64::MIN_POSITIVE)).max(l / self.scale.0);
        let gap = self.mean(&products(point), point) / (self.scale.0 * self.scale.1);
        Residual { force, length, gap, feasibility }
    }

    /// λ of each line, from the pair that is nearer to its bound.
    fn stresses(&self, point: &Point) -> Vec<f64> {
        let mut nearest = vec![(f64::INFINITY, 0.0); self.lines.len()];
        for p in &point.pairs {
            if p.force < nearest[p.line].0 {
                nearest[p.line] = (p.force, p.bound - p.sign * p.force);
            }
        }
        nearest.into_iter().map(|n| n.1).collect()
    }

    /// Mean over the pairs, weighted by D.
    fn mean(&self, values: &[f64], point: &Point) -> f64 {
        let weighted = values.iter().zip(&point.pairs).map(|(x, p)| (self.lines[p.line].weight, x));
        let (sum, weights) = weighted.fold((0.0, 0.0), |(sum, all), (w, x)| (sum + w * x, all + w));
        sum / weights
    }

    /// One predictor-corrector step with centrality corrections; None if the Newton matrix has no factor.
    pub fn step(&mut self, point: &Point, residual: &Residual) -> Option<Point> {
        let mut theta = vec![0.0; self.lines.len()];
        point.pairs.iter().for_each(|p| theta[p.line] += p.slack / p.force);
        if !self.factorise(&theta) {
            return None;
        }
        let product = products(point);
        let wanted: Vec<f64> = product.iter().map(|x| -x).collect();
        let affine = self.direction(point, residual, &theta, &wanted);
        let after = products_after(point, &affine, step_length(point, &affine, 1.0));
        let (mu, after) = (self.mean(&product, point), self.mean(&after, point));
        let share: Vec<f64> = point.pairs.iter().map(|p| self.lines[p.line].weight.powf(SHARE)).collect();
        let centre = mu * (after / mu).clamp(1e-3, 1.0).powi(3) / self.mean(&share, point);
        let target: Vec<f64> = share.iter().map(|share| centre * share).collect();
        let second = affine.slack.iter().zip(&affine.force).map(|(s, z)| s * z);
        let mut wanted: Vec<f64> =
            target.iter().zip(&product).zip(second).map(|((t, x), second)| t - x - second).collect();
        let mut direction = self.direction(point, residual, &theta, &wanted);
        let mut alpha = step_length(point, &direction, TO_BOUNDARY);
        for _ in 0..CORRECTIONS {
            let ahead = products_after(point, &direction, (alpha + REACH).min(1.0));
            let corrections =
                ahead.iter().zip(&target).map(|(x, t)| (x.max(t / SPREAD).min(t * SPREAD) - x).max(-t * SPREAD));
            let corrected: Vec<f64> = wanted.iter().zip(corrections).map(|(w, c)| w + c).collect();
            let better = self.direction(point, residual, &theta, &corrected);
            let longer = step_length(point, &better, TO_BOUNDARY);
            if longer < alpha + 0.1 * REACH {
                break;
            }
            (wanted, direction, alpha) = (corrected, better, longer);
        }
        let y = point.y.iter().zip(&direction.y).map(|(y, d)| y + alpha * d).collect();
        let moves = direction.slack.iter().zip(&direction.force);
        let moved = point.pairs.iter().zip(moves);
        let pairs: Vec<Pair> =
            moved.map(|(p, (s, z))| Pair { slack: p.slack + alpha * s, force: p.force + alpha * z, ..*p }).collect();
        let inside = |x: f64| x > 0.0 && x.is_finite();
        pairs.iter().all(|p| inside(p.slack) && inside(p.force)).then_some(Point { y, pairs })
    }

    /// Direction that removes the residual and brings each product s z by `wanted` nearer to its target.
    fn direction(&self, point: &Point, residual: &Residual, theta: &[f64], wanted: &[f64]) -> Direction {
        let mut ahead = residual.length.clone();
        let e: Vec<f64> = point.pairs.iter().zip(wanted).map(|(p, w)| w / p.force).collect();
        point.pairs.iter().zip(&e).for_each(|(p, e)| ahead[p.line] -= p.sign * e);
        let mut y = residual.force.clone();
        for (k, line) in self.lines.iter().enumerate() {
            line.add(-line.weight * ahead[k] / theta[k], &mut y);
        }
        self.newton.solve(&mut y);
        let lines = self.lines.iter().zip(ahead).zip(theta);
        let stress: Vec<f64> = lines.map(|((l, ahead), theta)| (l.along(&y) + ahead) / theta).collect();
        let pairs = point.pairs.iter();
        let slack = pairs.clone().zip(&e).map(|(p, e)| e + p.sign * p.slack / p.force * stress[p.line]).collect();
        let force = pairs.map(|p| -p.sign * stress[p.line]).collect();
        Direction { y, slack, force }
    }

    /// Cholesky factor of S + Σ (D/θ) d dᵀ, with a little more on the diagonal; whether there is one.
    fn factorise(&mut self, theta: &[f64]) -> bool {
        PROXIMAL.iter().any(|proximal| {
            self.newton.reset(&self.stiffness);
            for i in 0..self.load.len() {
                self.newton.add(i, i, proximal * self.largest);
            }
            for (line, theta) in self.lines.iter().zip(theta) {
                for i in 0..line.unknowns {
                    for j in 0..=i {
                        let value = line.weight / theta * line.direction[i] * line.direction[j];
                        self.newton.add(line.first + i, line.first + j, value);
                    }
                }
            }
            self.newton.factorise()
        })
    }

    /// v.
    pub fn displacement(&self, point: &Point) -> Vec<f64> {
        self.free.expand(&point.y).iter().zip(&self.free.fixed).map(|(a, b)| a + b).collect()
    }

    /// Branch of each kink of each node: on its line where z is larger than s times the stiffness there. `v` is the
    /// displacement of the point. More lines may be on than a piece allows.
    pub fn branches(&self, problem: &Problem, laws: &[Law], point: &Point, v: &[f64]) -> Vec<Piece> {
        let nodes = problem.nodes.iter().zip(laws);
        let mut branches: Vec<Piece> = nodes
            .map(|(node, law)| {
                let beside = |kink: &Kink| match dot(kink.direction, node.pick(v)) - kink.at {
                    _ if is_hard(kink) => Branch::On,
                    distance if distance > 0.0 && kink.high.is_finite() => Branch::Above,
                    _ => Branch::Below,
                };
                law.kinks.iter().map(beside).collect()
            })
            .collect();
        for line in &self.lines {
            branches[line.node][line.kink] = Branch::On;
        }
        let mut farthest = vec![0.0; self.lines.len()];
        for pair in &point.pairs {
            let line = &self.lines[pair.line];
            if pair.slack * line.stiffness > pair.force && pair.slack > farthest[pair.line] {
                farthest[pair.line] = pair.slack;
                branches[line.node][line.kink] = if pair.sign > 0.0 { Branch::Above } else { Branch::Below };
            }
        }
        branches
    }
}

/// All lines: the kinks except those of infinite friction and those to which these leave no direction.
fn lines(problem: &Problem, laws: &[Law], free: &Free, stiffness: &Symmetric, largest: f64) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut first = 0;
    for (n, (node, law)) in problem.nodes.iter().zip(laws).enumerate() {
        let own = free.directions[first..].iter().take_while(|d| d.0 == node.first);
        let own: Vec<[f64; 2]> = own.map(|d| d.2).collect();
        for (k, kink) in law.kinks.iter().enumerate().filter(|(_, kink)| !is_hard(kink)) {
            let mut direction = [0.0; 2];
            own.iter().zip(&mut direction).for_each(|(e, d)| *d = dot(kink.direction, *e));
            if norm(direction) <= FREE * norm(kink.direction) {
                continue;
            }
            let (condition, tangential) = law.source[k];
            let c = &node.conditions[condition];
            let weight = if tangential { c.tangent_weight } else { c.normal_weight };
            let row = |i: usize| (0..own.len()).map(|j| stiffness[(first + i, first + j)] * direction[j]).sum::<f64>();
            let energy: f64 = (0..own.len()).map(|i| direction[i] * row(i)).sum();
            let square = dot(direction, direction);
            lines.push(Line {
                node: n,
                kink: k,
                first,
                unknowns: own.len(),
                direction,
                at: kink.at - dot(kink.direction, node.pick(&free.fixed)),
                weight,
                // as for the laws, positive where the node has none
                stiffness: energy.max(1e-6 * largest * square) / (square * square * weight),
            });
        }
        first += own.len();
    }
    lines
}

fn is_hard(kink: &Kink) -> bool {
    kink.low.is_infinite() && kink.high.is_infinite()
}

/// Independent lines of infinite friction on, all else off.
fn hard_lines(law: &Law) -> Piece {
    let mut piece = vec![Branch::Below; law.kinks.len()];
    let hard = (0..law.kinks.len()).filter(|&i| is_hard(&law.kinks[i]));
    law.basis(hard).into_iter().for_each(|i| piece[i] = Branch::On);
    piece
}

/// The products s z of all pairs.
fn products(point: &Point) -> Vec<f64> {
    point.pairs.iter().map(|p| p.slack * p.force).collect()
}

/// The products s z after a step of length alpha.
fn products_after(point: &Point, d: &Direction, alpha: f64) -> Vec<f64> {
    let moved = point.pairs.iter().zip(d.slack.iter().zip(&d.force));
    moved.map(|(p, (s, z))| (p.slack + alpha * s) * (p.force + alpha * z)).collect()
}

/// The largest step of at most 1 that stays inside all bounds, times `part` where they limit it.
fn step_length(point: &Point, direction: &Direction, part: f64) -> f64 {
    let moves = point.pairs.iter().zip(direction.slack.iter().zip(&direction.force));
    let limits = moves.flat_map(|(p, (ds, dz))| [(p.slack, *ds), (p.force, *dz)]);
    limits.filter(|(_, d)| *d < 0.0).fold(1.0, |a: f64, (x, d)| a.min(-part * x / d))
}
