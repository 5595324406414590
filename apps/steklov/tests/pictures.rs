//! Pictures of made-up fields, from plain to extreme. With `STEKLOV_PICTURES=DIR` the files stay in DIR to be looked at.

use std::path::PathBuf;
use steklov::picture::{Body, ContactSide, Obstacle, Picture, body, contact, write};
use steklov::triangulate::{Triangulation, triangulate};

fn loops(corners: &[&[[f64; 2]]]) -> Vec<([f64; 2], [f64; 2], usize)> {
    let of = |l: usize, c: &[[f64; 2]]| (0..c.len()).map(|i| (c[i], c[(i + 1) % c.len()], l)).collect::<Vec<_>>();
    corners.iter().enumerate().flat_map(|(l, c)| of(l, c)).collect()
}

fn rectangle(low: [f64; 2], high: [f64; 2]) -> [[f64; 2]; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// Every number that the SVG places something at lies in the frame, and every text too, by its estimated width.
fn check(name: &str, picture: &Picture) {
    let svg = &picture.svg;
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
    let attribute = |line: &str, key: &str| -> Option<f64> {
        let rest = line.split(&format!(" {key}=\"")).nth(1)?;
        rest.split('"').next()?.parse().ok()
    };
    let height = attribute(svg.lines().next().unwrap(), "height").unwrap();
    assert!((200.0..900.0).contains(&height), "{name}: height {height}");
    for line in svg.lines() {
        if let Some(path) = line.split(" d=\"").nth(1).or(line.split("<path d=\"").nth(1)) {
            let numbers = path.split('"').next().unwrap().split(['M', 'L', 'Z', ' ']).filter(|s| !s.is_empty());
            let numbers: Vec<f64> = numbers.map(|s| s.parse().unwrap()).collect();
            for p in numbers.chunks(2) {
                assert!((0.0..=900.0).contains(&p[0]) && (0.0..=height).contains(&p[1]), "{name}: {p:?}");
            }
        }
        if line.contains("<text") {
            let (x, y) = (attribute(line, "x").unwrap(), attribute(line, "y").unwrap());
            let letters = line.split('>').nth(1).unwrap().split('<').next().unwrap().chars().count() as f64;
            let width = 0.6 * attribute(line, "font-size").unwrap() * letters;
            let (start, end) = if line.contains("\"start\"") {
                (x, x + width)
            } else if line.contains("\"end\"") {
                (x - width, x)
            } else {
                (x - width / 2.0, x + width / 2.0)
            };
            if line.contains("rotate") {
                let (top, bottom) = (y - width / 2.0, y + width / 2.0);
                assert!((10.0..=896.0).contains(&x) && top >= 0.0 && bottom <= height, "{name}: {line}");
            } else {
                assert!(start >= 0.0 && end <= 900.0 && y <= height - 4.0 && y > 10.0, "{name}: {line}");
            }
        }
    }
    let folder = std::env::var_os("STEKLOV_PICTURES").map(PathBuf::from);
    let temporary = tempfile::tempdir().unwrap();
    let [_, png] = write(folder.as_deref().unwrap_or(temporary.path()), name, picture).unwrap();
    let bytes = std::fs::read(png).unwrap();
    // Width and height stand at bytes 16 to 24 of a PNG file.
    let size = [16, 20].map(|i| u32::from_be_bytes(bytes[i..i + 4].try_into().unwrap()));
    assert_eq!(size, [1800, 2 * height as u32], "{name}");
}

type Field = dyn Fn([f64; 2]) -> [f64; 2];

fn show(
    name: &str,
    title: &str,
    t: &Triangulation,
    u: &Field,
    stress: &dyn Fn([f64; 2]) -> f64,
    walls: &[Obstacle<'_>],
) -> String {
    let picture = body(&Body {
        title,
        points: &t.points,
        displacement: &t.points.iter().map(|&p| u(p)).collect::<Vec<_>>(),
        triangles: &t.triangles,
        von_mises: &t.points.iter().map(|&p| stress(p)).collect::<Vec<_>>(),
        outline: &t.outline,
        obstacles: walls,
    })
    .unwrap();
    check(name, &picture);
    picture.svg
}

fn pressed([x, y]: [f64; 2]) -> [f64; 2] {
    [0.05 * x * (1.0 + 0.8 * y), -0.07 * (y + 0.5) * (1.0 - x * x) - 0.02 * x * x * (0.5 - y)]
}

fn peak([x, y]: [f64; 2]) -> f64 {
    20.0 * (-4.0 * ((x.abs() - 0.32).powi(2) + (y + 0.5).powi(2))).exp() + 2.0 * (y + 0.5)
}

#[test]
fn block_on_a_floor() {
    let t = triangulate(&loops(&[&rectangle([-0.5, -0.5], [0.5, 0.5])]), 600).unwrap();
    let foot: Vec<_> = (0..=20).map(|i| [f64::from(i) / 20.0 - 0.5, -0.5]).collect();
    let wall = Obstacle { points: &foot, gap: &vec![[0.0, 0.0]; foot.len()] };
    let svg = show("block", "Block on a rigid floor, Tresca friction", &t, &pressed, &peak, &[wall]);
    assert!(svg.contains(">drawn to scale; the largest displacement is 0.07"));
    assert!(svg.contains(">von Mises stress<") && svg.contains(">x<") && svg.contains(">y<"));
    assert!(svg.contains(">obstacle<"));
}

#[test]
fn small_displacements_are_drawn_larger_together_with_the_gaps() {
    let t = triangulate(&loops(&[&rectangle([-0.5, -0.5], [0.5, 0.5])]), 600).unwrap();
    let foot: Vec<_> = (0..=20).map(|i| [f64::from(i) / 20.0 - 0.5, -0.5]).collect();
    let gap: Vec<_> = foot.iter().map(|p| [0.0, -1e-4 * p[0].abs()]).collect();
    let small = |p: [f64; 2]| pressed(p).map(|u| 1e-3 * u);
    let wall = Obstacle { points: &foot, gap: &gap };
    let svg = show("small", "Wedge gap", &t, &small, &peak, &[wall]);
    assert!(svg.contains(">displacements and gaps drawn 1000 times as large; the largest displacement is 7"), "{svg}");
    let tiny = |p: [f64; 2]| pressed(p).map(|u| 1e-12 * u);
    let svg = show("tiny", "Tiny displacements & a tiny stress", &t, &tiny, &|p| 1e-9 * peak(p), &[]);
    assert!(svg.contains("times as large") && svg.contains("(×10⁻⁹)") && !svg.contains(">obstacle<"));
}

#[test]
fn body_with_a_hole_in_millimetres() {
    let circle: Vec<_> = (0..48).map(|i| -f64::from(i) * std::f64::consts::TAU / 48.0).collect();
    let hole: Vec<_> = circle.iter().map(|a| [100.0 + 30.0 * a.cos(), 50.0 + 30.0 * a.sin()]).collect();
    let t = triangulate(&loops(&[&rectangle([0.0, 0.0], [200.0, 100.0]), &hole]), 800).unwrap();
    let stress = |[x, y]: [f64; 2]| {
        let r2 = ((x - 100.0).powi(2) + (y - 50.0).powi(2)) / 900.0;
        3e12 * (1.0 + 2.0 / (r2 * r2) * ((y - 50.0).powi(2) / (900.0 * r2)))
    };
    let svg = show("hole", "Plate with a hole", &t, &|[x, y]| [0.02 * x, -0.006 * (y - 50.0)], &stress, &[]);
    assert!(svg.contains("(×10¹²)"));
}

#[test]
fn flat_and_tall_bodies() {
    let flat = triangulate(&loops(&[&rectangle([0.0, 0.0], [10.0, 0.1])]), 600).unwrap();
    let foot = [[0.0, 0.0], [10.0, 0.0]];
    let wall = Obstacle { points: &foot, gap: &[[0.0, -0.1], [0.0, -0.2]] };
    let bent = |[x, _]: [f64; 2]| [0.0, -0.006 * x * x];
    show("flat", "Strip 10 × 0.1", &flat, &bent, &|[x, _]| 10.0 - x, &[wall]);
    let tall = triangulate(&loops(&[&rectangle([0.0, 0.0], [0.1, 10.0])]), 600).unwrap();
    show("tall", "Column 0.1 × 10", &tall, &|[_, y]| [0.005 * y * y, 0.0], &|[_, y]| 10.0 - y, &[]);
}

#[test]
fn nothing_happens_far_from_the_origin() {
    let square = rectangle([1e6, -2.5], [1e6 + 2.0, -0.5]);
    let t = triangulate(&loops(&[&square]), 200).unwrap();
    let far = [[1e6, -2.5], [1e6 + 2.0, -2.5]];
    let wall = Obstacle { points: &far, gap: &[[0.0, -1e9], [0.0, -1e9]] };
    let long = "A title that is so long that no frame of this width could ever hold it on a single line, \
                and that goes on and on until even three lines are not enough for it, however small the letters \
                are made, because somebody put the whole of the report's abstract into it instead of a name, \
                which is anybody's right and must not ruin the picture";
    let svg = show("zero", long, &t, &|_| [0.0, 0.0], &|_| 0.0, &[wall]);
    assert!(svg.contains('…') && svg.contains(">drawn to scale; the largest displacement is 0<"));
    show(
        "constant",
        "Uniform stress, one corner unknown",
        &t,
        &|_| [0.0, -0.1],
        &|[x, y]| if x == 1e6 && y == -2.5 { f64::NAN } else { 7.25 },
        &[],
    );
}

fn tractions(n: usize, scale: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64 - 0.5).collect();
    let p = x.iter().map(|x| scale * 18.0 * (0.43f64.powi(2) - x * x).max(0.0).sqrt()).collect();
    let t = x.iter().map(|x: &f64| if x.abs() > 0.43 { 0.0 } else { scale * (1.2 * x).clamp(-0.3, 0.3) }).collect();
    (x, p, t)
}

#[test]
fn contact_with_tresca_friction() {
    let (x, pressure, shear) = tractions(40, 1.0);
    let side = ContactSide {
        title: "Block on a rigid floor: side floor",
        x_label: "x",
        position: &x,
        pressure: &pressure,
        shear: &shear,
        bound: &vec![0.3; x.len()],
    };
    let picture = contact(&side).unwrap();
    check("contact", &picture);
    for text in [">pressure<", ">shear<", ">x<", ">friction bound ±F<"] {
        assert!(picture.svg.contains(text), "{text}");
    }
    check("contact-stick", &contact(&ContactSide { bound: &vec![1e6; x.len()], ..side }).unwrap());
    check("contact-frictionless", &contact(&ContactSide { bound: &[], shear: &vec![0.0; x.len()], ..side }).unwrap());
}

#[test]
fn contact_with_coulomb_friction_at_extreme_scales() {
    for (name, scale) in [("contact-1e-9", 1e-9), ("contact-1e12", 1e12)] {
        let (mut x, pressure, shear) = tractions(400, scale);
        let bound: Vec<f64> = pressure.iter().map(|p| 0.05 * p).collect();
        let shear: Vec<f64> = shear.iter().zip(&bound).map(|(t, b)| t.clamp(-b, *b)).collect();
        x.iter_mut().for_each(|x| *x *= scale);
        let side = ContactSide {
            title: name,
            x_label: "arc length along floor",
            position: &x,
            pressure: &pressure,
            shear: &shear,
            bound: &bound,
        };
        check(name, &contact(&side).unwrap());
    }
}

#[test]
fn contact_without_points_or_values() {
    let empty = ContactSide { title: "", x_label: "x", position: &[], pressure: &[], shear: &[], bound: &[] };
    check("contact-empty", &contact(&empty).unwrap());
    let one = ContactSide { position: &[2.0], pressure: &[3.0], shear: &[-1.0], bound: &[4.0], ..empty };
    check("contact-one", &contact(&one).unwrap());
    let broken = ContactSide {
        position: &[0.0, 1.0, 2.0, f64::NAN, 3.0],
        pressure: &[1.0, f64::INFINITY, 2.0, 3.0, 1.0],
        shear: &[0.0, 1.0, f64::NAN, 1.0, -1.0],
        bound: &[1.0, 2.0, 2.0, 1.0, 1.0],
        ..empty
    };
    check("contact-broken", &contact(&broken).unwrap());
}
