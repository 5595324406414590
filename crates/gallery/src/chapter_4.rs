//! Figures of section 4.4: a block pressed on a floor with a random modulus.

use steklov_picture::Scale;

use crate::charts::{Drawing, Line, points, slope};
use crate::figure::{Entry, Expected, Figure, Runs, Verdict, number};

const PRESSED: &str =
    "The obstacle is said to occupy x₂ < -0.5, which would be the gap 0; the gap -0.2 presses the body by 0.2.";
const KERNEL: &str = "In 4.1 G has the sign of its logarithm reversed and β₁ twice too large; with (3-4ν)(1+ν)/(4π(1-ν)) it is the G of 2.1.";
const VALUES: &str = "The source gives J = 28.6199 and ⟨u, Su⟩ = 57.2398. The first is half of the second to all digits, so that ⟨t, u⟩ = J̃/2 - J would be 0, but the load does work (-0.204). \
    And with the whole top held ⟨u, Su⟩ is at least that of rollers without friction, 0.2² · 2000/(1-0.3²) = 87.91. No reading of the text that was tried gives its numbers: with β₁ as printed in 4.1, \
    in V alone, ⟨u, Su⟩ is 55.8; with only the middle 0.3 of the top held it is 57.5. They are not used as references.";

pub(crate) const FIGURES: [Entry; 2] = [
    Entry {
        name: "fig-4-1",
        number: "Figure 4.1, section 4.4",
        title: "Deformed geometry at the mean modulus",
        verdict: Verdict::Differs,
        set_up: "The square [-½, ½]², the top held, overlap 0.2 with the floor (gap -0.2), Tresca's bound 0.3, t = (0, -1) on the left and on the right, ν = 0.3, E = 2000 + 200 ξ/√3 with ξ uniform on ±√3, \
                 so E uniform from 1800 to 2200. Drawn at E = 2000.",
        seen: "All of the floor is in contact and the sides bulge. The outline does not depend on E to 2·10⁻⁵: the overlap prescribes it, and pressures are proportional to E.",
        left_open: "Γ_D (the top), and where t acts (on the left and on the right).",
        differs: &[PRESSED, KERNEL],
        runs: &["pressed", "pressed-uzawa"],
        range: Some([0.0, 800.0]),
        draw: deformed,
    },
    Entry {
        name: "fig-4-2",
        number: "Figure 4.2, section 4.4",
        title: "Convergence of the stochastic problem",
        verdict: Verdict::Differs,
        set_up: "The same block: errors of E[J] and of E⟨u, Su⟩ of uniform-h with p = 1 and degree q = 0 in chance, the same with q = 3, uniform-p on 16 elements with q = 3, and hp.",
        seen: "Straight lines, p steeper than h; q = 0 cannot be told from q = 3, because J is nearly linear in E and one point integrates that. The held corners have the exponent 0.7112, so that in the limit h tends to N^-1.42 and p to N^-2.84.",
        left_open: "",
        differs: &[VALUES],
        runs: &["chance", "pressed"],
        range: None,
        draw: convergence,
    },
];

fn deformed(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let (pressed, uzawa) = (runs.get("pressed")?, runs.get("pressed-uzawa")?);
    figure.field(runs.drawn("pressed", "body")?, "The block pressed flat by its floor, its sides bulging outwards");
    let force = "/stochastic/contact/force/y";
    figure.row("mean force of the floor", pressed.number(&format!("{force}/mean"))?, Expected::About(451.45, 1e-4));
    let variance = pressed.number(&format!("{force}/variance"))?;
    figure.row("standard deviation of this force", variance.sqrt(), Expected::Near(26.0, 0.05));
    figure.row(
        "iterations of Uzawa, mean outcome, last mesh",
        uzawa.number("/iterations")?,
        Expected::Near(434.0, 0.0),
    );
    let record = pressed.record.as_ref().ok_or("the run has no record")?;
    let largest = record.displacement.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    figure.row("largest displacement at the mean modulus", largest, Expected::Near(0.205, 5e-4));
    let outcomes = record.stochastic.as_ref().ok_or("the run has no outcomes")?;
    let variance = outcomes.displacement.variance.iter().copied().fold(0.0, f64::max);
    figure.row("largest standard deviation of a displacement", variance.sqrt(), Expected::About(1.7e-5, 0.05));
    Ok(())
}

fn convergence(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("chance")?;
    let curves = made.list("/space/curves")?;
    let mut lines = Vec::new();
    for curve in curves {
        let name = curve["name"].as_str().unwrap_or_default();
        let steps = curve["points"].as_array().map_or(&[][..], Vec::as_slice);
        let both = vec![points(steps, "dofs", "energy_error"), points(steps, "dofs", "norm_squared_error")];
        lines.push(Line { name: name.to_owned(), curves: both });
    }
    for (name, rate) in [("uniform-h, p = 1", -1.51), ("uniform-p", -2.70)] {
        let line = lines.iter().find(|line| line.name == name).ok_or_else(|| format!("there is no curve {name}"))?;
        figure.row(format!("rate of E[J], {name}"), slope(&line.curves[0]), Expected::Near(rate, 0.1));
    }
    let reference = made.json.pointer("/space/reference").ok_or("there is no reference")?;
    figure.row_of_source(
        "E[J], friction work in it",
        number(reference, "energy"),
        Expected::About(45.250_627, 1e-6),
        "28.6199",
    );
    // the displacements do not depend on the modulus, and neither does the friction work
    let without = number(reference, "energy") - runs.get("pressed")?.number("/friction_work")?;
    figure.row_of_source("E[J], friction work not in it", without, Expected::Near(45.2439, 1e-4), "28.6199");
    let norm = number(reference, "norm_squared");
    figure.row_of_source("E⟨u, Su⟩", norm, Expected::About(90.079_800, 1e-6), "57.2398");
    let picture = Drawing {
        title: "Pressed block: errors of E[J] and of E⟨u, Su⟩",
        x: ("degrees of freedom N", Scale::Log),
        y: ("relative error", Scale::Log),
        quantities: &["E[J]", "E⟨u, Su⟩"],
        lines,
        guides: &[],
        band: None,
    }
    .draw()?;
    figure.chart(picture, "Relative errors over unknowns: two curves of uniform-h lie on each other, uniform-p is steeper, hp the steepest");
    let uzawa = made.named("/solvers", "name", "Uzawa")?;
    for (elements, iterations) in [(16, 128.0), (256, 1489.0)] {
        let of = uzawa["points"].as_array().into_iter().flatten().find(|p| p["elements"] == elements);
        let found = of.map_or(f64::NAN, |p| number(p, "iterations"));
        figure.row_of_source(
            &format!("iterations of Uzawa, {elements} elements"),
            found,
            Expected::Near(iterations, 0.0),
            "more than 300",
        );
    }
    Ok(())
}
