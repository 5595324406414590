//! [`Persist`] for [`Problem`]: outline, sides, bodies, interfaces, and a list of the expressions in them.

use hdf5::Group;
use steklov_bem_operators::Polygon;
use steklov_coupling::Radiation;
use steklov_elastic::Material;
use steklov_problem::{
    BASES, Body, CellModuli, Cells, Condition, Contact, Faces, FarField, Friction, GridInput, Interface, Law, Other,
    Place, Problem, Side, Springs, Substance, TableOrder, Tie, modulus_cells,
};

use crate::array::{
    load_integers, load_number, load_pairs, load_vector, save_integers, save_number, save_pairs, save_vector,
};
use crate::dataset::{Label, label};
use crate::error::{IoError, invalid, mismatch};
use crate::expressions::{Numbered, Numbering};
use crate::persist::{Persist, create_group, load, open_group, save};
use crate::quadrature::check_length;
use crate::text::{load_text, load_texts, save_text, save_texts};
use crate::words::{load_word, save_word};

const ORDERS: [(&str, TableOrder); 3] = [("xy", TableOrder::Xy), ("yx", TableOrder::Yx), ("rows", TableOrder::Rows)];
const RADIATION: [(&str, Option<Radiation>); 3] =
    [("auto", None), ("decaying", Some(Radiation::Decaying)), ("bounded", Some(Radiation::Bounded))];
const PLACES: [(&str, Place); 2] = [("first", Place::First), ("second", Place::Second)];
const NO: [(&str, bool); 2] = [("no", false), ("yes", true)];
/// Words for laws and kinds of friction.
const KINDS: [&str; 4] = ["tied", "no friction", "tresca", "coulomb"];
const NUMBER: &str = "numbers of expressions from 1, 0 is none: ";

fn numbers<'a>(meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    label("1", meaning, axes)
}

impl Persist for Problem {
    const KIND: &'static str = "problem";
    const VERSION: u32 = 1;

    /// A body cut by cracks and random fields are refused.
    fn write(&self, at: &Group) -> Result<(), IoError> {
        let mut expressions = Numbering::default();
        save(at, "outline", &self.outline)?;
        save_sides(at, &self.sides, &mut expressions)?;
        for (k, body) in self.bodies.iter().enumerate() {
            save_body(&create_group(&folder(at, "bodies")?, &k.to_string())?, body, &mut expressions)?;
        }
        for (k, interface) in self.interfaces().iter().enumerate() {
            save_interface(&create_group(&folder(at, "interfaces")?, &k.to_string())?, interface, &mut expressions)?;
        }
        expressions.save(at)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let expressions = Numbered::load(at)?;
        let outline: Polygon = load(at, "outline")?;
        let mut bodies = Vec::new();
        for body in members(at, "bodies")? {
            bodies.push(load_body(&body, &expressions)?);
        }
        if bodies.len() < outline.bodies().len() {
            return Err(invalid(at, "bodies", format!("{} where {} are needed", bodies.len(), outline.bodies().len())));
        }
        check_tables(at, &outline, &bodies)?;
        let mut problem = Self::of_bodies(outline, bodies);
        problem.sides = load_sides(at, &problem.sides, &expressions)?;
        for interface in members(at, "interfaces")? {
            let joined = problem.join_as(load_interface(&interface, &expressions)?);
            joined.map_err(|e| invalid(&interface, "", e.message))?;
        }
        problem.check_bodies().map_err(|e| invalid(at, "", e.message))?;
        Ok(problem)
    }
}

/// Checks that tables have a modulus for each cell.
fn check_tables(at: &Group, outline: &Polygon, bodies: &[Body]) -> Result<(), IoError> {
    for (k, body) in bodies.iter().enumerate() {
        let Some(Cells { size, young, poisson, .. }) = body.cells() else { continue };
        for (of, place) in [(Some(young), "table"), (poisson.as_ref(), "poisson/table")] {
            let Some(CellModuli::Table { values, .. }) = of else { continue };
            if modulus_cells(outline, *size).is_none_or(|[nx, ny]| nx * ny != values.len()) {
                return Err(invalid(at, &format!("bodies/{k}/cells/{place}"), "it has not one modulus for each cell"));
            }
        }
    }
    Ok(())
}

/// A group, created if missing.
fn folder(at: &Group, name: &str) -> Result<Group, IoError> {
    if at.link_exists(name) { open_group(at, name) } else { create_group(at, name) }
}

pub(crate) fn check_finite(at: &Group, name: &str, values: &[f64]) -> Result<(), IoError> {
    let wrong = values.iter().find(|value| !value.is_finite());
    wrong.map_or(Ok(()), |value| Err(invalid(at, name, format!("{value} is no number"))))
}

/// The groups 0, 1, .. of the group `name`; none without it.
fn members(at: &Group, name: &str) -> Result<Vec<Group>, IoError> {
    if !at.link_exists(name) {
        return Ok(Vec::new());
    }
    let folder = open_group(at, name)?;
    (0..folder.len() as usize).map(|k| open_group(&folder, &k.to_string())).collect()
}

fn save_sides<'a>(at: &Group, sides: &'a [Side], expressions: &mut Numbering<'a>) -> Result<(), IoError> {
    let (mut kinds, mut displacement, mut traction) = (Vec::new(), Vec::new(), Vec::new());
    let (mut springs, mut stiffness) = (Vec::new(), Vec::new());
    for side in sides {
        let (kind, held, loaded) = match &side.condition {
            Condition::Free => (0, [0; 2], [0; 2]),
            Condition::Traction(t) => (1, [0; 2], expressions.of_pair(Some(t))),
            Condition::Pressure(q) => (2, [0; 2], [expressions.of(Some(q)), 0]),
            Condition::Displacement { values, traction } => {
                let held = [0, 1].map(|k| expressions.of(values[k].as_ref()));
                (3, held, expressions.of_pair(traction.as_ref()))
            }
        };
        kinds.push(kind);
        displacement.push(held);
        traction.push(loaded);
        springs.push(match &side.springs {
            None => 0,
            Some(Springs::Axes(_)) => 1,
            Some(Springs::Normal { .. }) => 2,
        });
        stiffness.push(side.springs.as_ref().map_or([0; 2], |s| s.stiffnesses().map(|k| expressions.of(Some(k)))));
    }
    let names: Vec<String> = sides.iter().map(|side| side.name.clone()).collect();
    save_texts(at, "side_names", &names, "names of the sides", "side")?;
    let meaning = "0 free, 1 traction, 2 pressure, 3 displacement";
    save_integers(at, "condition", &kinds, &label("1", meaning, &["side"]))?;
    let meaning = format!("{NUMBER}prescribed displacement (length)");
    save_pairs(at, "displacement", &displacement, &numbers(&meaning, &["side", "component"]))?;
    let meaning = format!("{NUMBER}traction (stress); pressure, 0");
    save_pairs(at, "traction", &traction, &numbers(&meaning, &["side", "component"]))?;
    let meaning = "0 none, 1 along x and y, 2 along normal and tangent";
    save_integers(at, "springs", &springs, &label("1", meaning, &["side"]))?;
    let meaning = format!("{NUMBER}stiffnesses (stress/length)");
    save_pairs(at, "stiffness", &stiffness, &numbers(&meaning, &["side", "direction"]))
}

/// Reads what [`save_sides`] wrote for sides of these names.
fn load_sides(at: &Group, free: &[Side], expressions: &Numbered) -> Result<Vec<Side>, IoError> {
    let names = load_texts(at, "side_names")?;
    if !names.iter().eq(free.iter().map(|side| &side.name)) {
        return Err(invalid(at, "side_names", "they are not those of the outline"));
    }
    let (kinds, springs) = (load_integers(at, "condition")?, load_integers(at, "springs")?);
    let [displacement, traction, stiffness] =
        ["displacement", "traction", "stiffness"].map(|name| load_pairs(at, name));
    let (displacement, traction, stiffness) = (displacement?, traction?, stiffness?);
    let lengths = [kinds.len(), springs.len(), displacement.len(), traction.len(), stiffness.len()];
    for (name, length) in ["condition", "springs", "displacement", "traction", "stiffness"].into_iter().zip(lengths) {
        check_length(at, name, length, names.len())?;
    }
    let required = |name: &str, number: usize| expressions.require(at, name, number);
    let mut sides = Vec::new();
    for (k, name) in names.into_iter().enumerate() {
        let [x, y] = traction[k];
        let unused = [
            ("displacement", kinds[k] != 3 && displacement[k] != [0, 0]),
            ("traction", kinds[k] == 0 && traction[k] != [0, 0] || kinds[k] == 2 && y != 0),
            ("stiffness", springs[k] == 0 && stiffness[k] != [0, 0]),
        ];
        if let Some((part, _)) = unused.into_iter().find(|(_, unused)| *unused) {
            return Err(invalid(at, part, format!("side {name:?} has no use for it")));
        }
        let condition = match kinds[k] {
            0 => Condition::Free,
            1 => Condition::Traction([required("traction", x)?, required("traction", y)?]),
            2 => Condition::Pressure(required("traction", x)?),
            3 => {
                let [x, y] = displacement[k].map(|number| expressions.get(at, "displacement", number));
                let values = [x?, y?];
                if values.iter().all(Option::is_none) {
                    return Err(invalid(at, "displacement", format!("side {name:?} holds no component")));
                }
                Condition::Displacement { values, traction: expressions.pair(at, "traction", traction[k])? }
            }
            other => return Err(invalid(at, "condition", format!("{other} is no condition"))),
        };
        let [first, second] = stiffness[k];
        let both = || Ok::<_, IoError>([required("stiffness", first)?, required("stiffness", second)?]);
        let springs = match springs[k] {
            0 => None,
            1 => Some(Springs::Axes(both()?)),
            2 => {
                let [normal, tangential] = both()?;
                Some(Springs::Normal { normal, tangential })
            }
            other => return Err(invalid(at, "springs", format!("{other} is no kind of springs"))),
        };
        sides.push(Side { name, condition, springs });
    }
    Ok(sides)
}

fn save_body<'a>(at: &Group, body: &'a Body, expressions: &mut Numbering<'a>) -> Result<(), IoError> {
    save_text(at, "name", &body.name, "name of the body")?;
    save(at, "material", &body.material())?;
    if let Some(cells) = body.cells() {
        save_cells(&create_group(at, "cells")?, cells, expressions)?;
    }
    if let Some(grid) = &body.grid {
        let at = create_group(at, "grid")?;
        save_word(&at, "basis", &BASES, &grid.basis, "basis of the coarse cells")?;
        save_pairs(
            &at,
            "cells",
            &[grid.coarse, grid.fine],
            &label("1", "coarse cells; fine cells in each", &["kind", "axis"]),
        )?;
        let meaning = "fine cells by which an oversampled cell is larger on each side; none: those of a coarse cell";
        save_integers(&at, "oversample", grid.oversample.as_slice(), &label("1", meaning, &["value"]))?;
    }
    let meaning = format!("{NUMBER}force per area");
    save_pairs(at, "force", &[expressions.of_pair(body.force.as_ref())], &numbers(&meaning, &["body", "component"]))?;
    let Some(far) = &body.far else { return Ok(()) };
    let at = create_group(at, "far")?;
    let meaning = "stress far away";
    save_vector(&at, "remote_stress", &far.remote_stress, &label("stress", meaning, &["xx, yy, xy"]))?;
    save_word(&at, "at_infinity", &RADIATION, &far.at_infinity, "what the displacement does there")?;
    save_word(&at, "named", &NO, &far.named, "whether the stress far away has names in it")
}

fn load_body(at: &Group, expressions: &Numbered) -> Result<Body, IoError> {
    let material = load(at, "material")?;
    let substance = match at.link_exists("cells") {
        false => Substance::Homogeneous(material),
        true => Substance::Cells(load_cells(&open_group(at, "cells")?, expressions, material)?),
    };
    let grid = match at.link_exists("grid") {
        false => None,
        true => {
            let at = open_group(at, "grid")?;
            let (cells, oversample) = (load_pairs(&at, "cells")?, load_integers(&at, "oversample")?);
            check_length(&at, "cells", cells.len(), 2)?;
            if oversample.len() > 1 {
                return Err(mismatch(&at, "oversample", "one number at most", oversample.len()));
            }
            let basis = load_word(&at, "basis", &BASES)?;
            let grid = GridInput { coarse: cells[0], fine: cells[1], basis, oversample: oversample.first().copied() };
            grid.check().map_err(|(name, message, _)| invalid(&at, name, message))?;
            Some(grid)
        }
    };
    let force = load_pairs(at, "force")?;
    check_length(at, "force", force.len(), 1)?;
    let far = match at.link_exists("far") {
        false => None,
        true => {
            let at = open_group(at, "far")?;
            let stress = load_vector(&at, "remote_stress")?;
            check_length(&at, "remote_stress", stress.len(), 3)?;
            check_finite(&at, "remote_stress", &stress)?;
            let at_infinity = load_word(&at, "at_infinity", &RADIATION)?;
            let named = load_word(&at, "named", &NO)?;
            Some(FarField { remote_stress: [stress[0], stress[1], stress[2]], at_infinity, named })
        }
    };
    let name = load_text(at, "name")?;
    Ok(Body { name, substance, grid, force: expressions.pair(at, "force", force[0])?, far })
}

fn save_cells<'a>(at: &Group, cells: &'a Cells, expressions: &mut Numbering<'a>) -> Result<(), IoError> {
    save_number(at, "size", cells.size, "length", "side of a modulus cell")?;
    save_values(at, &cells.young, expressions)?;
    match &cells.poisson {
        Some(poisson) => save_values(&create_group(at, "poisson")?, poisson, expressions),
        None => Ok(()),
    }
}

/// The numbers of cells: Young's moduli, in the group `poisson` Poisson's ratios.
fn save_values<'a>(at: &Group, values: &'a CellModuli, expressions: &mut Numbering<'a>) -> Result<(), IoError> {
    let kind = match values {
        CellModuli::Uniform { .. } => "uniform",
        CellModuli::Table { .. } => "table",
        CellModuli::Expression(_) => "expression",
    };
    save_text(at, "moduli", kind, "how the moduli are given")?;
    match values {
        CellModuli::Uniform { low, high, seed } => {
            let meaning = "smallest and largest modulus, uniform between them";
            save_vector(at, "uniform", &[*low, *high], &label("stress", meaning, &["low, high"]))?;
            save_text(at, "seed", &seed.to_string(), "seed of the moduli")
        }
        CellModuli::Table { values, order, source } => {
            save_vector(
                at,
                "table",
                values,
                &label("stress", "Young's modulus of cell ix, iy at ix NY + iy", &["cell"]),
            )?;
            save_word(at, "order", &ORDERS, order, "how they lay in the file that they come from")?;
            save_text(at, "source", source, "where they come from")
        }
        CellModuli::Expression(young) => {
            let meaning = format!("{NUMBER}Young's modulus (stress)");
            save_integers(at, "young", &[expressions.of(Some(young))], &numbers(&meaning, &["value"]))
        }
    }
}

fn load_cells(at: &Group, expressions: &Numbered, of_unit_modulus: Material) -> Result<Cells, IoError> {
    let young = load_values(at, expressions)?;
    let ratios = at.link_exists("poisson").then(|| open_group(at, "poisson")).transpose()?;
    let poisson = ratios.map(|group| load_values(&group, expressions)).transpose()?;
    let size = load_number(at, "size")?;
    check_finite(at, "size", &[size])?;
    Ok(Cells { size, young, poisson, of_unit_modulus })
}

fn load_values(at: &Group, expressions: &Numbered) -> Result<CellModuli, IoError> {
    Ok(match load_text(at, "moduli")?.as_str() {
        "uniform" => {
            let ends = load_vector(at, "uniform")?;
            check_length(at, "uniform", ends.len(), 2)?;
            check_finite(at, "uniform", &ends)?;
            let seed = load_text(at, "seed")?;
            let seed = seed.parse().map_err(|_| mismatch(at, "seed", "a number of 64 bits", &seed))?;
            CellModuli::Uniform { low: ends[0], high: ends[1], seed }
        }
        "table" => {
            let values = load_vector(at, "table")?;
            check_finite(at, "table", &values)?;
            let (order, source) = (load_word(at, "order", &ORDERS)?, load_text(at, "source")?);
            CellModuli::Table { values: values.into(), order, source }
        }
        "expression" => {
            let young = load_integers(at, "young")?;
            check_length(at, "young", young.len(), 1)?;
            CellModuli::Expression(expressions.require(at, "young", young[0])?)
        }
        other => return Err(mismatch(at, "moduli", "uniform, table or expression", other)),
    })
}

fn save_interface<'a>(at: &Group, interface: &'a Interface, expressions: &mut Numbering<'a>) -> Result<(), IoError> {
    if interface.faces == Faces::Cut {
        return Err(invalid(at, "", "a body that cracks cut is not stored: store the body and its cracks"));
    }
    save_text(at, "name", &interface.name, "name of the interface")?;
    save_word(at, "place", &PLACES, &interface.place, "where the sides are named, which carry the multipliers")?;
    save_integers(at, "sides", &interface.sides, &label("1", "sides of one body", &["side"]))?;
    match &interface.other {
        Other::Obstacle => save_text(at, "other", "obstacle", "what they meet")?,
        Other::Medium => save_text(at, "other", "medium", "what they meet")?,
        Other::Sides(sides) => {
            save_text(at, "other", "sides", "what they meet")?;
            save_integers(at, "facing", sides, &label("1", "sides that they meet", &["side"]))?;
        }
    }
    let (kind, data): (usize, Vec<usize>) = match &interface.law {
        Law::Tied(tie) => {
            let jumps = [&tie.displacement_jump, &tie.traction_jump].map(|jump| expressions.of_pair(jump.as_ref()));
            let stress = [0, 1, 2].map(|k| expressions.of(tie.stress_jump.as_ref().map(|jump| &jump[k])));
            (0, jumps.into_iter().flatten().chain(stress).collect())
        }
        Law::Contact(contact) => {
            let kind = match contact.friction {
                Friction::None => 1,
                Friction::Tresca(_) => 2,
                Friction::Coulomb(_) => 3,
            };
            (kind, contact.data().into_iter().map(|(_, datum)| expressions.of(Some(datum))).collect())
        }
    };
    save_text(at, "law", KINDS[kind], "law that holds there")?;
    let meaning = format!(
        "{NUMBER}of contact gap (length), friction bound (stress) or coefficient; of a tie jumps of displacement x, y (length), \
         traction x, y and stress xx, yy, xy (stress)"
    );
    save_integers(at, "data", &data, &numbers(&meaning, &["datum"]))
}

fn load_interface(at: &Group, expressions: &Numbered) -> Result<Interface, IoError> {
    let other = match load_text(at, "other")?.as_str() {
        "obstacle" => Other::Obstacle,
        "medium" => Other::Medium,
        "sides" => Other::Sides(load_integers(at, "facing")?),
        other => return Err(mismatch(at, "other", "obstacle, medium or sides", other)),
    };
    let data = load_integers(at, "data")?;
    let wanted = |n: usize| check_length(at, "data", data.len(), n);
    let datum = |k: usize| expressions.require(at, "data", data[k]);
    let kind = load_word(at, "law", &[0, 1, 2, 3].map(|k| (KINDS[k], k)))?;
    wanted([7, 1, 2, 2][kind])?;
    let law = match kind {
        0 => Law::Tied(Tie {
            displacement_jump: expressions.pair(at, "data", [data[0], data[1]])?,
            traction_jump: expressions.pair(at, "data", [data[2], data[3]])?,
            stress_jump: match data[4..] {
                [0, 0, 0] => None,
                _ => Some([datum(4)?, datum(5)?, datum(6)?]),
            },
        }),
        _ => {
            let friction = match kind {
                1 => Friction::None,
                2 => Friction::Tresca(datum(1)?),
                _ => Friction::Coulomb(datum(1)?),
            };
            Law::Contact(Contact { gap: datum(0)?, friction })
        }
    };
    let (name, sides) = (load_text(at, "name")?, load_integers(at, "sides")?);
    Ok(Interface { name, sides, other, law, place: load_word(at, "place", &PLACES)?, faces: Faces::Own })
}
