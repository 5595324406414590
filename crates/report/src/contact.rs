//! Contact sides in sums, and their nodes.

use serde::Serialize;
use steklov_model::solve::contact_rows::{ContactRow, TOUCHING};
use steklov_result::record::Record;

use crate::numbers::{number, pair, usual};

/// Nodes of contact that a page shows at most.
const NODES: usize = 600;

/// A side in sums over its nodes.
#[derive(Serialize)]
pub(crate) struct Side {
    name: String,
    nodes: usize,
    length: String,
    stick: String,
    slip: String,
    force: String,
    pressure: String,
}

/// A node.
#[derive(Serialize)]
pub(crate) struct Node {
    side: String,
    state: &'static str,
    numbers: Vec<String>,
}

/// The contact sides of a result.
pub(crate) fn sides(stored: &Record) -> Vec<Side> {
    let largest = stored.contact.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure));
    let names = stored.mesh.side_names.iter().enumerate();
    names.filter_map(|(side, name)| in_sums(name, &of_side(stored, side), largest)).collect()
}

fn of_side(stored: &Record, side: usize) -> Vec<&ContactRow> {
    stored.contact.iter().filter(|row| row.side == side).collect()
}

/// `largest` is the largest pressure of all sides.
fn in_sums(name: &str, rows: &[&ContactRow], largest: f64) -> Option<Side> {
    let touches = |row: &ContactRow| row.pressure > TOUCHING * largest;
    let sticks = |row: &ContactRow| row.status == 1;
    let length = |wanted: &dyn Fn(&ContactRow) -> bool| {
        rows.iter().filter(|row| touches(row) && wanted(row)).map(|row| row.weight).fold(0.0, |a, b| a + b) // sum() of nothing is -0
    };
    let mut force = [0.0; 2];
    for row in rows {
        let [x, y] = row.normal;
        // the tangent is the normal turned by 90 degrees
        force[0] += row.weight * (-row.pressure * x + row.shear * y);
        force[1] += row.weight * (-row.pressure * y - row.shear * x);
    }
    (!rows.is_empty()).then(|| Side {
        name: name.to_owned(),
        nodes: rows.len(),
        length: usual(length(&|_| true)),
        stick: usual(length(&sticks)),
        slip: usual(length(&|row| !sticks(row))),
        force: pair(force),
        pressure: usual(rows.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure))),
    })
}

/// The nodes of all sides, as many as the page shows, and how many more there are.
pub(crate) fn nodes(stored: &Record) -> (Vec<Node>, usize) {
    let node = |row: &ContactRow| {
        let [x, y] = row.point;
        let numbers =
            [x, y, row.gap, row.normal_displacement, row.tangential_displacement, row.pressure, row.shear, row.bound];
        Node {
            side: stored.mesh.side_names[row.side].clone(),
            state: ["apart", "sticks", "slips along +t", "slips along −t"]
                .get(row.status)
                .copied()
                .unwrap_or("unknown"),
            numbers: numbers.map(|value| number(value, 5)).to_vec(),
        }
    };
    let shown = stored.contact.iter().take(NODES).map(node).collect();
    (shown, stored.contact.len().saturating_sub(NODES))
}
