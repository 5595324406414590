//! Distance of two solutions of body and medium, in the norms of body, displacement and traction.

use steklov_coupling::Medium;
use steklov_elastic::plane::{cross, dot, minus};
use steklov_model::error::SolveError;
use steklov_model::grid::GridSolved;
use steklov_model::solve::medium::Around;

use crate::quadratic;

/// A reference solution on a grid, for solutions on coarse cells of the grid and on nested coarser grids.
pub(super) struct Truth {
    pub solved: GridSolved,
    medium: Medium,
}

/// Largest distance of a point on an element from the element, over its length.
const SAME_PLACE: f64 = 1e-6;

/// The medium of a solution.
pub(super) fn around(solved: &GridSolved) -> &Around {
    let Some(around) = &solved.around else { unreachable!("the scene has a medium") };
    around
}

impl Truth {
    /// Assembles the operators of its medium, whose boundary elements have degree 1.
    ///
    /// # Errors
    /// As [`Medium::new`].
    pub fn new(solved: GridSolved) -> Result<Self, SolveError> {
        let Around { mesh, material, length, .. } = around(&solved);
        let medium = Medium::new(mesh.clone(), *material, Some(*length))?;
        Ok(Self { solved, medium })
    }

    /// (a(u, u) + ⟨W ξ, ξ⟩ + ⟨V φ, φ⟩)^½ = (2 strain energy)^½.
    pub fn norm(&self) -> f64 {
        (2.0 * self.solved.energies.strain).sqrt()
    }

    /// a(e, e), ⟨W e, e⟩ and ⟨V e, e⟩ of the differences e of u in the body and of ξ and φ on the interface.
    ///
    /// All fields of `other` are fields of this grid and its boundary elements, so that nothing is interpolated. If both have
    /// the same boundary elements, ξ is u less the jump on them, and the body of `other` uses a part of the functions, the sum
    /// is 2 (J_other - J).
    pub fn squared(&self, other: &GridSolved) -> [f64; 3] {
        let (body, u) = (&self.solved.body, &self.solved.displacement);
        let is_same = body.grid.cells == other.body.grid.cells;
        let value = |node: usize| match is_same {
            true => [other.displacement[2 * node], other.displacement[2 * node + 1]],
            false => other.body.at(&other.displacement, body.grid.point(node)).map_or([f64::NAN; 2], |(u, _)| u),
        };
        let inside: Vec<f64> = (0..body.grid.nodes()).flat_map(value).zip(u).map(|(a, b)| a - b).collect();
        let [displacement, traction] = self.on_interface(around(other));
        let operators = &self.medium.operators;
        [body.energy(&inside, &inside), quadratic(&operators.w, &displacement), quadratic(&operators.v, &traction)]
    }

    /// ξ and φ of other boundary elements minus ξ and φ of this solution.
    fn on_interface(&self, other: &Around) -> [Vec<f64>; 2] {
        let Medium { mesh, space, .. } = &self.medium;
        let own = around(&self.solved);
        let mut differences = [vec![f64::NAN; own.displacement.len()], vec![f64::NAN; own.traction.len()]];
        for e in 0..mesh.len() {
            let Some(f) = (0..other.mesh.len()).find(|&f| on_element(other.mesh.ends(f), mesh.point(e, 0.0))) else {
                continue;
            };
            let [a, b] = other.mesh.ends(f);
            let along = minus(b, a);
            let s = dot(minus(mesh.ends(e)[0], a), along) / dot(along, along);
            let mut nodes = other.space.element_nodes(f);
            let (Some(node), Some(from), Some(to)) = (space.element_nodes(e).next(), nodes.next(), nodes.next()) else {
                continue;
            };
            for i in 0..2 {
                let xi = (1.0 - s) * other.displacement[2 * from + i] + s * other.displacement[2 * to + i];
                differences[0][2 * node + i] = xi - own.displacement[2 * node + i];
                let (at, from) = (2 * space.offset[e] + i, 2 * other.space.offset[f] + i);
                differences[1][at] = other.traction[from] - own.traction[at];
            }
        }
        differences
    }
}

/// Whether a point is on a straight element.
fn on_element([a, b]: [[f64; 2]; 2], x: [f64; 2]) -> bool {
    let (along, r) = (minus(b, a), minus(x, a));
    let square = dot(along, along);
    (0.0..=1.0).contains(&(dot(r, along) / square)) && cross(along, r).abs() < SAME_PLACE * square
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use steklov_problem::BasisInput;

    use super::*;
    use crate::multiscale::{on_all_cells, on_coarse_cells};

    const INCLUSION: &str = r#"title = "An inclusion"
[body]
corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
sides = ["floor", "right", "step", "inner", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.125, young = { uniform = [1, 9], seed = 7 } }
[exterior]
young = 2.0
poisson = 0.25
remote_stress = [1, 0.3, -0.2]
[grid]
coarse = [4, 4]
fine = [4, 4]
"#;

    /// On the same boundary elements the coarse functions are a subspace of the fine ones and S is the same, so the sum
    /// of the three squares is twice the difference of J to its minimum. With coarser boundary elements it is not.
    #[test]
    fn the_squares_are_twice_the_difference_of_the_energies() {
        let (scene, run) = (steklov_document::parse(INCLUSION, "inclusion", &[]).unwrap(), &AtomicUsize::new(0));
        let truth = Truth::new(on_all_cells(&scene, 1, run).unwrap()).unwrap();
        for (basis, is_galerkin) in [(BasisInput::Oscillatory, true), (BasisInput::Coupled, false)] {
            let solved = on_coarse_cells(&scene, [4, 4], basis, None, run).unwrap();
            let squared = truth.squared(&solved);
            assert!(squared.iter().all(|s| *s > 1e-4 * truth.norm().powi(2)), "{squared:?}");
            let ratio = squared.iter().sum::<f64>() / (2.0 * (solved.energies.total - truth.solved.energies.total));
            assert_eq!((ratio - 1.0).abs() < 1e-9, is_galerkin, "{ratio}");
        }
        assert_eq!(truth.squared(&truth.solved), [0.0; 3]);
        // ⟨S ξ, ξ⟩ = ⟨W ξ, ξ⟩ + ⟨V φ, φ⟩: the three squares of the solution itself are twice its strain energy
        let (own, Medium { operators, .. }) = (around(&truth.solved), &truth.medium);
        let u = &truth.solved.displacement;
        let inside = truth.solved.body.energy(u, u);
        let outside = quadratic(&operators.w, &own.displacement) + quadratic(&operators.v, &own.traction);
        assert!(((inside + outside) / truth.norm().powi(2) - 1.0).abs() < 1e-9, "{inside} {outside} {}", truth.norm());
    }

    /// A solution on a coarser grid is a field of the finer grid: its distance follows from the energies, because the
    /// grids are nested.
    #[test]
    fn coarser_grids_are_nested() {
        let run = &AtomicUsize::new(0);
        let parsed =
            |fine: &str| steklov_document::parse(&INCLUSION.replace("fine = [4, 4]", fine), "inclusion", &[]).unwrap();
        let truth = Truth::new(on_all_cells(&parsed("fine = [8, 8]"), 1, run).unwrap()).unwrap();
        let coarse = on_all_cells(&parsed("fine = [4, 4]"), 1, run).unwrap();
        let [body, displacement, traction] = truth.squared(&coarse);
        let norm = truth.norm().powi(2);
        // the field is the same on both grids, and so is its energy
        let u: Vec<f64> = (0..truth.solved.body.grid.nodes())
            .flat_map(|n| coarse.body.at(&coarse.displacement, truth.solved.body.grid.point(n)).unwrap().0)
            .collect();
        let (fine, own) =
            (truth.solved.body.energy(&u, &u), coarse.body.energy(&coarse.displacement, &coarse.displacement));
        assert!((fine / own - 1.0).abs() < 1e-12, "{fine} {own}");
        for part in [body, displacement, traction] {
            assert!(part > 1e-6 * norm && part < 0.05 * norm, "{part} of {norm}");
        }
    }
}
