//! The command `study` on scenes with solutions in closed form: rates against theory, energies.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::place::Place;
use serde_json::Value;
use steklov_quadrature::gauss_legendre;

/// sin(3π/2 λ) = λ: the symmetric singularity of a free re-entrant corner of 270 degrees.
const LAMBDA: f64 = 0.544_483_736_782_464;
const YOUNG: f64 = 1.0;
const POISSON: f64 = 0.3;

/// A field of the stress functions φ = z^λ/λ and ψ = b z^λ/λ (Muskhelishvili, plane strain), z = (x - origin) + iy, with b
/// such that the rays at ±135 degrees are free of traction.
struct Wedge {
    origin: f64,
}

impl Wedge {
    fn b() -> f64 {
        -((1.5 * PI * LAMBDA).cos() + LAMBDA * (1.5 * PI).cos())
    }

    fn polar(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        ((x - self.origin).hypot(y), y.atan2(x - self.origin))
    }

    /// u, from 2μ(u_x + iu_y) = κφ - z φ'* - ψ*.
    fn displacement(&self, point: [f64; 2]) -> [f64; 2] {
        let (r, t) = self.polar(point);
        let (mu, kappa, b) = (YOUNG / (2.0 * (1.0 + POISSON)), 3.0 - 4.0 * POISSON, Self::b());
        let scale = r.powf(LAMBDA) / (2.0 * mu);
        let (l, m) = (LAMBDA * t, (2.0 - LAMBDA) * t);
        [scale * ((kappa - b) / LAMBDA * l.cos() - m.cos()), scale * ((kappa + b) / LAMBDA * l.sin() - m.sin())]
    }

    /// σ_xx, σ_yy, σ_xy, from σ_xx + σ_yy = 4 Re φ' and σ_yy - σ_xx + 2iσ_xy = 2(z*φ'' + ψ').
    fn stress(&self, point: [f64; 2]) -> [f64; 3] {
        let (r, t) = self.polar(point);
        let (scale, m, b) = (r.powf(LAMBDA - 1.0), LAMBDA - 1.0, Self::b());
        let (near, far) = (m * t, (LAMBDA - 3.0) * t);
        let (sum, difference) = (4.0 * near.cos(), 2.0 * (m * far.cos() + b * near.cos()));
        [(sum - difference) / 2.0, (sum + difference) / 2.0, m * far.sin() + b * near.sin()].map(|s| scale * s)
    }

    /// The same stresses as texts for a scene.
    fn texts(&self) -> [String; 3] {
        let (m, b, shifted) = (LAMBDA - 1.0, Self::b(), format!("(x-({}))", self.origin));
        let (power, t) = (format!("({shifted}^2+y^2)^({})", m / 2.0), format!("atan2(y,{shifted})"));
        let (near, far) = (format!("({m})*{t}"), format!("({})*{t}", LAMBDA - 3.0));
        let normal = |sign: &str| format!("{power}*(2*cos({near}){sign}(({m})*cos({far})+({b})*cos({near})))");
        [normal("-"), normal("+"), format!("{power}*(({m})*sin({far})+({b})*sin({near}))")]
    }

    /// J = -½ ∫ t·u over straight sides with their normals.
    fn energy(&self, sides: &[([f64; 2], [f64; 2], [f64; 2])]) -> f64 {
        let rule = gauss_legendre(40);
        let work = sides.iter().map(|(a, b, n)| {
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let at = |x: f64| [0, 1].map(|i| a[i] + (b[i] - a[i]) * (1.0 + x) / 2.0);
            let density = |x: f64| {
                let (u, [xx, yy, xy]) = (self.displacement(at(x)), self.stress(at(x)));
                (xx * n[0] + xy * n[1]) * u[0] + (xy * n[0] + yy * n[1]) * u[1]
            };
            length / 2.0 * rule.points.iter().zip(&rule.weights).map(|(x, w)| w * density(*x)).sum::<f64>()
        });
        -work.sum::<f64>() / 2.0
    }
}

const BOX: [[f64; 2]; 4] = [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]];

/// A scene whose exact solution is the singular field at the tip of a notch, and its J.
fn notch() -> (String, f64) {
    let field = Wedge { origin: 0.0 };
    let [xx, yy, xy] = field.texts();
    let text = format!(
        r#"title = "Notch"
[body]
corners = [[0, 0], [-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]]
sides = ["notch", "bottom", "right", "top", "notch"]
[material]
young = {YOUNG}
poisson = {POISSON}
[sides.bottom]
traction = ["-({xy})", "-({yy})"]
[sides.right]
traction = ["{xx}", "{xy}"]
[sides.top]
traction = ["{xy}", "{yy}"]
"#
    );
    let [a, b, c, d] = BOX;
    (text, field.energy(&[(a, b, [0.0, -1.0]), (b, c, [1.0, 0.0]), (c, d, [0.0, 1.0])]))
}

/// A square in the same field, with the tip outside: its solution is smooth.
fn smooth() -> (String, f64) {
    let field = Wedge { origin: -1.2 };
    let [xx, yy, xy] = field.texts();
    let text = format!(
        r#"title = "Smooth"
[body]
corners = [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]]
sides = ["bottom", "right", "top", "left"]
[material]
young = {YOUNG}
poisson = {POISSON}
[sides.bottom]
traction = ["-({xy})", "-({yy})"]
[sides.right]
traction = ["{xx}", "{xy}"]
[sides.top]
traction = ["{xy}", "{yy}"]
[sides.left]
traction = ["-({xx})", "-({xy})"]
"#
    );
    let [a, b, c, d] = BOX;
    let sides = [(a, b, [0.0, -1.0]), (b, c, [1.0, 0.0]), (c, d, [0.0, 1.0]), (d, a, [-1.0, 0.0])];
    (text, field.energy(&sides))
}

/// The closed form itself: the notch is free of traction, and strains times Hooke are the stresses.
#[test]
fn the_closed_form_is_one() {
    assert!(((1.5 * PI * LAMBDA).sin() - LAMBDA).abs() < 1e-15);
    let field = Wedge { origin: 0.0 };
    for (point, n) in [([-0.3, 0.3], [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2]), ([-0.1, -0.1], [-FRAC_1_SQRT_2, FRAC_1_SQRT_2])]
    {
        let [xx, yy, xy] = field.stress(point);
        assert!((xx * n[0] + xy * n[1]).abs() < 1e-14 * xx.abs() && (xy * n[0] + yy * n[1]).abs() < 1e-14 * xx.abs());
    }
    let (h, [x, y]) = (1e-5, [0.2, 0.3]);
    let slope = |i: usize| {
        let step = |s: f64| field.displacement([x + if i == 0 { s } else { 0.0 }, y + if i == 1 { s } else { 0.0 }]);
        [0, 1].map(|k| (step(h)[k] - step(-h)[k]) / (2.0 * h))
    };
    let (dx, dy) = (slope(0), slope(1));
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let pressure = 2.0 * mu * POISSON / (1.0 - 2.0 * POISSON) * (dx[0] + dy[1]);
    let hooke = [pressure + 2.0 * mu * dx[0], pressure + 2.0 * mu * dy[1], mu * (dx[1] + dy[0])];
    let stress = field.stress([x, y]);
    assert!((0..3).all(|k| (hooke[k] - stress[k]).abs() < 1e-8), "{hooke:?} {stress:?}");
}

fn fit<'a>(o: &'a Value, name: &str, law: &str) -> &'a Value {
    let strategies = o["strategies"].as_array().unwrap();
    let strategy = strategies.iter().find(|s| s["name"] == name).unwrap_or_else(|| panic!("no {name}"));
    strategy["fits"].as_array().unwrap().iter().find(|f| f["law"] == law).unwrap_or_else(|| panic!("no {law}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Uniform h: N^-λ at the corner whatever the degree, N^-(p+½) without one; adaptive h: N^-(p+½) at the corner too; hp:
/// exponential. J and its errors are those of the closed form.
#[test]
fn rates_and_energies_of_closed_forms() {
    let place = Place::new();
    for (what, (text, energy), degree, theory) in [
        ("notch, degree 1", notch(), 1, LAMBDA),
        ("notch, degree 3", notch(), 3, LAMBDA),
        ("smooth, degree 1", smooth(), 1, 1.5),
        ("smooth, degree 2", smooth(), 2, 2.5),
    ] {
        place.write("scene.toml", &text);
        let settings = ["elements=8", "max_dofs=400", "tolerance=1e-5", &format!("degree={degree}")];
        let settings = settings.map(|s| format!("--set=method.{s}"));
        let all = what == "notch, degree 1";
        let strategies = if all { "uniform-h,h,hp" } else { "uniform-h" };
        let arguments =
            ["study", "scene.toml", "--repeat=1", "--json", "--quiet", "--force", "--strategies", strategies];
        let o = place.run(arguments.into_iter().chain(settings.iter().map(String::as_str))).demand(0).json();
        check_energies(what, &o, energy);
        let check = |strategy: &str, theory: f64, least: f64| {
            let fit = fit(&o, strategy, "algebraic");
            let (rate, r_squared) = (-number(&fit["rate"]), number(&fit["r_squared"]));
            assert!((rate - theory).abs() < 0.1 * theory, "{what}, {strategy}: N^-{rate}, not N^-{theory}");
            assert!(r_squared > least, "{what}, {strategy}: {fit}");
        };
        check("uniform-h", theory, 0.999);
        if all {
            check("h", 1.5, 0.98);
            let root = fit(&o, "hp", "square_root");
            assert!(number(&root["rate"]) < -0.5 && number(&root["r_squared"]) > 0.99, "{what}: {root}");
        }
    }
}

/// J of the reference and the energy errors of all steps against the exact J.
fn check_energies(what: &str, o: &Value, exact: f64) {
    let reference = &o["reference"];
    let off = (number(&reference["own_energy"]) - exact).abs();
    assert!(
        off <= number(&reference["uncertainty"]) && off <= 1e-9 * exact.abs(),
        "{what}: off by {off:e}, {reference}"
    );
    for step in o["strategies"].as_array().unwrap().iter().flat_map(|s| s["steps"].as_array().unwrap()) {
        let error = ((number(&step["energy"]) - exact) / exact).abs();
        let found = number(&step["energy_error"]).powi(2);
        assert!((found - error).abs() <= 1.01 * off / exact.abs() + 1e-15, "{what}: {error:e}, {step}");
    }
}

/// Energy errors are taken from the scene's energy where the study confirms it; where not, it says so.
#[test]
fn an_expected_energy_is_used_if_it_is_confirmed() {
    let place = Place::new();
    let (text, energy) = smooth();
    for (value, part, used) in [(energy, "by hand", true), (energy * (1.0 + 1e-6), "off", false)] {
        let expect = format!("[expect]\nenergy = {{ value = {value:?}, tol = 1e-3, source = \"by hand\" }}\n");
        place.write("scene.toml", text.clone() + &expect);
        let arguments = ["study", "scene.toml", "--strategies", "hp", "--repeat", "1", "--json", "--force"];
        let o = place.run(arguments.into_iter().chain(["--set", "method.tolerance=1e-5"])).demand(0).json();
        let reference = &o["reference"];
        assert!(reference["energy_source"].as_str().unwrap().contains(part), "{reference}");
        assert_eq!(number(&reference["energy"]) == value, used, "{reference}");
    }
}
