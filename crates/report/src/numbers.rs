//! The numbers of a result, each with its unit and beside what is known of its error.

use std::collections::BTreeMap;

use steklov_model::stochastic::StochasticResult;
use steklov_model::summary::{ContactSummary, InterfaceSummary, Named, Summary};
use steklov_picture::short;
use steklov_problem::Units;
use steklov_result::record::Record;

use crate::format::Piece::{self, Component, Number, Words};

/// Digits of a number whose error is not known.
pub(crate) const DIGITS: usize = 7;

/// Components of a vector below this part of its largest one are rounding.
const ROUNDING: f64 = 1e-10;

/// The components of a vector.
const PLANE: [&str; 2] = ["x", "y"];

/// A row: what the number is, the number, its unit, what is known of its error.
pub(crate) struct Row {
    pub what: String,
    pub value: Vec<Piece>,
    pub unit: Unit,
    pub error: Vec<Piece>,
}

/// The unit of a number, everything per unit thickness.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// Of a ratio, and of what its value says itself.
    One,
    Length,
    Stress,
    /// Stress × length.
    Force,
    /// Stress × length².
    Energy,
    /// The same of a moment.
    Moment,
    /// (Stress × length²)^½.
    EnergyNorm,
    /// 1 / stress.
    Compliance,
}

impl Unit {
    /// That of a number of the JSON object, by its path.
    fn of_path(path: &str) -> Self {
        let has = |words: &[&str]| path.split('.').any(|key| words.iter().any(|word| key.ends_with(word)));
        match () {
            // before all others: what follows is a name of the scene
            () if path.starts_with("reactions.") || path.starts_with("weighted_force.") => Self::Force,
            () if path.starts_with("pressure.") => Self::Stress,
            () if ["mean_displacement.", "opening."].iter().any(|group| path.starts_with(group)) => Self::Length,
            () if path.starts_with("moment.") => Self::Moment,
            () if has(&["energy", "work"]) => Self::Energy,
            () if has(&["stress", "pressure", "von_mises", "principal"]) => Self::Stress,
            () if has(&["force", "resultant"]) => Self::Force,
            () if has(&["length", "stick", "slip", "displacement"]) => Self::Length,
            () => Self::One,
        }
    }

    /// In the names of the scene; nothing if they are not known.
    pub(crate) fn name(self, units: &Units) -> Option<String> {
        let (length, stress) = (units.length.as_ref(), units.stress.as_ref());
        match self {
            Self::One => None,
            Self::Length => length.cloned(),
            Self::Stress => stress.cloned(),
            Self::Force => Some(format!("{} {}", stress?, length?)),
            Self::Energy | Self::Moment => Some(format!("{} {}²", stress?, length?)),
            Self::EnergyNorm => Some(format!("({} {}²)^½", stress?, length?)),
            Self::Compliance => Some(format!("1/{}", stress?)),
        }
    }
}

/// A number in HTML: short for readers, with all its digits for programs.
pub(crate) fn number(value: f64, digits: usize) -> String {
    format!("<data value=\"{value:?}\">{}</data>", short(value, digits))
}

pub(crate) fn usual(value: f64) -> String {
    number(value, DIGITS)
}

pub(crate) fn pair([x, y]: [f64; 2]) -> String {
    format!("({}, {})", usual(x), usual(y))
}

/// Digits of a value that an error of this size leaves.
pub(crate) fn digits(value: f64, error: f64) -> usize {
    let known = (value.abs() / error).log10();
    if known.is_finite() { (known.ceil() + 1.0).clamp(2.0, 15.0) as usize } else { DIGITS }
}

/// A number beside a larger one of its kind: 0 where it is rounding of that.
pub(crate) fn beside(value: f64, largest: f64) -> f64 {
    if value.abs() < ROUNDING * largest { 0.0 } else { value }
}

fn words(text: impl Into<String>) -> Vec<Piece> {
    vec![Words(text.into())]
}

fn one(value: f64) -> Vec<Piece> {
    vec![Number(value, DIGITS)]
}

/// Components in parentheses.
fn vector<const N: usize>(components: [f64; N]) -> Vec<Piece> {
    let largest = components.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let mut pieces = words("(");
    for (k, component) in components.into_iter().enumerate() {
        if k > 0 {
            pieces.push(Words(", ".into()));
        }
        pieces.push(Component(component, largest));
    }
    pieces.push(Words(")".into()));
    pieces
}

/// A number between words.
fn within(before: &str, value: f64, digits: usize, after: &str) -> Vec<Piece> {
    vec![Words(before.into()), Number(value, digits), Words(after.into())]
}

/// The error bars of the components of a vector at a path of the result, those of unknown ones as a dash; nothing without any.
fn bars<const N: usize>(s: &Summary, path: &str, components: [&str; N]) -> Vec<Piece> {
    let known = components.map(|component| s.quantities.get(&format!("{path}.{component}")));
    if known.iter().all(Option::is_none) {
        return Vec::new();
    }
    let mut pieces = words("± (");
    for (k, told) in known.into_iter().enumerate() {
        if k > 0 {
            pieces.push(Words(", ".into()));
        }
        pieces.push(told.map_or(Words("–".into()), |told| Number(told.uncertainty, 2)));
    }
    pieces.push(Words(")".into()));
    pieces
}

fn row(what: impl Into<String>, value: Vec<Piece>, unit: Unit, error: Vec<Piece>) -> Row {
    Row { what: what.into(), value, unit, error }
}

/// Rows of the whole result.
pub(crate) fn rows(s: &Summary) -> Vec<Row> {
    let mut rows = energies(s);
    rows.extend(s.contact.iter().flat_map(|c| of_contact(s, c)));
    rows.extend(of_forces(s));
    rows.extend(of_names(s));
    rows.extend(of_parts(s));
    rows
}

fn energies(s: &Summary) -> Vec<Row> {
    let last = "energy J of the last mesh";
    let energy = vec![Number(s.energy, 10)];
    let mut rows = match (s.energy_extrapolated, s.energy_uncertainty) {
        (Some(extrapolated), Some(uncertainty)) => {
            let value = vec![Number(extrapolated, digits(extrapolated, uncertainty))];
            let apart = within("", s.energy - extrapolated, 2, " from J extrapolated");
            vec![
                row(last, energy, Unit::Energy, apart),
                row("J extrapolated", value, Unit::Energy, within("± ", uncertainty, 2, "")),
            ]
        }
        _ => vec![row(last, energy, Unit::Energy, words("not estimated"))],
    };
    let parts = [
        ("strain energy", "strain_energy", Some(s.strain_energy)),
        ("energy of springs", "spring_energy", s.spring_energy),
        ("work of loads", "load_work", Some(s.load_work)),
        ("work of friction", "friction_work", s.contact.as_ref().map(|_| s.friction_work)),
    ];
    for (what, path, value) in parts {
        let Some(value) = value else { continue };
        let bar = s.quantities.get(path).map(|told| within("± ", told.uncertainty, 2, ""));
        rows.push(row(what, one(value), Unit::Energy, bar.unwrap_or_else(|| words("not estimated by itself"))));
    }
    if let (Some(estimate), Some(relative)) = (s.estimate, s.estimate_relative) {
        let trust = match s.estimate_doubts.is_empty() {
            true => "near the true error: nothing is in doubt".to_owned(),
            false => format!("not reliable: {}", s.estimate_doubts.join(", ")),
        };
        rows.push(row("estimated error, energy norm", vec![Number(estimate, 4)], Unit::EnergyNorm, words(trust)));
        rows.push(row("the same over (2 strain energy)^½", vec![Number(relative, 4)], Unit::One, vec![]));
    }
    rows
}

fn of_contact(s: &Summary, c: &ContactSummary) -> Vec<Row> {
    let bar = |path: &str| s.quantities.get(path).map(|told| within("± ", told.uncertainty, 2, ""));
    let located = match &c.ends {
        Some(_) => "between ends of contact that have vertices of their own",
        None => "sum over the nodes that press: their distance is the error",
    };
    let largest = match c.max_pressure_unbounded {
        true => "the exact one is infinite: this is a number of the mesh",
        false => "at a node; not estimated by itself",
    };
    let mut rows = vec![
        row("contact: length", one(c.length), Unit::Length, bar("contact.length").unwrap_or_else(|| words(located))),
        row("contact: length that sticks", one(c.stick), Unit::Length, bar("contact.stick").unwrap_or_default()),
        row("contact: length that slips", one(c.slip), Unit::Length, bar("contact.slip").unwrap_or_default()),
        row(
            "contact: largest pressure",
            one(c.max_pressure),
            Unit::Stress,
            bar("contact.max_pressure").unwrap_or_else(|| words(largest)),
        ),
        row("contact: force on the body", vector(c.force), Unit::Force, bars(s, "contact.force", PLANE)),
    ];
    for (k, end) in c.ends.iter().flatten().enumerate() {
        rows.push(row(format!("contact: end {}", k + 1), vector(*end), Unit::Length, vec![]));
    }
    if let Some(factor) = c.contraction {
        let settles = if factor < 1.0 { "" } else { "the fixed point of Tresca problems does not settle" };
        rows.push(row("Coulomb friction: contraction", vec![Number(factor, 3)], Unit::One, words(settles)));
    }
    if let Some(s) = c.stabilisation {
        let critical = within("below the critical ", s.critical_gamma, DIGITS, "");
        rows.push(row("stabilisation γ₀", one(s.gamma), Unit::Compliance, critical));
    }
    rows
}

/// The numbers that the scene asks for by names, with their error bars.
fn of_names(s: &Summary) -> Vec<Row> {
    let Named { pressure, mean_displacement, moment, weighted_force, opening } = &s.named;
    let bar = |path: &str| s.quantities.get(path).map_or(Vec::new(), |told| within("± ", told.uncertainty, 2, ""));
    let single = |group: &str, what: &str, unit: Unit, all: &BTreeMap<String, f64>| -> Vec<Row> {
        let of = |(name, value): (&String, &f64)| {
            row(format!("{what} {name}"), one(*value), unit, bar(&format!("{group}.{name}")))
        };
        all.iter().map(of).collect()
    };
    let mut rows = single("pressure", "pressure", Unit::Stress, pressure);
    for (name, mean) in mean_displacement {
        for (component, value) in ["x", "y"].into_iter().zip(mean) {
            let path = format!("mean_displacement.{name}.{component}");
            rows.push(row(format!("mean displacement {name}, {component}"), one(*value), Unit::Length, bar(&path)));
        }
    }
    rows.extend(single("moment", "moment", Unit::Moment, moment));
    rows.extend(single("weighted_force", "weighted force", Unit::Force, weighted_force));
    rows.extend(single("opening", "opening", Unit::Length, opening));
    rows
}

/// How far a force at a path of the result may be off, and how well forces balance.
fn of_force(s: &Summary, path: &str, equilibrium: Option<f64>) -> Vec<Piece> {
    let mut known = bars(s, path, PLANE);
    if let Some(equilibrium) = equilibrium {
        known.extend((!known.is_empty()).then(|| Words("; ".into())));
        known.extend(within("forces balance to ", equilibrium, 2, " of their size"));
    }
    known
}

/// Reactions, and how well forces and contact conditions hold.
fn of_forces(s: &Summary) -> Vec<Row> {
    let equilibrium = s.audit.map(|a| a.equilibrium);
    let reaction = |(side, force): (&String, &[f64; 2])| {
        let known = of_force(s, &format!("reactions.{side}"), equilibrium);
        row(format!("force on the body from side {side}"), vector(*force), Unit::Force, known)
    };
    let mut rows: Vec<Row> = s.reactions.iter().map(reaction).collect();
    if let Some(a) = s.audit {
        let conditions = [
            ("penetration", a.penetration),
            ("tension", a.tension),
            ("complementarity", a.complementarity),
            ("friction law", a.friction),
        ];
        rows.extend(conditions.map(|(what, value)| {
            let holds = "0 where the condition holds, relative to its scale";
            row(format!("audit: {what}"), vec![Number(value, 2)], Unit::One, words(holds))
        }));
    }
    rows
}

/// Bodies, interfaces, grid and what is around.
fn of_parts(s: &Summary) -> Vec<Row> {
    let mut rows = Vec::new();
    for (k, body) in s.bodies.iter().enumerate() {
        let bar = s.quantities.get(&format!("bodies.{k}.strain_energy"));
        let bar = bar.map(|told| within("± ", told.uncertainty, 2, ""));
        let of_body = |e| within("estimated error of this body ", e, 3, "");
        let error = bar.or_else(|| body.estimate.map(of_body)).unwrap_or_default();
        rows.push(row(format!("strain energy of body {}", body.name), one(body.strain_energy), Unit::Energy, error));
    }
    s.interfaces.iter().enumerate().for_each(|(number, i)| rows.extend(of_interface(s, number, i)));
    if let Some(grid) = &s.grid {
        let parts = [
            (grid.estimate_multiscale, "coarse cells"),
            (grid.estimate_fine_grid, "fine grid"),
            (grid.estimate_medium, "boundary elements around"),
        ];
        for (value, what) in parts.into_iter().filter_map(|(value, what)| Some((value?, what))) {
            let what = format!("part of the estimated error: {what}");
            rows.push(row(what, vec![Number(value, 4)], Unit::EnergyNorm, vec![]));
        }
        rows.push(row("contrast of the moduli", one(grid.contrast), Unit::One, vec![]));
    }
    if let Some(around) = &s.exterior {
        let balanced = if around.balanced { "balanced" } else { "not balanced: displacements depend on the length L" };
        rows.push(row("net force on the medium", vector(around.resultant), Unit::Force, words(balanced)));
        if around.radiation == "bounded" {
            rows.push(row("displacement at infinity", vector(around.constant), Unit::Length, vec![]));
        }
    }
    rows
}

fn of_interface(s: &Summary, number: usize, i: &InterfaceSummary) -> Vec<Row> {
    let sides = i.sides[0].iter().chain(&i.sides[1]).cloned().collect::<Vec<_>>().join(", ");
    let length = format!("interface {}, {} ({sides}): length", i.name, i.kind);
    let bar = |name: &str| {
        let own = s.quantities.get(&format!("interfaces.{number}.{name}"));
        own.map_or(Vec::new(), |told| within("± ", told.uncertainty, 2, ""))
    };
    let mut rows = vec![row(length, one(i.length), Unit::Length, bar("length"))];
    for (what, name, value) in [("sticks", "stick", i.stick), ("slips", "slip", i.slip)] {
        let Some(value) = value else { continue };
        rows.push(row(format!("interface {}: length that {what}", i.name), one(value), Unit::Length, bar(name)));
    }
    // where the largest one is infinite, the row of all contact says so
    let bounded = s.contact.as_ref().is_some_and(|contact| !contact.max_pressure_unbounded);
    if let Some(pressure) = i.max_pressure.filter(|_| bounded) {
        let bar = s.quantities.get(&format!("interfaces.{number}.max_pressure"));
        let known = bar
            .map_or_else(|| words("at a node; not estimated by itself"), |told| within("± ", told.uncertainty, 2, ""));
        rows.push(row(format!("interface {}: largest pressure", i.name), one(pressure), Unit::Stress, known));
    }
    let first = format!("interface {}: force on the body named first", i.name);
    let known = of_force(s, &format!("interfaces.{number}.force"), i.audit.map(|a| a.equilibrium));
    rows.push(row(first, vector(i.force), Unit::Force, known));
    if let Some(n) = i.normals {
        let angle = within("", n.angle.to_degrees(), 3, "°");
        let change = within("J is uncertain by ", n.energy_change, 2, " for that");
        rows.push(row(format!("interface {}: normals differ by", i.name), angle, Unit::One, change));
    }
    rows
}

/// Rows of the points of `[probe]`.
pub(crate) fn of_probes(s: &Summary) -> Vec<Row> {
    let rows = s.probe.iter().enumerate().flat_map(|(k, p)| {
        let [x, y] = p.point;
        let (stress, known) = match p.stress_unbounded {
            true => (words("infinite"), words("at this vertex, whatever the mesh")),
            false => (vector(p.stress), bars(s, &format!("probe.{k}.stress"), ["xx", "yy", "xy"])),
        };
        let of_displacement = bars(s, &format!("probe.{k}.displacement"), PLANE);
        [
            row(format!("displacement at ({x}, {y})"), vector(p.displacement), Unit::Length, of_displacement),
            row(format!("stress (xx, yy, xy) at ({x}, {y})"), stress, Unit::Stress, known),
        ]
    });
    rows.collect()
}

/// Rows of the means over all outcomes, each with its standard deviation.
pub(crate) fn of_outcomes(result: &StochasticResult) -> Vec<Row> {
    let rows = result.quantities.iter().map(|q| {
        let deviation = q.variance.max(0.0).sqrt();
        let value = match q.variance.is_nan() {
            true => one(q.mean),
            false => vec![Number(q.mean, DIGITS), Words(" ± ".into()), Number(deviation, 3)],
        };
        let mut error = Vec::new();
        if q.variance.is_nan() {
            error.extend(words("variance not resolved: negative by this rule; "));
        }
        if q.bounds_left.is_some() {
            error.extend(words("mean not resolved: out of its bounds by this rule; "));
        }
        if let Some(e) = q.standard_error {
            error.extend(within("standard error of the mean ", e, 2, "; "));
        }
        if let Some(e) = q.truncation {
            error.extend(within("truncation ", e, 2, "; "));
        }
        if let Some(Words(last)) = error.last_mut() {
            *last = last.trim_end_matches("; ").to_owned();
        }
        row(format!("mean ± deviation over outcomes: {}", q.name), value, Unit::of_path(&q.name), error)
    });
    rows.collect()
}

/// How the run ended, and of what the rows below are.
fn of_run(stored: &Record) -> Row {
    let s = &stored.summary;
    let ended = if s.converged { s.reason.clone() } else { format!("NOT CONVERGED: {}", s.reason) };
    let of = match &stored.stochastic {
        Some(_) => {
            "these are numbers of one solution, of the mean of the random input; means over outcomes stand at the end"
        }
        None => "",
    };
    row("run", words(ended), Unit::One, words(of))
}

/// All of them, for a table.
pub(crate) fn all(stored: &Record) -> Vec<Row> {
    let s = &stored.summary;
    let outcomes = stored.stochastic.iter().flat_map(of_outcomes);
    [of_run(stored)].into_iter().chain(rows(s)).chain(of_probes(s)).chain(outcomes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_the_digits_that_its_error_leaves() {
        assert_eq!((digits(-2.99, 1.6e-7), digits(1.0, 0.5), digits(3.0, 0.0)), (9, 2, DIGITS));
        assert_eq!(number(-0.25, 7), "<data value=\"-0.25\">\u{2212}0.25</data>");
    }

    /// A unit is told where all of its parts have names.
    #[test]
    fn units_are_made_of_their_parts() {
        let of = |length: Option<&str>, stress: Option<&str>| Units {
            length: length.map(str::to_owned),
            stress: stress.map(str::to_owned),
        };
        let both = of(Some("mm"), Some("MPa"));
        assert_eq!(Unit::Energy.name(&both).as_deref(), Some("MPa mm²"));
        assert_eq!((Unit::One.name(&both), Unit::Force.name(&of(Some("mm"), None))), (None, None));
        assert_eq!(Unit::Length.name(&of(Some("mm"), None)).as_deref(), Some("mm"));
        for (path, unit) in [
            ("strain_energy", "MPa mm²"),
            ("friction_work", "MPa mm²"),
            ("contact.max_pressure", "MPa"),
            ("probe.0.stress.yy", "MPa"),
            ("probe.0.von_mises", "MPa"),
            ("probe.0.max_principal", "MPa"),
            ("contact.force.y", "MPa mm"),
            ("reactions.pressure.x", "MPa mm"),
            ("interfaces.0.stick", "mm"),
            ("probe.1.displacement.x", "mm"),
        ] {
            assert_eq!(Unit::of_path(path).name(&both).as_deref(), Some(unit), "{path}");
        }
    }
}
