//! The body to look into: triangles whose corners have displacement and stress, as the script of the page reads them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use steklov_elastic::plane::norm;
use steklov_figures::obstacles;
use steklov_io::vtkhdf::{Field, Grid};
use steklov_picture::{exaggeration, lattice_triangles};
use steklov_result::grid::{GridRecord, of_quads};
use steklov_result::record::Record;

/// Points of a body on a grid, about.
const GRID_POINTS: usize = 5000;

/// With more points than this a body would take more than half of the page.
const MOST_POINTS: usize = 9000;

/// Triangles and the fields at their corners.
#[derive(Default)]
pub(crate) struct Body {
    points: Vec<[f64; 2]>,
    displacement: Vec<[f64; 2]>,
    /// σ_xx, σ_yy, σ_xy.
    stress: Vec<[f64; 3]>,
    von_mises: Vec<f64>,
    triangles: Vec<[usize; 3]>,
    outline: Vec<[usize; 2]>,
    /// Points of contact sides and the gap vectors there, a list of each for each stretch.
    walls: [Vec<Vec<[f64; 2]>>; 2],
    /// The factor at which the other pictures draw displacements.
    magnification: f64,
}

/// Numbers as the script reads them: each is `scale` times a float of four bytes, little-endian.
#[derive(Serialize)]
struct Numbers {
    scale: f64,
    base64: String,
}

/// What the page holds of a body.
#[derive(Serialize)]
struct Embedded {
    /// The point that x and y are relative to.
    origin: [f64; 2],
    x: Numbers,
    y: Numbers,
    ux: Numbers,
    uy: Numbers,
    xx: Numbers,
    yy: Numbers,
    xy: Numbers,
    mises: Numbers,
    /// Corners, integers of two bytes, little-endian.
    triangles: String,
    outline: String,
    walls: Vec<Wall>,
    magnification: f64,
}

/// An obstacle: the line through points of the side and their gaps.
#[derive(Serialize)]
struct Wall {
    x: Numbers,
    y: Numbers,
    gx: Numbers,
    gy: Numbers,
}

/// The body of a result, and the medium around it; None of one that has no triangles or too many points for a page.
pub(crate) fn body(stored: &Record) -> Option<Body> {
    let mut body = match &stored.on_grid {
        Some(record) => on_grid(stored, record)?,
        None => of_points(&stored.grid)?,
    };
    let far = |i: usize| body.points.iter().map(move |x| x[i]);
    let extent = [0, 1].map(|i| far(i).fold(f64::NEG_INFINITY, f64::max) - far(i).fold(f64::INFINITY, f64::min));
    let size = extent[0].max(extent[1]);
    let displacements = stored.displacement.iter().chain(&body.displacement).map(|u| norm(*u));
    body.magnification = exaggeration(
        displacements.filter(|u| u.is_finite()).fold(0.0, f64::max) / size,
        stored.largest_factor().factor,
    );
    body.walls = obstacles(stored);
    (!body.triangles.is_empty() && body.points.len() <= MOST_POINTS).then_some(body)
}

fn field<'a>(fields: &'a [Field], name: &str, components: usize) -> Option<&'a [f64]> {
    Grid::field(fields, name, components).map(|f| f.values.as_slice())
}

fn planar(values: &[f64]) -> impl Iterator<Item = [f64; 2]> + '_ {
    values.chunks_exact(3).map(|u| [u[0], u[1]])
}

fn triples(values: &[f64]) -> impl Iterator<Item = [f64; 3]> + '_ {
    values.chunks_exact(3).map(|s| [s[0], s[1], s[2]])
}

/// Triangles with fields at their points.
fn of_points(grid: &Grid) -> Option<Body> {
    let at_points = |name: &str, components: usize| field(&grid.point_data, name, components);
    Some(Body {
        points: grid.points.clone(),
        displacement: planar(at_points("displacement", 3)?).collect(),
        stress: triples(at_points("stress", 3)?).collect(),
        von_mises: at_points("von_mises", 1)?.to_vec(),
        triangles: grid.triangles.clone(),
        outline: grid.lines.clone(),
        ..Body::default()
    })
}

/// Sums of stresses in cells around points, and their number.
struct Means(Vec<([f64; 4], f64)>);

impl Means {
    fn add(&mut self, point: usize, [xx, yy, xy]: [f64; 3], von_mises: f64) {
        let (sums, count) = &mut self.0[point];
        for (sum, value) in sums.iter_mut().zip([xx, yy, xy, von_mises]) {
            *sum += value;
        }
        *count += 1.0;
    }

    /// The means are those of a body's points.
    fn give(self, body: &mut Body) {
        for (sums, count) in self.0 {
            let [xx, yy, xy, von_mises] = sums.map(|sum| sum / count);
            body.stress.push([xx, yy, xy]);
            body.von_mises.push(von_mises);
        }
    }
}

/// Few triangles over the cells of a grid, and those of the medium around it, with the means of the stresses around each point.
fn on_grid(stored: &Record, record: &GridRecord) -> Option<Body> {
    let (fields, grid) = (&stored.grid, &record.body.grid);
    let displacement: Vec<[f64; 2]> = planar(field(&fields.point_data, "displacement", 3)?).collect();
    let lattice = lattice_triangles(grid.spacing, grid.cells, |ix, iy| grid.inside(ix, iy), GRID_POINTS);
    let [nx, ny] = grid.cells;
    let mut quad = vec![usize::MAX; nx * ny];
    grid.body_cells().enumerate().for_each(|(k, cell)| quad[cell] = k);
    let quad = &quad;
    let stress: Vec<[f64; 3]> = triples(of_quads(fields, "stress", 3)?).collect();
    let von_mises = of_quads(fields, "von_mises", 1)?;
    // points of the medium stand behind the nodes of the grid
    let (first, offset) = (grid.nodes(), lattice.points.len());
    let mut means = Means(vec![([0.0; 4], 0.0); offset + fields.points.len() - first]);
    for (point, &[i, j]) in lattice.points.iter().enumerate() {
        let near = |k: usize, n: usize| k.saturating_sub(1)..(k + 1).min(n);
        let around = near(i, nx).flat_map(|ix| near(j, ny).map(move |iy| quad[ix * ny + iy]));
        around.filter(|&k| k != usize::MAX).for_each(|k| means.add(point, stress[k], von_mises[k]));
    }
    let of_triangles = |name: &str, components: usize| {
        field(&fields.cell_data, name, components).and_then(|values| values.get(components * fields.lines.len()..))
    };
    let (of_stress, of_von_mises) = (of_triangles("stress", 3)?, of_triangles("von_mises", 1)?);
    for ((corners, stress), von_mises) in fields.triangles.iter().zip(triples(of_stress)).zip(of_von_mises) {
        corners.iter().for_each(|corner| means.add(corner - first + offset, stress, *von_mises));
    }
    // each point of the lattice is the corner of a cell of the body
    let nodes = lattice.points.iter().map(|&[i, j]| grid.node(i, j).map_or([0.0; 2], |node| displacement[node]));
    let around = fields.triangles.iter().map(|corners| corners.map(|i| i - first + offset));
    let mut body = Body {
        points: lattice
            .points
            .iter()
            .map(|&p| grid.lattice_point(p))
            .chain(fields.points[first..].iter().copied())
            .collect(),
        displacement: nodes.chain(displacement[first..].iter().copied()).collect(),
        triangles: lattice.triangles.iter().copied().chain(around).collect(),
        outline: lattice.outline,
        ..Body::default()
    };
    means.give(&mut body);
    Some(body)
}

impl Body {
    /// The number of points, and of triangles.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [self.points.len(), self.triangles.len()]
    }

    /// Whether there is an obstacle.
    pub(crate) fn has_walls(&self) -> bool {
        !self.walls[0].is_empty()
    }

    /// The object that the script of the page reads.
    pub(crate) fn json(&self) -> Result<String, serde_json::Error> {
        let origin = self.points.first().copied().unwrap_or_default();
        let points = |i: usize| numbers(self.points.iter().map(|x| x[i] - origin[i]));
        let displacement = |i: usize| numbers(self.displacement.iter().map(|u| u[i]));
        let stress = |i: usize| numbers(self.stress.iter().map(|s| s[i]));
        let [lines, gaps] = &self.walls;
        let wall = |(points, gaps): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| Wall {
            x: numbers(points.iter().map(|x| x[0] - origin[0])),
            y: numbers(points.iter().map(|x| x[1] - origin[1])),
            gx: numbers(gaps.iter().map(|g| g[0])),
            gy: numbers(gaps.iter().map(|g| g[1])),
        };
        serde_json::to_string(&Embedded {
            origin,
            x: points(0),
            y: points(1),
            ux: displacement(0),
            uy: displacement(1),
            xx: stress(0),
            yy: stress(1),
            xy: stress(2),
            mises: numbers(self.von_mises.iter().copied()),
            triangles: indices(self.triangles.iter().flatten()),
            outline: indices(self.outline.iter().flatten()),
            walls: lines.iter().zip(gaps).map(wall).collect(),
            magnification: self.magnification,
        })
    }
}

fn numbers(values: impl Iterator<Item = f64> + Clone) -> Numbers {
    let largest = values.clone().filter(|v| v.is_finite()).fold(0.0, |largest: f64, v| largest.max(v.abs()));
    let scale = if largest > 0.0 { largest } else { 1.0 };
    let bytes: Vec<u8> = values.flat_map(|v| ((v / scale) as f32).to_le_bytes()).collect();
    Numbers { scale, base64: STANDARD.encode(bytes) }
}

/// There are at most [`MOST_POINTS`], so that two bytes hold each.
fn indices<'a>(values: impl Iterator<Item = &'a usize>) -> String {
    STANDARD.encode(values.flat_map(|&i| (i as u16).to_le_bytes()).collect::<Vec<u8>>())
}
