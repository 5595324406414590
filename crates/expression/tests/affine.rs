//! Expressions that are affine by their form: in names, and in the place.

use steklov_expression::{Expression, Value};

/// What is affine by its form; and there second differences vanish at every place.
#[test]
fn affine_expressions_are_found() {
    let constants = [("g", 0.3), ("h", -1.2), ("c", 2.0)].map(|(name, value)| (name.to_owned(), value)).into();
    let read = |text: &str| Expression::parse(text, &constants).unwrap_or_else(|e| panic!("{text}: {e}"));
    let affine = [
        "1",
        "x*y",
        "1000*(1 + 0.1*g)",
        "exp(x)*g - h/(1 + x^2)",
        "-(g + h)*c",
        "if(x > 0, g, 2*h)",
        "c^2*g",
        "g + g*x",
    ];
    let others = [
        "exp(g)",
        "g*h",
        "g^2",
        "1/g",
        "x/(1 + h)",
        "if(g > 0, 1, 2)",
        "abs(g)",
        "min(g, 1)",
        "g > 0",
        "sin(x*g)",
        "x^g",
        "g*g/g",
    ];
    let at = |text: &str, g: f64, h: f64, x: f64| {
        let values = [("g", g), ("h", h)].map(|(name, value)| (name.to_owned(), Value::Constant(value))).into();
        read(text).with_values(&values).eval(x, 0.7, 0.2)
    };
    for text in affine {
        assert!(read(text).is_affine_in(["g", "h"]), "{text}");
        for x in [-0.4, 0.9] {
            let off = at(text, 0.5, 2.0, x) - 2.0 * at(text, 1.0, 0.5, x) + at(text, 1.5, -1.0, x);
            assert!(off.abs() < 1e-12, "{text}: {off}");
        }
    }
    for text in others {
        assert!(!read(text).is_affine_in(["g", "h"]), "{text}");
    }
    assert!(read("exp(g)*h").is_affine_in(["h"]) && read("exp(g)").is_affine_in([]));
}

/// What is affine in the place by its form, with its coefficients; and the value is that of the plane everywhere.
#[test]
fn affine_functions_of_the_place_have_coefficients() {
    let constants = [("g", 9.81), ("w", 3.0)].map(|(name, value)| (name.to_owned(), value)).into();
    let read = |text: &str| Expression::parse(text, &constants).unwrap_or_else(|e| panic!("{text}: {e}"));
    for (text, want) in [
        ("2", [2.0, 0.0, 0.0]),
        ("-12*(2-y)", [-24.0, 0.0, 12.0]),
        ("w^2*(x - 0.5) - y/4", [-4.5, 9.0, -0.25]),
        ("(x + y)*(w - 1) - -x", [0.0, 3.0, 2.0]),
        ("if(w > 2, x, x^2)", [0.0, 1.0, 0.0]),
        ("sqrt(w + 1)*y^1 + 0*x", [0.0, 0.0, 2.0]),
        ("g*(x - x)*y", [0.0, 0.0, 0.0]),
    ] {
        let Some(found) = read(text).affine_in_place() else { panic!("{text}") };
        assert_eq!(found, want, "{text}");
        let [c, a, b] = found;
        for (x, y) in [(0.3, -0.8), (-5.0, 2.5)] {
            assert!((read(text).eval(x, y, 0.0) - (c + a * x + b * y)).abs() < 1e-13, "{text}");
        }
    }
    for text in
        ["x*y", "x^2", "abs(x)", "1/x", "x/y", "if(x > 0, x, 0)", "min(x, 1)", "s", "x*x/x", "sin(y)", "2^x", "x < 1"]
    {
        assert_eq!(read(text).affine_in_place(), None, "{text}");
    }
    let free = read("g*x").with_values(&[("g".to_owned(), Value::Free(0))].into());
    assert_eq!(free.affine_in_place(), None);
    let Some([c, ..]) = read("1/0 + x").affine_in_place() else { panic!() };
    assert!(c.is_infinite());
}
