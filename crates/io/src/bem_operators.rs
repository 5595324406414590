//! [`Persist`] for the types of `steklov-bem-operators`.
//!
//! The space of a mesh is numbered anew from it, and the Steklov-Poincaré matrix is made anew from the stored operators,
//! both with the same bits; S alone is stored by [`save_dense`].

use hdf5::Group;
use steklov_bem_operators::{Loop, Mesh, Operators, Polygon, edge_tangents};

use crate::array::{
    load_integers, load_number, load_pairs, load_points, save_integers, save_number, save_pairs, save_points,
};
use crate::dataset::{Label, label};
use crate::error::{IoError, invalid, mismatch};
use crate::matrix::{load_dense, load_sparse, save_dense, save_sparse};
use crate::persist::Persist;
use crate::quadrature::{check_length, load_sized};
use crate::text::{load_texts, save_texts};

fn index<'a>(meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    Label { unit: "1", meaning, axes }
}

impl Persist for Polygon {
    const KIND: &'static str = "polygon";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let corners: Vec<[f64; 2]> = self.edges().iter().map(|edge| edge.listed()[0]).collect();
        let sides: Vec<usize> = self.edges().iter().map(|edge| edge.side).collect();
        let loops: Vec<[usize; 2]> = self.loops().iter().map(|edges| [edges.start, edges.end]).collect();
        let label = Label { unit: "length", meaning: "corners as listed", axes: &["corner", "xy"] };
        save_points(at, "corners", &corners, &label)?;
        save_integers(at, "side", &sides, &index("side of the edge that starts at each corner", &["corner"]))?;
        save_pairs(at, "loops", &loops, &index("corners of each loop, the outer one first", &["loop", "first, end"]))?;
        save_texts(at, "side_names", self.side_names(), "names of the sides", "side")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (corners, sides, names) =
            (load_points(at, "corners")?, load_integers(at, "side")?, load_texts(at, "side_names")?);
        check_length(at, "side", sides.len(), corners.len())?;
        let mut loops = Vec::new();
        for [first, end] in load_pairs(at, "loops")? {
            let (Some(corners), Some(sides)) = (corners.get(first..end), sides.get(first..end)) else {
                return Err(invalid(at, "loops", format!("no corners {first} to {end} of {}", corners.len())));
            };
            let named: Option<Vec<String>> = sides.iter().map(|&s| names.get(s).cloned()).collect();
            let sides = named.ok_or_else(|| invalid(at, "side", format!("a side above {}", names.len())))?;
            loops.push(Loop { corners: corners.to_vec(), sides });
        }
        if loops.is_empty() {
            return Err(invalid(at, "loops", "there is none"));
        }
        let outer = loops.remove(0);
        Polygon::new(outer, loops).map_err(|e| invalid(at, "corners", e))
    }
}

impl Persist for Mesh {
    const KIND: &'static str = "boundary mesh";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let elements: Vec<[usize; 2]> = self.next.iter().enumerate().map(|(e, &next)| [e, next]).collect();
        let nodes = Label { unit: "length", meaning: "start point of each element", axes: &["node", "xy"] };
        save_points(at, "nodes", &self.vertices, &nodes)?;
        save_pairs(at, "elements", &elements, &index("start and end node", &["element", "start, end"]))?;
        save_integers(at, "degree", &self.degree, &index("degree of the displacement", &["element"]))?;
        save_integers(at, "edge", &self.edge, &index("edge of the polygon", &["element"]))?;
        save_integers(at, "side", &self.side, &index("side, a row of side_names", &["element"]))?;
        save_points(at, "span", &self.span, &index("parameter s on the edge", &["element", "start, end"]))?;
        save_texts(at, "side_names", &self.side_names, "names of the sides", "side")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (vertices, elements) = (load_points(at, "nodes")?, load_pairs(at, "elements")?);
        if let Some(e) = elements.iter().enumerate().position(|(e, element)| element[0] != e) {
            return Err(invalid(at, "elements", format!("element {e} starts at node {}", elements[e][0])));
        }
        let next: Vec<usize> = elements.iter().map(|element| element[1]).collect();
        let edge = load_integers(at, "edge")?;
        let mesh = Self {
            tangent: edge_tangents(&vertices, &next, &edge),
            vertices,
            next,
            degree: load_integers(at, "degree")?,
            edge,
            side: load_integers(at, "side")?,
            span: load_points(at, "span")?,
            side_names: load_texts(at, "side_names")?,
        };
        mesh.check().map_err(|e| invalid(at, "", e))?;
        if let Some(side) = mesh.side.iter().find(|&&side| side >= mesh.side_names.len()) {
            return Err(invalid(at, "side", format!("side {side} of {}", mesh.side_names.len())));
        }
        Ok(mesh)
    }
}

const TRACTION: &str = "traction: Legendre coefficients by element, component fastest";
const DISPLACEMENT: &str = "displacement: nodes, component fastest";

impl Persist for Operators {
    const KIND: &'static str = "boundary element operators";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_dense(at, "V", self.v.as_ref(), &label("length²/stress", "single layer", &[TRACTION, TRACTION]))?;
        save_dense(at, "K", self.k.as_ref(), &label("length", "double layer", &[TRACTION, DISPLACEMENT]))?;
        save_dense(at, "W", self.w.as_ref(), &label("stress", "hypersingular", &[DISPLACEMENT, DISPLACEMENT]))?;
        save_sparse(at, "M", &self.mass, &label("length", "mass", &[TRACTION, DISPLACEMENT]))?;
        save_number(at, "length", self.length, "length", "L in log(L/r)")?;
        save_number(at, "diameter", self.diameter, "length", "diameter of the boundary")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (v, w) = (load_dense(at, "V")?, load_dense(at, "W")?);
        let (p, n) = (v.nrows(), w.nrows());
        if (v.ncols(), w.ncols()) != (p, n) {
            return Err(invalid(
                at,
                "",
                format!("V is {p}×{}, W is {n}×{}; both must be square", v.ncols(), w.ncols()),
            ));
        }
        let (k, mass) = (load_sized(at, "K", p, n)?, load_sparse(at, "M")?);
        if mass.shape() != (p, n) {
            return Err(mismatch(at, "M", format!("a {p}×{n} matrix"), format!("{:?}", mass.shape())));
        }
        Ok(Self { v, k, w, mass, length: load_number(at, "length")?, diameter: load_number(at, "diameter")? })
    }
}
