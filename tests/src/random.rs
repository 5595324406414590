//! Random scenes: bodies, loads, supports, gaps and bounds of friction of all kinds, each from a seed.

use std::f64::consts::{PI, TAU};

use steklov_bem_operators::{Loop, Polygon};

use crate::case::{Case, On};

/// Random numbers by splitmix64 (Steele, Lea and Flood 2014): a seed fixes every bit.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// 0 to n - 1.
    pub fn below(&mut self, n: usize) -> usize {
        (self.between(0.0, n as f64) as usize).min(n - 1)
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// 10 to a uniform power.
    pub fn power(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }
}

type Corners = Vec<[f64; 2]>;

fn is_valid(outer: &Corners, holes: &[Corners]) -> bool {
    let named = |corners: &Corners| Loop::straight(corners.clone(), vec!["side".into(); corners.len()]);
    Polygon::new(named(outer), holes.iter().map(named).collect()).is_ok()
}

/// Corners about a centre at rising angles that differ by at least a third of their mean.
fn around(random: &mut Random, centre: [f64; 2], n: usize, radius: impl Fn(&mut Random) -> f64) -> Corners {
    let shares: Vec<f64> = (0..n).map(|_| random.between(0.5, 1.5)).collect();
    let whole: f64 = shares.iter().sum();
    let mut angle = random.between(0.0, TAU);
    let mut corners = Vec::new();
    for share in shares {
        angle += TAU * share / whole;
        let r = radius(random);
        corners.push([centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]);
    }
    corners
}

/// Convex (on an ellipse), star-shaped or L, about the origin, of size 1.
fn outline(random: &mut Random) -> Corners {
    match random.below(3) {
        0 => {
            let (n, flat, turn) = (3 + random.below(4), random.between(0.4, 1.0), random.between(0.0, PI));
            let circle = around(random, [0.0; 2], n, |_| 1.0);
            circle.into_iter().map(|[x, y]| crate::rotated([x, flat * y], turn)).collect()
        }
        1 => {
            let n = 5 + random.below(3);
            around(random, [0.0; 2], n, |r| r.between(0.45, 1.0))
        }
        _ => {
            let (w, h) = (random.between(0.8, 1.6), random.between(0.8, 1.6));
            let (a, b) = (w * random.between(0.3, 0.7), h * random.between(0.3, 0.7));
            let turn = random.below(4) as f64 * PI / 2.0;
            let corners = [[0.0, 0.0], [w, 0.0], [w, b], [a, b], [a, h], [0.0, h]];
            corners.into_iter().map(|[x, y]| crate::rotated([x - w / 2.0, y - h / 2.0], turn)).collect()
        }
    }
}

/// At most so many holes, with some room around each.
fn holes(random: &mut Random, outer: &Corners, wanted: usize) -> Vec<Corners> {
    let mut holes: Vec<Corners> = Vec::new();
    for _ in 0..20 {
        if holes.len() == wanted {
            break;
        }
        let centre = [random.between(-0.6, 0.6), random.between(-0.6, 0.6)];
        let (n, size) = (3 + random.below(3), random.between(0.05, 0.2));
        let hole = around(random, centre, n, |_| size);
        let wide = hole.iter().map(|x| [0, 1].map(|i| centre[i] + 1.4 * (x[i] - centre[i]))).collect();
        let all: Vec<Corners> = holes.iter().cloned().chain([wide]).collect();
        if is_valid(outer, &all) {
            holes.push(hole);
        }
    }
    holes
}

/// Flat, parabola, wedge, waves or a step, in s, of the size of `depth`; mostly with an overlap.
fn gap(random: &mut Random, depth: f64) -> String {
    let (at, overlap) = (random.between(0.15, 0.85), depth * random.between(-0.2, 1.0));
    match random.below(6) {
        0 => "0".into(),
        1 => format!("{:?}", -overlap),
        2 => format!("{:?}*(s - {at:?})^2 - {overlap:?}", depth * random.between(4.0, 40.0)),
        3 => format!("{:?}*abs(s - {at:?}) - {overlap:?}", depth * random.between(2.0, 10.0)),
        4 => {
            let (waves, phase) = (random.between(1.0, 5.0), random.between(0.0, TAU));
            format!("{depth:?}*cos({:?}*s + {phase:?}) - {overlap:?}", TAU * waves)
        }
        _ => format!("if(s < {at:?}, {:?}, {:?}) - {overlap:?}", 0.0, depth * random.between(1.0, 10.0)),
    }
}

/// None, zero, small, large, growing, or with a jump.
fn bound(random: &mut Random, stress: f64) -> Option<String> {
    let at = random.between(0.2, 0.8);
    Some(match random.below(7) {
        0 | 1 => return None,
        2 => "0".into(),
        3 => format!("{:?}", 0.05 * stress),
        4 => format!("{:?}", 10.0 * stress),
        5 => format!("{:?}*s", stress),
        _ => format!("if(s < {at:?}, 0, {:?})", 0.3 * stress),
    })
}

/// Constant, polynomial, kinked, wavy or a pressure.
fn load(random: &mut Random, stress: f64) -> On {
    let (a, b) = (stress * random.between(-1.0, 1.0), stress * random.between(-1.0, 1.0));
    let at = random.between(0.2, 0.8);
    match random.below(5) {
        0 => On::traction(&format!("{a:?}"), &format!("{b:?}")),
        1 => On::traction(&format!("{a:?}*s*(1-s)"), &format!("{b:?}*(1 - 2*s)^3")),
        2 => On::traction(&format!("{a:?}*abs(s - {at:?})"), &format!("if(s < {at:?}, {b:?}, 0)")),
        3 => On::traction(&format!("{a:?}*sin(7*s)"), &format!("{b:?}*exp(-20*(s - {at:?})^2)")),
        _ => On::pressure(&format!("{:?}", a.abs())),
    }
}

/// Displacement of a held side: all of it, or one component.
fn support(random: &mut Random, depth: f64) -> On {
    let shift = |random: &mut Random| if random.chance(0.6) { 0.0 } else { depth * random.between(-0.3, 0.3) };
    let (x, y) = (format!("{:?}", shift(random)), format!("{:?}", shift(random)));
    let none = ["0".to_owned(), "0".to_owned()];
    match random.below(6) {
        0 => On::Partly([x, "free".into()], none),
        1 => On::Partly(["free".into(), y], none),
        2 => On::held(&format!("{x}*s"), &y),
        _ => On::held(&x, &y),
    }
}

/// A scene: one or two sides in contact, a held side or none, loads on some of the others.
pub fn random_case(random: &mut Random) -> Case {
    let outer = loop {
        let outer = outline(random);
        if is_valid(&outer, &[]) {
            break outer;
        }
    };
    let wanted = [0, 0, 0, 1, 1, 2][random.below(6)];
    let holes = holes(random, &outer, wanted);
    let n = outer.len();
    let names: Vec<String> = (0..n).map(|k| format!("side{k}")).collect();
    let poisson = match random.below(5) {
        0 => 0.4999999,
        1 => 0.499,
        2 => random.between(-0.5, 0.49),
        _ => 0.3,
    };
    let mut case = Case::new(&outer, &names.iter().map(String::as_str).collect::<Vec<_>>(), poisson);
    case.young = random.power(0.0, 5.0);
    case.plane_stress = random.chance(0.25);
    let (strain, young) = (random.power(-4.0, -2.0), case.young);
    let stress = strain * young;

    let mut roles: Vec<Option<On>> = vec![None; n];
    // the longest side is the floor, so that what stands on it seldom falls
    let length = |k: usize| {
        let (a, b) = (outer[k], outer[(k + 1) % n]);
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    let floor = (0..n).max_by(|&a, &b| length(a).total_cmp(&length(b))).expect("a polygon has sides");
    roles[floor] = Some(On::Contact(gap(random, strain), bound(random, stress)));
    if random.chance(0.35) {
        let other = (floor + 1 + random.below(n - 1)) % n;
        roles[other] = Some(On::Contact(gap(random, strain), bound(random, stress)));
    }
    // what is held at the end of a contact side may stand in the obstacle: mostly not so
    let apart = |k: usize| roles[(k + 1) % n].is_none() && roles[(k + n - 1) % n].is_none();
    let anywhere = random.chance(0.15);
    let open: Vec<usize> = (0..n).filter(|&k| roles[k].is_none() && (anywhere || apart(k))).collect();
    let held = !open.is_empty() && random.chance(0.8);
    if held {
        roles[open[random.below(open.len())]] = Some(support(random, strain));
    }
    for role in &mut roles {
        if role.is_none() && random.chance(0.5) {
            *role = Some(load(random, if held { stress } else { 0.05 * stress }));
        }
    }
    if !held || random.chance(0.2) {
        // a weight that leans a little
        let (a, b) = (outer[floor], outer[(floor + 1) % n]);
        let (t, l) = ([b[0] - a[0], b[1] - a[1]], length(floor));
        let (down, aside) = (stress / l, if held { 0.3 } else { 0.02 } * random.between(-1.0, 1.0) * stress / l);
        case.body_force = Some([down * t[1] + aside * t[0], aside * t[1] - down * t[0]]);
    }
    for (hole, corners) in holes.into_iter().enumerate() {
        let name = format!("hole{hole}");
        case.holes.push(corners.into_iter().map(|x| (x, name.clone())).collect());
        if random.chance(0.3) {
            case = case.on(&name, On::pressure(&format!("{:?}", stress * random.between(0.0, 1.0))));
        }
    }
    for (name, role) in names.iter().zip(roles) {
        if let Some(role) = role {
            case = case.on(name, role);
        }
    }
    let tolerance = random.power(-5.0, -3.0);
    case.method(&format!("tolerance = {tolerance:e}\nmax_dofs = 800"))
}
