//! The reported numbers of each interface between bodies.

use steklov_problem::{Interface, Law, Place, Scene};

use crate::answer::normals::Normals;
use crate::answer::reach::Entered;
use crate::answer::report::summary_of_sides;
use crate::data::joints::Joint;
use crate::data::on_mesh::{OnMesh, TRACTION_JUMP};
use crate::doubt::Doubt;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, Trace, max_pressure};
use crate::solve::solution::Solved;
use crate::summary::{Audit, InterfaceSummary, NormalsSummary, ReachSummary};
use steklov_contact::Located;

/// The interfaces between bodies, `joints` those of the mesh.
pub(crate) fn interfaces(
    scene: &Scene,
    solved: &Solved,
    joints: &[Joint],
    rows: &[ContactRow],
    located: Option<&[Located]>,
) -> Vec<InterfaceSummary> {
    let data = OnMesh { scene, mesh: &solved.mesh, space: &solved.space };
    let normals = |interface: &Interface| {
        let joint = joints
            .iter()
            .find(|joint| std::ptr::eq(&raw const scene.problem.interfaces()[joint.interface], interface))?;
        let Normals { angle, change } = data.normals(joint, solved.elastic_field());
        Some(NormalsSummary { angle, energy_change: change })
    };
    let mut told = interface_numbers(scene, solved, rows, located);
    for (told, interface) in told.iter_mut().zip(scene.problem.joints()) {
        if told.audit.is_some() {
            told.normals = normals(interface);
        }
    }
    told
}

/// The same without what the directions of their sides say.
pub(crate) fn interface_numbers(
    scene: &Scene,
    solved: &Solved,
    rows: &[ContactRow],
    located: Option<&[Located]>,
) -> Vec<InterfaceSummary> {
    let of = |interface: &Interface| match (&interface.law, &solved.contact) {
        (Law::Contact(_), Some(contact)) => of_contact(scene, solved.trace(), (interface, contact), rows, located),
        _ => of_tie(scene, interface, solved),
    };
    scene.problem.joints().map(of).collect()
}

/// Places where bodies lie in each other beyond the relative error of their displacements.
pub(crate) fn reach(scene: &Scene, solved: &Solved, joints: &[Joint], error: f64) -> Vec<ReachSummary> {
    let data = OnMesh { scene, mesh: &solved.mesh, space: &solved.space };
    let name = |body: usize| scene.problem.bodies[body].name.clone();
    let told = |Entered { bodies, point, depth }| ReachSummary { bodies: bodies.map(name), point, depth };
    data.entered(&solved.displacement, joints, error).into_iter().map(told).collect()
}

/// The doubts about a solution with several bodies.
pub(crate) fn doubts(
    scene: &Scene,
    solved: &Solved,
    interfaces: &[InterfaceSummary],
    reach: &[ReachSummary],
) -> Vec<Doubt> {
    let change: f64 = interfaces.iter().filter_map(|i| i.normals).map(|normals| normals.energy_change).sum();
    // of bodies that move rigidly the strain energy is rounding, of either sign
    let matters = change > scene.method.tolerance() * 2.0 * solved.energies.strain.max(0.0);
    let found = [(Doubt::Normals, matters), (Doubt::Reach, !reach.is_empty())];
    found.into_iter().filter(|(_, is)| *is).map(|(doubt, _)| doubt).collect()
}

fn of_contact(
    scene: &Scene,
    trace: Trace<'_>,
    (interface, contact): (&Interface, &ContactResult),
    rows: &[ContactRow],
    located: Option<&[Located]>,
) -> InterfaceSummary {
    let own: Vec<ContactRow> = rows.iter().filter(|row| interface.sides.contains(&row.side)).cloned().collect();
    let largest = max_pressure(rows);
    let told = summary_of_sides(scene, trace, contact, &own, &interface.sides, largest, located);
    InterfaceSummary {
        name: interface.name.clone(),
        kind: "contact".into(),
        sides: names(scene, interface),
        length: told.length,
        stick: Some(told.stick),
        slip: Some(told.slip),
        max_pressure: Some(told.max_pressure),
        force: told.force,
        ends: told.ends,
        audit: Some(audit(contact, &own, rows)),
        normals: None,
    }
}

fn names(scene: &Scene, interface: &Interface) -> [Vec<String>; 2] {
    let names = |sides: &[usize]| sides.iter().map(|&side| scene.problem.sides[side].name.clone()).collect();
    [names(&interface.sides), names(scene.problem.facing_sides(interface))]
}

/// The measures of the judge over the rows of an interface, relative to the scales of all rows.
fn audit(contact: &ContactResult, own: &[ContactRow], all: &[ContactRow]) -> Audit {
    let largest = |of: &dyn Fn(&ContactRow) -> f64, rows: &[ContactRow]| rows.iter().map(of).fold(0.0, f64::max);
    let length = largest(&|r| r.gap.abs().max(r.normal_displacement.abs()).max(r.tangential_displacement.abs()), all);
    let stress = largest(&|r| r.pressure.abs().max(r.shear.abs()), all);
    let over = |value: f64, scale: f64| if scale > 0.0 { value / scale } else { 0.0 };
    let opening = |r: &ContactRow| r.gap - r.normal_displacement;
    Audit {
        equilibrium: contact.audit.equilibrium,
        penetration: over(largest(&|r| -opening(r), own), length),
        tension: over(largest(&|r| -r.pressure, own), stress),
        complementarity: over(largest(&|r| (r.pressure * opening(r)).abs(), own), stress * length),
        friction: over(largest(&|r| r.shear.abs() - r.bound, own), stress),
    }
}

/// ∫ of the jump of the traction over a tie: the force on the body that is named first less that of the other body on it.
fn jump_of_force(scene: &Scene, interface: &Interface, solved: &Solved) -> [f64; 2] {
    let data = OnMesh { scene, mesh: &solved.mesh, space: &solved.space };
    let mut force = [0.0; 2];
    let summed = data.each_traction(&mut |side, name, expression, factor, direction| {
        if name != TRACTION_JUMP || !interface.sides.contains(&side) {
            return Ok(());
        }
        for (element, moment) in data.integrals(side, name, expression, factor)? {
            force.iter_mut().zip(direction(element)).for_each(|(force, d)| *force += d * moment);
        }
        Ok(())
    });
    // the load has it too
    summed.map_or([f64::NAN; 2], |()| force)
}

/// 1, or -1 where the body that is named second carries the multipliers.
pub(crate) fn sign_of(interface: &Interface) -> f64 {
    if interface.place == Place::Second { -1.0 } else { 1.0 }
}

/// The force of an interface on the body that is named first.
pub(crate) fn force_of(scene: &Scene, interface: &Interface, solved: &Solved) -> [f64; 2] {
    let sign = sign_of(interface);
    let mut force = [0.0; 2];
    match (&interface.law, &solved.contact) {
        (Law::Contact(_), Some(contact)) => {
            for &side in &interface.sides {
                force.iter_mut().zip(contact.force(side)).for_each(|(force, own)| *force += sign * own);
            }
        }
        _ => {
            force = jump_of_force(scene, interface, solved);
            for (_, own) in solved.tie_forces.iter().filter(|(name, _)| *name == interface.name) {
                (0..2).for_each(|i| force[i] += sign * own[i]);
            }
        }
    }
    force
}

fn of_tie(scene: &Scene, interface: &Interface, solved: &Solved) -> InterfaceSummary {
    let own = solved.ties.iter().filter(|tie| tie.name == interface.name);
    let length = own.fold(0.0, |length, tie| length + tie.weight);
    InterfaceSummary {
        name: interface.name.clone(),
        kind: "tied".into(),
        sides: names(scene, interface),
        length,
        stick: None,
        slip: None,
        max_pressure: None,
        force: force_of(scene, interface, solved),
        ends: None,
        audit: None,
        normals: None,
    }
}
