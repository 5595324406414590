//! The numbers of a run.

use std::collections::BTreeMap;

use steklov_contact::Kkt;
use steklov_problem::{Law, Scene, Solver, facets};

use crate::answer::probes;
use crate::answer::report::contact_summary;
use crate::answer::singular_points;
use crate::answer::small_strain::is_large;
use crate::bars::ROUNDED;
use crate::contact_length::{ends_at_corners_are_known, of_vertices};
use crate::doubt::Doubt;
use crate::estimators::Estimators;
use crate::quantities::told::{Told, quantities};
use crate::quantities::{Quantities, Quantity, contact_between, named};
use crate::run::adaptive_loop::{Model, Reason, Run};
use crate::run::expect::expected;
use crate::run::report::{OfMeans, Report};
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, Trace, contact_rows};
use crate::stochastic::{self, StochasticResult};
use crate::summary::{
    Audit, ContactSummary, InterfaceSummary, MediumSummary, SecondsSummary, Summary, peak_memory_bytes,
};
use crate::zone_bars::{Zones, lengths_of_nodes, off_by_nodes, rubs};

impl Summary {
    /// The numbers of a run, with all outcomes of its random input if they were solved.
    pub fn of_run<M: Model>(scene: &Scene, run: &Run<M>, outcomes: Option<&StochasticResult>) -> Self {
        summary_and_contact(scene, run, outcomes).0
    }
}

/// Adds the lengths of contact, stick and slip, of all contact and of each interface in contact; a length of contact that is there already is
/// better known.
fn add_lengths(quantities: &mut Quantities, zones: Zones<'_>, doubts: &[String]) {
    let with = |[value, uncertainty]: [f64; 2]| Quantity {
        value,
        uncertainty,
        doubts: doubts.to_vec(),
        parts: BTreeMap::new(),
    };
    let sides = zones.scene.contacts().map(|(side, _)| side).collect();
    let own = contact_between(zones.scene).map(|(number, own)| (format!("interfaces.{number}"), own.sides.clone()));
    for (of, sides) in std::iter::once(("contact".to_owned(), sides)).chain(own) {
        let [Some(length), stick] = zones.lengths(&sides) else { continue };
        let length = quantities.entry(format!("{of}.length")).or_insert_with(|| with(length)).clone();
        // while the sets change stick may be anywhere
        let settled = !doubts.iter().any(|doubt| doubt == Doubt::Sets.word());
        let Some([stick, of_stick]) = stick.filter(|_| settled) else { continue };
        quantities.insert(format!("{of}.stick"), with([stick, of_stick]));
        let slip = [length.value - stick, length.uncertainty + of_stick];
        quantities.insert(format!("{of}.slip"), with(slip));
    }
}

/// Adds the coordinates of the ends of contact that are located, of all contact or of an interface.
fn add_ends(quantities: &mut Quantities, zones: Zones<'_>, (of, ends): (&str, &[[f64; 2]]), doubts: &[String]) {
    for (k, (end, off)) in ends.iter().zip(zones.ends(ends)).enumerate() {
        for (i, uncertainty) in off.into_iter().flatten().enumerate() {
            let quantity = Quantity { value: end[i], uncertainty, doubts: doubts.to_vec(), parts: BTreeMap::new() };
            quantities.insert(format!("{of}.ends.{k}.{}", ["x", "y"][i]), quantity);
        }
    }
}

/// Adds the lengths of ties, which the geometry gives.
fn add_lengths_of_ties(quantities: &mut Quantities, scene: &Scene, interfaces: &[InterfaceSummary]) {
    for (number, (own, told)) in scene.problem.joints().zip(interfaces).enumerate() {
        if matches!(own.law, Law::Tied(_)) {
            let (value, uncertainty) = (told.length, ROUNDED * told.length);
            let quantity = Quantity { value, uncertainty, doubts: Vec::new(), parts: BTreeMap::new() };
            quantities.insert(format!("interfaces.{number}.length"), quantity);
        }
    }
}

/// Adds lengths of contact, stick and slip with their uncertainties.
fn add_all_lengths(quantities: &mut Quantities, lengths: [(f64, f64); 3], doubts: &[String]) {
    for (name, (value, uncertainty)) in ["length", "stick", "slip"].into_iter().zip(lengths) {
        let quantity = Quantity { value, uncertainty, doubts: doubts.to_vec(), parts: BTreeMap::new() };
        quantities.insert(format!("contact.{name}"), quantity);
    }
}

/// Adds the lengths of all contact, stick and slip that nodes tell: on a grid, and where meshes do not follow the ends of contact; else the
/// length of contact with the error bar of nodes where there is no other one.
fn add_lengths_of_nodes(
    quantities: &mut Quantities,
    scene: &Scene,
    (trace, contact, rows): (Trace<'_>, &ContactResult, &[ContactRow]),
    (told, by_nodes, known_at_corners): (&ContactSummary, bool, bool),
    doubts: &[String],
) {
    let edges = scene.problem.outline.edges();
    let [[length, of_length], stick] = lengths_of_nodes(trace, (contact, rows), edges, known_at_corners);
    // a body may touch between the nodes
    if length == 0.0 || !by_nodes && quantities.contains_key("contact.length") {
        return;
    }
    if !by_nodes {
        let uncertainty = of_length + (told.length - length).abs();
        let quantity = Quantity { value: told.length, uncertainty, doubts: doubts.to_vec(), parts: BTreeMap::new() };
        quantities.insert("contact.length".to_owned(), quantity);
        return;
    }
    let [stick, of_stick] = if scene.contacts().any(|(side, _)| rubs(scene, side)) { stick } else { [0.0; 2] };
    let all = [(length, of_length), (stick, of_stick), (length - stick, of_length + of_stick)];
    add_all_lengths(quantities, all, doubts);
}

/// Adds those in the mean over outcomes, which tell the lengths of their nodes.
fn add_lengths_of_outcomes(
    of_mesh: &mut Quantities,
    scene: &Scene,
    (told, [of_length, of_stick]): (&ContactSummary, [f64; 2]),
    doubts: &[String],
) {
    let of_stick = if scene.contacts().any(|(side, _)| rubs(scene, side)) { of_stick } else { 0.0 };
    let all = [(told.length, of_length), (told.stick, of_stick), (told.slip, of_length + of_stick)];
    add_all_lengths(of_mesh, all, doubts);
}

/// The numbers of a run, and the contact table.
pub(crate) fn summary_and_contact<M: Model>(
    scene: &Scene,
    run: &Run<M>,
    outcomes: Option<&StochasticResult>,
) -> (Summary, Vec<ContactRow>) {
    let report = M::report(scene, run);
    let rows = report.contact.map_or(Vec::new(), |contact| contact_rows(report.trace, contact));
    (answer(scene, run, report, &rows, outcomes), rows)
}

/// The numbers of a run with all outcomes of its random input; `report` is that of its last solution, `rows` are those of the
/// contact table.
pub fn answer<M: Model>(
    scene: &Scene,
    run: &Run<M>,
    report: Report<'_>,
    rows: &[ContactRow],
    outcomes: Option<&StochasticResult>,
) -> Summary {
    let Report { energies, contact, mut probe, mut lines, mut sides, exterior, named: mut values, .. } = report;
    let exact = M::is_exact(run);
    // an exact field has no singular part
    let singular = if exact { Vec::new() } else { singular_points::singular_points(scene, report.trace.mesh, rows) };
    let infinite = singular_points::is_among(scene, &singular);
    probes::tell_unbounded(&mut probe, &mut lines, &mut sides, &infinite);
    probes::tell_invariants(scene, &mut probe);
    report.bars.tell(&mut values);
    // beside an infinite shear a finite pressure has no digits
    let is_beside = rows.iter().any(|row| infinite(row.point));
    let named = named(scene, &values, infinite);
    let told = || singular_points::told(scene, report.trace.mesh, rows, singular);
    let infinite_stress = if exact { Vec::new() } else { told() };
    let mut doubts = report.doubts;
    doubts.extend(exterior.iter().filter_map(MediumSummary::doubt));
    if outcomes.is_some_and(|result| result.is_doubtful()) {
        doubts.push(Doubt::Outcomes);
    }
    if is_large(scene, report.trace) {
        doubts.push(Doubt::Large);
    }
    if !facets(&scene.problem.outline).is_empty() {
        doubts.push(Doubt::Facets);
    }
    let doubts: Vec<String> = doubts.iter().map(|doubt| doubt.word().to_owned()).collect();
    let contact_in_numbers = contact.map(|c| contact_summary(scene, report.trace, c, rows, report.located));
    // without ends the length is that of nodes
    let off = report.located.filter(|_| ends_at_corners_are_known(scene, rows));
    let off = off.and_then(|located| of_vertices(scene, located));
    let by_ends = contact_in_numbers.as_ref().filter(|told| told.ends.is_some());
    let length = by_ends.zip(off).map(|(told, off)| [told.length, off]);
    let is_pressed = |told: &ContactSummary| told.max_pressure > 0.0 && !told.max_pressure_unbounded;
    let peak = contact_in_numbers.as_ref().filter(|told| !is_beside && is_pressed(told)).map(|told| told.max_pressure);
    let energy = (energies.total, report.energy);
    let force = contact_in_numbers.as_ref().map(|told| told.force);
    let told = Told {
        energy,
        probes: &probe,
        named: &named,
        near: &report.near,
        parts_of_energy: [energies.strain, energies.load_work],
        reactions: report.reactions,
        force,
        length,
        rows,
        peak,
        largest_at: report.largest_stress.map(|largest| largest.point),
        interfaces: &report.interfaces,
        doubts: &doubts,
        is_exact: exact,
    };
    let mut of_means = Quantities::new();
    if let (Some(result), Some(OfMeans { bars, energy, lengths })) = (outcomes, &report.over_outcomes) {
        let of_mean = energy.map(|[more, uncertainty]| [energies.total + more, uncertainty]);
        let told = Told { energy: (energies.total, of_mean), length: None, ..told };
        let mut of_mesh = quantities(scene, bars, told);
        if let (Some(lengths), Some(told)) = (lengths, &contact_in_numbers) {
            add_lengths_of_outcomes(&mut of_mesh, scene, (told, *lengths), &doubts);
        }
        of_means = stochastic::with_bars(result, &of_mesh);
    }
    let mut quantities = quantities(scene, &report.bars, told);
    quantities.extend(of_means);
    // nothing says which end belongs to which of several interfaces
    let several = scene.problem.interfaces().len() > 1 && scene.problem.has_several_bodies();
    if let (Some(contact), Some(located), Some(off)) = (contact, report.located, &report.off) {
        let off = &off_by_nodes(scene, report.trace, (contact, rows), (located, off));
        let zones = Zones { scene, trace: report.trace, contact, rows, located, off, is_exact: exact };
        add_lengths(&mut quantities, zones, &doubts);
        let ends = contact_in_numbers.as_ref().and_then(|told| told.ends.as_deref()).filter(|_| !several);
        add_ends(&mut quantities, zones, ("contact", ends.unwrap_or_default()), &doubts);
        for (number, own) in report.interfaces.iter().enumerate() {
            let ends = own.ends.as_deref().unwrap_or_default();
            add_ends(&mut quantities, zones, (&format!("interfaces.{number}"), ends), &doubts);
        }
    }
    add_lengths_of_ties(&mut quantities, scene, &report.interfaces);
    if let (Some(contact), Some(told)) = (contact, &contact_in_numbers) {
        let by_nodes = report.located.is_none();
        let known_at_corners = exact || report.grid.is_some() && ends_at_corners_are_known(scene, rows);
        let of_nodes = (told, by_nodes, known_at_corners);
        add_lengths_of_nodes(&mut quantities, scene, (report.trace, contact, rows), of_nodes, &doubts);
    }
    let with_peak = |(number, told): (usize, InterfaceSummary)| {
        let peak = quantities.get(&format!("interfaces.{number}.max_pressure")).map(|peak| peak.value);
        InterfaceSummary { max_pressure: peak.or(told.max_pressure), ..told }
    };
    let interfaces = report.interfaces.into_iter().enumerate().map(with_peak).collect();
    let mut summary = Summary {
        title: scene.title.clone(),
        units: scene.units.clone(),
        model: scene.model().word().into(),
        file: String::new(),
        converged: run.converged(),
        reason: run.reason.word().into(),
        failure: run.error.as_ref().map(ToString::to_string).or_else(|| {
            let solver = run.reason == Reason::Solver;
            solver.then(|| unsolved(scene, contact, outcomes.map_or(0, |result| result.unconverged)))
        }),
        dofs: run.step().dofs,
        steps: run.progress.steps.len(),
        energy: energies.total,
        energy_extrapolated: report.energy.map(|[energy, _]| energy),
        energy_uncertainty: report.energy.map(|[_, uncertainty]| uncertainty),
        strain_energy: energies.strain,
        spring_energy: scene.problem.has_springs().then_some(energies.springs),
        load_work: energies.load_work,
        friction_work: energies.friction_work,
        estimate: report.error.map(|[error, _]| error),
        estimate_relative: report.error.map(|[_, relative]| relative),
        estimate_doubts: doubts,
        estimators: report
            .estimators
            .map(|own| Estimators { stochastic: outcomes.and_then(|result| result.estimator.clone()), ..own }),
        iterations: contact.map_or(0, |c| c.reported().iterations),
        contact: contact_in_numbers.map(|told| {
            let max_pressure = quantities.get("contact.max_pressure").map_or(told.max_pressure, |peak| peak.value);
            ContactSummary { ends: told.ends.filter(|_| !several), max_pressure, ..told }
        }),
        bodies: report.bodies,
        interfaces,
        reach: report.reach,
        audit: contact.map(|c| audit_summary(&c.audit)),
        reactions: report.reactions.iter().cloned().collect(),
        named,
        probe,
        infinite_stress,
        max_von_mises: report.largest_stress.map(|largest| largest.value),
        max_von_mises_at: report.largest_stress.map(|largest| largest.point),
        probe_lines: lines,
        probe_sides: sides,
        quantities,
        stochastic: scene.random.as_ref().zip(outcomes).map(|(random, result)| stochastic::json(random, result)),
        grid: report.grid,
        exterior,
        seconds: SecondsSummary::of_steps(run.seconds()),
        peak_memory_bytes: peak_memory_bytes(),
        expect: Vec::new(),
    };
    summary.expect = expected(scene, &summary);
    summary
}

/// What the solver left undone, and what to do about it.
fn unsolved(scene: &Scene, contact: Option<&ContactResult>, outcomes: usize) -> String {
    let nearer = match scene.problem.has_springs() {
        true => {
            "bring lengths, gaps, loads, Young's modulus and the stiffness of springs (stress/length) nearer to each other"
        }
        false => "bring lengths, gaps, loads and Young's modulus nearer to each other",
    };
    let Some(contact) = contact else {
        return format!("the forces balance to few digits only: {nearer}");
    };
    if contact.converged() && outcomes > 0 {
        return format!("contact of {outcomes} outcomes is not solved: solve one of them alone to see why");
    }
    let Kkt { equilibrium, penetration, tension, complementarity, friction } = contact.audit;
    let remedy = match scene.method.solver {
        Solver::Auto if contact.converged() => format!("the forces balance only as far as that, {nearer}"),
        Solver::Auto if contact.coulomb.is_some() => {
            "no solution under Coulomb's law was found on this mesh: lower the friction coefficients, or try another number of \
             method.elements"
                .to_owned()
        }
        Solver::Auto => format!("the contact conditions hold only as far as that, {nearer}"),
        _ => "the solver that method.solver names did not reach its criterion: leave that at \"auto\"".to_owned(),
    };
    format!(
        "after {} iterations equilibrium is off by {equilibrium:.1e}, penetration {penetration:.1e}, tension {tension:.1e}, \
         complementarity {complementarity:.1e}, friction {friction:.1e}: {remedy}",
        contact.reported().iterations
    )
}

/// The judge's measures as they are reported.
pub(crate) fn audit_summary(audit: &Kkt) -> Audit {
    Audit {
        equilibrium: audit.equilibrium,
        penetration: audit.penetration,
        tension: audit.tension,
        complementarity: audit.complementarity,
        friction: audit.friction,
    }
}
