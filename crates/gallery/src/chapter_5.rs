//! Figures of sections 5.3.1 and 5.7: multiscale basis functions and two bars.

use steklov_figures::{difference, difference_picture};
use steklov_msfem::{Basis, Multiscale};

use crate::charts::range;
use crate::figure::{Entry, Expected, Figure, Runs, Verdict};
use crate::runs::Made;

const EXAMPLE: &str = "Neither supports nor load are given.";
const BAR: &str = "Bar 6 by 1, ν = 0.3, fine cells of 1/32; the left side held, the shear traction (0, -1) on the right; basis `coupled`.";
const ACCURACY: &str = "A multiscale element on coarse cells is a function of the fine grid, so that with an energy-best solution it cannot be more accurate than bilinear elements on that grid; \
    it is more accurate than bilinear elements on the coarse cells (.0838 against .0998) with the same number of unknowns. Its stresses show the same order. \
    Nor do good results of finite elements need cells smaller than those of the moduli: at h = L_h their energy error is 5.9 %.";

const GRIDS: [&str; 5] = ["12 by 2", "24 by 4", "48 by 8", "96 by 16", "finite elements"];

pub(crate) const FIGURES: [Entry; 5] = [
    Entry {
        name: "fig-5-1",
        number: "Figures 5.1 and 5.2, section 5.3.1",
        title: "Multiscale basis functions",
        verdict: Verdict::Same,
        set_up: "One coarse cell of 16 by 16 fine cells, ν = 0.3: homogeneous, and with random moduli. For the basis `linear` one component is prescribed on its boundary and the other is dropped, for `coupled` both are prescribed. Figure 5.3 is a sketch of the method without a result and is left out.",
        seen: "The x component of the function of a corner falls from 1 there to 0 on the two far edges; its y component is a bubble that is 0 on the boundary, with the other sign at the neighbouring corner.",
        left_open: "",
        differs: &[],
        runs: &["bar-12", "cells-12"],
        range: None,
        draw: bases,
    },
    Entry {
        name: "fig-5-4",
        number: "Figures 5.4 to 5.8, section 5.7",
        title: "Homogeneous bar, four coarse grids and finite elements",
        verdict: Verdict::Chosen,
        set_up: BAR,
        seen: "At 12 by 2 the stress jumps between coarse cells: the bending of a cell is not in its linear edges. From 48 by 8 on there is no difference to the eye.",
        left_open: "Supports and load: the left side held, a shear traction on the right. E = 2000.",
        differs: &[EXAMPLE],
        runs: &["bar-12", "bar-24", "bar-48", "bar-96", "bar-fem"],
        range: Some([0.0, 34.0]),
        draw: homogeneous,
    },
    Entry {
        name: "fig-5-9",
        number: "Figure 5.9, section 5.7",
        title: "Moduli of the heterogeneous bar",
        verdict: Verdict::Chosen,
        set_up: "192 by 32 cells of 1/32, E uniform in [2000, 3000], ν = 0.3 in all cells (the caption of the source promises Poisson's ratio, its text says that it is constant).",
        seen: "Grains of one cell without a pattern.",
        left_open: "The random numbers (seed 2014 here).",
        differs: &[],
        runs: &["cells-96"],
        range: None,
        draw: moduli,
    },
    Entry {
        name: "fig-5-10",
        number: "Figure 5.10, section 5.7",
        title: "Deformed geometry of the heterogeneous bar",
        verdict: Verdict::Chosen,
        set_up: BAR,
        seen: "The bar bends downwards as a homogeneous one would.",
        left_open: "Supports and load, as before.",
        differs: &[EXAMPLE],
        runs: &["cells-96"],
        range: None,
        draw: bent,
    },
    Entry {
        name: "fig-5-11",
        number: "Figures 5.11 and 5.12, section 5.7",
        title: "Stress of the heterogeneous bar",
        verdict: Verdict::Differs,
        set_up: "The same bar by 96 by 16 coarse cells, and by finite elements on 1536 by 256 cells.",
        seen: "Both show the stress of bending with grains of the size of the cells.",
        left_open: "Supports and load, as before.",
        differs: &[ACCURACY, EXAMPLE],
        runs: &["cells-12", "cells-24", "cells-48", "cells-96", "cells-fem", "cells-fine"],
        range: Some([0.0, 38.0]),
        draw: heterogeneous,
    },
];

/// The compliance: the work of the loads, twice the strain energy. Energy errors refer to a solution in the same or a
/// larger space.
fn compliance(made: &Made) -> Result<f64, String> {
    made.number("/load_work")
}

fn bases(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    for (name, what) in [("bar-12", "a homogeneous cell"), ("cells-12", "a cell of random moduli")] {
        figure.field(
            runs.drawn(name, "basis")?,
            &format!("Components of basis functions of {what}, as fields on the cell"),
        );
        figure.field(
            runs.drawn(name, "basis-deformed")?,
            &format!("The outline of {what}, dashed, and as the functions of all corners displace it"),
        );
    }
    let record = runs.get("bar-12")?.record.as_ref().and_then(|record| record.on_grid.as_ref());
    let (body, mesh) = record.and_then(|r| Some((&r.body, r.coarse.clone()?))).ok_or("the run has no coarse cells")?;
    let all = Multiscale::new(body, mesh, Basis::Coupled).map_err(|e| e.to_string())?;
    let cell = all.cell_basis(0).map_err(|e| e.to_string())?;
    let largest =
        |column: usize| cell.values.iter().skip(1).step_by(2).map(|row| row[column].abs()).fold(0.0, f64::max);
    figure.row("largest y component of an x function, homogeneous cell", largest(0), Expected::Near(0.0853, 5e-5));
    Ok(())
}

fn homogeneous(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let names = ["bar-12", "bar-24", "bar-48", "bar-96", "bar-fem"];
    let made: Vec<&Made> = names.iter().map(|name| runs.get(name)).collect::<Result<_, _>>()?;
    let fine = compliance(made[4])?;
    for (grid, name) in GRIDS.iter().zip(names) {
        let what = format!("Von Mises stress of the bar, {grid}: bending, largest at the held end");
        figure.field(runs.drawn(name, "stress")?, &what);
    }
    for ((grid, made), expected) in GRIDS.iter().zip(&made).zip([0.38225, 0.39459, 0.39831, 0.39945, 0.39986]) {
        figure.row(format!("compliance, {grid}"), compliance(made)?, Expected::Near(expected, 1e-5));
    }
    for ((grid, made), expected) in GRIDS.iter().zip(&made).zip([0.2099, 0.1149, 0.0623, 0.0321]) {
        let error = (1.0 - compliance(made)? / fine).sqrt();
        figure.row(format!("energy error against finite elements, {grid}"), error, Expected::About(expected, 0.05));
    }
    for ((grid, made), expected) in GRIDS.iter().zip(&made).zip([78.0, 250.0, 882.0, 3298.0, 12738.0]) {
        figure.row(format!("unknowns, {grid}"), made.number("/dofs")?, Expected::Near(expected, 0.0));
    }
    Ok(())
}

fn moduli(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("cells-96")?;
    figure.field(runs.drawn("cells-96", "moduli")?, "Young's modulus of 192 by 32 cells, without a pattern");
    let young = made.record.as_ref().and_then(|record| record.on_grid.as_ref()).map(|grid| &grid.body.young);
    let young = young.ok_or("the run has no grid")?;
    let [low, high] = range(young.iter().copied());
    figure.row("smallest modulus", low, Expected::Near(2000.03, 0.01));
    figure.row("largest modulus", high, Expected::Near(2999.95, 0.01));
    figure.row("mean modulus", young.iter().sum::<f64>() / young.len() as f64, Expected::Near(2507.0, 1.0));
    Ok(())
}

fn bent(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let made = runs.get("cells-96")?;
    figure.field(runs.drawn("cells-96", "body")?, "The bar bent downwards, with its von Mises stress");
    figure.row("u_y at the end of the axis", made.number("/probe/0/displacement/1")?, Expected::Near(-0.31934, 1e-5));
    Ok(())
}

fn heterogeneous(runs: &Runs<'_>, figure: &mut Figure) -> Result<(), String> {
    let names = ["cells-12", "cells-24", "cells-48", "cells-96", "cells-fem"];
    let made: Vec<&Made> = names.iter().map(|name| runs.get(name)).collect::<Result<_, _>>()?;
    let fine = runs.get("cells-fine")?;
    figure.field(runs.drawn("cells-96", "stress")?, "Von Mises stress by 96 by 16 coarse cells: bending, with grains");
    figure.field(
        runs.drawn("cells-fine", "stress")?,
        "Von Mises stress by finite elements eight times finer: the same, sharper",
    );
    let record = |name: &str| runs.get(name)?.record.as_ref().ok_or_else(|| "the run has no record".to_owned());
    let finest = record("cells-fine")?;
    let stress = [1.30, 0.87, 0.70, 0.60, 0.37];
    for ((grid, name), expected) in GRIDS.iter().zip(names).zip(stress) {
        let difference = difference(record(name)?, finest).ok_or("the grids do not fit")?;
        if *grid == "96 by 16" {
            let title = "Stress by 96 by 16 coarse cells less that of the finest grid, means over cells of 1/32";
            let picture = difference_picture(title, record(name)?, &difference, 4.0).map_err(|e| e.to_string())?;
            figure.field(
                picture.ok_or("the run has no grid")?,
                "Difference of the stresses of both: largest near the held end, without a pattern elsewhere",
            );
            figure.row("root mean square of the stress", difference.of_stress, Expected::Near(10.8, 0.05));
        }
        figure.row(
            format!("root mean square of the difference to the finest grid, {grid}"),
            difference.root_mean_square,
            Expected::Near(expected, 0.006),
        );
    }
    figure.row("compliance, 96 by 16", compliance(made[3])?, Expected::Near(0.319_413, 2e-6));
    figure.row("compliance, finite elements on 1/32", compliance(made[4])?, Expected::Near(0.320_543, 2e-6));
    figure.row("compliance, finite elements on 1/256", compliance(fine)?, Expected::Near(0.321_642, 2e-6));
    // limit of the compliance, -2 J, on finer and finer grids
    let limit = 0.321_682;
    for ((grid, made), expected) in GRIDS.iter().zip(&made).zip([0.220, 0.135, 0.099, 0.0838, 0.0593]) {
        let error = (1.0 - compliance(made)? / limit).sqrt();
        figure.row(
            format!("energy error against the limit of fine grids, {grid}"),
            error,
            Expected::About(expected, 0.05),
        );
    }
    Ok(())
}
