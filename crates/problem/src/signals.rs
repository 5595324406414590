//! Data of a scene as functions of its germs, enclosed over boxes of them.

use steklov_bem_operators::Edge;
use steklov_expression::{Enclosure, Expression, Interval, Leaves, Switch, Value};

use super::cells::bounding_box;
use super::{Random, RandomName, Scene};

/// Most boxes of one germ that are examined for the zeros of a switch.
const BOXES: usize = 10_000;
/// Boxes about a curved edge.
const CHORDS: usize = 64;
/// Lines on which the modulus of cells is examined.
const ROWS: usize = 32;
/// Most cuts of a germ: more of them are left to refinement.
const CUTS: usize = 16;
/// Probability on either side of a cut that is worth one.
const RARE: f64 = 1e-12;

/// A function that describes the data of an outcome: the values of an expression, or of one of its switches.
#[derive(Debug, Clone)]
pub struct Signal {
    expression: Expression,
    switch: Option<Switch>,
    /// Germs that it depends on.
    pub germs: Vec<usize>,
    /// Start and end of the edges along which it acts; one of length 0 if it is the same at all places.
    pub paths: Vec<[[f64; 2]; 2]>,
}

impl Signal {
    /// Whether it is a switch: the data have a kink or a jump where it is 0.
    pub fn is_switch(&self) -> bool {
        self.switch.is_some()
    }

    /// Holds all values for germs in a box along a part of a path, from 0 to 1.
    pub fn range(&self, random: &Random, germs: &[[f64; 2]], path: usize, part: [f64; 2]) -> Interval {
        let [start, end] = self.paths[path];
        let coordinate = |i: usize| {
            let [a, b] = part.map(|t| start[i] + t * (end[i] - start[i]));
            Enclosure::fixed(Interval::new(a.min(b), a.max(b)))
        };
        let (x, y) = (coordinate(0), coordinate(1));
        let name = |name: &RandomName| match name {
            RandomName::Variable { germ, .. } => {
                let [a, b] = germs[*germ].map(|xi| random.germs[*germ].variable.value(xi));
                Enclosure::fixed(Interval::new(a, b))
            }
            RandomName::Field { field, first } => field.range(&germs[*first..*first + field.expansion.len()], x, y),
        };
        let names: Vec<Enclosure> = random.names.iter().map(name).collect();
        let s = Enclosure::fixed(Interval::new(part[0], part[1]));
        let leaves = Leaves { x, y, s, names: &names };
        match &self.switch {
            Some(switch) => self.expression.switch_range(switch, &leaves).value,
            None => self.expression.range(&leaves).value,
        }
    }
}

impl Scene {
    /// The signals of all data that depend on germs.
    pub fn signals(&self, random: &Random) -> Vec<Signal> {
        let names = random.names.iter().enumerate();
        let names = names.map(|(k, name)| (name.name().to_owned(), Value::Free(k))).collect();
        let free = |expression: &Expression| {
            let free = expression.with_values(&names);
            (!free.free_names(None).is_empty()).then_some(free)
        };
        let nowhere = vec![[[0.0; 2]; 2]];
        let mut all: Vec<(Expression, Vec<[[f64; 2]; 2]>)> = Vec::new();
        all.extend(random.constants.young.values().filter_map(free).map(|e| (e, nowhere.clone())));
        all.extend(self.body().cell_expressions().filter_map(free).map(|e| (e, self.rows_of_cells())));
        let forces = self.problem.bodies.iter().flat_map(|body| &body.force).flatten();
        all.extend(forces.filter_map(free).map(|e| (e, nowhere.clone())));
        let chords = |e: &Edge| -> Vec<[[f64; 2]; 2]> {
            let count = if e.is_line() { 1 } else { CHORDS };
            let point = |k: usize| e.point(k as f64 / count as f64);
            (0..count).map(|k| [point(k), point(k + 1)]).collect()
        };
        let paths_of = |index: usize| -> Vec<[[f64; 2]; 2]> {
            self.problem.outline.edges().iter().filter(|e| e.side == index).flat_map(chords).collect()
        };
        for index in 0..self.problem.sides.len() {
            let read = self.problem.side_data(index).into_iter().filter_map(|(_, e)| free(e));
            all.extend(read.map(|e| (e, paths_of(index))));
        }
        all.extend(self.problem.jumps_of_ties().filter_map(|(side, _, e)| Some((free(e)?, paths_of(side)))));
        let germs_of = |name: &RandomName| match name {
            RandomName::Variable { germ, .. } => *germ..*germ + 1,
            RandomName::Field { field, first } => *first..*first + field.expansion.len(),
        };
        let mut signals = Vec::new();
        for (expression, paths) in all {
            let switches = expression.switches().to_vec();
            for switch in switches.into_iter().map(Some).chain([None]) {
                let germs: Vec<usize> = expression
                    .free_names(switch.as_ref())
                    .into_iter()
                    .flat_map(|name| germs_of(&random.names[name]))
                    .collect();
                let fields = random.fields().any(|(_, first)| germs.contains(&first));
                let paths =
                    if fields || expression.uses_place(switch.as_ref()) { paths.clone() } else { nowhere.clone() };
                if !germs.is_empty() {
                    signals.push(Signal { expression: expression.clone(), switch, germs, paths });
                }
            }
        }
        signals
    }

    /// The middle lines of rows of modulus cells from left to right, 32 of them at most.
    fn rows_of_cells(&self) -> Vec<[[f64; 2]; 2]> {
        let (low, size) = bounding_box(&self.problem.outline);
        let rows = self.body().cells().map_or(1, |cells| ((size[1] / cells.size) as usize).clamp(1, ROWS));
        let y = |k: usize| low[1] + size[1] * (k as f64 + 0.5) / rows as f64;
        (0..rows).map(|k| [[low[0], y(k)], [low[0] + size[0], y(k)]]).collect()
    }

    /// Where data have kinks or jumps in one germ, whatever the others and the place: rising, for each germ.
    pub fn cuts(&self, random: &Random) -> Vec<Vec<f64>> {
        let mut cuts = vec![Vec::new(); random.germs.len()];
        for signal in self.signals(random).iter().filter(|s| s.is_switch()) {
            if let ([germ], true) = (&signal.germs[..], signal.paths.iter().all(|[a, b]| a == b)) {
                cuts[*germ].extend(zeros(random, signal, *germ));
            }
        }
        for (germ, cuts) in cuts.iter_mut().enumerate() {
            let variable = &random.germs[germ].variable;
            let [low, high] = variable.germ_support();
            cuts.retain(|&c| variable.probability([low, c]) > RARE && variable.probability([c, high]) > RARE);
            cuts.sort_by(f64::total_cmp);
            cuts.dedup_by(|b, a| variable.probability([*a, *b]) < RARE);
            if cuts.len() > CUTS {
                cuts.clear();
            }
        }
        cuts
    }
}

/// Germs at which a switch of one germ is 0; none if they are too many to be distinguished.
fn zeros(random: &Random, signal: &Signal, germ: usize) -> Vec<f64> {
    let variable = &random.germs[germ].variable;
    let mut all: Vec<[f64; 2]> = random.nominal().iter().map(|&xi| [xi, xi]).collect();
    let mut boxes = vec![[variable.quantile(RARE), variable.quantile(1.0 - RARE)]];
    let (mut zeros, mut looked) = (Vec::<[f64; 2]>::new(), 0);
    while let Some([a, b]) = boxes.pop() {
        looked += 1;
        if looked > BOXES {
            return Vec::new();
        }
        all[germ] = [a, b];
        if !signal.range(random, &all, 0, [0.0, 0.0]).contains(0.0) {
            continue;
        }
        let middle = a + 0.5 * (b - a);
        if b - a > 1e-14 * a.abs().max(b.abs()) && a < middle && middle < b {
            boxes.extend([[middle, b], [a, middle]]);
        } else {
            match zeros.last_mut() {
                Some(last) if last[1] == a => last[1] = b,
                _ => zeros.push([a, b]),
            }
        }
    }
    zeros.into_iter().map(|[a, b]| a + 0.5 * (b - a)).collect()
}
