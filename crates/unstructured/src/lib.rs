//! Unstructured grids of the plane: points, cells and fields on them, as plain data.
//!
//! ```
//! use steklov_unstructured::{Field, Grid};
//!
//! let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
//! let height = Field { name: "height".into(), unit: "length".into(), components: 1, values: vec![0.0, 0.0, 2.0] };
//! let grid = Grid { points, triangles: vec![[0, 1, 2]], point_data: vec![height], ..Grid::default() };
//! assert_eq!(Grid::field(&grid.point_data, "height", 1).map(|f| f.values[2]), Some(2.0));
//! ```

/// Values at points or in cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Name shown by the viewer.
    pub name: String,
    /// Unit, stored in an attribute.
    pub unit: String,
    /// Numbers per point or cell; 3 make a vector, by which a viewer can warp the grid.
    pub components: usize,
    /// Values, component fastest.
    pub values: Vec<f64>,
}

/// Points, cells and fields.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Points (length).
    pub points: Vec<[f64; 2]>,
    /// Lines of the boundary: part 0, the first cells.
    pub lines: Vec<[usize; 2]>,
    /// Triangles of the body: part 1, the cells after the lines.
    pub triangles: Vec<[usize; 3]>,
    /// Quadrilaterals of the body, counter-clockwise: part 1, the last cells.
    pub quads: Vec<[usize; 4]>,
    /// Fields on the points.
    pub point_data: Vec<Field>,
    /// Fields on the cells: lines first, then triangles, then quadrilaterals.
    pub cell_data: Vec<Field>,
}

impl Grid {
    /// The field with this name and as many components, among those at the points, or in the cells.
    pub fn field<'a>(fields: &'a [Field], name: &str, components: usize) -> Option<&'a Field> {
        fields.iter().find(|field| field.name == name && field.components == components)
    }
}
