//! The page: one file that loads nothing.

use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;
use steklov_figures::{View, drawn, stochastic};
use steklov_io::{File, load_text, load_texts};
use steklov_model::doubt::Doubt;
use steklov_model::run::adaptive_loop::Reason;
use steklov_model::summary::{Probe, Summary};
use steklov_picture::STYLE;
use steklov_plan::Decision;
use steklov_result::history::{StepNumbers, history};
use steklov_result::record::Record;
use steklov_result::store;

use crate::body::body;
use crate::contact::{Node, Side, nodes, sides};
use crate::format::{Piece, html};
use crate::images::{Image, image};
use crate::numbers::{number, pair, rows, usual};
use crate::{LARGEST, ReportError, convergence, told};

const TEMPLATE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("body.js");

/// Texts of a scene, and objects of numbers, with more bytes than this are left out.
const LONGEST_TEXT: usize = 60_000;

/// What is in doubt and what to do about it.
#[derive(Serialize)]
struct Doubted {
    word: &'static str,
    meaning: &'static str,
    remedy: &'static str,
}

/// Results at a point.
#[derive(Serialize)]
struct AtPoint {
    point: String,
    displacement: String,
    stress: String,
    /// Von Mises stress and the principal stresses.
    invariants: [String; 3],
}

/// A number, with its unit, and what is known of its error.
#[derive(Serialize)]
struct Row {
    what: String,
    value: String,
    error: String,
}

/// An entry of `[expect]`.
#[derive(Serialize)]
struct Verdict<'a> {
    path: &'a str,
    value: String,
    expected: String,
    tol: String,
    holds: bool,
}

/// The body to look into.
#[derive(Serialize)]
struct Interactive {
    data: String,
    points: usize,
    triangles: usize,
    has_walls: bool,
}

/// What the page is made of.
#[derive(Serialize)]
struct Page<'a> {
    title: &'a str,
    file: &'a str,
    program: &'static str,
    converged: bool,
    reason: &'a str,
    ending: &'static str,
    advice: Option<String>,
    failure: Option<&'a str>,
    dofs: usize,
    model: &'a str,
    modelled: &'a [Decision],
    left_out: &'a [Decision],
    numbers: Vec<Row>,
    doubts: Vec<Doubted>,
    warnings: Vec<String>,
    expect: Vec<Verdict<'a>>,
    probes: Vec<AtPoint>,
    outcomes: Option<String>,
    steps: Vec<convergence::Row>,
    seconds: String,
    total_seconds: String,
    sides: Vec<Side>,
    nodes: Vec<Node>,
    more_nodes: usize,
    interactive: Option<Interactive>,
    style: &'static str,
    script: &'static str,
    body: Option<Image>,
    charts: Vec<Image>,
    pictures: Vec<Image>,
    /// Pictures without a place on the page.
    without: Vec<String>,
    scene: Option<String>,
    overrides: Vec<String>,
    json: Option<String>,
}

/// The page of a result file; `name` is that of the file.
///
/// # Errors
/// A file that is no result, truncated or altered; a picture that cannot be drawn.
pub fn page(file: &File, name: &str) -> Result<String, ReportError> {
    let (mut stored, steps) = (store::read(file)?, history(file)?);
    stored.summary.file = name.to_owned();
    let failed = |e: serde_json::Error| ReportError::Page(e.to_string());
    let short = |text: String| Some(text).filter(|text| text.len() <= LONGEST_TEXT);
    let summary = &stored.summary;
    let (nodes, more_nodes) = nodes(&stored);
    let interactive = match body(&stored) {
        Some(body) => {
            let [points, triangles] = body.counts();
            let has_walls = body.has_walls();
            Some(Interactive { data: body.json().map_err(failed)?, points, triangles, has_walls })
        }
        None => None,
    };
    let mut page = Page {
        title: &summary.title,
        file: name,
        program: concat!("steklov ", env!("CARGO_PKG_VERSION")),
        converged: summary.converged,
        reason: &summary.reason,
        ending: told::ending(&summary.reason),
        advice: told::advice(summary, &stored.plan),
        failure: summary.failure.as_deref().filter(|_| summary.reason == Reason::Failed.word()),
        dofs: summary.dofs,
        model: &summary.model,
        modelled: &stored.plan.modelled,
        left_out: &stored.plan.left_out,
        numbers: numbers(summary),
        doubts: doubts(summary),
        warnings: warnings(&stored),
        expect: expect(summary),
        probes: summary.probe.iter().map(at_point).collect(),
        outcomes: stored.stochastic.as_ref().map(|_| stochastic::lines(&stored).join("\n")),
        steps: convergence::rows(&steps),
        seconds: convergence::total(&steps),
        total_seconds: number(summary.seconds.total, 3),
        sides: sides(&stored),
        nodes,
        more_nodes,
        interactive,
        style: STYLE,
        script: SCRIPT,
        body: None,
        charts: Vec::new(),
        pictures: Vec::new(),
        without: Vec::new(),
        scene: short(load_text(file, "scene")?),
        overrides: load_texts(file, "overrides")?,
        json: short(serde_json::to_string_pretty(summary).map_err(failed)?),
    };
    add_pictures(&mut page, &stored, &steps)?;
    rendered(&page)
}

/// Adds pictures as far as the page has room: charts, the body, all others.
fn add_pictures(page: &mut Page<'_>, stored: &Record, steps: &[StepNumbers]) -> Result<(), ReportError> {
    let mut left = LARGEST.saturating_sub(rendered(page)?.len());
    let is_shown = page.interactive.is_some();
    let charts = convergence::charts(page.title, steps)?;
    let all = charts.into_iter().chain(drawn(stored, &View::default())?);
    // the interactive picture has the stresses of grids and of the medium around them too
    for (name, picture) in all.filter(|(name, _)| !(is_shown && ["stress", "medium"].contains(&name.as_str()))) {
        let image = image(&name, &picture)?;
        // its words and tags
        let bytes = image.source.len() + image.alternative.len() + 100;
        if bytes > left {
            page.without.push(image.alternative);
            continue;
        }
        left -= bytes;
        match name.as_str() {
            "body" => page.body = Some(image),
            name if name.starts_with("convergence-") => page.charts.push(image),
            _ => page.pictures.push(image),
        }
    }
    Ok(())
}

fn rendered(page: &Page<'_>) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let text = environment.render_named_str("page.html", TEMPLATE, context! { page => Serde(page) });
    text.map_err(|e| ReportError::Page(format!("{e:#}")))
}

fn numbers(summary: &Summary) -> Vec<Row> {
    let cells = |row: crate::numbers::Row| {
        let unit =
            row.unit.name(&summary.units).map_or(String::new(), |unit| html(&[Piece::Words(format!(" {unit}"))]));
        Row { what: row.what, value: html(&row.value) + &unit, error: html(&row.error) }
    };
    rows(summary).into_iter().map(cells).collect()
}

fn doubts(summary: &Summary) -> Vec<Doubted> {
    let known = summary.estimate_doubts.iter().filter_map(|word| Doubt::of_word(word));
    known.map(|d| Doubted { word: d.word(), meaning: d.meaning(), remedy: d.remedy() }).collect()
}

/// What a reader has to know besides doubts.
fn warnings(stored: &Record) -> Vec<String> {
    let summary = &stored.summary;
    let mut all: Vec<String> = summary.grid.as_ref().and_then(told::crossing_warning).into_iter().collect();
    if let Some(result) = &stored.stochastic {
        all.push("the numbers below are those of one solution, of the mean of the random input; means over all outcomes stand under Outcomes".into());
        all.extend(stochastic::shortfall(result).into_iter().chain(stochastic::overlooked(result)));
    }
    all.extend(told::untouched(stored).iter().map(|side| format!("nothing touches side {side}")));
    for reach in &summary.reach {
        let ([a, b], [x, y]) = (&reach.bodies, reach.point);
        let depth = reach.depth;
        all.push(format!(
            "{a} and {b} lie {depth:.3e} in each other at ({x:.6e}, {y:.6e}): name the sides that meet there in an interface"
        ));
    }
    all
}

fn expect(summary: &Summary) -> Vec<Verdict<'_>> {
    let verdict = |entry: &'_ steklov_model::summary::Expected| {
        (entry.value.map_or("none".into(), |value| number(value, 12)), number(entry.expected, 12), number(entry.tol, 3))
    };
    let told = summary.expect.iter().map(|entry| (entry, verdict(entry)));
    told.map(|(entry, (value, expected, tol))| Verdict { path: &entry.path, value, expected, tol, holds: entry.holds })
        .collect()
}

fn at_point(probe: &Probe) -> AtPoint {
    let stress = match probe.stress_unbounded {
        true => "unbounded: infinite at this vertex, whatever the mesh".to_owned(),
        false => format!("({})", probe.stress.map(usual).join(", ")),
    };
    let one = |value: Option<f64>| value.map_or(String::new(), usual);
    let invariants = [probe.von_mises, probe.max_principal, probe.min_principal].map(one);
    AtPoint { point: pair(probe.point), displacement: pair(probe.displacement), stress, invariants }
}
