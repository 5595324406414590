//! A scene on half as many cells: a family of grids of one problem.

use std::sync::Arc;

use steklov_expression::RandomField;

use super::moduli::cell_values;
use super::{
    CellModuli, Cells, GridInput, RandomName, Scene, Substance, TableOrder, check_body, field_cells, modulus_cells,
};

impl Scene {
    /// The scene with cells twice as large along both axes, of bilinear elements: fine cells at first down to modulus cells, then
    /// both. None where cells are odd in number, or where the body, its moduli or a random field do not consist of such cells.
    ///
    /// Moduli are the geometric means of those of the smaller cells if they are numbers (Poisson's ratios the arithmetic ones), and
    /// the expression in the larger cell if they are one; a field of cells has the mean over the larger cell. Germs mean the same outcome on both grids.
    pub fn coarsened(&self) -> Option<Self> {
        let input = self.body().grid.as_ref()?;
        let cells = halved(input.cells())?;
        let mut coarse = self.clone();
        coarse.body_mut().grid = Some(GridInput { coarse: cells, fine: [1, 1], ..*input });
        if let Substance::Cells(of_cells) = &self.body().substance {
            let counts = modulus_cells(&self.problem.outline, of_cells.size)?;
            if (0..2).any(|k| !cells[k].is_multiple_of(counts[k])) {
                let larger = self.larger_cells(of_cells, counts)?;
                coarse.body_mut().substance = Substance::Cells(larger);
                for name in coarse.random.iter_mut().flat_map(|random| &mut random.names) {
                    coarsen_field(name)?;
                }
            }
        }
        check_body(&coarse, cells, "grid").ok()?;
        Some(coarse)
    }

    /// Modulus cells twice as large.
    fn larger_cells(&self, cells: &Cells, counts: [usize; 2]) -> Option<Cells> {
        let larger = halved(counts)?;
        // numbers outside of the body may be anything
        let inside = field_cells(&self.problem.outline, self.body().grid.as_ref()?, cells.size)?.inside?;
        let means = |of_cells: &CellModuli, forth: fn(f64) -> f64, back: fn(f64) -> f64| {
            if let CellModuli::Expression(value) = of_cells {
                return CellModuli::Expression(value.clone());
            }
            let values = cell_values(self, cells.size, of_cells, counts);
            let mean = |c: usize| -> f64 {
                let (ix, iy) = (c / larger[1], c % larger[1]);
                let parts = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[a, b]| (2 * ix + a) * counts[1] + 2 * iy + b);
                let own: Vec<f64> = parts.iter().filter(|&&i| inside[i]).map(|&i| forth(values[i])).collect();
                if own.is_empty() { values[parts[0]] } else { back(own.iter().sum::<f64>() / own.len() as f64) }
            };
            let means: Vec<f64> = (0..larger[0] * larger[1]).map(mean).collect();
            let source = "means over larger cells".to_owned();
            CellModuli::Table { values: means.into(), order: TableOrder::Xy, source }
        };
        Some(Cells {
            size: 2.0 * cells.size,
            young: means(&cells.young, f64::ln, f64::exp),
            poisson: cells.poisson.as_ref().map(|poisson| means(poisson, |v| v, |v| v)),
            of_unit_modulus: cells.of_unit_modulus,
        })
    }
}

impl Scene {
    /// The scene with fields that are drawn as a whole on tori of their own cells: the same law, other outcomes of the germs. None
    /// without such a field.
    pub fn redrawn(&self) -> Option<Self> {
        let mut redrawn = self.clone();
        let mut some = false;
        for name in redrawn.random.iter_mut().flat_map(|random| &mut random.names) {
            if let RandomName::Field { field, .. } = name
                && let Some(expansion) = field.expansion.redrawn()
            {
                *field = Arc::new(RandomField { expansion, ..(**field).clone() });
                some = true;
            }
        }
        some.then_some(redrawn)
    }
}

/// Half of both numbers, if they are even.
fn halved(counts: [usize; 2]) -> Option<[usize; 2]> {
    counts.iter().all(|n| n.is_multiple_of(2)).then(|| counts.map(|n| n / 2))
}

/// A field of cells as the means over cells twice as large; other fields stay. None if the body does not consist of them.
fn coarsen_field(name: &mut RandomName) -> Option<()> {
    if let RandomName::Field { field, .. } = name {
        let RandomField { name, support, expansion } = &**field;
        let (name, support) = (name.clone(), support.clone());
        *field = Arc::new(RandomField { name, support, expansion: expansion.coarsened()? });
    }
    Some(())
}
