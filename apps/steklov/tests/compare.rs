//! Two results compared.

use crate::place::Place;

#[test]
fn the_table_has_both_numbers_and_their_difference() {
    let place = Place::new();
    place.run(["solve", "block.toml", "--quiet", "--out", "a.vtkhdf"]).demand(0);
    let finer = ["--set", "method.refine=\"hp\"", "--set", "method.tolerance=1e-5"];
    place.run(["solve", "block.toml", "--quiet", "--out", "b.vtkhdf"].iter().chain(&finer)).demand(0);
    let object = place.run(["compare", "a.vtkhdf", "b.vtkhdf", "--json"]).demand(0).json();
    assert!(object["same_scene"] == true && object["settings"][1][1] == "method.tolerance=1e-5", "{object}");
    let [a, b] = ["a", "b"].map(|name| place.run(["show", &format!("{name}.vtkhdf"), "--json"]).demand(0).json());
    let rows = object["numbers"].as_array().unwrap();
    let row = |path: &str| rows.iter().find(|row| row["path"] == path).unwrap_or_else(|| panic!("{path}"));
    for (path, keys) in [("energy", vec!["energy"]), ("contact.slip", vec!["contact", "slip"]), ("dofs", vec!["dofs"])]
    {
        let number = |object: &serde_json::Value| keys.iter().fold(object, |at, key| &at[*key]).as_f64().unwrap();
        let (row, first, second) = (row(path), number(&a), number(&b));
        let told = ["first", "second", "difference", "relative"].map(|key| row[key].as_f64().unwrap());
        let relative = (second - first).abs() / first.abs().max(second.abs());
        assert_eq!(told, [first, second, second - first, relative], "{path}");
    }
    // the force along x is rounding of that along y
    assert!(row("contact.force.x")["relative"].as_f64().unwrap() < 1e-12);
    assert!(object["energy_distance"].as_f64().unwrap() <= object["energy_uncertainty"].as_f64().unwrap());

    let text = place.run(["compare", "a.vtkhdf", "b.vtkhdf", "--plots", "both"]).demand(0).out;
    assert!(text.contains("settings    of b: ") && text.contains("within the uncertainties of both"), "{text}");
    let names = crate::place::names(&place.path("both"));
    assert_eq!(names, ["compared-contact-floor.png", "compared-contact-floor.svg", "compared.csv"]);
    let itself = place.run(["compare", "a.vtkhdf", "a.vtkhdf", "--json"]).demand(0).json();
    assert!(itself["numbers"].as_array().unwrap().iter().all(|row| row["difference"] == 0.0 && row["relative"] == 0.0));
}

#[test]
fn what_is_no_result_is_refused() {
    let place = Place::new();
    place.run(["solve", "block.toml", "--quiet"]).demand(0);
    place.run(["sweep", "block.toml", "--quiet", "--vary", "parameters.F=0.2,0.3", "--out", "s.h5"]).demand(0);
    for (other, told) in
        [("block.toml", "is a scene and no result"), ("s.h5", "is a sweep"), ("nix.vtkhdf", "nix.vtkhdf")]
    {
        for pair in [["block.vtkhdf", other], [other, "block.vtkhdf"]] {
            let ran = place.run(["compare"].iter().chain(&pair)).demand(1);
            assert!(ran.err.contains(told), "{pair:?}: {}", ran.err);
        }
    }
}
