//! Charts that the project adds: measurements of the statements of the source's theorems.

use serde_json::Value;
use steklov_picture::Scale;

use crate::chapter_2::steps;
use crate::charts::{Drawing, Line, at, points, range};
use crate::figure::{Entry, Expected, Figure, Runs, Verdict, number};

const fn own(
    name: &'static str,
    number: &'static str,
    title: &'static str,
    [set_up, seen]: [&'static str; 2],
    runs: &'static [&'static str],
    draw: fn(&Runs<'_>, &mut Figure) -> Result<(), String>,
) -> Entry {
    Entry {
        name,
        number,
        title,
        verdict: Verdict::Own,
        set_up,
        seen,
        left_open: "",
        differs: &[],
        runs,
        range: None,
        draw,
    }
}

const COUPLING: &str = "T* u_c = -S u_c; the equation with W needs W, not 2W; three rigid motions have to be taken out, not two translations (reciprocal condition 10⁻¹⁷ against 10⁻⁴); \
    the d/ds term of the estimate has both signs reversed.";

pub(crate) const FIGURES: [Entry; 12] = [
    own(
        "own-effectivity",
        "Theorems 2.7, 3.5, 3.6, 4.2",
        "Residual and two-level estimates over the true error",
        [
            "Uniform-h on the block, on the wedge with both multipliers, and on the pressed block at its mean modulus.",
            "Each residual estimator is the error times a constant that changes little with the mesh; the two-level estimate is the error to within half.",
        ],
        &["block-residual", "wedge-residual", "pressed-residual"],
        effectivity,
    ),
    own(
        "own-newton",
        "Algorithm 2.1, Theorem 2.4",
        "The semi-smooth Newton method",
        [
            "Block and wedge, 16 to 256 elements of degree 1.",
            "Superlinear: the ratio of an error to the one before falls to 0, and few more iterations are needed on finer meshes.",
        ],
        &["block-newton", "wedge-newton", "block-solvers", "solvers"],
        newton,
    ),
    own(
        "own-inf-sup",
        "Assumption 2.1, section 3.2",
        "Inf-sup constants",
        [
            "Seven pairs of displacements and multipliers on the wedge, with and without stabilisation.",
            "Biorthogonal multipliers are stable at all degrees; discontinuous ones of full degree, shifted and halved elements have the constant 0, which stabilisation lifts.",
        ],
        &["inf-sup"],
        inf_sup,
    ),
    own(
        "own-gamma",
        "Lemma 3.1",
        "The critical stabilisation",
        [
            "Largest γ₀ for which the form is coercive over elements and degree; errors over γ₀ up to it.",
            "The critical γ₀E tends to a constant as elements get smaller, and rises with the degree.",
        ],
        &["stability"],
        gamma,
    ),
    own(
        "own-capacity",
        "Lemma 2.2",
        "The single layer at degenerate sizes",
        [
            "Smallest eigenvalue of V over the diameter of the body, with the length 1 in its logarithm and with the diameter.",
            "With length 1 V is singular at one size and indefinite beyond; with the diameter it is positive at every size.",
        ],
        &["stability"],
        capacity,
    ),
    own(
        "own-solvers",
        "Algorithm 4.1",
        "Iterations of contact solvers",
        [
            "Uzawa, active sets, the interior point method and the semi-smooth Newton method on the pressed block.",
            "Uzawa takes about twice as many on elements half as long; the others do not depend on the mesh.",
        ],
        &["chance"],
        solvers,
    ),
    own(
        "own-chance",
        "Section 4.3",
        "Rules in chance",
        [
            "Errors of mean and variance of J over solves: one element of degree q, elements, sparse grid, Monte Carlo.",
            "Polynomials are exact to rounding with four points; Monte Carlo falls like one over the root of the samples.",
        ],
        &["chance"],
        chance,
    ),
    own(
        "own-bases",
        "Theorem 5.3",
        "Multiscale bases",
        [
            "Five bases on the bar of random cells: energy error over unknowns and seconds, estimate over error.",
            "Bases that follow the moduli along edges are the most accurate; the estimate is twice to three times the error.",
        ],
        &["bases"],
        bases,
    ),
    own(
        "own-resonance",
        "Theorems 5.1, 5.2",
        "Resonance",
        [
            "Layers of moduli 1:10, error over the size H of coarse cells and over the number of periods 1/ε.",
            "The error has its peak at H = ε and falls like H below.",
        ],
        &["bases"],
        resonance,
    ),
    own(
        "own-contrast",
        "Theorem 5.3",
        "High contrast",
        [
            "Stiff parts inside of coarse cells, across their edges and as channels, contrasts from 10 to 10⁶.",
            "Inside of cells a contrast does no harm. Across edges the error tends to 1 and the estimate to a small part of it: from a contrast of 100 along an edge it is in doubt.",
        ],
        &["bases"],
        contrast,
    ),
    Entry {
        differs: &[COUPLING],
        ..own(
            "own-coupling",
            "Theorems 5.5, 5.6",
            "Body and medium",
            [
                "Errors of body and traction of the two-field, Schur and three-field forms for pairs of materials; residual estimate over error by term; wrong signs.",
                "Rate 1 in the body and 2 in the traction; the three forms agree; wrong signs do not converge.",
            ],
            &["inclusion", "coupling"],
            coupling,
        )
    },
    own(
        "own-multiscale-medium",
        "Theorems 5.5, 5.6",
        "Multiscale elements beside a medium",
        [
            "The stiff inclusion of random cells under its own load, the tension far away: multiscale elements of coarse cells of the size H against the coupling on the same fine grid, and the coupling on finer and finer grids against its limit.",
            "The error falls like H^0.9, and that of fine grids like h^0.8; the residual estimator of Theorem 5.6 is 1.6 to 1.9 times the first and 2.5 to 2.7 times the second.",
        ],
        &["coupling"],
        multiscale_medium,
    ),
];

fn effectivity(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let mut lines = Vec::new();
    for (name, run, strategy, [low, high]) in [
        ("block (2.7)", "block-residual", "uniform-h", [2.6, 3.9]),
        ("wedge, biorthogonal (3.5)", "wedge-residual", "uniform-h, biorthogonal", [4.2, 5.4]),
        ("wedge, stabilised (3.6)", "wedge-residual", "uniform-h, stabilised", [3.2, 4.1]),
        ("pressed block (4.2)", "pressed-residual", "uniform-h", [1.75, 2.05]),
    ] {
        let steps = steps(runs.get(run)?, strategy)?;
        let curves = vec![points(steps, "dofs", "residual_effectivity"), points(steps, "dofs", "effectivity")];
        let [least, largest] = range(curves[0].iter().map(|p| p[1]));
        figure.row(format!("smallest residual effectivity, {name}"), least, Expected::Between(low, high));
        figure.row(format!("largest residual effectivity, {name}"), largest, Expected::Between(low, high));
        lines.push(Line { name: name.to_owned(), curves });
    }
    let picture = Drawing {
        title: "Estimates over the true error",
        x: ("degrees of freedom N", Scale::Log),
        y: ("estimate over true error", Scale::Linear),
        quantities: &["residual", "two-level"],
        lines,
        guides: &[],
        band: None,
    }
    .draw()?;
    figure.chart(picture, "Nearly level curves between 1 and 5.3");
    Ok(())
}

fn newton(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    for (run, what, [low, high]) in [("block-newton", "block", [4.0, 8.0]), ("wedge-newton", "wedge", [4.0, 9.0])] {
        let mut lines = Vec::new();
        for step in runs.get(run)?.list("/histories")? {
            let history = step["history"].as_array().map_or(&[][..], Vec::as_slice);
            let curve: Vec<[f64; 2]> =
                history.iter().enumerate().filter_map(|(k, v)| Some([k as f64, v.as_f64()?])).collect();
            let elements = number(step, "dofs") / 2.0;
            figure.row(
                format!("iterations, {what}, {elements} elements"),
                curve.len() as f64 - 1.0,
                Expected::Between(low, high),
            );
            lines.push(Line { name: format!("{elements} elements"), curves: vec![curve] });
        }
        let picture = Drawing {
            title: &format!("Newton's method on the {what}"),
            x: ("iteration", Scale::Linear),
            y: ("measure of the error", Scale::Log),
            quantities: &["measure"],
            lines,
            guides: &[],
            band: None,
        }
        .draw()?;
        figure.chart(picture, &format!("Measures over iterations on the {what}, falling faster and faster"));
    }
    for (run, what) in [("block-solvers", "block"), ("solvers", "wedge")] {
        figure.chart(
            runs.get(run)?.picture("newton-order")?,
            &format!("Error over the error before on the {what}: steeper than slope 1 for small errors"),
        );
    }
    Ok(())
}

fn inf_sup(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("inf-sup")?;
    figure.chart(made.picture("inf-sup-elements-1")?, "Inf-sup constants of degree 1 over the number of elements");
    figure.chart(made.picture("inf-sup-degree")?, "Inf-sup constants of 8 elements over the degree");
    figure.chart(
        made.picture("pressure-floor")?,
        "An oscillating pressure of an unstable pair, and the smooth one with stabilisation",
    );
    let constants = |name: &str, key: &str| -> Result<[f64; 2], String> {
        let pair = made.named("/pairs", "name", name)?;
        Ok(range(pair["points"].as_array().into_iter().flatten().map(|p| number(p, key))))
    };
    let [least, largest] = constants("biorthogonal", "beta")?;
    figure.row("smallest β, biorthogonal", least, Expected::Between(0.76, 0.82));
    figure.row("largest β, biorthogonal", largest, Expected::Between(0.76, 0.82));
    for name in ["P_p, shifted elements", "P_p, halved elements", "discontinuous P_p"] {
        figure.row(format!("smallest β, {name}"), constants(name, "beta")?[0], Expected::Near(0.0, 1e-3));
        figure.row(
            format!("smallest β, {name}, stabilised"),
            constants(name, "beta_stabilised")?[0],
            Expected::Between(0.45, 1.0),
        );
    }
    Ok(())
}

fn gamma(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("stability")?;
    for (name, what) in [
        ("stabilisation-elements", "Critical γ₀E over elements, nearly level"),
        ("stabilisation-degree", "Critical γ₀E over the degree, rising"),
        ("stabilisation-error", "Errors over γ₀ up to the critical one"),
    ] {
        figure.chart(made.picture(name)?, what);
    }
    let critical = made.list("/stabilisation/critical")?;
    for (degree, elements, expected) in
        [(1, 16, 0.6935), (1, 128, 0.6218), (2, 16, 1.031), (2, 128, 0.994), (4, 16, 1.48), (12, 16, 1.96)]
    {
        let found = critical.iter().find(|c| c["degree"] == degree && c["elements"] == elements);
        let value = found.map_or(f64::NAN, |c| number(c, "gamma_critical_young"));
        figure.row(
            format!("critical γ₀E, degree {degree}, {elements} elements"),
            value,
            Expected::About(expected, 0.01),
        );
    }
    Ok(())
}

fn capacity(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("stability")?;
    figure.chart(
        made.picture("single-layer")?,
        "Smallest eigenvalue of V over the diameter, through 0 with the length 1 and constant with the diameter",
    );
    figure.row(
        "diameter at which V is singular",
        made.number("/single_layer/degenerate/0")?,
        Expected::About(3.129_920_8, 1e-6),
    );
    let constant = made.list("/single_layer/points")?.iter().map(|p| number(p, "smallest_diameter"));
    let [least, largest] = range(constant);
    figure.row("smallest eigenvalue with the diameter, least", least, Expected::About(4.45e-2, 0.01));
    figure.row("smallest eigenvalue with the diameter, largest", largest, Expected::About(4.45e-2, 0.01));
    Ok(())
}

/// The points of a solver.
fn of_solver<'a>(list: &'a [Value], name: &str) -> Vec<&'a Value> {
    let found = list.iter().find(|solver| solver["name"] == name);
    found.map_or(Vec::new(), |solver| solver["points"].as_array().into_iter().flatten().collect())
}

fn solvers(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("chance")?;
    figure.chart(made.picture("solver-iterations")?, "Iterations over elements: Uzawa rises, the others are level");
    let all = made.list("/solvers")?;
    for (name, low, high) in [("active set", 2.0, 2.0), ("interior point", 7.0, 8.0), ("semi-smooth Newton", 2.0, 3.0)]
    {
        let [least, largest] = range(of_solver(all, name).into_iter().map(|p| number(p, "iterations")));
        figure.row(format!("fewest iterations, {name}"), least, Expected::Between(low, high));
        figure.row(format!("most iterations, {name}"), largest, Expected::Between(low, high));
    }
    for (point, expected) in of_solver(all, "Uzawa").into_iter().zip([128.0, 242.0, 429.0, 795.0, 1489.0]) {
        figure.row(
            format!("iterations of Uzawa, {} elements", point["elements"]),
            number(point, "iterations"),
            Expected::Near(expected, 0.0),
        );
    }
    Ok(())
}

fn chance(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("chance")?;
    figure.chart(made.picture("mean-energy")?, "Error of the mean of J over solves");
    figure.chart(made.picture("variance-energy")?, "Error of the variance of J over solves");
    figure.chart(made.picture("mean-energy-seconds")?, "Error of the mean of J over seconds");
    let energy = made.named("/chance/quantities", "name", "energy")?;
    let rules = energy["rules"].as_array().map_or(&[][..], Vec::as_slice);
    let rule = |name: &str| rules.iter().find(|rule| rule["name"] == name).and_then(|rule| rule["points"].as_array());
    let one = rule("one element of degree q").ok_or("there is no rule of one element")?;
    let linear = one.iter().find(|p| number(p, "parameter") == 1.0).ok_or("there is no degree 1")?;
    figure.row("error of the mean of J, q = 1", number(linear, "mean_error"), Expected::Between(3e-11, 7e-11));
    figure.row("error of the variance of J, q = 1", number(linear, "variance_error"), Expected::Between(2e-8, 4e-8));
    let samples = rule("Monte Carlo").ok_or("there is no Monte Carlo")?;
    let last = samples.last().map_or(f64::NAN, |p| number(p, "mean_error"));
    figure.row("error of the mean of J, 10,000 samples", last, Expected::Between(0.0, 3e-3));
    Ok(())
}

fn bases(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("bases")?;
    for (name, what) in [
        ("error-dofs", "Energy errors of five bases over unknowns, the oscillatory basis lowest"),
        ("error-size", "Errors in energy and L² norms over the size of coarse cells"),
        ("error-seconds", "The energy errors over seconds"),
        ("effectivity", "Estimate over error, between 1.9 and 2.9"),
    ] {
        figure.chart(made.picture(name)?, what);
    }
    for (name, expected) in
        [("q1", 0.0801), ("linear", 0.0702), ("coupled", 0.0594), ("oscillatory", 0.0438), ("oversampled", 0.0466)]
    {
        let basis = made.named("/bases", "name", name)?;
        let steps = basis["points"].as_array().map_or(&[][..], Vec::as_slice);
        figure.row(
            format!("energy error, 96 by 16, {name}"),
            at(&points(steps, "coarse_x", "error"), 96.0),
            Expected::About(expected, 0.02),
        );
        let effectivities = points(steps, "coarse_x", "effectivity");
        if !effectivities.is_empty() {
            let [least, largest] = range(effectivities.iter().map(|p| p[1]));
            figure.row(format!("smallest estimate over error, {name}"), least, Expected::Between(1.9, 2.9));
            figure.row(format!("largest estimate over error, {name}"), largest, Expected::Between(1.9, 2.9));
        }
    }
    Ok(())
}

fn resonance(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("bases")?;
    figure.chart(
        made.picture("resonance-cells")?,
        "Error over the number of coarse cells, with a peak where they are as large as a period",
    );
    figure.chart(made.picture("resonance-period")?, "Error over the number of periods in four coarse cells");
    let straight: Vec<&Value> =
        made.list("/laminates")?.iter().filter(|l| l["laminate"] == 0 && l["basis"] == 0).collect();
    for (periods, coarse, expected) in [
        (16, 4, 0.428),
        (16, 8, 0.538),
        (16, 16, 0.675),
        (16, 32, 0.094),
        (16, 64, 0.049),
        (4, 4, 0.692),
        (8, 4, 0.561),
        (32, 4, 0.336),
    ] {
        let found = straight.iter().find(|l| l["periods"] == periods && l["coarse"] == coarse);
        let error = found.map_or(f64::NAN, |l| number(l, "error"));
        figure.row(format!("error, ε = 1/{periods}, H = 1/{coarse}"), error, Expected::About(expected, 0.02));
    }
    Ok(())
}

fn contrast(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("bases")?;
    figure.chart(made.picture("contrast-error")?, "Error over contrast: level inside of cells, to 1 across edges");
    figure.chart(made.picture("contrast-effectivity")?, "Estimate over error over contrast, falling across edges");
    // basis coupled, parts across edges
    let across: Vec<&Value> = made.list("/contrast")?.iter().filter(|c| c["part"] == 1 && c["basis"] == 0).collect();
    let of = |contrast: u64, key: &str| {
        across.iter().find(|c| number(c, "contrast") == contrast as f64).map_or(f64::NAN, |c| number(c, key))
    };
    figure.row("error across edges, contrast 10", of(10, "error"), Expected::About(0.573, 0.02));
    figure.row("error across edges, contrast 10⁶", of(1_000_000, "error"), Expected::About(1.0, 0.001));
    figure.row("estimate over error across edges, contrast 10", of(10, "nodal"), Expected::About(2.3, 0.05));
    figure.row("estimate over error across edges, contrast 10⁶", of(1_000_000, "nodal"), Expected::Between(0.0, 0.1));
    Ok(())
}

fn coupling(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    figure.field(
        runs.drawn("inclusion", "medium")?,
        "A stiff inclusion of random cells and the medium around it, von Mises stress",
    );
    let made = runs.get("coupling")?;
    for (name, what) in [
        ("error-cells", "Error of the body over cells, rate 1"),
        ("traction-cells", "Error of the traction over cells, rate 2"),
        ("effectivity-cells", "Residual estimate over error over cells, level"),
        ("effectivity-contrast", "The same over the ratio of the moduli of body and medium"),
        ("conditioning", "Reciprocal condition with two and with three rigid motions taken out"),
        ("wrong-signs", "Errors with wrong signs, which do not fall"),
    ] {
        figure.chart(made.picture(name)?, what);
    }
    let forms = made.list("/forms")?;
    for form in forms {
        let last = form["points"].as_array().and_then(|points| points.last()).ok_or("a form has no points")?;
        let name = form["name"].as_str().unwrap_or_default();
        figure.row(format!("rate of the body, {name}"), number(last, "rate"), Expected::Near(1.0, 0.05));
        figure.row(format!("rate of the traction, {name}"), number(last, "traction_rate"), Expected::Near(1.9, 0.1));
    }
    let soft = made
        .list("/contrast")?
        .iter()
        .find(|c| number(c, "contrast") < 2e-3)
        .map_or(f64::NAN, |c| number(c, "effectivity"));
    figure.row("residual estimate over error, body 1000 times softer", soft, Expected::Between(55.0, 75.0));
    let stiff = made.list("/effectivity")?.last().map_or(f64::NAN, |c| number(c, "effectivity"));
    figure.row("residual estimate over error, the scene's materials", stiff, Expected::About(4.08, 0.02));
    Ok(())
}

fn multiscale_medium(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("coupling")?;
    for (name, what) in [
        ("own-error-coarse", "Errors over the size of coarse cells: the basis coupled below linear and bilinear ones"),
        ("own-error-fine", "Errors of the coupling over the size of fine cells"),
        ("own-effectivity", "Residual estimator over error, level"),
    ] {
        figure.chart(made.picture(name)?, what);
    }
    // over H by the basis coupled on the trace of the coarse cells, and over h by bilinear elements
    let all = made.list("/own_loads/points")?;
    let of = |over: f64, elements: f64| -> Vec<&Value> {
        all.iter().filter(|p| number(p, "over") == over && number(p, "elements") == elements).collect()
    };
    let (coarse, fine) = (of(0.0, 3.0), of(1.0, 0.0));
    let last = |points: &[&Value], key: &str| points.last().map_or(f64::NAN, |p| number(p, key));
    figure.row(
        "error, coupled, H = 1/4 of the side",
        coarse.first().map_or(f64::NAN, |p| number(p, "error")),
        Expected::About(0.179, 0.02),
    );
    figure.row("error, coupled, H = 1/32", last(&coarse, "error"), Expected::About(0.038, 0.02));
    figure.row("rate of the error over H", last(&coarse, "rate"), Expected::Near(0.95, 0.05));
    figure.row("rate of the error over h", last(&fine, "rate"), Expected::Near(0.79, 0.05));
    for (points, what, [low, high]) in [(&coarse, "over H", [1.5, 2.0]), (&fine, "over h", [2.4, 2.8])] {
        let [least, largest] = range(points.iter().map(|p| number(p, "effectivity")));
        figure.row(format!("smallest estimator over error, {what}"), least, Expected::Between(low, high));
        figure.row(format!("largest estimator over error, {what}"), largest, Expected::Between(low, high));
    }
    Ok(())
}
