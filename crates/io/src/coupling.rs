//! [`Persist`] for the types of `steklov-coupling`.
//!
//! The space of a medium is rebuilt from its mesh, with the same bits.

use hdf5::Group;
use sprs::CsMat;
use steklov_bem_operators::{Mesh, Operators, Polygon, Space};
use steklov_coupling::{Balance, CellIndicators, Coupled, InterfaceIndicators, Medium, Trace, Transfer};
use steklov_elastic::plane::{cross, dot, minus};

use crate::array::{load_integers, load_points, load_vector, save_integers, save_points, save_vector};
use crate::dataset::label;
use crate::error::{IoError, invalid, mismatch};
use crate::matrix::{load_sparse, save_sparse};
use crate::persist::{Persist, load, save};
use crate::quadrature::check_length;

const TRACE: &str = "unknown of the trace";
const DISPLACEMENT: &str = "displacement of the boundary elements: nodes, component fastest";
const TRACTION: &str = "traction of the boundary elements: Legendre coefficients by element, component fastest";

/// Distance of a point from its edge, in parts of the edge, that counts as rounding.
const ACROSS: f64 = 1e-9;

/// Demands numbers that are neither NaN nor infinite.
fn check_finite<'a>(at: &Group, name: &str, values: impl IntoIterator<Item = &'a f64>) -> Result<(), IoError> {
    match values.into_iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((k, value)) => Err(invalid(at, name, format!("entry {k} is {value}: it must be finite"))),
        None => Ok(()),
    }
}

/// Finite numbers; `n` of them if that is known.
fn load_finite(at: &Group, name: &str, n: Option<usize>) -> Result<Vec<f64>, IoError> {
    let values = load_vector(at, name)?;
    check_length(at, name, values.len(), n.unwrap_or(values.len()))?;
    check_finite(at, name, &values)?;
    Ok(values)
}

/// A matrix of finite numbers.
fn load_finite_sparse(at: &Group, name: &str) -> Result<CsMat<f64>, IoError> {
    let matrix = load_sparse(at, name)?;
    check_finite(at, name, matrix.data())?;
    Ok(matrix)
}

/// Two finite numbers.
fn load_pair(at: &Group, name: &str) -> Result<[f64; 2], IoError> {
    let values = load_finite(at, name, Some(2))?;
    Ok([values[0], values[1]])
}

/// Squares of energy norms: none may be negative or NaN.
fn load_squares(at: &Group, name: &str, n: Option<usize>) -> Result<Vec<f64>, IoError> {
    let values = load_vector(at, name)?;
    check_length(at, name, values.len(), n.unwrap_or(values.len()))?;
    match values.iter().enumerate().find(|(_, value)| value.is_nan() || **value < 0.0) {
        Some((k, value)) => Err(invalid(at, name, format!("entry {k} is {value}: it is the square of an energy"))),
        None => Ok(values),
    }
}

/// Checks that the points run along the outline, one edge after the other from corner to corner.
fn check_points(polygon: &Polygon, points: &[[f64; 2]]) -> Result<(), String> {
    let mut k = 0;
    for (number, edge) in polygon.edges().iter().enumerate() {
        let [start, end] = [edge.start, edge.end];
        let (length, mut last) = (edge.length(), 0.0);
        if points.get(k) != Some(&start) {
            return Err(format!(
                "point {k} is not the corner ({}, {}) at the start of edge {number}",
                start[0], start[1]
            ));
        }
        k += 1;
        while let Some(x) = points.get(k).filter(|x| **x != end) {
            let (d, r) = (minus(end, start), minus(*x, start));
            let along = dot(r, d) / (length * length);
            let across = cross(d, r) / (length * length);
            // NaN fails, too
            if !(last < along && along < 1.0 && across.abs() < ACROSS) {
                return Err(format!(
                    "point {k} ({}, {}) does not follow the one before it on edge {number}",
                    x[0], x[1]
                ));
            }
            (k, last) = (k + 1, along);
        }
    }
    if k == points.len() { Ok(()) } else { Err(format!("{} points follow the last edge", points.len() - k)) }
}

impl Persist for Trace {
    const KIND: &'static str = "displacement on the outer boundary";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save(at, "polygon", &self.polygon)?;
        let meaning = "points between which the displacement is linear, along the polygon from its first corner";
        save_points(at, "points", &self.points, &label("length", meaning, &["point", "xy"]))?;
        let meaning = "unknowns of the body on which the displacement depends";
        save_integers(at, "unknowns", &self.unknowns, &label("1", meaning, &[TRACE]))?;
        let axes = &["displacement: points, component fastest", TRACE];
        save_sparse(at, "values", &self.values, &label("1", "displacement of the points by these unknowns", axes))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (polygon, points): (Polygon, _) = (load(at, "polygon")?, load_points(at, "points")?);
        check_points(&polygon, &points).map_err(|why| invalid(at, "points", why))?;
        let unknowns = load_integers(at, "unknowns")?;
        let mut sorted = unknowns.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(invalid(at, "unknowns", format!("{} stands there twice", pair[0])));
        }
        let values = load_finite_sparse(at, "values")?;
        let needed = (2 * points.len(), unknowns.len());
        if values.shape() != needed {
            return Err(mismatch(at, "values", format!("a matrix {needed:?}"), format!("{:?}", values.shape())));
        }
        Ok(Self { polygon, points, unknowns, values })
    }
}

impl Persist for Transfer {
    const KIND: &'static str = "transfer from a trace to boundary elements";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let meaning =
            label("1", "Pi, the trace in the displacement space of the boundary elements", &[DISPLACEMENT, TRACE]);
        save_sparse(at, "projection", &self.projection, &meaning)?;
        let meaning = label("length", "B, moments of the trace against the tractions", &[TRACTION, TRACE]);
        save_sparse(at, "mass", &self.mass, &meaning)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (projection, mass) = (load_finite_sparse(at, "projection")?, load_finite_sparse(at, "mass")?);
        // a closed loop has as many coefficients of tractions as nodes
        if projection.shape() != mass.shape() {
            return Err(mismatch(
                at,
                "mass",
                format!("a matrix {:?}", projection.shape()),
                format!("{:?}", mass.shape()),
            ));
        }
        Ok(Self { projection: projection.to_csc(), mass: mass.to_csc() })
    }
}

impl Persist for Medium {
    const KIND: &'static str = "unbounded medium";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save(at, "mesh", &self.mesh)?;
        save(at, "material", &self.material)?;
        save(at, "operators", &self.operators)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let mesh: Mesh = load(at, "mesh")?;
        let space = Space::new(&mesh);
        let operators: Operators = load(at, "operators")?;
        let Operators { v, k, w, mass, length, diameter } = &operators;
        if (v.nrows(), w.nrows()) != (space.dofs(), space.dofs()) {
            let why = format!("V has {} rows and W {}, the mesh {} unknowns", v.nrows(), w.nrows(), space.dofs());
            return Err(invalid(at, "operators", why));
        }
        for (name, matrix) in [("operators/V", v), ("operators/K", k), ("operators/W", w)] {
            matrix.col_iter().try_for_each(|column| check_finite(at, name, column.iter()))?;
        }
        check_finite(at, "operators/M", mass.data())?;
        for (name, value) in [("operators/length", *length), ("operators/diameter", *diameter)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(invalid(at, name, format!("{value} is no length")));
            }
        }
        Ok(Self { mesh, space, material: load(at, "material")?, operators })
    }
}

impl Persist for Coupled {
    const KIND: &'static str = "solution in a body and the medium around it";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let displacement =
            |name, values: &[f64], meaning, axis| save_vector(at, name, values, &label("length", meaning, &[axis]));
        displacement("displacement", &self.displacement, "unknowns of the body", "unknown: component fastest")?;
        displacement("trace", &self.trace, "displacement u of the body", DISPLACEMENT)?;
        displacement("exterior_displacement", &self.exterior_displacement, "u_c of the medium", DISPLACEMENT)?;
        displacement("constant", &self.constant, "displacement a at infinity", "component")?;
        let meaning = "sigma(u_c) n of the medium, n out of the body";
        save_vector(at, "traction", &self.traction, &label("stress", meaning, &[TRACTION]))?;
        let force = |name, values: &[f64], meaning, axis| {
            save_vector(at, name, values, &label("force/thickness", meaning, &[axis]))
        };
        force("resultant", &self.balance.force, "resultant of body force and jump of tractions", "component")?;
        force("load_scale", &[self.balance.scale], "sum of absolute nodal loads", "value")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let trace = load_finite(at, "trace", None)?;
        let n = Some(trace.len());
        if trace.len() % 2 != 0 {
            return Err(invalid(at, "trace", format!("{} numbers are no vectors of two", trace.len())));
        }
        let scale = load_finite(at, "load_scale", Some(1))?[0];
        if scale < 0.0 {
            return Err(invalid(at, "load_scale", format!("{scale} is no sum of absolute values")));
        }
        Ok(Self {
            displacement: load_finite(at, "displacement", None)?,
            exterior_displacement: load_finite(at, "exterior_displacement", n)?,
            traction: load_finite(at, "traction", n)?,
            constant: load_pair(at, "constant")?,
            balance: Balance { force: load_pair(at, "resultant")?, scale },
            trace,
        })
    }
}

impl Persist for InterfaceIndicators {
    const KIND: &'static str = "residual indicators of boundary elements between body and medium";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let term = |name, values: &[f64], meaning| {
            save_vector(at, name, values, &label("force*length/thickness", meaning, &["boundary element"]))
        };
        term("traction", &self.traction, "h/E1 of the balance of tractions")?;
        term("displacement", &self.displacement, "h E2 of the slope of the first equation of the medium")?;
        if let Some(values) = &self.hypersingular {
            term("hypersingular", values, "h/E2 of the second equation of the medium")?;
        }
        term("traction_error", &self.traction_error, "squared error of the traction of the medium in the norm of V")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let traction = load_squares(at, "traction", None)?;
        let term = |name| load_squares(at, name, Some(traction.len()));
        Ok(Self {
            displacement: term("displacement")?,
            hypersingular: if at.link_exists("hypersingular") { Some(term("hypersingular")?) } else { None },
            traction_error: term("traction_error")?,
            traction,
        })
    }
}

impl Persist for CellIndicators {
    const KIND: &'static str = "residual indicators of the cells of a grid";
    const VERSION: u32 = 2;
    const OLDEST: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let term = |name, values: &[f64], meaning| {
            save_vector(at, name, values, &label("force*length/thickness", meaning, &["cell"]))
        };
        term("volume", &self.volume, "h^2/E of the body force and the divergence of the stress")?;
        term("jump", &self.jump, "half of h^2/E of the jumps of the traction between cells")?;
        term("neumann", &self.neumann, "h/E of the given traction less that of the solution")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let volume = load_squares(at, "volume", None)?;
        let cells = Some(volume.len());
        let jump = load_squares(at, "jump", cells)?;
        // version 1 had no tractions
        let neumann = match at.link_exists("neumann") {
            true => load_squares(at, "neumann", cells)?,
            false => vec![0.0; volume.len()],
        };
        Ok(Self { volume, jump, neumann })
    }
}
