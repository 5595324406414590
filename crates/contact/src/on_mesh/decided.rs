//! Which transitions mark a change of the solution, and which separate zones whose pressure and opening are negligible.
//!
//! Where gap and pressure are both 0, rounding decides the states of nodes. A zone of one state extends from transition to
//! transition, also over the ends of edges. To give it the other state costs no more than
//!
//! ```text
//! closed   ∫ λ_n ds / √E*        open   max (g - u_n) √E*
//! ```
//! in the energy norm, up to factors of the order of 1.

use crate::on_mesh::transitions::{TipKind, Transition, transitions};
use crate::{Condition, ContactLine, Problem, Sets, Solution};

/// The force and the gap of a zone on an edge below which it is undecided; more than 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Least {
    /// ∫ λ_n ds (force per thickness).
    pub force: f64,
    /// g - u_n (length).
    pub gap: f64,
}

/// The transitions and lengths that the states of the nodes decide.
#[derive(Debug, Clone, PartialEq)]
pub struct Decided {
    /// The transitions of each line, rising, without those of undecided zones.
    pub transitions: Vec<Vec<Transition>>,
    /// Length of the zones that are closed.
    pub closed: f64,
    /// Length of the undecided zones that have other states than their neighbours, or are closed.
    pub undecided: f64,
    /// Length of all zones.
    pub length: f64,
}

/// Neighbouring nodes of one state on a line.
struct Zone {
    closed: bool,
    /// Force or gap over the least one.
    share: f64,
    length: f64,
    undecided: bool,
    /// The zone that it was merged into, or itself.
    part_of: usize,
}

/// The zones of all lines.
struct Zones {
    all: Vec<Zone>,
    /// The zone of each point of each line.
    of_point: Vec<Vec<usize>>,
    /// Pairs of zones with a transition between them.
    neighbours: Vec<[usize; 2]>,
}

/// The transitions along lines without those of undecided zones; the smallest zones are left out first. `least(edge)`: the
/// limits that decide.
pub fn decided(
    lines: &[ContactLine],
    problem: &Problem,
    solution: &Solution,
    sets: &Sets,
    least: &dyn Fn(usize) -> Least,
) -> Decided {
    let mut zones = Zones::new(lines, problem, solution, sets, least);
    zones.join_at_corners(lines);
    while zones.merge_smallest() {}
    for k in 0..zones.all.len() {
        let root = &zones.all[zones.root(k)];
        if root.closed && root.share < 1.0 {
            zones.all[k].undecided = true;
        }
    }
    let stays = |l: usize, t: &Transition| {
        let [a, b] = [t.point, t.point + 1].map(|i| zones.of_point[l][i]);
        match t.kind {
            TipKind::ContactEnd => zones.root(a) != zones.root(b),
            // slip under no pressure of Coulomb's law
            _ => !zones.all[a].undecided || condition(problem, &lines[l], t.point).bound > 0.0,
        }
    };
    let of_line = |(l, line)| transitions(line, sets).into_iter().filter(|t| stays(l, t)).collect();
    let length = |of: &dyn Fn(&Zone) -> bool| zones.all.iter().filter(|z| of(z)).map(|z| z.length).sum();
    Decided {
        transitions: lines.iter().enumerate().map(of_line).collect(),
        closed: length(&|zone| zone.closed && !zone.undecided),
        undecided: length(&|zone| zone.undecided),
        length: length(&|_| true),
    }
}

fn condition<'a>(problem: &'a Problem, line: &ContactLine, i: usize) -> &'a Condition {
    &problem.nodes[line.points[i].node].conditions[line.points[i].condition]
}

impl Zones {
    fn new(
        lines: &[ContactLine],
        problem: &Problem,
        solution: &Solution,
        sets: &Sets,
        least: &dyn Fn(usize) -> Least,
    ) -> Self {
        let mut zones = Self { all: Vec::new(), of_point: Vec::new(), neighbours: Vec::new() };
        for line in lines {
            let least = least(line.edge);
            let mut of_point: Vec<usize> = Vec::with_capacity(line.points.len());
            for (i, point) in line.points.iter().enumerate() {
                let closed = sets.closed(point.index);
                let before = of_point.last().copied();
                if before.is_none_or(|zone| zones.all[zone].closed != closed) {
                    let new = zones.all.len();
                    zones.neighbours.extend(before.map(|before| [before, new]));
                    zones.all.push(Zone { closed, share: 0.0, length: 0.0, undecided: false, part_of: new });
                }
                let condition = condition(problem, line, i);
                let zone = zones.all.last_mut().expect("one at least");
                zone.length += condition.normal_weight;
                zone.share = if closed {
                    zone.share + solution.multipliers[point.index][0] * condition.normal_weight / least.force
                } else {
                    let displacement = problem.nodes[point.node].pick(&solution.displacement);
                    zone.share.max(condition.opening(displacement) / least.gap)
                };
                of_point.push(zones.all.len() - 1);
            }
            zones.of_point.push(of_point);
        }
        zones
    }

    /// Zones go on where the ends of two edges meet in a node and have the same state.
    fn join_at_corners(&mut self, lines: &[ContactLine]) {
        let mut ends = Vec::new();
        for (line, of_point) in lines.iter().zip(&self.of_point) {
            let both = [line.points.first().zip(of_point.first()), line.points.last().zip(of_point.last())];
            ends.extend(both.into_iter().flatten().map(|(point, &zone)| (point.node, zone)));
        }
        ends.sort_unstable();
        for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let [a, b] = [pair[0].1, pair[1].1].map(|zone| self.root(zone));
            if self.all[a].closed == self.all[b].closed {
                self.unite(a, b);
            }
        }
    }

    fn root(&self, mut zone: usize) -> usize {
        while self.all[zone].part_of != zone {
            zone = self.all[zone].part_of;
        }
        zone
    }

    /// Makes b, the root of its zones, a part of a, which has the same state.
    fn unite(&mut self, a: usize, b: usize) {
        if a != b {
            let share = self.all[b].share;
            let zone = &mut self.all[a];
            zone.share = if zone.closed { zone.share + share } else { zone.share.max(share) };
            self.all[b].part_of = a;
        }
    }

    /// Gives the smallest undecided zone beside another undecided one the state of its neighbours; zones without a decided
    /// neighbour come first. Returns whether there was one.
    fn merge_smallest(&mut self) -> bool {
        let pairs = self.neighbours.iter().map(|pair| pair.map(|zone| self.root(zone)));
        let pairs: Vec<[usize; 2]> = pairs.filter(|[a, b]| a != b).collect();
        let undecided = |zone: usize| self.all[zone].share < 1.0;
        let mut among_decided = vec![false; self.all.len()];
        for [a, b] in pairs.iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
            among_decided[a] |= !undecided(b);
        }
        let candidates = pairs.iter().filter(|pair| pair.iter().all(|&zone| undecided(zone))).flatten().copied();
        let rank = |zone: usize| (among_decided[zone], self.all[zone].share);
        let order = |a: &usize, b: &usize| {
            let ((among, share), (of_other, other)) = (rank(*a), rank(*b));
            among.cmp(&of_other).then(share.total_cmp(&other))
        };
        let Some(least) = candidates.min_by(order) else { return false };
        for k in (0..self.all.len()).filter(|&k| self.root(k) == least).collect::<Vec<_>>() {
            self.all[k].undecided = true;
        }
        let mut beside: Vec<usize> =
            pairs.iter().filter(|pair| pair.contains(&least)).map(|[a, b]| a + b - least).collect();
        beside.sort_unstable();
        beside.dedup();
        let root = beside[0];
        beside[1..].iter().for_each(|&zone| self.unite(root, zone));
        self.all[least].part_of = root;
        true
    }
}
