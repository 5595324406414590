//! Figures of section 2.7: a block on a rigid floor with friction of Tresca's kind.

use steklov_picture::Scale;
use steklov_study::convergence::mesh_picture;

use crate::charts::{Drawing, Line, at, points, range};
use crate::figure::{Entry, Expected, Figure, Runs, Verdict, number};
use crate::runs::Made;

const BLOCK: &str = "The square [-½, ½]², E = 200, ν = 0.3, plane strain, on the floor y = -½ with gap 0 and Tresca's bound 0.3; no side is held. \
    On the left and on the right t = (-400 sign(x) (y+½)(½-y) exp(-10 (y+0.3)²), 10 (y+½)(½-y)), on the top t = (0, -500 (½-x)² (½+x)²).";
const OPEN: &str = "The degree of the first mesh (1 here), and how the body is held along x: friction alone does it, as force and moment \
    balance and the bound 0.3 times the length 1 exceeds the net force 0.";

pub(crate) const FIGURES: [Entry; 5] = [
    Entry {
        name: "fig-2-1",
        number: "Figure 2.1, section 2.7",
        title: "Deformed geometry",
        verdict: Verdict::Chosen,
        set_up: BLOCK,
        seen: "A waist at y of about -0.2, where the von Mises stress is largest at |x| of about 0.3; the top dips in its middle; both lower corners lift.",
        left_open: OPEN,
        differs: &[],
        runs: &["block"],
        range: Some([0.0, 48.0]),
        draw: deformed,
    },
    Entry {
        name: "fig-2-2",
        number: "Figure 2.2, section 2.7",
        title: "Estimated and true errors",
        verdict: Verdict::Chosen,
        set_up: "The same block; first mesh 16 equal elements of degree 1, θ = 0.5, δ = 0.6; uniform-h, h, hp-decay (Algorithm 2.2), and hp, the project's own. \
                 Above the two-level estimate steers and is drawn beside the true error, below the residual estimate.",
        seen: "From 150 unknowns on hp-decay is below h and h below uniform-h, by a factor of 1.1 to 1.4 only, as uniform-h has the best rate of degree 1 already; \
               hp-decay is exponential. Every estimate runs parallel to its true error.",
        left_open: "Which indicator the figure shows (both are drawn), and its norm (the relative energy norm here). The a priori bound (2.82) promises h^¼ only.",
        differs: &[],
        runs: &["block-strategies", "block-residual"],
        range: None,
        draw: errors,
    },
    Entry {
        name: "fig-2-3",
        number: "Figure 2.3, section 2.7",
        title: "Multiplier",
        verdict: Verdict::Same,
        set_up: BLOCK,
        seen: "λ_n has two humps and is 0 beyond the ends of contact, like a square root there; λ_t is +0.3 for x < 0 and -0.3 for x > 0: the shear of the body on the floor, \
               prescribed where they are apart too. A stick zone of exponentially small width is at x = 0.",
        left_open: "",
        differs: &[],
        runs: &["block"],
        range: None,
        draw: multiplier,
    },
    Entry {
        name: "fig-2-4",
        number: "Figure 2.4, section 2.7",
        title: "Adaptive meshes by the two-level indicator",
        verdict: Verdict::Chosen,
        set_up: "The same block; h after 11 steps and hp-decay after 13, the first mesh being step 0. Numbers are degrees.",
        seen: "Short elements at the lower corners and around the ends of contact, long ones of higher degree in the middles; the top stays coarse.",
        left_open: "Whether the source counts the first mesh as step 0 or 1; its counts of elements are in its pictures only.",
        differs: &[],
        runs: &["block-strategies"],
        range: None,
        draw: two_level_meshes,
    },
    Entry {
        name: "fig-2-5",
        number: "Figure 2.5, section 2.7",
        title: "Adaptive meshes by the residual indicator",
        verdict: Verdict::Chosen,
        set_up: "The same block; h after 9 steps and hp-decay after 11.",
        seen: "The same places as in Figure 2.4; residual indicators mark more elements a step.",
        left_open: "As in Figure 2.4.",
        differs: &[],
        runs: &["block-residual"],
        range: None,
        draw: residual_meshes,
    },
];

fn deformed(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let block = runs.get("block")?;
    figure.field(
        runs.drawn("block", "body")?,
        "The deformed block with its von Mises stress, wider at its foot than at its waist",
    );
    figure.row("J", block.number("/energy")?, Expected::About(-2.993_329_193_070_8, 1e-6));
    figure.row("u_x at (-½, -½)", block.number("/probe/0/displacement/0")?, Expected::Near(0.05068, 1e-5));
    figure.row("u_y at (-½, -½)", block.number("/probe/0/displacement/1")?, Expected::Near(0.01137, 1e-5));
    figure.row("force of the floor", block.number("/contact/force/1")?, Expected::About(40.0 / 3.0, 1e-6));
    Ok(())
}

fn multiplier(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let block = runs.get("block")?;
    figure.chart(
        runs.drawn("block", "contact-floor")?,
        "Pressure along the floor with two humps; shear at its bound, positive on the left and negative on the right",
    );
    figure.row("largest pressure at a node", block.number("/contact/max_pressure")?, Expected::Near(18.847, 0.1));
    figure.row("left end of contact", block.number("/contact/ends/0/0")?, Expected::Near(-0.429_014_63, 2e-5));
    figure.row("right end of contact", block.number("/contact/ends/1/0")?, Expected::Near(0.429_014_63, 2e-5));
    Ok(())
}

/// The steps of a strategy in a JSON object.
pub(crate) fn steps<'a>(made: &'a Made, strategy: &str) -> Result<&'a [serde_json::Value], String> {
    let found = made.named("/strategies", "name", strategy)?;
    found["steps"].as_array().map(Vec::as_slice).ok_or_else(|| format!("{strategy} has no steps"))
}

/// The rate of the first fitted law of a strategy.
fn rate(made: &Made, strategy: &str) -> f64 {
    let found = made.named("/strategies", "name", strategy);
    found.map_or(f64::NAN, |s| s["fits"].get(0).map_or(f64::NAN, |fit| number(fit, "rate")))
}

fn errors(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let (two_level, residual) = (runs.get("block-strategies")?, runs.get("block-residual")?);
    let by_strategy = |made: &Made, names: &[&str], estimate: &str| -> Result<Vec<Line>, String> {
        let line = |&name: &&str| {
            let steps = steps(made, name)?;
            let curves = vec![points(steps, "dofs", "error"), points(steps, "dofs", estimate)];
            Ok(Line { name: name.to_owned(), curves })
        };
        names.iter().map(line).collect()
    };
    for (made, title, names, estimate, word) in [
        (
            two_level,
            "Two-level estimate and true error",
            &["uniform-h", "h", "hp-decay", "hp"][..],
            "estimate",
            "two-level",
        ),
        (residual, "Residual estimate and true error", &["uniform-h", "h", "hp-decay"][..], "residual", "residual"),
    ] {
        let picture = Drawing {
            title,
            x: ("degrees of freedom N", Scale::Log),
            y: ("relative error, energy norm", Scale::Log),
            quantities: &["true error", "estimate"],
            lines: by_strategy(made, names, estimate)?,
            guides: &[],
            band: None,
        }
        .draw()?;
        figure.chart(picture, &format!("Errors over unknowns: hp-decay falls below h, h below uniform-h; each {word} estimate is parallel to its error"));
    }
    let uniform = steps(two_level, "uniform-h")?;
    for (dofs, error) in [(32.0, 0.180), (64.0, 0.0635), (128.0, 0.0164), (256.0, 0.00599), (512.0, 0.00250)] {
        let found = at(&points(uniform, "dofs", "error"), dofs);
        figure.row(format!("true error, uniform-h, N = {dofs}"), found, Expected::About(error, 0.05));
    }
    figure.row("rate of uniform-h", rate(two_level, "uniform-h"), Expected::Near(-1.36, 0.05));
    for (made, names, key, [low, high]) in [
        (two_level, &["uniform-h", "h", "hp-decay"][..], "effectivity", [0.9, 1.5]),
        (residual, &["uniform-h", "h", "hp-decay"][..], "residual_effectivity", [2.0, 4.0]),
    ] {
        for name in names {
            let [least, largest] = range(steps(made, name)?.iter().map(|step| number(step, key)));
            let key = key.replace('_', " ");
            figure.row(format!("smallest {key}, {name}"), least, Expected::Between(low, high));
            figure.row(format!("largest {key}, {name}"), largest, Expected::Between(low, high));
        }
    }
    Ok(())
}

fn two_level_meshes(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("block-strategies")?;
    mesh(figure, made, ("h", 11), [86.0, 172.0])?;
    mesh(figure, made, ("hp-decay", 13), [48.0, 196.0])
}

fn residual_meshes(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("block-residual")?;
    mesh(figure, made, ("h", 9), [128.0, 256.0])?;
    mesh(figure, made, ("hp-decay", 11), [52.0, 216.0])
}

/// The mesh of a step of a strategy, and its numbers of elements and unknowns.
fn mesh(
    figure: &mut Figure,
    made: &Made,
    (name, step): (&str, usize),
    [elements, dofs]: [f64; 2],
) -> Result<(), String> {
    let strategy =
        made.strategies.iter().find(|s| s.name == name).ok_or_else(|| format!("there is no strategy {name}"))?;
    let point = strategy.points.get(step).ok_or_else(|| format!("{name} has no step {step}"))?;
    figure.chart(
        mesh_picture("Block", strategy, &[step]).map_err(|e| e.to_string())?,
        &format!("Elements along the four sides after {step} steps of {name}, shorter where the solution is singular"),
    );
    figure.row(format!("elements, {name}, step {step}"), point.mesh.len() as f64, Expected::Near(elements, 0.0));
    figure.row(format!("unknowns, {name}, step {step}"), point.dofs as f64, Expected::Near(dofs, 0.0));
    Ok(())
}
