//! Compares the schema and the reference with the reader.

mod validator;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use steklov_document::steklov_problem::{self, DataErrorKind, Scene};
use steklov_document::{SceneError, SceneErrorKind, TEMPLATE, parse, reference, schema};

/// Scenes with the keys that no scene of the gallery has.
const MORE: [&str; 8] = [
    r#"
    title = "Ellipse with holes"
    units = { length = "mm", stress = "MPa" }
    body = { ellipse = { centre = [0, 0], radii = [3, 2] }, side = "rim", holes = [
        { corners = [[-1, 0], [1, 0], [1, 1], [-1, 1]], sides = ["a", "b", "c", "d"], fillet = { 1 = 0.1 },
          arcs = { c = { bulge = 0.1 } }, curves = [{ edge = 3, control = [[-1.1, 0.7], [-1.1, 0.3]] }] },
        { ellipse = { centre = [0, -1], radii = [0.5, 0.2], angle = 10 }, side = "e" } ] }
    material = { young = 100, poisson = 0.2 }
    sides.rim = { pressure = 1, springs = { tangential = 2 } }
    sides.e.springs = { normal = "1" }
    profiles.rough = { points = [[0, 0], [1, 0.1]], slopes = [[0, 0.1], [0.1, 0]] }
    sides.a = { contact = { gap = "rough(s)", friction = { tresca = 1 } } }
    probe = { points = [[1.5, 0]], lines = [{ from = [-2, 0], to = [-1.5, 0] }, { from = [-2, 0], to = [-1.5, 0], points = 3 }],
              sides = ["a"] }
    quantities.press = { pressure_at = [0, 0] }
    quantities.sinks = { mean_displacement = "a" }
    quantities.turns = { moment = "a", about = [0, 0] }
    quantities.opens = { opening_at = [0, 0] }
    quantities.works = { weighted_force = "a", weight = ["x", 0] }
    expect.energy = { value = 1.0, tol = 0.1 }
    expect.contact.length = { value = 1.0, tol = 0.1, source = "here" }
    [method]
    model = "bem"
    elements = 8
    degree = 2
    refine = "hp"
    indicator = "bubble"
    max_dofs = 1000
    max_steps = 3
    marking = 0.5
    smoothness = 0.5
    estimators = true
    multiplier = "stabilised"
    gamma = 0.1
    multiplier_mesh = "same"
    multiplier_degree = 1
    solver = "newton"
    "#,
    r#"
    [body]
    corners = [[0, 0], [4, 0], [4, 2], [0, 2]]
    sides = ["bottom", "right", "top", "left"]
    arcs = [{ edge = 0, through = [2, -0.5] }, { edge = 1, radius = 2, large = false }, { edge = 2, centre = [2, 2], radii = [2, 1], angle = 0 }]
    curves = { left = { control = [[-0.5, 1.5], [-0.5, 0.5]] } }
    [material]
    young = "E*b*n*l"
    poisson = 0.3
    plane = "stress"
    [sides.bottom]
    displacement = [0, "free"]
    [sides.top]
    traction = [0, "f"]
    [body_force]
    value = [0, -1]
    [random]
    E = { distribution = "uniform", low = 1, high = 2 }
    b = { distribution = "beta", alpha = 1, beta = 2, low = 1, high = 2 }
    n = { distribution = "normal", mean = 5, deviation = 0.1, low = 1, high = 9 }
    l = { distribution = "lognormal", mean = 5, deviation = 0.1, low = 1, high = 9 }
    f = { covariance = "gaussian", correlation = [10, 20], on = "body", captured = 0.5 }
    [stochastic]
    method = "monte-carlo"
    refine = "none"
    samples = 10
    seed = 2
    quantiles = [0.5]
    quantities = ["energy"]
    "#,
    r#"
    [body]
    corners = [[0, 0], [4, 0], [4, 2], [0, 2]]
    sides = ["bottom", "right", "top", "left"]
    arcs = { top = { radius = 2.5 }, left = { centre = [0, 1] } }
    [material]
    young = 1.0
    poisson = 0.3
    [sides.bottom]
    displacement = [0, 0]
    [sides.right]
    pressure = "f + g"
    [random]
    f = { covariance = "matern", smoothness = 1.5, correlation = 2, on = "right", modes = 2, variables = "normal" }
    g = { covariance = "exponential", correlation = 2, on = "right" }
    [stochastic]
    degree = 2
    elements = 1
    level = 2
    tolerance = 0.1
    max_nodes = 100
    "#,
    r#"
    [[body]]
    name = "block"
    corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
    sides = ["bottom", "right", "top", "left"]
    material = { young = 1, poisson = 0 }
    body_force = [0, -1]
    arcs = { left = { bulge = 0.1 } }
    curves = { right = { control = [[2.2, 0.3], [2.2, 0.6]] } }
    cracks = [{ points = [[0.5, 0.5], [1, 0.5]], side = "notch" }]
    [[body]]
    name = "slab"
    corners = [[0, -1], [2, -1], [2, 0], [0, 0]]
    sides = ["bottom", "right", "top", "left"]
    fillet = { 0 = 0.1 }
    material = { young = 1, poisson = 0 }
    [[body]]
    name = "pebble"
    ellipse = { centre = [1, -3], radii = [0.5, 0.2] }
    side = "rim"
    material = { young = 1, poisson = 0 }
    [sides.slab.bottom]
    displacement = [0, 0]
    [sides.pebble.rim]
    springs = [1, 1]
    traction = [1, 0]
    [[interface]]
    between = [["block.bottom"], "slab.top"]
    tied = { displacement_jump = [0, 0.1], traction_jump = [0, 1] }
    multiplier = "block.bottom"
    name = "joint"
    [[interface]]
    on = "block.notch"
    contact = { friction = { coulomb = 0.3 } }
    "#,
    r#"
    [[body]]
    name = "rock"
    medium = { remote_stress = [0, -1, 0], at_infinity = "bounded" }
    material = { young = 1, poisson = 0 }
    holes = [{ circle = { centre = [0, 0], radius = 1 }, side = "wall" }]
    [[body]]
    name = "lining"
    circle = { centre = [0, 0], radius = 1 }
    side = "outside"
    material = { young = 1, poisson = 0 }
    [[interface]]
    between = ["rock.wall", "lining.outside"]
    tied = true
    "#,
    r#"
    [body]
    corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
    sides = ["rim", "rim", "rim", "rim"]
    [material]
    young = 1
    poisson = 0
    [exterior]
    young = 2
    poisson = 0
    plane = "strain"
    traction_jump = [0, "y"]
    "#,
    r#"
    [body]
    corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
    sides = ["bottom", "right", "top", "left"]
    [material]
    poisson = 0
    cells = { size = 0.5, young = { uniform = [1, 2] } }
    [grid]
    coarse = [1, 1]
    fine = [2, 2]
    [sides]
    bottom.displacement = [0, 0]
    top.pressure = 1
    "#,
    r#"
    [body]
    corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
    sides = ["bottom", "right", "top", "left"]
    [material]
    cells = { size = 0.5, young = 1, poisson = { uniform = [0.1, 0.2] } }
    [grid]
    coarse = [1, 1]
    fine = [2, 2]
    [sides]
    bottom.displacement = [0, 0]
    top.pressure = 1
    "#,
];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// Names and texts of sound scenes.
fn scenes() -> Vec<(String, String)> {
    let mut scenes = vec![("template".to_owned(), TEMPLATE.to_owned())];
    let files = std::fs::read_dir(folder("scenes")).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    scenes.extend(files.iter().map(|path| (path.display().to_string(), std::fs::read_to_string(path).unwrap())));
    scenes.extend(MORE.iter().enumerate().map(|(k, text)| (format!("scene {k} of the test"), (*text).to_owned())));
    scenes.extend(of_a_file());
    scenes
}

/// Scenes whose moduli, Poisson's ratios or heights are in a file, and one of seeded ratios.
fn of_a_file() -> [(String, String); 6] {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let label = steklov_io::label("stress", "Young's modulus", &["row", "column"]);
    let young = faer::Mat::from_fn(2, 2, |i, j| 1.0 + (2 * i + j) as f64);
    steklov_io::create_atomically(folder.join("young.h5"), true, |file| {
        steklov_io::save_dense(file, "young", young.as_ref(), &label)?;
        let ratios = faer::Mat::from_fn(2, 2, |i, j| 0.1 * (2 * i + j) as f64);
        steklov_io::save_dense(file, "ratios", ratios.as_ref(), &label)
    })
    .unwrap();
    let of = |name: &str| format!("{{ file = \"young.h5\", dataset = \"{name}\", order = \"rows\" }}");
    let texts = [
        MORE[6].replace("{ uniform = [1, 2] }", &of("young")),
        MORE[7].replace("{ uniform = [0.1, 0.2] }", &of("ratios")),
        MORE[7].replace("[0.1, 0.2] }", "[0.1, 0.2], seed = 2 }"),
        MORE[6].replace("{ uniform = [1, 2] }", "{ image = \"grey.png\", low = 1, high = 6 }"),
        MORE[7].replace("{ uniform = [0.1, 0.2] }", "{ image = \"grey.png\", low = 0.4, high = 0.2 }"),
        MORE[0].replace(
            "{ points = [[0, 0], [1, 0.1]], slopes = [[0, 0.1], [0.1, 0]] }",
            "{ file = \"rough.csv\", smooth = true }",
        ),
    ];
    std::fs::write(folder.join("rough.csv"), "s,height\n0,0\n1,0.1\n").unwrap();
    write_png(&folder.join("grey.png"), png::ColorType::Grayscale, 2, &GREY);
    texts.map(|text| (folder.join("scene.toml").display().to_string(), text))
}

/// Grey levels of two rows of two pixels, the upper one first.
const GREY: [u8; 4] = [0, 255, 51, 102];

fn write_png(path: &Path, colours: png::ColorType, columns: u32, bytes: &[u8]) {
    let mut encoder = png::Encoder::new(std::fs::File::create(path).unwrap(), columns, 2);
    encoder.set_color(colours);
    encoder.write_header().unwrap().write_image_data(bytes).unwrap();
}

#[test]
fn an_image_lies_as_it_is_seen_and_what_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_png(&folder.path().join("grey.png"), png::ColorType::Grayscale, 2, &GREY);
    write_png(&folder.path().join("wide.png"), png::ColorType::Grayscale, 4, &[GREY, GREY].concat());
    write_png(&folder.path().join("colour.png"), png::ColorType::Rgb, 2, &[GREY, GREY, GREY].concat());
    std::fs::write(folder.path().join("none.png"), "none").unwrap();
    let name = folder.path().join("scene.toml").display().to_string();
    let read = |value: &str| parse(&MORE[6].replace("{ uniform = [1, 2] }", value), &name, &[]);
    let scene = read("{ image = \"grey.png\", low = 1, high = 6 }").unwrap();
    let grid = steklov_problem::grid_of(&scene).unwrap();
    // cells from the lower left, upwards first; 51 and 102 of 255 are 1/5 and 2/5 of the way from 1 to 6
    let moduli = steklov_problem::moduli(&scene, &grid).unwrap();
    let expected = [2.0, 1.0, 3.0, 6.0];
    assert!(moduli.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{moduli:?}");
    for (value, told) in [
        ("{ image = \"wide.png\", low = 1, high = 2 }", "4 by 2 pixels for 2 by 2 cells"),
        ("{ image = \"colour.png\", low = 1, high = 2 }", "it has colours"),
        ("{ image = \"none.png\", low = 1, high = 2 }", "none.png: "),
        ("{ image = \"nix.png\", low = 1, high = 2 }", "nix.png: "),
        ("{ image = \"grey.png\", low = 1 }", "high is missing"),
        ("{ image = \"grey.png\", low = 0, high = 2 }", "low is 0"),
        ("{ image = \"grey.png\", low = 1, high = 2, seed = 1 }", "stands beside"),
        ("{ uniform = [1, 2], low = 1 }", "stands without image"),
    ] {
        let error = read(value).unwrap_err();
        assert!(error.message.contains(told), "{value}: {error}");
    }
}

fn json_of(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap()
}

/// The path of a value as the key of an override.
fn key_of(path: &[String]) -> String {
    path.iter().map(|key| format!("{key:?}")).collect::<Vec<_>>().join(".")
}

fn at<'a>(value: &'a mut Value, path: &[String]) -> &'a mut Value {
    path.iter().fold(value, |value, key| match value {
        Value::Array(list) => &mut list[key.parse::<usize>().unwrap()],
        table => table.as_object_mut().unwrap().entry(key).or_insert(Value::Null),
    })
}

/// Paths of all values in a scene.
fn paths(value: &Value, path: &[String], all: &mut Vec<Vec<String>>) {
    let mut below = |key: String, value: &Value| {
        let path = [path, &[key]].concat();
        all.push(path.clone());
        paths(value, &path, all);
    };
    match value {
        Value::Array(list) => list.iter().enumerate().for_each(|(k, value)| below(k.to_string(), value)),
        Value::Object(table) => table.iter().for_each(|(key, value)| below(key.clone(), value)),
        _ => {}
    }
}

#[test]
fn the_schema_takes_all_sound_scenes_and_they_have_all_keys() {
    let schema = schema();
    let mut seen = BTreeSet::new();
    for (name, text) in scenes() {
        parse(&text, &name, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        let keys = validator::validate(&schema, &json_of(&text)).unwrap_or_else(|e| panic!("{name}: {e}"));
        seen.extend(keys.into_iter().map(|(key, _)| key));
    }
    let tables = schema["$defs"].as_object().unwrap();
    let tables = tables.iter().map(|(name, table)| (name.as_str(), table)).chain([("scene", &schema)]);
    let keys = tables.flat_map(|(name, table)| {
        table["properties"].as_object().into_iter().flatten().map(move |(key, _)| format!("{name}.{key}"))
    });
    let unseen: Vec<String> = keys.filter(|key| !seen.contains(key)).collect();
    assert!(unseen.is_empty(), "no scene of this test has {unseen:?}");
}

/// Whether the error is one that a schema can find: keys, types and words.
fn is_formal(error: &SceneError) -> bool {
    match error.kind {
        SceneErrorKind::WrongType => true,
        SceneErrorKind::UnknownKey => error.message.starts_with("unknown key"),
        SceneErrorKind::Data(DataErrorKind::Value) => error.message.contains("is not a choice"),
        _ => false,
    }
}

/// Numbers that follow from a seed (splitmix64).
struct Draw(u64);

impl Draw {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % count as u64) as usize
    }
}

/// Changes of a scene: a key that no table has, and other values of existing keys.
fn changes(scene: &Value, draw: &mut Draw, count: usize) -> Vec<(Vec<String>, Value)> {
    let mut all = vec![Vec::new()];
    paths(scene, &[], &mut all);
    let mut list = Vec::new();
    for _ in 0..count {
        let mut path = all[draw.below(all.len())].clone();
        let is_table = at(&mut scene.clone(), &path).is_object();
        if path.is_empty() || is_table && draw.below(2) == 0 {
            path.push("zz_unknown".to_owned());
            if !is_table {
                continue;
            }
        }
        let values = [
            json!(true),
            json!(false),
            json!("zz"),
            json!(7.5),
            json!(-3),
            json!(0),
            json!(1),
            json!([]),
            json!({}),
            json!([1, 2]),
            json!({ "zz": 1 }),
            json!([{}]),
            json!(""),
        ];
        list.push((path, values[draw.below(values.len())].clone()));
    }
    list
}

#[test]
fn empty_lists_and_names_are_refused() {
    for (scene, setting, told) in [
        (3, "body = []", "body lists no body"),
        (4, "body.0.holes = []", "body[0].holes lists no hole"),
        (3, "body.1.sides.3 = ''", "an empty name"),
        (3, "body.1.sides = ['']", "4 corners"),
    ] {
        let error = parse(MORE[scene], "scene", &[setting.to_owned()]).unwrap_err();
        assert!(error.message.contains(told), "{setting}: {error}");
    }
}

#[test]
fn schema_and_reader_refuse_alike_what_is_changed() {
    let (schema, mut draw, mut wrong) = (schema(), Draw(1), Vec::new());
    let mut counts: BTreeMap<(bool, bool), usize> = BTreeMap::new();
    for (name, text) in scenes() {
        let scene = json_of(&text);
        for (path, value) in changes(&scene, &mut draw, 30) {
            let mut changed = scene.clone();
            *at(&mut changed, &path) = value.clone();
            let by_schema = validator::validate(&schema, &changed);
            let toml = toml::Value::try_from(&value).unwrap();
            let setting = format!("{} = {toml}", key_of(&path));
            let read = || parse(&text, &name, std::slice::from_ref(&setting));
            let Ok(by_reader) = std::panic::catch_unwind(read) else {
                wrong.push(format!("{name}: {setting}\n  the reader panics"));
                continue;
            };
            *counts.entry((by_schema.is_ok(), by_reader.is_ok())).or_default() += 1;
            match (&by_schema, &by_reader) {
                (Err(why), Ok(_)) => wrong.push(format!("{name}: {setting}\n  the schema alone refuses it: {why}")),
                (Ok(_), Err(error)) if is_formal(error) => {
                    wrong.push(format!("{name}: {setting}\n  the reader alone refuses it: {error}; {}", error.help));
                }
                _ => {}
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {counts:?}:\n{}", wrong.len(), wrong.join("\n"));
    // the changes must include refused and accepted scenes
    assert!(counts[&(false, false)] > 1000 && counts[&(true, true)] > 100, "{counts:?}");
}

/// A scene as text, without places, and with the defaults filled in that depend on other keys.
fn told(mut scene: Scene) -> String {
    let method = &mut scene.method;
    (method.tolerance, method.elements, method.max_dofs) =
        (Some(method.tolerance()), Some(method.elements()), Some(method.max_dofs()));
    let text = format!("{scene:?}");
    let mut parts = text.split("Place {");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |told, part| told + part.split_once('}').map_or(part, |(_, rest)| rest))
}

/// Keys `DEFINITION.KEY` of the schema and their defaults.
fn defaults(schema: &Value) -> Vec<(String, Value)> {
    let of = |(name, table): (&String, &Value)| -> Vec<(String, Value)> {
        let keys = table["properties"].as_object().into_iter().flatten();
        keys.filter_map(|(key, of)| Some((format!("{name}.{key}"), of.get("default")?.clone()))).collect()
    };
    schema["$defs"].as_object().unwrap().iter().flat_map(of).collect()
}

#[test]
fn a_default_that_is_written_out_changes_nothing() {
    let schema = schema();
    let defaults = defaults(&schema);
    let mut untried: BTreeSet<&str> = defaults.iter().map(|(full, _)| full.as_str()).collect();
    for (name, text) in scenes() {
        let (scene, without) = (json_of(&text), told(parse(&text, &name, &[]).unwrap()));
        let mut all = Vec::new();
        paths(&scene, &[], &mut all);
        for path in all {
            let table = at(&mut scene.clone(), &path).clone();
            for (full, default) in
                defaults.iter().filter(|(full, _)| untried.contains(full.as_str())).collect::<Vec<_>>()
            {
                let key = full.rsplit('.').next().unwrap();
                if table.as_object().is_none_or(|table| table.contains_key(key)) {
                    continue;
                }
                let path = [&path[..], &[key.to_owned()]].concat();
                let mut changed = scene.clone();
                *at(&mut changed, &path) = default.clone();
                let place = (full.clone(), format!(".{}", path.join(".")));
                let setting = format!("{} = {}", key_of(&path), toml::Value::try_from(default).unwrap());
                if validator::validate(&schema, &changed).is_ok_and(|seen| seen.contains(&place))
                    && let Ok(scene) = parse(&text, &name, std::slice::from_ref(&setting))
                {
                    assert!(told(scene) == without, "{name}: {setting} changes the scene");
                    untried.remove(full.as_str());
                }
            }
        }
    }
    assert!(untried.is_empty(), "no scene of this test can have {untried:?}");
}

/// A fifth of the numbers of all scenes, each in turn, is a multiple of a parameter: the scene is the same one. Where the schema refuses
/// texts, as it does where words may stand, the reader refuses them too.
#[test]
fn numbers_may_be_expressions_of_parameters() {
    let (schema, mut draw, mut counts) = (schema(), Draw(2), BTreeMap::<&str, usize>::new());
    for (name, text) in scenes() {
        let (scene, mut without) = (json_of(&text), parse(&text, &name, &[]).unwrap());
        without.parameters.clear();
        let without = told(without);
        let mut all = Vec::new();
        paths(&scene, &[], &mut all);
        for path in all {
            let value = at(&mut scene.clone(), &path).clone();
            let Some(number) = value.as_f64().filter(|_| path[0] != "parameters" && draw.below(5) == 0) else {
                continue;
            };
            // of powers of two the product and the quotient are exact
            let factor = [1.0, -2.0, 0.25][draw.below(3)];
            let text_of_number = format!("p_0/({factor})");
            let settings =
                [format!("parameters.p_0 = {:?}", number * factor), format!("{} = '{text_of_number}'", key_of(&path))];
            let mut changed = scene.clone();
            *at(&mut changed, &path) = json!(text_of_number);
            let by_schema = validator::validate(&schema, &changed);
            let outcome = match parse(&text, &name, &settings) {
                Err(_) if by_schema.is_err() => "refused",
                Err(error) => panic!("{name}: {settings:?}: {error}; {}", error.help),
                Ok(_) if by_schema.is_err() => panic!("{name}: {settings:?}: the schema alone refuses it"),
                Ok(mut with) => {
                    with.parameters.clear();
                    let with = told(with);
                    // data keep their text, and a far field knows that it depends on names
                    let is_of_place = with.contains(&text_of_number) || with.contains("named: true");
                    assert!(is_of_place || with == without, "{name}: {settings:?}: {with}\n{without}");
                    if is_of_place { "data" } else { "numbers" }
                }
            };
            *counts.entry(outcome).or_default() += 1;
        }
    }
    assert!(counts["numbers"] > 500 && counts["data"] > 10, "{counts:?}");
    for key in ["marking", "gamma"] {
        let settings = ["parameters.p_0 = 0.5".to_owned(), format!("method.{key} = 'p_0'")];
        let error = parse(MORE[0], "scene", &settings).unwrap_err();
        assert!(error.message.contains("is \"p_0\"") && error.help.contains("auto"), "{error}: {}", error.help);
    }
}

#[test]
fn the_page_of_the_keys_is_the_one_that_the_keys_make() {
    let file = folder("docs/reference/scene-keys.md");
    let page = std::fs::read_to_string(&file).unwrap_or_default();
    let same = page == reference();
    assert!(
        same,
        "write the page anew: cargo run -p steklov-document --example reference > docs/reference/scene-keys.md"
    );
}
