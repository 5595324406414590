//! The numbers of a result, each beside what is known of its error.

use serde::Serialize;
use steklov_model::summary::{ContactSummary, Summary};
use steklov_picture::short;

/// Digits of a number whose error is not known.
const DIGITS: usize = 7;

/// A row: what the number is, the number in HTML, what is known of its error.
#[derive(Serialize)]
pub(crate) struct Row {
    pub what: String,
    pub value: String,
    pub error: String,
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
fn digits(value: f64, error: f64) -> usize {
    let known = (value.abs() / error).log10();
    if known.is_finite() { (known.ceil() + 1.0).clamp(2.0, 15.0) as usize } else { DIGITS }
}

/// Rows of the whole result.
pub(crate) fn rows(s: &Summary) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut add = |what: &str, value: String, error: String| rows.push(Row { what: what.into(), value, error });
    match (s.energy_extrapolated, s.energy_uncertainty) {
        (Some(energy), Some(uncertainty)) => {
            add(
                "energy J of the last mesh",
                number(s.energy, 10),
                format!("{} from J extrapolated", usual_short(s.energy - energy)),
            );
            let value = number(energy, digits(energy, uncertainty));
            add("J extrapolated", value, format!("± {}", number(uncertainty, 2)));
        }
        _ => add("energy J of the last mesh", number(s.energy, 10), "not estimated".into()),
    }
    let work = "not estimated by itself";
    add("strain energy", usual(s.strain_energy), work.into());
    if let Some(energy) = s.spring_energy {
        add("energy of springs", usual(energy), work.into());
    }
    add("work of loads", usual(s.load_work), work.into());
    if s.contact.is_some() {
        add("work of friction", usual(s.friction_work), work.into());
    }
    if let (Some(estimate), Some(relative)) = (s.estimate, s.estimate_relative) {
        let trust = match s.estimate_doubts.is_empty() {
            true => "near the true error: nothing is in doubt".into(),
            false => format!("not reliable: {}", s.estimate_doubts.join(", ")),
        };
        add("estimated error, energy norm", number(estimate, 4), trust);
        add("the same over (2 strain energy)^½", number(relative, 4), String::new());
    }
    if let Some(contact) = &s.contact {
        rows.extend(of_contact(contact));
    }
    rows.extend(of_forces(s));
    rows.extend(of_parts(s));
    rows
}

fn usual_short(value: f64) -> String {
    number(value, 2)
}

fn of_contact(c: &ContactSummary) -> Vec<Row> {
    let row = |what: &str, value: String, error: &str| Row { what: what.into(), value, error: error.into() };
    let located = match &c.ends {
        Some(_) => "between ends of contact that have vertices of their own",
        None => "sum over the nodes that press: their distance is the error",
    };
    let mut rows = vec![
        row("contact: length", usual(c.length), located),
        row("contact: length that sticks", usual(c.stick), ""),
        row("contact: length that slips", usual(c.slip), ""),
    ];
    let largest = match c.max_pressure_unbounded {
        true => "the exact one is infinite: this is a number of the mesh",
        false => "at a node; not estimated by itself",
    };
    rows.push(row("contact: largest pressure", usual(c.max_pressure), largest));
    rows.push(row("contact: force on the body", pair(c.force), ""));
    for (k, end) in c.ends.iter().flatten().enumerate() {
        rows.push(row(&format!("contact: end {}", k + 1), pair(*end), ""));
    }
    if let Some(factor) = c.contraction {
        let settles = if factor < 1.0 { "" } else { "the fixed point of Tresca problems does not settle" };
        rows.push(row("Coulomb friction: contraction", number(factor, 3), settles));
    }
    if let Some(s) = c.stabilisation {
        let critical = format!("below the critical {}", usual(s.critical_gamma));
        rows.push(row("stabilisation γ₀", usual(s.gamma), &critical));
    }
    rows
}

/// Reactions, and how well forces and contact conditions hold.
fn of_forces(s: &Summary) -> Vec<Row> {
    let balance =
        s.audit.map_or(String::new(), |a| format!("forces balance to {} of their size", number(a.equilibrium, 2)));
    let reaction = |(side, force): (&String, &[f64; 2])| Row {
        what: format!("force on the body from side {side}"),
        value: pair(*force),
        error: balance.clone(),
    };
    let mut rows: Vec<Row> = s.reactions.iter().map(reaction).collect();
    if let Some(a) = s.audit {
        let conditions = [
            ("penetration", a.penetration),
            ("tension", a.tension),
            ("complementarity", a.complementarity),
            ("friction law", a.friction),
        ];
        let row = |(what, value)| Row {
            what: format!("audit: {what}"),
            value: number(value, 2),
            error: "0 where the condition holds, relative to its scale".into(),
        };
        rows.extend(conditions.map(row));
    }
    rows
}

/// Bodies, interfaces, grid and what is around.
fn of_parts(s: &Summary) -> Vec<Row> {
    let row = |what: String, value: String, error: String| Row { what, value, error };
    let mut rows = Vec::new();
    for body in &s.bodies {
        let error = body.estimate.map_or(String::new(), |e| format!("estimated error of this body {}", number(e, 3)));
        rows.push(row(format!("strain energy of body {}", body.name), usual(body.strain_energy), error));
    }
    for i in &s.interfaces {
        let sides = i.sides[0].iter().chain(&i.sides[1]).cloned().collect::<Vec<_>>().join(", ");
        rows.push(row(format!("interface {}, {} ({sides}): length", i.name, i.kind), usual(i.length), String::new()));
        if let (Some(stick), Some(slip)) = (i.stick, i.slip) {
            let value = format!("{}, {}", usual(stick), usual(slip));
            rows.push(row(format!("interface {}: sticks, slips", i.name), value, String::new()));
        }
        let first = format!("interface {}: force on the body named first", i.name);
        let balance =
            i.audit.map_or(String::new(), |a| format!("forces balance to {} of their size", number(a.equilibrium, 2)));
        rows.push(row(first, pair(i.force), balance));
        if let Some(n) = i.normals {
            let angle = format!("{}°", number(n.angle.to_degrees(), 3));
            let change = format!("J is uncertain by {} for that", number(n.energy_change, 2));
            rows.push(row(format!("interface {}: normals differ by", i.name), angle, change));
        }
    }
    if let Some(grid) = &s.grid {
        let parts = [
            (grid.estimate_multiscale, "coarse cells"),
            (grid.estimate_fine_grid, "fine grid"),
            (grid.estimate_medium, "boundary elements around"),
        ];
        for (value, what) in parts.into_iter().filter_map(|(value, what)| Some((value?, what))) {
            rows.push(row(format!("part of the estimated error: {what}"), number(value, 4), String::new()));
        }
        rows.push(row("contrast of the moduli".into(), usual(grid.contrast), String::new()));
    }
    if let Some(around) = &s.exterior {
        let balanced = if around.balanced { "balanced" } else { "not balanced: displacements depend on the length L" };
        rows.push(row("net force on the medium".into(), pair(around.resultant), balanced.into()));
        if around.radiation == "bounded" {
            rows.push(row("displacement at infinity".into(), pair(around.constant), String::new()));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_the_digits_that_its_error_leaves() {
        assert_eq!((digits(-2.99, 1.6e-7), digits(1.0, 0.5), digits(3.0, 0.0)), (9, 2, DIGITS));
        assert_eq!(number(-0.25, 7), "<data value=\"-0.25\">\u{2212}0.25</data>");
    }
}
