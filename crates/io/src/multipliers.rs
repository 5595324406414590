//! [`Persist`] for spaces of multipliers, the forms of their stabilisation, and their inf-sup constants.

use faer::Mat;
use hdf5::Group;
use sprs::CsMat;
use steklov_contact::{InfSup, MultiplierElement, MultiplierNode, MultiplierSpace, StabilisedForms, StabilisedParts};

use crate::array::{
    load_integers, load_number, load_points, load_vector, save_integers, save_number, save_points, save_vector,
};
use crate::bem_operators::DISPLACEMENT;
use crate::dataset::label;
use crate::error::{IoError, invalid, mismatch, write_error};
use crate::matrix::{load_dense, load_sparse, save_dense, save_sparse};
use crate::persist::Persist;
use crate::quadrature::check_length;
use crate::steklov::check_same;

const ELEMENT: &str = "multiplier element";
const NODE: &str = "multiplier node";
const POINT: &str = "quadrature point";

impl Persist for MultiplierSpace {
    const KIND: &'static str = "space of contact multipliers";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let of_element = |name, meaning, value: &dyn Fn(&MultiplierElement) -> usize| {
            let values: Vec<usize> = self.elements.iter().map(value).collect();
            save_integers(at, name, &values, &label("1", meaning, &[ELEMENT]))
        };
        of_element("edge", "edge of the polygon", &|e| e.edge)?;
        of_element("side", "side to which the edge belongs", &|e| e.side)?;
        of_element("degree", "degree q", &|e| e.degree)?;
        let spans: Vec<[f64; 2]> = self.elements.iter().map(|e| e.span).collect();
        save_points(at, "span", &spans, &label("1", "parameters s on the edge, rising", &[ELEMENT, "start, end"]))?;
        let nodes: Vec<usize> = self.elements.iter().flat_map(|e| e.nodes.clone()).collect();
        let meaning = "nodes of the elements, q + 1 each at its Lobatto points, the middle of one of degree 0";
        save_integers(at, "nodes", &nodes, &label("1", meaning, &["element and node"]))?;

        let of_node = |name, meaning, value: &dyn Fn(&MultiplierNode) -> usize| {
            let values: Vec<usize> = self.nodes.iter().map(value).collect();
            save_integers(at, name, &values, &label("1", meaning, &[NODE]))
        };
        of_node("node_edge", "edge of the polygon", &|n| n.edge)?;
        of_node("node_side", "side to which the edge belongs", &|n| n.side)?;
        let number = |name, unit, meaning, value: &dyn Fn(&MultiplierNode) -> f64| {
            let values: Vec<f64> = self.nodes.iter().map(value).collect();
            save_vector(at, name, &values, &label(unit, meaning, &[NODE]))
        };
        number("parameter", "1", "parameter s on the edge", &|n| n.s)?;
        number("weight", "length", "int mu_i ds of the basis function, positive", &|n| n.weight)?;
        let vector = |name, unit, meaning, value: &dyn Fn(&MultiplierNode) -> [f64; 2]| {
            let values: Vec<[f64; 2]> = self.nodes.iter().map(value).collect();
            save_points(at, name, &values, &label(unit, meaning, &[NODE, "xy"]))
        };
        vector("points", "length", "the points", &|n| n.point)?;
        vector("normal", "1", "outward unit normal n", &|n| n.frame[0])?;
        vector("tangent", "1", "t, n turned by +90 degrees", &|n| n.frame[1])?;
        let curved = self.nodes.iter().enumerate().filter_map(|(k, n)| Some((k, n.resultant?)));
        let (curved, resultants): (Vec<usize>, Vec<[[f64; 2]; 2]>) = curved.unzip();
        let meaning = "nodes on curved edges: elsewhere resultants are the weight times normal and tangent";
        save_integers(at, "curved", &curved, &label("1", meaning, &["curved node"]))?;
        let meaning = "int mu_i n ds, then int mu_i t ds, of each of these";
        let label = label("length", meaning, &["curved node and direction", "xy"]);
        save_points(at, "resultant", resultants.as_flattened(), &label)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (edge, side, degree) =
            (load_integers(at, "edge")?, load_integers(at, "side")?, load_integers(at, "degree")?);
        let span = load_points(at, "span")?;
        for (name, found) in [("side", side.len()), ("degree", degree.len()), ("span", span.len())] {
            check_length(at, name, found, edge.len())?;
        }
        let nodes = load_integers(at, "nodes")?;
        let (mut elements, mut rest) = (Vec::new(), &nodes[..]);
        for e in 0..edge.len() {
            let own = degree[e].checked_add(1).and_then(|count| rest.split_at_checked(count));
            let (own, after) = own.ok_or_else(|| invalid(at, "nodes", format!("element {e} has too few")))?;
            rest = after;
            let (edge, side, degree) = (edge[e], side[e], degree[e]);
            elements.push(MultiplierElement { edge, side, span: span[e], degree, nodes: own.to_vec() });
        }
        check_length(at, "nodes", nodes.len(), nodes.len() - rest.len())?;

        let (edge, side) = (load_integers(at, "node_edge")?, load_integers(at, "node_side")?);
        let (s, weight) = (load_vector(at, "parameter")?, load_vector(at, "weight")?);
        let vectors = [load_points(at, "points")?, load_points(at, "normal")?, load_points(at, "tangent")?];
        let [points, normal, tangent] = &vectors;
        let lengths = [("node_side", side.len()), ("parameter", s.len()), ("weight", weight.len())];
        let of_vectors = [("points", points.len()), ("normal", normal.len()), ("tangent", tangent.len())];
        for (name, found) in lengths.into_iter().chain(of_vectors) {
            check_length(at, name, found, edge.len())?;
        }
        let node = |k: usize| {
            let (edge, side, s, point, weight) = (edge[k], side[k], s[k], points[k], weight[k]);
            MultiplierNode { edge, side, s, point, frame: [normal[k], tangent[k]], weight, resultant: None }
        };
        let mut nodes: Vec<MultiplierNode> = (0..edge.len()).map(node).collect();
        let (curved, resultant) = (load_integers(at, "curved")?, load_points(at, "resultant")?);
        check_length(at, "resultant", resultant.len() / 2, curved.len())?;
        check_length(at, "resultant", resultant.len() % 2, 0)?;
        for (&k, r) in curved.iter().zip(resultant.chunks_exact(2)) {
            match nodes.get_mut(k) {
                Some(node) if node.resultant.is_none() => node.resultant = Some([r[0], r[1]]),
                _ => return Err(invalid(at, "curved", format!("node {k} stands there twice or is none"))),
            }
        }
        let space = Self { elements, nodes };
        space.check().map_err(|e| invalid(at, "", e))?;
        Ok(space)
    }
}

/// The nonzero entries as a sparse matrix.
fn sparse(a: &Mat<f64>) -> CsMat<f64> {
    let (mut indptr, mut indices, mut data) = (vec![0], Vec::new(), Vec::new());
    for i in 0..a.nrows() {
        for j in (0..a.ncols()).filter(|&j| a[(i, j)] != 0.0) {
            indices.push(j);
            data.push(a[(i, j)]);
        }
        indptr.push(indices.len());
    }
    CsMat::new((a.nrows(), a.ncols()), indptr, indices, data)
}

/// Reads a sparse matrix of this size as a dense one.
fn full(at: &Group, name: &str, (rows, columns): (usize, usize)) -> Result<Mat<f64>, IoError> {
    let sparse = load_sparse(at, name)?;
    if sparse.shape() != (rows, columns) {
        return Err(mismatch(at, name, format!("a {rows}×{columns} matrix"), format!("{:?}", sparse.shape())));
    }
    let mut a = Mat::zeros(rows, columns);
    sparse.iter().for_each(|(value, (i, j))| a[(i, j)] = *value);
    Ok(a)
}

/// Names of the normal and the tangential part.
const TRACE: [&str; 2] = ["trace_n", "trace_t"];
const VALUES: [&str; 2] = ["values_n", "values_t"];
const PAIRING: [&str; 2] = ["pairing_n", "pairing_t"];
const MIXED: [&str; 2] = ["C_gamma_n", "C_gamma_t"];
const MULTIPLIERS: [&str; 2] = ["D_gamma_n", "D_gamma_t"];

impl Persist for StabilisedForms {
    const KIND: &'static str = "forms of stabilised multipliers for gamma_0 = 1";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let StabilisedParts { points, weights, damping, trace, values, pairing } = self.parts();
        let (elements, coordinates): (Vec<usize>, Vec<f64>) = points.iter().copied().unzip();
        save_integers(at, "elements", &elements, &label("1", "element of T_h of each point, not falling", &[POINT]))?;
        save_vector(at, "coordinates", &coordinates, &label("1", "its reference coordinate", &[POINT]))?;
        save_vector(at, "weights", weights, &label("length", "(w h/p^2)^(1/2), w with the speed", &[POINT]))?;
        let meaning = "d of Q = 1 - d pi pi^T, pi the constant pressure (w h/p^2)^(1/2) over its norm";
        save_number(at, "damping", *damping, "1", meaning)?;
        let meanings = ["T_n = Q (w h/p^2)^(1/2) n sigma^h", "T_t = (w h/p^2)^(1/2) t sigma^h"];
        for (k, name) in TRACE.into_iter().enumerate() {
            save_dense(at, name, trace[k].as_ref(), &label("stress", meanings[k], &[POINT, DISPLACEMENT]))?;
        }
        let meanings = ["M_n = Q M_t", "M_t = (w h/p^2)^(1/2) mu_i, rows sum to (w h/p^2)^(1/2)"];
        for (k, name) in VALUES.into_iter().enumerate() {
            save_dense(at, name, values[k].as_ref(), &label("length", meanings[k], &[POINT, NODE]))?;
        }
        let meanings = ["int mu_i n phi_j ds of b(mu, v)", "int mu_i t phi_j ds of b(mu, v)"];
        for (k, name) in PAIRING.into_iter().enumerate() {
            save_sparse(at, name, &sparse(&pairing[k]), &label("length", meanings[k], &[NODE, DISPLACEMENT]))?;
        }

        let failed = |name, e: steklov_contact::ContactError| write_error(at, name, e);
        let form = self.trace_form().map_err(|e| failed("B_gamma", e))?;
        let meaning = "B = int (h/p^2) sigma^h sigma^h = T_n^T T_n + T_t^T T_t; B_gamma = gamma_0 B, of [S - B_gamma, E^T; E, -D_gamma]";
        let both = [DISPLACEMENT, DISPLACEMENT];
        save_dense(at, "B_gamma", form.as_ref(), &label("stress^2; gamma_0 in 1/stress", meaning, &both))?;
        let forms = self.mixed_forms().map_err(|e| failed("C_gamma_n", e))?;
        for (name, (form, k)) in MIXED.into_iter().zip(forms.iter().zip(["n", "t"])) {
            let meaning =
                format!("C = int (h/p^2) mu sigma^h = M_{k}^T T_{k}; C_gamma = gamma_0 C, E = pairing_{k} - C_gamma");
            let label = label("length*stress; gamma_0 in 1/stress", &meaning, &[NODE, DISPLACEMENT]);
            save_dense(at, name, form.as_ref(), &label)?;
        }
        let forms = self.multiplier_forms().map_err(|e| failed("D_gamma_n", e))?;
        for (name, (form, k)) in MULTIPLIERS.into_iter().zip(forms.iter().zip(["n", "t"])) {
            let meaning = format!("D = int (h/p^2) mu_i mu_j = M_{k}^T M_{k}; D_gamma = gamma_0 D");
            save_dense(at, name, form.as_ref(), &label("length^2; gamma_0 in 1/stress", &meaning, &[NODE, NODE]))?;
        }
        Ok(())
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (elements, coordinates) = (load_integers(at, "elements")?, load_vector(at, "coordinates")?);
        check_length(at, "coordinates", coordinates.len(), elements.len())?;
        if let Some(pair) = elements.windows(2).find(|pair| pair[0] > pair[1]) {
            return Err(invalid(at, "elements", format!("element {} follows element {}", pair[1], pair[0])));
        }
        let points = elements.into_iter().zip(coordinates).collect();
        let [trace, values] = [TRACE, VALUES].map(|names| Ok([load_dense(at, names[0])?, load_dense(at, names[1])?]));
        let (trace, values): ([Mat<f64>; 2], [Mat<f64>; 2]) = (trace?, values?);
        let size = (values[0].ncols(), trace[0].ncols());
        let pairing = [full(at, PAIRING[0], size)?, full(at, PAIRING[1], size)?];
        let (weights, damping) = (load_vector(at, "weights")?, load_number(at, "damping")?);
        let parts = StabilisedParts { points, weights, damping, trace, values, pairing };
        let forms = Self::from_parts(parts).map_err(|e| invalid(at, "", e))?;

        // Cauchy's inequality: an entry is at most the product of the norms of its columns
        let norms = |a: &Mat<f64>| -> Vec<f64> { a.col_iter().map(|column| column.norm_l2()).collect() };
        let (traces, multipliers) =
            (forms.parts().trace.each_ref().map(norms), forms.parts().values.each_ref().map(norms));
        let failed = |name, e: steklov_contact::ContactError| invalid(at, name, e);
        let made = forms.trace_form().map_err(|e| failed("B_gamma", e))?;
        let scale = |i: usize, j: usize| traces[0][i] * traces[0][j] + traces[1][i] * traces[1][j];
        check_same(at, "B_gamma", made.as_ref(), scale)?;
        let mixed = forms.mixed_forms().map_err(|e| failed("C_gamma_n", e))?;
        let own = forms.multiplier_forms().map_err(|e| failed("D_gamma_n", e))?;
        for k in 0..2 {
            check_same(at, MIXED[k], mixed[k].as_ref(), |i, j| multipliers[k][i] * traces[k][j])?;
            check_same(at, MULTIPLIERS[k], own[k].as_ref(), |i, j| multipliers[k][i] * multipliers[k][j])?;
        }
        Ok(forms)
    }
}

impl Persist for InfSup {
    const KIND: &'static str = "inf-sup constant";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let meaning = "beta = inf_mu sup_v b(mu, v) / (|v| |mu|), beta^2 the least eigenvalue of B S^-1 B^T against that of a finer space";
        save_number(at, "beta", self.beta, "1", meaning)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        match load_number(at, "beta")? {
            beta if beta >= 0.0 && beta.is_finite() => Ok(Self { beta }),
            beta => Err(invalid(at, "beta", format!("{beta} is no root of an eigenvalue"))),
        }
    }
}
