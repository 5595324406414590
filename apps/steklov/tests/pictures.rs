//! Pictures of made-up fields, from plain to extreme. With `STEKLOV_PICTURES=DIR` the files stay in DIR to be looked at.

use crate::frame::{check, check_up_to, loops, rectangle};
use steklov_fields::triangulate::{Triangulation, triangulate};
use steklov_picture::{Body, Colours, ContactSide, Largest, MeshFigure, MeshPanel, Obstacle, body, contact, meshes};

/// The areas of the closed lines of an SVG path.
fn areas(line: &str) -> Vec<f64> {
    let Some(path) = line.split(" d=\"").nth(1).and_then(|rest| rest.split('"').next()) else { return Vec::new() };
    let of = |closed: &str| {
        let numbers: Vec<f64> = closed.split(['M', 'L', ' ']).filter_map(|n| n.parse().ok()).collect();
        let points: Vec<&[f64]> = numbers.chunks_exact(2).collect();
        let turns = (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()]));
        (turns.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0).abs()
    };
    path.split('Z').map(of).collect()
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
        largest: 0.0,
        triangles: &t.triangles,
        values: &t.points.iter().map(|&p| stress(p)).collect::<Vec<_>>(),
        infinite: &[],
        label: "von Mises stress",
        noun: "stress",
        colours: Colours::Automatic,
        outline: &t.outline,
        obstacles: walls,
        window: None,
        most: Largest::NONE,
        enlarge: None,
        units: [None; 2],
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
    // the shades have the area of the plate before the deformation, and none is over the hole
    let svg = show("hole-at-rest", "Plate with a hole", &t, &|_| [0.0; 2], &stress, &[]);
    let shaded: f64 = svg.lines().filter(|line| line.contains("stroke-width=\"0.9\"")).flat_map(areas).sum();
    // 640 units are 1.12 lengths of the plate; the colour bar is as high as the frame, 1.24 heights
    let scale = 640.0 / (1.12 * 200.0);
    let [plate, bar] = [200.0 * 100.0, 18.0 * 124.0 * scale];
    let hole = 24.0 * 900.0 * (std::f64::consts::TAU / 48.0).sin();
    let drawn = (shaded - bar) / (scale * scale);
    assert!((drawn / (plate - hole) - 1.0).abs() < 2e-3, "{drawn} of {}", plate - hole);
}

#[test]
fn stresses_beyond_the_colours_are_told_with_their_place() {
    let t = triangulate(&loops(&[&rectangle([-0.5, -0.5], [0.5, 0.5])]), 600).unwrap();
    let tip = |top: f64| move |[x, y]: [f64; 2]| if [x, y] == [0.5, -0.5] { top } else { 2.0 + y };
    let svg = show("tip", "Tip", &t, &pressed, &tip(123.4), &[]);
    assert!(svg.contains(">colours end below the largest stress that is drawn, 123 at (0.5, −0.5)<"), "{svg}");
    let svg = show("no-tip", "No tip", &t, &pressed, &tip(2.1), &[]);
    assert!(!svg.contains("colours end below"));
}

#[test]
fn asked_for_colours_have_arrows_where_stresses_are_beyond_them() {
    let t = triangulate(&loops(&[&rectangle([-0.5, -0.5], [0.5, 0.5])]), 600).unwrap();
    let zeros = vec![[0.0; 2]; t.points.len()];
    let stress: Vec<f64> = t.points.iter().map(|p| 10.0 * p[0]).collect();
    let of = |name: &str, ends: [f64; 2]| {
        let (points, triangles, outline) = (t.points.as_slice(), t.triangles.as_slice(), t.outline.as_slice());
        let colours = Colours::Range(ends);
        let picture = body(&Body {
            title: name,
            points,
            displacement: &zeros,
            largest: 0.0,
            triangles,
            values: &stress,
            infinite: &[],
            label: "von Mises stress",
            noun: "stress",
            colours,
            outline,
            obstacles: &[],
            window: None,
            most: Largest::NONE,
            enlarge: None,
            units: [None; 2],
        });
        let picture = picture.unwrap();
        check(name, &picture);
        picture.svg
    };
    let told =
        |svg: &str| [">colours end below the largest", ">colours end above the smallest"].map(|t| svg.contains(t));
    assert_eq!(told(&of("inside", [-5.0, 5.0])), [false, false]);
    assert_eq!(told(&of("above", [-6.0, 3.0])), [true, false]);
    assert_eq!(told(&of("below", [-3.0, 6.0])), [false, true]);
    let svg = of("both", [-1.0, 2.0]);
    assert!(svg.contains("above the smallest stress that is drawn, −5 at (−0.5, "), "{svg}");
    assert!(svg.contains("5 at (0.5, "), "{svg}");
    // an arrow is the only line with one corner
    let arrows = |svg: &str| {
        let count = |line: &str, letter: char| line.split(" d=\"").nth(1).map_or(0, |d| d.matches(letter).count());
        svg.lines().filter(|line| ['M', 'L', 'Z'].map(|letter| count(line, letter)) == [1, 2, 0]).count()
    };
    assert_eq!([arrows(&svg), arrows(&of("above", [-6.0, 2.0])), arrows(&of("inside", [-5.0, 5.0]))], [2, 1, 0]);
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
        stress: None,
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
            stress: None,
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
    let empty =
        ContactSide { title: "", x_label: "x", stress: None, position: &[], pressure: &[], shear: &[], bound: &[] };
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

/// Ends of the elements of a unit interval, refined by `layers` towards each of the given shares with a factor 0.15.
fn graded(towards: &[f64], layers: usize) -> Vec<f64> {
    let mut cuts = vec![0.0, 0.5, 1.0];
    for &c in towards {
        let layer = |k: usize, sign: f64| c + sign * 0.25 * 0.15f64.powi(k as i32);
        cuts.extend((0..layers).flat_map(|k| [layer(k, -1.0), layer(k, 1.0)]).chain([c]));
    }
    cuts.retain(|s| (0.0..=1.0).contains(s));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

type Elements = (Vec<[[f64; 2]; 2]>, Vec<usize>, Vec<usize>);

/// A mesh of a closed polygon, each side cut at given shares; degrees rise by one from element to element off a cut.
fn mesh(corners: &[[f64; 2]], cuts: impl Fn(usize) -> Vec<f64>) -> Elements {
    let (mut elements, mut degree, mut side) = (Vec::new(), Vec::new(), Vec::new());
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let at = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
        for w in cuts(i).windows(2) {
            elements.push([at(w[0]), at(w[1])]);
            degree.push((10.0 + (w[1] - w[0]).log10() / -0.15f64.log10()).clamp(1.0, 12.0).round() as usize);
            side.push(i);
        }
    }
    (elements, degree, side)
}

fn panel<'a>(caption: &'a str, (elements, degree, side): &'a Elements) -> MeshPanel<'a> {
    MeshPanel { caption, elements, degree, side }
}

#[test]
fn steps_of_a_refinement_towards_corners_and_contact_ends() {
    let square = rectangle([-0.5, -0.5], [0.5, 0.5]);
    let steps: Vec<Elements> = (0..5)
        .map(|n| {
            mesh(&square, |side| match side {
                0 => graded(&[0.0, 0.18, 0.31, 0.69, 0.82, 1.0], 2 * n),
                1 => graded(&[0.0], 2 * n),
                2 => graded(&[], 0),
                _ => graded(&[1.0], 2 * n),
            })
        })
        .collect();
    let captions: Vec<String> = (0..5).map(|n| format!("step {n}: {} elements, 282 dofs", steps[n].0.len())).collect();
    let panels: Vec<MeshPanel<'_>> = captions.iter().zip(&steps).map(|(c, m)| panel(c, m)).collect();
    let side_names = ["floor", "right", "top", "left"].map(String::from);
    let figure = MeshFigure { title: "Block on a floor: hp", side_names: &side_names, panels: &panels };
    let picture = meshes(&figure).unwrap();
    check_up_to("mesh-steps", &picture, 1400.0);
    let texts = [">degree<", ">length / side<", ">floor<", ">left<", ">10⁻⁶<"];
    for text in texts.into_iter().map(String::from).chain(captions.iter().map(|c| format!(">{c}<"))) {
        assert!(picture.svg.contains(&text), "{text}");
    }
    // The top is not refined: it has no bars, and its name stands nowhere.
    assert!(!picture.svg.contains(">top<"));
    // The first step alone has no short element, so no bars.
    let first = meshes(&MeshFigure { panels: &panels[..1], ..figure }).unwrap();
    check("mesh-first", &first);
    assert!(!first.svg.contains("length / side") && first.svg.contains(">degree<"));
}

#[test]
fn meshes_without_short_elements_stand_in_rows() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, -1.0], [2.0, -1.0], [2.0, 1.0], [0.0, 1.0]];
    let all: Vec<Elements> = (1..=6)
        .map(|n| {
            let (e, _, s) = mesh(&corners, |_| (0..=n).map(|k| k as f64 / n as f64).collect());
            let degree = (0..e.len()).map(|i| 1 + i % (2 * n)).collect();
            (e, degree, s)
        })
        .collect();
    let panels: Vec<MeshPanel<'_>> = all.iter().map(|m| panel("step 1: 6 elements", m)).collect();
    let side_names = ["a", "b", "c", "d", "e", "f"].map(String::from);
    for count in [1, 2, 3, 4, 6] {
        let figure = MeshFigure { title: "L-shape", side_names: &side_names, panels: &panels[..count] };
        let picture = meshes(&figure).unwrap();
        check(&format!("mesh-rows-{count}"), &picture);
        assert_eq!(picture.svg.matches(">step 1: 6 elements<").count(), count);
        if count == 1 {
            // Degrees 1 and 2 by turns: both colours and both figures at three elements and in the key.
            for text in [">1<", ">2<", "fill=\"#f3e51e\"", "fill=\"#45065a\""] {
                assert_eq!(picture.svg.matches(text).count(), 4, "{text}");
            }
        }
    }
}

#[test]
fn meshes_of_unusual_bodies() {
    // A ring whose 48 edges are one side each, a hole traversed with the body on the left.
    let circle = |n: i32, middle: f64, r: f64, turn: f64| -> Vec<[f64; 2]> {
        let angles = (0..n).map(|i| turn * f64::from(i) / f64::from(n));
        angles.map(|a| [middle + r * a.cos(), middle + r * a.sin()]).collect()
    };
    let mut outer = mesh(&circle(48, 0.0, 2.0, std::f64::consts::TAU), |_| vec![0.0, 1.0]);
    let inner = mesh(&circle(48, 0.0, 0.7, -std::f64::consts::TAU), |_| vec![0.0, 0.5, 1.0]);
    outer.0.extend(&inner.0);
    outer.1.extend(&inner.1);
    outer.2.extend(inner.2.iter().map(|s| s + 48));
    let many: Vec<String> = (0..96).map(|i| format!("edge {i}")).collect();
    let ring = MeshFigure { title: "Ring", side_names: &many, panels: &[panel("a ring", &outer)] };
    check("mesh-ring", &meshes(&ring).unwrap());

    // Every side refined, more than can be drawn, with long names; a strip; far from the origin.
    let all = mesh(&circle(12, 1e6, 1.0, std::f64::consts::TAU), |_| graded(&[0.0, 1.0], 5));
    let long: Vec<String> = (0..12).map(|i| format!("the side with the number {i} of the polygon")).collect();
    let figure = MeshFigure { title: "Polygon", side_names: &long, panels: &[panel("all corners", &all)] };
    let picture = meshes(&figure).unwrap();
    check("mesh-many", &picture);
    assert!(picture.svg.contains(">4 more sides "));
    let strip = mesh(&rectangle([0.0, 0.0], [10.0, 0.1]), |s| graded(&[0.0, 1.0], if s % 2 == 0 { 9 } else { 1 }));
    let sides = ["bottom", "right", "top", "left"].map(String::from);
    let caption = "step 12: 45 elements, 282 dofs, and a caption that goes on for longer than there is room for it";
    let panels = [panel(caption, &strip), panel("", &strip)];
    check("mesh-strip", &meshes(&MeshFigure { title: "Strip", side_names: &sides, panels: &panels }).unwrap());
}

#[test]
fn meshes_that_are_empty_or_broken() {
    let sides = ["only"].map(String::from);
    check("mesh-none", &meshes(&MeshFigure { title: "", side_names: &[], panels: &[] }).unwrap());
    let (empty, point) = ((vec![], vec![], vec![]), (vec![[[1.0, 1.0]; 2]], vec![0], vec![0]));
    let broken = (
        vec![[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [f64::NAN, 2.0]], [[1.0, 0.0], [1.0, 1e-300]], [[1.0, 0.0]; 2]],
        vec![1, 2, 300, 4],
        vec![0; 4],
    );
    let wide = (vec![[[-1e200, 0.0], [1e200, 0.0]], [[1e200, 0.0], [-1e200, 1e-200]]], vec![1, 1], vec![0; 2]);
    for (name, m) in [("mesh-empty", &empty), ("mesh-point", &point), ("mesh-broken", &broken), ("mesh-wide", &wide)] {
        check(name, &meshes(&MeshFigure { title: name, side_names: &sides, panels: &[panel(name, m)] }).unwrap());
    }
}
