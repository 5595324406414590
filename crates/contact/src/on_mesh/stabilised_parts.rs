//! The parts of the stabilisation's forms, and whether they fit together.

use faer::Mat;

use crate::on_mesh::uniform_pressure::UniformPressure;

/// The parts of [`StabilisedForms`](crate::StabilisedForms).
#[derive(Debug, Clone)]
pub struct StabilisedParts {
    /// Quadrature points: element of T_h, reference coordinate.
    pub points: Vec<(usize, f64)>,
    /// (w h/p²)^½ at the points.
    pub weights: Vec<f64>,
    /// 1-√ρ, the part that Q takes of the constant normal stress: from 0 to less than 1.
    pub damping: f64,
    /// (w h/p²)^½ n·σ^h, times Q, and t·σ^h: points × displacements.
    pub trace: [Mat<f64>; 2],
    /// (w h/p²)^½ μ, times Q for μ_n: points × nodes of the multipliers.
    pub values: [Mat<f64>; 2],
    /// ∫ μ n·φ and ∫ μ t·φ: nodes of the multipliers × displacements.
    pub pairing: [Mat<f64>; 2],
}

/// Largest rounding error of sums of basis functions, and of Q, over the weight of a point.
const SAME: f64 = 1e-9;

impl StabilisedParts {
    pub(crate) fn check(&self, uniform: &UniformPressure) -> Result<(), String> {
        let (points, n, nodes) = (self.points.len(), self.trace[0].ncols(), self.values[0].ncols());
        if points == 0 || self.weights.len() != points {
            return Err(format!("weights: {} of {points} points", self.weights.len()));
        }
        if let Some(w) = self.weights.iter().find(|w| !(**w > 0.0 && w.is_finite())) {
            return Err(format!("weights: {w} is not positive"));
        }
        if let Some((element, t)) = self.points.iter().find(|(_, t)| !(-1.0..=1.0).contains(t)) {
            return Err(format!("coordinates: {t} is outside of element {element}"));
        }
        if !(0.0..1.0).contains(&self.damping) {
            return Err(format!("damping: {} is not from 0 to below 1", self.damping));
        }
        let sized = [("trace", &self.trace, points, n), ("values", &self.values, points, nodes)];
        for (part, matrices, rows, columns) in sized.into_iter().chain([("pairing", &self.pairing, nodes, n)]) {
            for a in matrices {
                if (a.nrows(), a.ncols()) != (rows, columns) {
                    return Err(format!("{part}: a matrix is {}×{}, not {rows}×{columns}", a.nrows(), a.ncols()));
                }
                if !a.col_iter().all(|column| column.iter().all(|v| v.is_finite())) {
                    return Err(format!("{part}: an entry is not finite"));
                }
            }
        }
        let [damped, values] = &self.values;
        for (i, w) in self.weights.iter().enumerate() {
            let sum: f64 = values.row(i).iter().sum();
            if (sum - w).abs() > SAME * w * nodes as f64 {
                return Err(format!("values: the basis functions sum to {} at point {i}", sum / w));
            }
        }
        let mut again = values.clone();
        uniform.damp_columns(&mut again);
        let largest = values.norm_max();
        if (again - damped).norm_max() > SAME * largest {
            return Err("values: Q of the tangential ones is not the normal ones".into());
        }
        Ok(())
    }
}
