//! Pictures, tables, mean fields and stored arrays of results with random input.

use std::sync::atomic::AtomicUsize;

use crate::place::{Place, names};
use steklov_io::{File, IoError, create_atomically, create_group, open, open_group};
use steklov_model::run::adaptive_loop::{Progress, run};
use steklov_model::stochastic::{OutcomesWatch, StochasticResult, solve_stochastic};
use steklov_result::outcomes::{read, write};
use steklov_result::record::Record;
use steklov_result::store;

/// A block on a floor whose height and load are random, `more` at the end.
fn rough(more: &str) -> String {
    let random = r#"[random.rough]
covariance = "exponential"
correlation = 0.5
on = "floor"
modes = 2
[random.p]
distribution = "uniform"
low = 0.8
high = 1.2
[stochastic]
degree = 2
samples = 400
"#;
    let text = crate::place::BLOCK.replace("gap = \"0\"", "gap = \"0.01*(x-1)^2 + 0.001*rough\"");
    text.replace("[\"0\", \"-1\"]", "[\"0\", \"-p\"]") + random + more
}

fn stored(place: &Place, name: &str) -> Record {
    store::read(&open(place.path(name)).unwrap()).unwrap()
}

/// Tags are closed in their order, and every number of a path lies in the frame.
fn check_svg(name: &str, svg: &str) {
    assert!(!svg.contains("NaN") && !svg.replace("is infinite", "").contains("inf"), "{name}");
    let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("{name}: {text}"));
    let view: Vec<f64> =
        svg.split("viewBox=\"").nth(1).unwrap().split('"').next().unwrap().split(' ').map(number).collect();
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1).filter(|t| !t.starts_with(['?', '!'])) {
        let tag = tag.split('>').next().unwrap();
        let word = |t: &str| t.split([' ', '\n', '/']).next().unwrap().to_owned();
        match tag.strip_prefix('/') {
            Some(end) => assert_eq!(open.pop(), Some(word(end)), "{name}"),
            None if tag.ends_with('/') => {}
            None => open.push(word(tag)),
        }
        if let Some(path) = tag.split(" d=\"").nth(1) {
            let values = path.split('"').next().unwrap().split(['M', 'L', 'Z', ' ']).filter(|s| !s.is_empty());
            let values: Vec<f64> = values.map(number).collect();
            for p in values.chunks(2) {
                let inside = (0.0..=view[2]).contains(&p[0]) && (0.0..=view[3]).contains(&p[1]);
                assert!(inside, "{name}: {p:?} in {view:?}");
            }
        }
    }
    assert!(open.is_empty(), "{name}: {open:?}");
}

#[test]
fn pictures_of_each_method_appear_and_are_whole() {
    let place = Place::new();
    let always = ["band", "body", "contact-floor", "density", "field-rough", "pressure", "probability"];
    for (method, more) in
        [("galerkin", &["effects"][..]), ("collocation", &["effects"]), ("sparse", &[]), ("monte-carlo", &[])]
    {
        place.write("rough.toml", rough(&format!("method = \"{method}\"\n")));
        let folder = format!("drawn-{method}");
        place.run(["solve", "rough.toml", "--force", "--plots", &folder]).demand(0);
        let mut wanted: Vec<&str> = always.iter().chain(more).copied().collect();
        // a sparse grid is no surrogate
        wanted.retain(|part| method != "sparse" || *part != "density");
        wanted.sort_unstable();
        let files: Vec<String> =
            wanted.iter().flat_map(|p| [format!("rough-{p}.png"), format!("rough-{p}.svg")]).collect();
        assert_eq!(names(&place.path(&folder)), files, "{method}");
        for name in files.iter().filter(|f| f.ends_with("svg")) {
            check_svg(name, &String::from_utf8(place.read(&format!("{folder}/{name}"))).unwrap());
        }
        let shown = place.run(["show", "rough.vtkhdf", "--plots", "shown"]).demand(0).out;
        assert!(files.iter().all(|f| shown.contains(f)), "{shown}");
        assert!(files.iter().all(|f| place.read(&format!("{folder}/{f}")) == place.read(&format!("shown/{f}"))));
        assert!(shown.contains(&format!("outcomes    {method}: 3 germs")), "{shown}");
        assert!(shown.contains("field rough: 2 modes"), "{shown}");
    }
}

#[test]
fn stochastic_meshes_of_one_and_two_germs_and_modes_of_a_body_are_drawn() {
    let place = Place::new();
    let normal = "[random.p]\ndistribution = \"normal\"\nmean = 1\ndeviation = 0.1\n";
    let text = crate::place::BLOCK.replace("[\"0\", \"-1\"]", "[\"0\", \"-p\"]") + normal;
    place.write("one.toml", &text);
    let uniform = "[random.q]\ndistribution = \"uniform\"\nlow = 0.9\nhigh = 1.1\n[stochastic]\nelements = 2\n";
    place.write("two.toml", text.replace("-p", "-p*q") + uniform);
    let field = "[random.patch]\ncovariance = \"gaussian\"\ncorrelation = 1\non = \"body\"\nmodes = 3\n";
    place.write("body.toml", text.replace("-p", "-p-0.1*patch") + field);
    for (name, parts) in [
        ("one", &["stochastic-mesh"][..]),
        ("two", &["stochastic-mesh", "effects"]),
        ("body", &["effects", "field-patch", "modes-patch"]),
    ] {
        place.run(["solve", &format!("{name}.toml"), "--plots", "drawn"]).demand(0);
        for part in parts {
            let file = format!("{name}-{part}.svg");
            let svg = String::from_utf8(place.read(&format!("drawn/{file}"))).unwrap();
            check_svg(&file, &svg);
            if name == "two" && *part == "stochastic-mesh" {
                assert!(svg.contains(">p<") && svg.contains(">q<") && svg.contains(" × "), "{svg}");
            }
        }
    }
    // one germ alone needs no effects
    assert!(!names(&place.path("drawn")).contains(&"one-effects.svg".to_owned()));
}

/// Numbers of a table by row, the head with the names in its first row; quotes are taken off.
fn table(place: &Place, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = String::from_utf8(place.read(name)).unwrap();
    let cells = |line: &str| line.split(',').map(|c| c.trim_matches('"').to_owned()).collect::<Vec<_>>();
    let mut lines = text.lines().map(cells);
    (lines.next().unwrap(), lines.collect())
}

#[test]
fn tables_give_back_the_arrays_and_their_moments() {
    let place = Place::new();
    place.write("rough.toml", rough(""));
    place.run(["solve", "rough.toml"]).demand(0);
    place.run(["show", "rough.vtkhdf", "--csv", "tables"]).demand(0);
    let parts = ["contact-statistics", "contact", "displacement", "points", "quantities", "traction"];
    assert_eq!(names(&place.path("tables")), parts.map(|p| format!("rough-{p}.csv")));
    let Record { stochastic: Some(result), contact, summary, .. } = stored(&place, "rough.vtkhdf") else {
        panic!("no outcomes are stored")
    };
    let number = |text: &String| text.parse::<f64>().unwrap();

    let (head, points) = table(&place, "tables/rough-points.csv");
    assert_eq!(head[..5], ["rough 1", "rough 2", "p", "weight", "young"]);
    assert_eq!(points.len(), result.points.len());
    for (i, row) in points.iter().enumerate() {
        let values: Vec<f64> = row.iter().map(number).collect();
        assert_eq!(values[..3], result.points[i][..]);
        assert_eq!((values[3], values[4]), (result.weights[i], result.young[i]));
        assert!(values[5..].iter().zip(&result.quantities).all(|(v, q)| *v == q.values[i]));
    }

    let (head, rows) = table(&place, "tables/rough-quantities.csv");
    let quantiles = ["quantile_0.05", "quantile_0.5", "quantile_0.95"];
    assert_eq!(head[..4], ["name", "mean", "variance", "standard_error"]);
    assert_eq!(
        (&head[4..7], &head[7..]),
        (&quantiles.map(String::from)[..], &["truncation", "mesh", "uncertainty"].map(String::from)[..])
    );
    for (k, (row, q)) in rows.iter().zip(&result.quantities).enumerate() {
        assert_eq!(row[0], q.name);
        let (mean, variance) = (number(&row[1]), number(&row[2]));
        assert_eq!((mean, variance), (q.mean, q.variance));
        let moment =
            |f: &dyn Fn(f64) -> f64| -> f64 { points.iter().map(|p| number(&p[3]) * f(number(&p[5 + k]))).sum() };
        let scale = moment(&|v| v * v);
        assert!((moment(&|v| v) - mean).abs() < 1e-12 * scale.sqrt(), "{}", q.name);
        assert!((moment(&|v| (v - mean) * (v - mean)) - variance).abs() < 1e-12 * scale, "{}", q.name);
        assert_eq!(row[3], "", "no standard error but of Monte Carlo");
        match &q.quantiles {
            Some(quantiles) => assert!(row[4..7].iter().map(number).eq(quantiles.clone()), "{}", q.name),
            // a spread of rounding has none
            None => assert!(row[4..7].iter().all(String::is_empty) && variance.sqrt() < 1e-10, "{}", q.name),
        }
        assert_eq!(number(&row[7]), q.truncation.unwrap(), "{}", q.name);
        match summary.quantities.get(&format!("stochastic.{}.mean", q.name)) {
            Some(bar) => {
                assert_eq!(row[8..].iter().map(number).collect::<Vec<_>>(), [bar.parts["mesh"], bar.uncertainty])
            }
            None => assert!(row[8..].iter().all(String::is_empty), "{}", q.name),
        }
    }

    let (_, rows) = table(&place, "tables/rough-contact-statistics.csv");
    assert_eq!(rows.len(), contact.len());
    for (i, row) in rows.iter().enumerate() {
        let values: Vec<f64> = row[1..].iter().map(number).collect();
        assert_eq!(values[..2], contact[i].point);
        assert_eq!((values[2], values[3]), (result.pressure.mean[i], result.pressure.variance[i]));
        assert_eq!((values[4], values[5]), (result.shear.mean[i], result.shear.variance[i]));
        assert!(values[6] == result.probability[i] && (0.0..=1.0).contains(&values[6]));
    }
}

/// Writes outcomes into a file of their own and reads them back.
fn there_and_back(place: &Place, result: &StochasticResult) -> StochasticResult {
    let path = place.path("outcomes.vtkhdf");
    create_atomically(&path, true, |file: &File| -> Result<(), IoError> {
        write(&create_group(file, "stochastic")?, result)
    })
    .unwrap();
    read(&open_group(&open(&path).unwrap(), "stochastic").unwrap()).unwrap()
}

#[test]
fn what_is_stored_is_read_with_the_same_bits() {
    let place = Place::new();
    for method in ["galerkin", "collocation", "sparse", "monte-carlo"] {
        place.write("rough.toml", rough(&format!("method = \"{method}\"\n")));
        let scene = steklov_document::read(&place.path("rough.toml"), &[]).unwrap();
        let run = run(&scene, Progress::first(&scene), &AtomicUsize::new(0), &mut |_, _| Ok(())).unwrap();
        let random = scene.random.as_ref().unwrap();
        let result =
            solve_stochastic(&scene, random, run.matrices.as_ref().unwrap(), &OutcomesWatch::NONE, &mut |_| Ok(()))
                .unwrap();
        // the text of a number is that of no other number
        let again = format!("{:?}", there_and_back(&place, &result));
        assert_eq!(again, format!("{result:?}"), "{method}");
        let mut altered = result.clone();
        altered.displacement.variance[3] = f64::from_bits(altered.displacement.variance[3].to_bits() ^ 1);
        assert_ne!(again, format!("{:?}", there_and_back(&place, &altered)), "{method}");
    }
}

/// The array that an error names, and what makes it unfit.
type Spoilt = (&'static str, fn(&mut StochasticResult));

#[test]
fn arrays_that_do_not_fit_are_refused() {
    let place = Place::new();
    place.write("rough.toml", rough(""));
    place.run(["solve", "rough.toml"]).demand(0);
    let result = stored(&place, "rough.vtkhdf").stochastic.unwrap();
    let spoil: [Spoilt; 9] = [
        ("weights", |r| r.weights.truncate(1)),
        ("points", |r| r.labels.truncate(2)),
        ("displacements", |r| r.displacement.mean.truncate(4)),
        ("quantities", |r| r.quantities[1].values.truncate(3)),
        ("quantities", |r| r.probabilities.truncate(1)),
        ("quantities", |r| r.quantities[0].effects = Some(vec![1.0])),
        ("fields", |r| r.fields[0].eigenvalues.truncate(1)),
        ("mesh", |r| r.cells.as_mut().unwrap().low.truncate(0)),
        ("probability", |r| r.probability.truncate(1)),
    ];
    for (name, spoil) in spoil {
        let mut result = result.clone();
        spoil(&mut result);
        if name == "displacements" {
            result.displacement.variance.truncate(4);
        }
        let path = place.path("spoilt.vtkhdf");
        let put = |file: &File| -> Result<(), IoError> { write(&create_group(file, "stochastic")?, &result) };
        create_atomically(&path, true, put).unwrap();
        let error = read(&open_group(&open(&path).unwrap(), "stochastic").unwrap()).unwrap_err();
        assert!(error.to_string().contains(name), "{name}: {error}");
    }
}

/// A block held on its left, E = 200 (1 + 0.3 ξ), ξ uniform on (-1, 1), `more` at the end.
fn soft(more: &str) -> String {
    let text = crate::place::BLOCK.replace("young = 200.0", "young = \"200*(1+0.3*xi)\"");
    let text = text.replace("[sides.floor]\ncontact = { gap = \"0\", friction = { tresca = \"F\" } }", "");
    let held = "[sides.left]\ndisplacement = [\"0\", \"0\"]\n";
    let random = "[random.xi]\ndistribution = \"uniform\"\nlow = -1\nhigh = 1\n";
    text + held + random + "[stochastic]\nmethod = \"collocation\"\ndegree = 12\n" + more
}

#[test]
fn mean_fields_of_a_random_modulus_under_given_loads_are_known() {
    let place = Place::new();
    place.write("soft.toml", soft(""));
    place.run(["solve", "soft.toml"]).demand(0);
    let grid = stored(&place, "soft.vtkhdf").grid;
    let field = |name: &str| &grid.point_data.iter().find(|f| f.name == name).unwrap().values;
    let near = |a: &[f64], b: &[f64], factor: f64| {
        let scale = b.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - factor * b).abs() < 1e-11 * scale));
    };
    // stresses do not depend on the modulus; displacements go with its inverse, of mean log(1.3/0.7)/0.6
    near(field("mean_stress"), field("stress"), 1.0);
    near(field("mean_displacement"), field("displacement"), (1.3f64 / 0.7).ln() / 0.6);
}

#[test]
fn a_body_force_leaves_mean_fields_out() {
    let place = Place::new();
    place.write("heavy.toml", soft("").replace("[material]", "[body_force]\nvalue = [\"0\", \"-1\"]\n[material]"));
    place.run(["solve", "heavy.toml"]).demand(0);
    let stored = stored(&place, "heavy.vtkhdf");
    let names: Vec<&str> = stored.grid.point_data.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["displacement", "stress", "von_mises"]);
    assert!(stored.stochastic.is_some());
}
