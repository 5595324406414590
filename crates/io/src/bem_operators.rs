//! [`Persist`] for the types of `steklov-bem-operators`.
//!
//! The space of a stored mesh is rebuilt from it with the same bits; a space alone is stored as its numbers and points.

use hdf5::Group;
use steklov_bem_operators::{Loop, Mesh, Operators, Path, Polygon, Shape, Space, edge_tangents};

use crate::array::{
    load_integers, load_number, load_pairs, load_points, load_vector, save_integers, save_number, save_pairs,
    save_points, save_vector,
};
use crate::dataset::{Label, label};
use crate::error::{IoError, invalid, mismatch};
use crate::matrix::{load_dense, load_sparse, save_dense, save_sparse};
use crate::persist::Persist;
use crate::quadrature::{check_length, load_sized};
use crate::steklov::misfit;
use crate::text::{load_texts, save_texts};

fn index<'a>(meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    Label { unit: "1", meaning, axes }
}

impl Persist for Polygon {
    const KIND: &'static str = "polygon";
    const VERSION: u32 = 3;
    const OLDEST: u32 = 1;

    /// 1 for one bounded body with straight edges only, 2 for one with curved edges, 3 for all others.
    fn version(&self) -> u32 {
        match self.bodies().len() {
            1 if self.is_bounded() && !self.is_curved() => 1,
            1 if self.is_bounded() => 2,
            _ => 3,
        }
    }

    fn write(&self, at: &Group) -> Result<(), IoError> {
        // pieces between cracks alone are not valid outlines
        if rebuilt(self).as_ref() != Ok(self) {
            return Err(invalid(at, "", "a body that cracks cut is not stored: store the body and its cracks"));
        }
        let corners: Vec<[f64; 2]> = self.edges().iter().map(|edge| edge.listed()[0]).collect();
        let sides: Vec<usize> = self.edges().iter().map(|edge| edge.side).collect();
        let loops: Vec<[usize; 2]> = self.loops().iter().map(|edges| [edges.start, edges.end]).collect();
        let label = Label { unit: "length", meaning: "corners as listed", axes: &["corner", "xy"] };
        save_points(at, "corners", &corners, &label)?;
        save_integers(at, "side", &sides, &index("side of the edge that starts at each corner", &["corner"]))?;
        save_pairs(at, "loops", &loops, &index("corners of each loop, the outer one first", &["loop", "first, end"]))?;
        if self.is_curved() {
            let (kinds, numbers): (Vec<usize>, Vec<[f64; 5]>) =
                self.edges().iter().map(|e| path_numbers(e.path)).unzip();
            let meaning = "how the edge from each corner runs: 0 line, 1 circular arc, 2 elliptic arc, 3 cubic";
            save_integers(at, "path", &kinds, &index(meaning, &["corner"]))?;
            let meaning = "opening; half axes, angle, start, opening; control points: five for each corner";
            save_vector(at, "path_numbers", numbers.as_flattened(), &index(meaning, &["corner and number"]))?;
        }
        if self.version() == 3 {
            let bodies: Vec<[usize; 2]> = self.bodies().iter().map(|loops| [loops.start, loops.end]).collect();
            let bounded: Vec<usize> = (0..bodies.len()).map(|b| usize::from(self.is_body_bounded(b))).collect();
            save_pairs(at, "bodies", &bodies, &index("loops of each body", &["body", "first, end"]))?;
            let meaning = "1: inside of its first loop; 0: the plane outside of its loops";
            save_integers(at, "bounded", &bounded, &index(meaning, &["body"]))?;
        }
        save_texts(at, "side_names", self.side_names(), "names of the sides", "side")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (corners, sides, names) =
            (load_points(at, "corners")?, load_integers(at, "side")?, load_texts(at, "side_names")?);
        check_length(at, "side", sides.len(), corners.len())?;
        let paths = match at.link_exists("path") || at.link_exists("path_numbers") {
            true => paths(at, corners.len())?,
            false => vec![Path::Line; corners.len()],
        };
        let mut loops = Vec::new();
        for [first, end] in load_pairs(at, "loops")? {
            let (Some(corners), Some(sides)) = (corners.get(first..end), sides.get(first..end)) else {
                return Err(invalid(at, "loops", format!("no corners {first} to {end} of {}", corners.len())));
            };
            let named: Option<Vec<String>> = sides.iter().map(|&s| names.get(s).cloned()).collect();
            let sides = named.ok_or_else(|| invalid(at, "side", format!("a side above {}", names.len())))?;
            let paths = paths[first..end].to_vec();
            loops.push(Loop { paths, ..Loop::straight(corners.to_vec(), sides) });
        }
        if loops.is_empty() {
            return Err(invalid(at, "loops", "there is none"));
        }
        let bodies = match at.link_exists("bodies") || at.link_exists("bounded") {
            true => {
                let (bodies, bounded) = (load_pairs(at, "bodies")?, load_integers(at, "bounded")?);
                check_length(at, "bounded", bounded.len(), bodies.len())?;
                bodies.into_iter().zip(bounded.iter().map(|b| *b == 1)).collect()
            }
            false => vec![([0, loops.len()], true)],
        };
        outline(&loops, &bodies).map_err(|why| invalid(at, "corners", why))
    }
}

/// The polygon of bodies, each with its first loop, the loop after its last one, and whether it is bounded.
fn outline(loops: &[Loop], bodies: &[([usize; 2], bool)]) -> Result<Polygon, String> {
    let mut all = Vec::new();
    for &([first, end], bounded) in bodies {
        let own = loops.get(first..end).ok_or_else(|| format!("no loops {first} to {end} of {}", loops.len()))?;
        let body = match (own.split_first(), bounded) {
            (Some((outer, holes)), true) => Polygon::new(outer.clone(), holes.to_vec()),
            (Some(_), false) => Polygon::outside(own.to_vec()),
            (None, _) => return Err("a body without a loop".into()),
        };
        all.push(body.map_err(|e| e.to_string())?);
    }
    if all.is_empty() { Err("there is no body".into()) } else { Ok(Polygon::assembly(all)) }
}

/// The polygon rebuilt from its stored data.
fn rebuilt(polygon: &Polygon) -> Result<Polygon, String> {
    let of_loop = |edges: &std::ops::Range<usize>| {
        let edges = &polygon.edges()[edges.clone()];
        Loop {
            corners: edges.iter().map(|edge| edge.listed()[0]).collect(),
            sides: edges.iter().map(|edge| polygon.side_names()[edge.side].clone()).collect(),
            paths: edges.iter().map(|edge| edge.path).collect(),
        }
    };
    let loops: Vec<Loop> = polygon.loops().iter().map(of_loop).collect();
    let bodies: Vec<_> = polygon.bodies().iter().map(|loops| [loops.start, loops.end]).collect();
    outline(
        &loops,
        &bodies.into_iter().enumerate().map(|(b, loops)| (loops, polygon.is_body_bounded(b))).collect::<Vec<_>>(),
    )
}

impl Persist for Mesh {
    const KIND: &'static str = "boundary mesh";
    const VERSION: u32 = 2;
    const OLDEST: u32 = 1;

    /// 1 with straight elements only, else 2.
    fn version(&self) -> u32 {
        if self.shape.iter().all(|s| *s == Shape::Line) { 1 } else { 2 }
    }

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let elements: Vec<[usize; 2]> = self.next.iter().enumerate().map(|(e, &next)| [e, next]).collect();
        let nodes = Label { unit: "length", meaning: "start point of each element", axes: &["node", "xy"] };
        save_points(at, "nodes", &self.vertices, &nodes)?;
        save_pairs(at, "elements", &elements, &index("start and end node", &["element", "start, end"]))?;
        save_integers(at, "degree", &self.degree, &index("degree of the displacement", &["element"]))?;
        save_integers(at, "edge", &self.edge, &index("edge of the polygon", &["element"]))?;
        save_integers(at, "side", &self.side, &index("side, a row of side_names", &["element"]))?;
        save_points(at, "span", &self.span, &index("parameter s on the edge", &["element", "start, end"]))?;
        if self.version() == 2 {
            let numbers: Vec<Vec<f64>> = self.shape.iter().map(shape_numbers).collect();
            let counts: Vec<usize> = numbers.iter().map(Vec::len).collect();
            let meaning = "how many shape_numbers each element has: 0 of a line, 1 of an arc, else of a polynomial";
            save_integers(at, "shape", &counts, &index(meaning, &["element"]))?;
            let meaning = "half the opening of an arc; re, im of the coefficients of t², t³, ... over that of t";
            save_vector(at, "shape_numbers", &numbers.concat(), &index(meaning, &["number"]))?;
            let heading = index("unit tangent in the middle", &["element", "xy"]);
            save_points(at, "heading", &self.heading, &heading)?;
            let arc = index("fraction of the length of the edge", &["element", "start, end"]);
            save_points(at, "arc", &self.arc, &arc)?;
        }
        save_texts(at, "side_names", &self.side_names, "names of the sides", "side")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (vertices, elements) = (load_points(at, "nodes")?, load_pairs(at, "elements")?);
        if let Some(e) = elements.iter().enumerate().position(|(e, element)| element[0] != e) {
            return Err(invalid(at, "elements", format!("element {e} starts at node {}", elements[e][0])));
        }
        let next: Vec<usize> = elements.iter().map(|element| element[1]).collect();
        let edge = load_integers(at, "edge")?;
        let span = load_points(at, "span")?;
        let (shape, heading, arc) = match at.link_exists("shape") {
            true => (shapes(at)?, load_points(at, "heading")?, load_points(at, "arc")?),
            false => (vec![Shape::Line; vertices.len()], edge_tangents(&vertices, &next, &edge), span.clone()),
        };
        let mesh = Self {
            shape,
            heading,
            arc,
            vertices,
            next,
            degree: load_integers(at, "degree")?,
            edge,
            side: load_integers(at, "side")?,
            span,
            side_names: load_texts(at, "side_names")?,
        };
        mesh.check().map_err(|e| invalid(at, "", e))?;
        if let Some(side) = mesh.side.iter().find(|&&side| side >= mesh.side_names.len()) {
            return Err(invalid(at, "side", format!("side {side} of {}", mesh.side_names.len())));
        }
        Ok(mesh)
    }
}

impl Persist for Space {
    const KIND: &'static str = "displacement and traction unknowns of a boundary mesh";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let meaning = "first node of each element, and the number of nodes; the differences are the degrees";
        save_integers(at, "offset", &self.offset, &index(meaning, &["element, end"]))?;
        save_integers(at, "next", &self.next, &index("successor of each element on its loop", &["element"]))?;
        let meaning = "nodes: start of each element, then its inner Gauss-Lobatto points";
        save_points(at, "points", &self.points, &Label { unit: "length", meaning, axes: &["node", "xy"] })
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (offset, next) = (load_integers(at, "offset")?, load_integers(at, "next")?);
        Space::from_parts(offset, next, load_points(at, "points")?).map_err(|e| misfit(at, e))
    }
}

/// Number of the kind of a path, and its parameters.
fn path_numbers(path: Path) -> (usize, [f64; 5]) {
    match path {
        Path::Line => (0, [0.0; 5]),
        Path::Arc { opening } => (1, [opening, 0.0, 0.0, 0.0, 0.0]),
        Path::Ellipse { radii: [a, b], angle, start, opening } => (2, [a, b, angle, start, opening]),
        Path::Cubic { control: [[a, b], [c, d]] } => (3, [a, b, c, d, 0.0]),
    }
}

fn paths(at: &Group, corners: usize) -> Result<Vec<Path>, IoError> {
    let (kinds, numbers) = (load_integers(at, "path")?, load_vector(at, "path_numbers")?);
    check_length(at, "path", kinds.len(), corners)?;
    check_length(at, "path_numbers", numbers.len(), 5 * corners)?;
    let path = |(kind, n): (&usize, &[f64])| match kind {
        0 => Ok(Path::Line),
        1 => Ok(Path::Arc { opening: n[0] }),
        2 => Ok(Path::Ellipse { radii: [n[0], n[1]], angle: n[2], start: n[3], opening: n[4] }),
        3 => Ok(Path::Cubic { control: [[n[0], n[1]], [n[2], n[3]]] }),
        kind => Err(invalid(at, "path", format!("there is no kind {kind}"))),
    };
    kinds.iter().zip(numbers.chunks_exact(5)).map(path).collect()
}

fn shape_numbers(shape: &Shape) -> Vec<f64> {
    match shape {
        Shape::Line => Vec::new(),
        Shape::Arc(half_opening) => vec![*half_opening],
        Shape::Polynomial(_) => shape.coefficients().iter().flat_map(|b| [b.re, b.im]).collect(),
    }
}

fn shapes(at: &Group) -> Result<Vec<Shape>, IoError> {
    let (counts, numbers) = (load_integers(at, "shape")?, load_vector(at, "shape_numbers")?);
    check_length(at, "shape_numbers", numbers.len(), counts.iter().sum())?;
    let mut rest = &numbers[..];
    let mut shape = |&count: &usize| {
        let (own, after) = rest.split_at(count);
        rest = after;
        match own {
            [] => Ok(Shape::Line),
            [half_opening] => Ok(Shape::Arc(*half_opening)),
            _ if count % 2 == 0 => Ok(Shape::polynomial(own)),
            _ => Err(invalid(at, "shape", format!("a polynomial of {count} numbers; they come in pairs"))),
        }
    };
    counts.iter().map(&mut shape).collect()
}

pub(crate) const TRACTION: &str = "traction: Legendre coefficients by element, component fastest";
pub(crate) const DISPLACEMENT: &str = "displacement: nodes, component fastest";

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
