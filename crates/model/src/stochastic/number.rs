//! The numbers of an outcome of which statistics are made: their paths are read once.

use steklov_problem::{DataError, Interface, Law, Random, Scene};

use crate::stochastic::outcomes::paths_of;
use crate::summary::{ContactSummary, InterfaceSummary, Probe, Summary};

/// A function that finds a number in a summary.
type Reader = dyn Fn(&Summary) -> Option<f64> + Send + Sync;

/// A number that each outcome has.
pub(super) struct Number {
    /// Its path in the JSON object.
    pub(super) path: String,
    of: Box<Reader>,
}

impl Number {
    /// The number at a path; none if outcomes have none there.
    pub(super) fn new(path: &str) -> Option<Self> {
        Some(Self { path: path.to_owned(), of: reader(path)? })
    }

    /// Its value; NaN where the outcome has none, or an infinite one.
    pub(super) fn of(&self, summary: &Summary) -> f64 {
        (self.of)(summary).filter(|value| value.is_finite()).unwrap_or(f64::NAN)
    }
}

/// The numbers of a scene's quantities.
///
/// # Errors
/// The first path that leads to none.
pub(super) fn numbers(scene: &Scene, random: &Random) -> Result<Vec<Number>, DataError> {
    let number = |path: &String| Number::new(path).ok_or_else(|| scene.quantity_error(path));
    paths_of(scene, random).iter().map(number).collect()
}

/// Whether every quantity that a scene asks for is a number of its outcomes: before anything is solved.
///
/// # Errors
/// The first that is none.
pub(crate) fn check_quantities(scene: &Scene, random: &Random) -> Result<(), DataError> {
    let holds = |side: usize| {
        let of_side = &scene.problem.sides[side];
        of_side.springs.is_some() || of_side.holds(0) || of_side.holds(1) || scene.contact(side).is_some()
    };
    let zero = ContactSummary { contraction: Some(0.0), ..ContactSummary::default() };
    let at = |&point: &[f64; 2]| Probe { stress_unbounded: true, ..Probe::new(point, [0.0; 2], [0.0; 3]) };
    let sides = (0..scene.problem.sides.len()).filter(|&side| holds(side));
    let interface = |interface: &Interface| {
        let of_contact = matches!(interface.law, Law::Contact(_)).then_some(0.0);
        InterfaceSummary {
            stick: of_contact,
            slip: of_contact,
            max_pressure: of_contact,
            ..InterfaceSummary::default()
        }
    };
    let has = Summary {
        spring_energy: scene.problem.has_springs().then_some(0.0),
        contact: scene.contacts().next().map(|_| zero),
        reactions: sides.map(|side| (scene.problem.sides[side].name.clone(), [0.0; 2])).collect(),
        probe: scene.probe.iter().map(at).collect(),
        interfaces: scene.problem.joints().map(interface).collect(),
        ..Summary::default()
    };
    let is_number = |path: &String| Number::new(path).is_some_and(|number| !number.of(&has).is_nan());
    match paths_of(scene, random).iter().find(|path| !is_number(path)) {
        Some(path) => Err(scene.quantity_error(path)),
        None => Ok(()),
    }
}

fn reader(path: &str) -> Option<Box<Reader>> {
    let component = Summary::component;
    let contact =
        |of: fn(&ContactSummary) -> Option<f64>| -> Box<Reader> { Box::new(move |s| of(s.contact.as_ref()?)) };
    let reader: Box<Reader> = match path.split('.').collect::<Vec<_>>()[..] {
        ["energy"] => Box::new(|s| Some(s.energy)),
        ["strain_energy"] => Box::new(|s| Some(s.strain_energy)),
        ["spring_energy"] => Box::new(|s| s.spring_energy),
        ["load_work"] => Box::new(|s| Some(s.load_work)),
        ["friction_work"] => Box::new(|s| Some(s.friction_work)),
        ["contact", "length"] => contact(|c| Some(c.length)),
        ["contact", "stick"] => contact(|c| Some(c.stick)),
        ["contact", "slip"] => contact(|c| Some(c.slip)),
        ["contact", "max_pressure"] => contact(|c| Some(c.max_pressure)),
        ["contact", "max_pressure_unbounded"] => contact(|c| Some(f64::from(u8::from(c.max_pressure_unbounded)))),
        ["contact", "contraction"] => contact(|c| c.contraction),
        ["contact", "force", k] => {
            let k = component(k)?;
            Box::new(move |s| s.contact.as_ref()?.force.get(k).copied())
        }
        ["interfaces", place, "force", k] => {
            let (place, k) = (component(place)?, component(k)?);
            Box::new(move |s| s.interfaces.get(place)?.force.get(k).copied())
        }
        ["interfaces", place, of] => {
            let place = component(place)?;
            let number: fn(&InterfaceSummary) -> Option<f64> = match of {
                "length" => |i| Some(i.length),
                "stick" => |i| i.stick,
                "slip" => |i| i.slip,
                "max_pressure" => |i| i.max_pressure,
                _ => return None,
            };
            Box::new(move |s| number(s.interfaces.get(place)?))
        }
        // names of sides may have points
        ["reactions", ref side @ .., k] => {
            let (side, k) = (side.join("."), component(k)?);
            Box::new(move |s| s.reactions.get(&side)?.get(k).copied())
        }
        ["probe", point, "stress_unbounded"] => {
            let point = component(point)?;
            Box::new(move |s| s.probe.get(point)?.stress_unbounded.then_some(1.0))
        }
        ["probe", point, of, k] => {
            let (point, k) = (component(point)?, component(k)?);
            let vector: fn(&Probe) -> &[f64] = match of {
                "point" => |p| &p.point,
                "displacement" => |p| &p.displacement,
                "stress" => |p| &p.stress,
                _ => return None,
            };
            Box::new(move |s| vector(s.probe.get(point)?).get(k).copied())
        }
        _ => return None,
    };
    Some(reader)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An outcome all of whose numbers are others.
    fn outcome() -> Summary {
        let contact = ContactSummary {
            length: 1.5,
            stick: 0.5,
            slip: 1.0,
            max_pressure: 7.0,
            max_pressure_unbounded: true,
            force: [-2.0, 3.0],
            ends: None,
            contraction: Some(0.25),
            stabilisation: None,
        };
        let probe = |k: f64, stress_unbounded| Probe {
            stress_unbounded,
            ..Probe::new([k, 0.1], [k + 0.2, -0.0], [k + 10.0, f64::NAN, k + 30.0])
        };
        Summary {
            energy: -1.0,
            strain_energy: 2.0,
            load_work: f64::INFINITY,
            friction_work: 4.0,
            contact: Some(contact),
            reactions: [("floor".to_owned(), [5.0, 6.0]), ("low.floor".to_owned(), [8.0, 9.0])].into(),
            probe: vec![probe(100.0, false), probe(200.0, true)],
            ..Summary::default()
        }
    }

    /// Numbers are those that paths find in the JSON object, with the same bits; of the run there are none.
    #[test]
    fn numbers_are_those_of_the_json_object() {
        let outcome = outcome();
        let mut paths: Vec<String> = ["energy", "strain_energy", "load_work", "friction_work", "energy.x", "contact"]
            .iter()
            .map(|path| (*path).to_owned())
            .collect();
        let of_contact =
            ["length", "stick", "slip", "max_pressure", "max_pressure_unbounded", "contraction", "ends", "force"];
        paths.extend(of_contact.iter().map(|of| format!("contact.{of}")));
        let keys = ["x", "y", "xx", "yy", "xy", "0", "1", "2", "3", "z", ""];
        let vectors =
            ["contact.force", "contact.length", "reactions.floor", "reactions.low.floor", "reactions.low", "reactions"];
        let of_points = ["point", "displacement", "stress", "stress_unbounded", "more", "stress.x"];
        let points = ["0", "1", "y", "2", "z"].into_iter().flat_map(|k| of_points.map(|of| format!("probe.{k}.{of}")));
        for vector in vectors.into_iter().map(str::to_owned).chain(points) {
            paths.extend(keys.iter().map(|key| format!("{vector}.{key}")));
            paths.push(vector);
        }
        let mut found = 0;
        for path in paths {
            let number = Number::new(&path).map_or(f64::NAN, |number| number.of(&outcome));
            let in_json = outcome.at(&path).unwrap_or(f64::NAN);
            assert_eq!(number.to_bits(), in_json.to_bits(), "{path}: {number}, in JSON {in_json}");
            found += usize::from(!number.is_nan());
        }
        assert_eq!(found, 84);
        assert!(Number::new("dofs").is_none() && outcome.at("dofs").is_some());
    }
}
