//! Figures of section 3.5: a block above a wedge-shaped gap, stabilised multipliers.

use steklov_picture::Scale;

use crate::chapter_2::steps;
use crate::charts::{Drawing, Line, at, points};
use crate::figure::{Entry, Expected, Figure, Runs, Verdict};

/// The text on the source's γ, which is too large for some meshes.
pub(crate) const GAMMA: &str = "The source takes γ = 10⁻³ h/p². Its form is coercive (Lemma 3.1) only below a critical γ₀ that follows from the matrices: \
    γ₀E is 0.62 to 0.69 for degree 1 and 0.99 to 1.03 for degree 2, and it is 1 here. If h is the whole length of an element, every mesh of degree 1 and those of degree 2 \
    with 64 or more elements are beyond it, and are refused; degree 3 and higher are not. If h is half of it, γ₀E is 0.5 and all meshes are within: that is the curve γ₀ = 5·10⁻⁴ here. \
    (3.2 writes h/p, 3.5 and Theorem 3.6 write h/p²: p² is what keeps the critical γ₀ from falling with p.)";

pub(crate) const FIGURES: [Entry; 2] = [
    Entry {
        name: "fig-3-1",
        number: "Figure 3.1, section 3.5",
        title: "Deformed geometry above a wedge",
        verdict: Verdict::Chosen,
        set_up: "The square [-½, ½]², E = 1000, ν = 0.3, no load, gap |x|/10 - 0.05, Tresca's bound 0.3, the top held.",
        seen: "The floor wraps around the ridge, and both lower corners rise. The largest pressure at a node is a number of the mesh: the exact one is infinite like 35.03 log(1/|x|).",
        left_open: "Γ_D. It must exist: without it the body rises by 0.05 and nothing is stressed. The top is the only side that keeps Γ_N on both sides of Γ_C.",
        differs: &[],
        runs: &["wedge"],
        range: Some([0.0, 120.0]),
        draw: deformed,
    },
    Entry {
        name: "fig-3-2",
        number: "Figure 3.2, section 3.5",
        title: "Convergence, stabilised and not",
        verdict: Verdict::Differs,
        set_up: "The same block; uniform-h from 16 elements of degree 1 with biorthogonal and with stabilised multipliers, γ_I = γ₀ h_I/p_I² with the whole length h_I, and hp with both.",
        seen: "The curves of uniform-h lie on each other; hp falls exponentially with either multiplier. The source proves h^¼.",
        left_open: "The meshes, and whether h is the length of an element or half of it.",
        differs: &[GAMMA],
        runs: &["wedge-multipliers", "wedge-gamma"],
        range: None,
        draw: convergence,
    },
];

fn deformed(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let wedge = runs.get("wedge")?;
    figure.field(
        runs.drawn("wedge", "body")?,
        "The block pressed down onto a ridge that dents the middle of its floor; von Mises stress is largest there",
    );
    figure.chart(
        runs.drawn("wedge", "contact-floor")?,
        "Pressure on the floor with a peak over the ridge, and shear at its bound",
    );
    figure.row("J", wedge.number("/energy")?, Expected::About(0.647_194_015_987, 1e-6));
    figure.row("force of the floor", wedge.number("/contact/force/1")?, Expected::About(31.1503, 1e-4));
    figure.row("right end of contact", wedge.number("/contact/ends/1/0")?, Expected::Near(0.25999, 2e-5));
    Ok(())
}

fn convergence(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let (both, smaller) = (runs.get("wedge-multipliers")?, runs.get("wedge-gamma")?);
    let mut lines = Vec::new();
    for (name, made, strategy) in [
        ("uniform-h, biorthogonal", both, "uniform-h, biorthogonal"),
        ("uniform-h, stabilised, half of the critical γ₀", both, "uniform-h, stabilised"),
        ("uniform-h, stabilised, γ₀ = 5·10⁻⁴", smaller, "uniform-h"),
        ("hp, biorthogonal", both, "hp, biorthogonal"),
        ("hp, stabilised", both, "hp, stabilised"),
    ] {
        let steps = steps(made, strategy)?;
        let curves = vec![points(steps, "dofs", "error"), points(steps, "dofs", "estimate")];
        lines.push(Line { name: name.to_owned(), curves });
    }
    for (line, expected) in lines.iter().zip([
        [0.111, 0.0557, 0.0286, 0.0153, 0.00839],
        [0.112, 0.0546, 0.0283, 0.0152, 0.00833],
        [0.119, 0.0573, 0.0294, 0.0155, 0.00846],
    ]) {
        for (dofs, error) in [32.0, 64.0, 128.0, 256.0, 512.0].into_iter().zip(expected) {
            let found = at(&line.curves[0], dofs);
            figure.row(format!("true error, {}, N = {dofs}", line.name), found, Expected::About(error, 0.05));
        }
    }
    let picture = Drawing {
        title: "Wedge: true error and estimate",
        x: ("degrees of freedom N", Scale::Log),
        y: ("relative error, energy norm", Scale::Log),
        quantities: &["true error", "estimate"],
        lines,
        guides: &[],
        band: None,
    }
    .draw()?;
    figure
        .chart(picture, "Errors over unknowns: three curves of uniform-h lie on each other, two of hp fall below 10⁻⁴");
    Ok(())
}
