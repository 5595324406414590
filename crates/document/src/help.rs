//! Help for unknown keys, and overrides without effect.

use steklov_expression::nearest;
use steklov_problem::Scene;

use super::error::{ReadError, SceneErrorKind as Kind};
use super::form::{Form, Table};
use super::keys;
use super::tree::{Entry, Item, Value, suggestion};

/// The tables of fixed keys, the likelier ones first.
static TABLES: [&Table; 14] = [
    &keys::METHOD,
    &keys::MATERIAL,
    &keys::BODY,
    &keys::SIDE,
    &keys::CONTACT,
    &keys::FRICTION,
    &keys::SPRINGS,
    &keys::BODY_FORCE,
    &keys::PROBE,
    &keys::GRID,
    &keys::CELLS,
    &keys::STOCHASTIC,
    &keys::EXTERIOR,
    &keys::INTERFACE,
];

/// Whether a key of this name takes a list of tables and nothing else.
pub(super) fn is_list_of_tables(key: &str) -> bool {
    let is_list = |form: &Form| matches!(form, Form::List(Form::Table(_), None));
    keys::SCENE.all().iter().flat_map(|table| table.keys).any(|k| k.name == key && is_list(&k.form))
}

/// Keys of other programs that scenes do not have, and what to write instead.
const INSTEAD: [(&[&str], &str); 9] = [
    (
        &["thickness", "depth"],
        "everything is per unit thickness: divide forces by it, and multiply forces of the result by it",
    ),
    (
        &["density", "rho", "gravity", "weight", "unit_weight"],
        "write the weight per volume, density times gravity: [body_force] value = [\"0\", \"-7.85e-5\"]",
    ),
    (
        &["force", "forces", "load", "loads", "point_load"],
        "write a force as a traction, force over length of the side (and thickness): [sides.NAME] traction = [\"0\", \"-1\"]; a \
         force on the whole body is [body_force] value",
    ),
    (
        &["moment", "torque"],
        "write a moment as a traction that varies along its side, such as traction = [\"y\", \"0\"] on one that is upright",
    ),
    (
        &["e", "e_modulus", "modulus", "youngs_modulus", "elasticity"],
        "write young = 200.0, in the scene's unit of stress",
    ),
    (&["nu", "poisson_ratio", "poissons_ratio"], "write poisson = 0.3"),
    (
        &["fixed", "fix", "support", "supports", "clamped", "hold", "roller"],
        "write displacement = [\"0\", \"0\"] on the side, \"free\" for a component that may move",
    ),
    (
        &["spring", "stiffness", "foundation", "winkler", "robin", "bedding", "subgrade"],
        "write springs = \"10\" on the side, stress per length, or { normal = \"10\", tangential = \"0\" }",
    ),
    (
        &["mesh", "mesh_size", "element_size"],
        "the mesh follows from method.tolerance; method.elements is the number of the first one",
    ),
];

/// Help for a key that is unknown in a table with these entries: the table where such a key belongs, the replacement of
/// another program's key, or the nearest key.
pub(super) fn help(key: &str, table: &'static Table, entries: &[Entry]) -> String {
    let near = || nearest(key, table.known());
    let elsewhere = || nearest(key, TABLES.iter().flat_map(|table| table.known()));
    let lower = key.to_lowercase();
    let instead = INSTEAD.iter().find(|(words, _)| words.contains(&lower.as_str())).map(|(_, help)| *help);
    match (homes(key, entries), instead) {
        (Some(homes), _) => format!("did you mean {homes}?"),
        (None, Some(help)) => help.to_owned(),
        (None, None) => match elsewhere().filter(|_| near().is_none()).and_then(|key| homes(key, entries)) {
            Some(homes) => format!("did you mean {homes}?"),
            None => suggestion(key, table.known()),
        },
    }
}

/// The full name of a key of a table of fixed keys whose name is not chosen by the user.
pub fn full_key(key: &str) -> Option<String> {
    let has = |table: &&&Table| !table.name.contains("NAME") && table.has(key);
    TABLES.iter().find(has).map(|table| format!("{}.{key}", table.name))
}

/// The full names that end in `key`, of tables among the entries and of `[method]`; None if there are none.
fn homes(key: &str, entries: &[Entry]) -> Option<String> {
    let table = |name: &str| entries.iter().find(|e| e.key == name).map(|e| &e.item);
    let mut homes = Vec::new();
    for name in ["parameters", "random"] {
        if table(name).is_some_and(|names| names.at(&[key]).is_some()) {
            homes.push(format!("{name}.{key}"));
        }
    }
    let is_side = |item: &Item| matches!(&item.value, Value::Text(name) if name == key);
    if let Some(Value::Array(sides)) = table("body").and_then(|body| body.at(&["sides"])).map(|sides| &sides.value)
        && sides.iter().any(is_side)
    {
        homes.push(format!("sides.{key}"));
    }
    let with_key = || TABLES.iter().filter(|table| table.has(key)).map(|table| table.name);
    let is_there = |name: &&str| {
        let path: Vec<&str> = name.split('.').take_while(|key| *key != "NAME").collect();
        *name == "method" || table(path[0]).is_some_and(|first| first.at(&path[1..]).is_some())
    };
    let there: Vec<&str> = with_key().filter(is_there).collect();
    let named = if there.is_empty() && homes.is_empty() { with_key().collect() } else { there };
    // in a list of tables the first one stands for all
    let is_list = |name: &str| table(name).is_some_and(|item| matches!(item.value, Value::Array(_)));
    homes.extend(named.iter().map(|name| format!("{name}{}.{key}", if is_list(name) { ".0" } else { "" })));
    (!homes.is_empty()).then(|| homes.join(" or "))
}

/// Refuses overrides that change nothing: of names that nothing uses, and of `[stochastic]` without random input.
pub(super) fn check_overrides(scene: &Scene, root: &Item) -> Result<(), ReadError> {
    let Value::Table(tables) = &root.value else { return Ok(()) };
    for table in tables {
        let names = match (&table.item.value, table.key.as_str()) {
            (Value::Table(names), "parameters" | "random") => names,
            (_, "stochastic") if table.key_place.source > 0 && scene.random.is_none() => {
                let message = "[stochastic] has no effect: nothing in the scene is random";
                let help = "use a name of [random] in an expression, or leave out this override";
                return Err(ReadError::new(Kind::UnusedKey, table.key_place, message, help));
            }
            _ => continue,
        };
        let is_unused = |entry: &&Entry| scene.unused.contains(&entry.key);
        if let Some(entry) = names.iter().filter(is_unused).find(|entry| entry.key_place.source > 0) {
            let used = names.iter().filter(|entry| !is_unused(entry)).map(|entry| entry.key.as_str());
            let message = format!("{}.{} has no effect: no expression uses {}", table.key, entry.key, entry.key);
            let help = match (nearest(&entry.key, used.clone()), used.clone().next()) {
                (Some(near), _) => format!("did you mean {}.{near}?", table.key),
                (None, Some(_)) => format!("used are {}", used.collect::<Vec<_>>().join(", ")),
                (None, None) => "set the key itself whose value is to change".to_owned(),
            };
            return Err(ReadError::new(Kind::UnusedKey, entry.key_place, message, help));
        }
    }
    Ok(())
}
