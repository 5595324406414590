//! Scenes as data, written as TOML in rotated coordinates and in other units.

use std::fmt::Write;

/// Condition on a side; expressions in the case's own coordinates and units.
#[derive(Debug, Clone)]
pub enum On {
    /// Traction.
    Traction([String; 2]),
    /// Pressure.
    Pressure(String),
    /// Both components of the displacement.
    Held([String; 2]),
    /// One component of the displacement, the other one "free", and the traction beside it; only in the plain view.
    Partly([String; 2], [String; 2]),
    /// Contact: gap and bound of friction, none for frictionless.
    Contact(String, Option<String>),
}

impl On {
    /// A traction.
    pub fn traction(x: &str, y: &str) -> Self {
        Self::Traction([x.into(), y.into()])
    }

    /// A pressure.
    pub fn pressure(p: &str) -> Self {
        Self::Pressure(p.into())
    }

    /// A held displacement.
    pub fn held(x: &str, y: &str) -> Self {
        Self::Held([x.into(), y.into()])
    }

    /// Frictionless contact.
    pub fn smooth(gap: &str) -> Self {
        Self::Contact(gap.into(), None)
    }

    /// Contact with Tresca friction.
    pub fn rough(gap: &str, bound: &str) -> Self {
        Self::Contact(gap.into(), Some(bound.into()))
    }
}

/// A scene that knows how to be rotated and rescaled.
#[derive(Debug, Clone)]
pub struct Case {
    /// Outer corners with the name of the side that begins at each.
    pub outer: Vec<([f64; 2], String)>,
    /// Holes, in the same form.
    pub holes: Vec<Vec<([f64; 2], String)>>,
    /// Young's modulus.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Whether in plane stress.
    pub plane_stress: bool,
    /// Conditions by the name of the side.
    pub sides: Vec<(String, On)>,
    /// Constant body force; none without.
    pub body_force: Option<[f64; 2]>,
    /// Lines of the table `[method]`.
    pub method: String,
}

/// How a case is looked at: turned by an angle about the origin, its lengths and stresses multiplied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Angle, counter-clockwise (radian).
    pub angle: f64,
    /// New length of an old unit length.
    pub length: f64,
    /// New stress of an old unit stress.
    pub stress: f64,
}

impl View {
    /// As it is.
    pub const PLAIN: View = View { angle: 0.0, length: 1.0, stress: 1.0 };
}

/// A vector turned by an angle.
pub fn rotated([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    [c * x - s * y, s * x + c * y]
}

/// Where a point of the case is in the view.
pub fn point_of(view: &View, x: [f64; 2]) -> [f64; 2] {
    rotated(x, view.angle).map(|c| view.length * c)
}

impl Case {
    /// A convex or other polygon of which side k is called by the k-th name.
    pub fn new(corners: &[[f64; 2]], names: &[&str], poisson: f64) -> Self {
        let outer = corners.iter().zip(names).map(|(x, n)| (*x, (*n).to_owned())).collect();
        Self {
            outer,
            holes: Vec::new(),
            young: 200.0,
            poisson,
            plane_stress: false,
            sides: Vec::new(),
            body_force: None,
            method: String::new(),
        }
    }

    /// The square of side 1 about the origin with the sides floor, right, top, left.
    pub fn square(poisson: f64) -> Self {
        Self::new(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], &["floor", "right", "top", "left"], poisson)
    }

    /// With a condition on a side.
    pub fn on(mut self, side: &str, condition: On) -> Self {
        self.sides.push((side.to_owned(), condition));
        self
    }

    /// With lines of `[method]`.
    pub fn method(mut self, lines: &str) -> Self {
        self.method = lines.to_owned();
        self
    }

    /// The scene in TOML.
    pub fn toml(&self, view: &View) -> String {
        let mut text = String::from("[body]\n");
        let outline = |text: &mut String, corners: &[([f64; 2], String)]| {
            let points: Vec<_> = corners.iter().map(|(x, _)| format!("{:?}", point_of(view, *x))).collect();
            let names: Vec<_> = corners.iter().map(|(_, n)| format!("{n:?}")).collect();
            let _ = writeln!(text, "corners = [{}]\nsides = [{}]", points.join(", "), names.join(", "));
        };
        outline(&mut text, &self.outer);
        for hole in &self.holes {
            text.push_str("[[body.holes]]\n");
            outline(&mut text, hole);
        }
        let plane = if self.plane_stress { "stress" } else { "strain" };
        let (young, poisson) = (self.young * view.stress, self.poisson);
        let _ = writeln!(text, "[material]\nyoung = {young:?}\npoisson = {poisson:?}\nplane = \"{plane}\"");
        for (side, condition) in &self.sides {
            let _ = writeln!(text, "[sides.{side}]");
            let _ = match condition {
                On::Traction(t) => {
                    let [x, y] = turned(view, view.stress, t);
                    writeln!(text, "traction = [\"{x}\", \"{y}\"]")
                }
                On::Held(u) => {
                    let [x, y] = turned(view, view.length, u);
                    writeln!(text, "displacement = [\"{x}\", \"{y}\"]")
                }
                On::Partly([u, v], [x, y]) => {
                    assert_eq!(*view, View::PLAIN, "held components have their axes");
                    writeln!(text, "displacement = [\"{u}\", \"{v}\"]\ntraction = [\"{x}\", \"{y}\"]")
                }
                On::Pressure(p) => writeln!(text, "pressure = \"{}\"", scalar(view, view.stress, p)),
                On::Contact(gap, bound) => {
                    let gap = scalar(view, view.length, gap);
                    let friction = bound.as_ref().map(|f| scalar(view, view.stress, f));
                    let friction = friction.map_or(String::new(), |f| format!(", friction = {{ tresca = \"{f}\" }}"));
                    writeln!(text, "contact = {{ gap = \"{gap}\"{friction} }}")
                }
            };
        }
        if let Some(b) = self.body_force {
            let [x, y] = rotated(b, view.angle).map(|c| c * view.stress / view.length);
            let _ = writeln!(text, "[body_force]\nvalue = [\"{x:?}\", \"{y:?}\"]");
        }
        let _ = writeln!(text, "[method]\n{}", self.method);
        text
    }
}

/// An expression in the coordinates of the view, its value multiplied.
fn scalar(view: &View, factor: f64, expression: &str) -> String {
    let moved = if view.angle == 0.0 && view.length == 1.0 { expression.to_owned() } else { moved(view, expression) };
    if factor == 1.0 { moved } else { format!("{factor:?}*({moved})") }
}

/// Components of a vector in the view.
fn turned(view: &View, factor: f64, [x, y]: &[String; 2]) -> [String; 2] {
    let [x, y] = [scalar(view, factor, x), scalar(view, factor, y)];
    if view.angle == 0.0 {
        return [x, y];
    }
    let (s, c) = view.angle.sin_cos();
    [format!("{c:?}*({x}) - {s:?}*({y})"), format!("{s:?}*({x}) + {c:?}*({y})")]
}

/// The expression with x and y written in the coordinates of the view.
fn moved(view: &View, expression: &str) -> String {
    let (s, c) = view.angle.sin_cos();
    let (s, c) = (s / view.length, c / view.length);
    let (x, y) = (format!("({c:?}*x + {s:?}*y)"), format!("({c:?}*y - {s:?}*x)"));
    let mut out = String::new();
    let mut word = String::new();
    for letter in expression.chars().chain([' ']) {
        if letter.is_ascii_alphanumeric() || letter == '_' || letter == '.' {
            word.push(letter);
            continue;
        }
        out.push_str(match word.as_str() {
            "x" => &x,
            "y" => &y,
            other => other,
        });
        word.clear();
        out.push(letter);
    }
    out.trim_end().to_owned()
}
