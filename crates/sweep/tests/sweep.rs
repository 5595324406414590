//! Points, tables, files and parts of sweeps.

use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;
use steklov_sweep::steklov_document::{Document, parse};
use steklov_sweep::{Journal, MOST_POINTS, Observer, Outcome, Points, Sweep, SweepError, read, solve_points, write};

/// A block that a floor holds, pressed by p: J = -p² (1 - ν²) A / 2E.
const BLOCK: &str = r#"
title = "block"
body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
material = { young = 200, poisson = 0.3 }
parameters.p = 1
sides.floor.contact = { gap = "0" }
sides.top.pressure = "p"
"#;

fn document() -> Document {
    Document::parse(BLOCK, "block.toml", &[]).unwrap()
}

fn vary(texts: &[&str]) -> Points {
    Points::vary(texts, false).unwrap()
}

/// Solves the missing points of a part, each told to `keep`.
fn solve(sweep: &mut Sweep, part: [usize; 2], threads: usize, journal: Option<&mut Journal>) {
    solve_of(&document(), sweep, part, threads, journal);
}

/// The same of another scene.
fn solve_of(
    document: &Document,
    sweep: &mut Sweep,
    part: [usize; 2],
    threads: usize,
    mut journal: Option<&mut Journal>,
) {
    let wanted = sweep.missing(part);
    let (points, outcomes) = (&sweep.points, &mut sweep.outcomes);
    let mut keep = |point: usize, outcome: &Outcome| {
        outcomes[point] = Some(outcome.clone());
        journal.as_mut().map_or(Ok(()), |journal| journal.add(point, outcome))
    };
    let observer = Observer { interrupts: &AtomicUsize::new(0), keep: &mut keep };
    solve_points(document, points, &wanted, threads, observer).unwrap();
}

fn solved(points: Points, threads: usize) -> Sweep {
    let mut sweep = Sweep::new(&document(), points);
    solve(&mut sweep, [1, 1], threads, None);
    sweep
}

#[test]
fn ranges_and_lists_are_the_values_that_they_say() {
    let points = vary(&["a=0:1:5", "n=4:12:3", "m=1:2:3", "w=h,\"hp\"", "v=[0, 1],[2, 3]"]);
    assert_eq!(points.len(), 5 * 3 * 3 * 2 * 2);
    let values = |key: usize| -> Vec<&str> {
        let mut all: Vec<&str> = (0..points.len()).map(|point| points.value(point, key)).collect();
        all.dedup();
        all.truncate(5);
        all
    };
    assert_eq!(values(0), ["0.0", "0.25", "0.5", "0.75", "1.0"]);
    assert_eq!(values(1)[..3], ["4", "8", "12"]);
    assert_eq!(values(2)[..3], ["1.0", "1.5", "2.0"]);
    assert_eq!(points.settings(1), ["a=0.0", "n=4", "m=1.0", "w=\"h\"", "v=[2, 3]"]);
    let pairs = Points::vary(&["a=1,2", "b=3:4:2"], true).unwrap();
    assert_eq!((pairs.len(), pairs.settings(1)), (2, vec!["a=2".to_owned(), "b=4".to_owned()]));
    let table = Points::from_csv("parameters.p, method.refine\n1.5, h\n2, hp\n", "points.csv").unwrap();
    assert_eq!(table.settings(1), ["parameters.p=2", "method.refine=\"hp\""]);
}

#[test]
fn points_that_cannot_be_are_refused_with_a_remedy() {
    for (texts, zip, told) in [
        (&["a"][..], false, "there is no ="),
        (&["=1,2"], false, "a key is missing"),
        (&["a="], false, "a value is missing"),
        (&["a=1,,2"], false, "a value is missing"),
        (&["a=1:2:0"], false, "there are no 0 values"),
        (&["a=1:2:1"], false, "there are no 1 values"),
        (&["a=1:1:3"], false, "there are no 3 values"),
        (&["a=0:inf:3"], false, "must be finite"),
        (&["a=0:1:x"], false, "is no number of values"),
        (&["a=1", "a=2"], false, "varied twice"),
        (&["a=1,2", "b=1"], true, "are no pairs"),
        (&[], false, "a key is missing"),
    ] {
        let error = Points::vary(texts, zip).unwrap_err();
        assert!(matches!(&error, SweepError::Vary { .. }) && error.to_string().contains(told), "{texts:?}: {error}");
    }
    for (table, told) in [
        ("", "a key is missing"),
        ("a\n", "no points"),
        ("a,b\n1\n", "found record with 1 fields"),
        ("a,a\n1,2\n", "twice"),
    ] {
        let error = Points::from_csv(table, "points.csv").unwrap_err();
        assert!(error.to_string().contains(told), "{table:?}: {error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn a_range_has_its_ends_and_equal_distances(a in -1e6..1e6f64, b in -1e6..1e6f64, n in 2usize..40) {
        let points = vary(&[&format!("k={a:?}:{b:?}:{n}")]);
        prop_assert_eq!(points.len(), n);
        prop_assert_eq!((points.number(0, 0), points.number(n - 1, 0)), (a, b));
        let scale = a.abs().max(b.abs());
        for k in 0..n {
            let exact = a + (b - a) * k as f64 / (n - 1) as f64;
            prop_assert!((points.number(k, 0) - exact).abs() <= 4.0 * f64::EPSILON * scale);
        }
    }

    #[test]
    fn every_point_is_in_one_part(counts in proptest::collection::vec(1usize..5, 1..4), parts in 1usize..6) {
        let texts: Vec<String> = counts.iter().enumerate().map(|(k, n)| {
            format!("k{k}={}", (0..*n).map(|v| v.to_string()).collect::<Vec<_>>().join(","))
        }).collect();
        let sweep = Sweep::new(&document(), Points::vary(&texts, false).unwrap());
        let all: Vec<Vec<String>> = (0..sweep.points.len()).map(|point| sweep.points.settings(point)).collect();
        prop_assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
        let mut seen: Vec<usize> = (1..=parts).flat_map(|part| sweep.missing([part, parts])).collect();
        seen.sort_unstable();
        prop_assert_eq!(seen, (0..sweep.points.len()).collect::<Vec<_>>());
    }
}

#[test]
fn points_have_the_numbers_of_their_scene_for_any_number_of_threads() {
    let points = || vary(&["parameters.p=0.5:3:6", "material.poisson=0.0,0.45"]);
    let sweep = solved(points(), 1);
    assert_eq!(sweep, solved(points(), 3));
    let energies = sweep.quantities().column("energy").unwrap();
    for (point, energy) in energies.iter().enumerate() {
        let [p, nu] = [0, 1].map(|key| sweep.points.number(point, key));
        let exact = -0.5 * p * p * (1.0 - nu * nu) * 2.0 / 200.0;
        assert!((energy / exact - 1.0).abs() < 1e-10, "{p} {nu}: {energy} for {exact}");
        let scene = parse(BLOCK, "block.toml", &sweep.points.settings(point)).unwrap();
        let alone = steklov_model::solve(&scene).unwrap().summary.energy;
        assert_eq!(energy.to_bits(), alone.to_bits());
    }
    let csv = sweep.csv();
    let mut lines = csv.lines();
    assert!(
        lines.next().unwrap().starts_with("point,parameters.p,material.poisson,state,reason,converged,doubts,message,")
    );
    assert!(lines.next().unwrap().starts_with("0,0.5,0.0,solved,"));
    assert_eq!(lines.count(), 11);
}

#[test]
fn sides_of_any_name_are_in_the_table() {
    for name in ["file", "seconds", "ends", "point", "sides", "solution"] {
        let text = BLOCK.replace("floor", name);
        let document = Document::parse(&text, "block.toml", &[]).unwrap();
        let mut sweep = Sweep::new(&document, vary(&["parameters.p=1,2"]));
        solve_of(&document, &mut sweep, [1, 1], 2, None);
        let force = sweep.quantities().column(&format!("reactions.{name}.y")).unwrap_or_default();
        assert!(force.len() == 2 && force.iter().zip([2.0, 4.0]).all(|(f, exact)| (f - exact).abs() < 1e-9), "{name}");
    }
}

#[test]
fn points_with_random_input_have_no_seconds_in_them() {
    let text =
        format!("{BLOCK}\n[random.r]\ndistribution = \"uniform\"\nlow = 1\nhigh = 2\n").replace("\"p\"", "\"p*r\"");
    let document = Document::parse(&text, "block.toml", &[]).unwrap();
    let points = vary(&["parameters.p=1,2"]);
    let solved = || {
        let mut sweep = Sweep::new(&document, points.clone());
        solve_of(&document, &mut sweep, [1, 1], 2, None);
        sweep
    };
    let sweep = solved();
    assert_eq!(sweep, solved());
    // J of p r, r from 1 to 2: E r² = 7/3
    let means = sweep.quantities().column("stochastic.energy.mean").unwrap();
    for (p, mean) in [1.0, 2.0].iter().zip(means) {
        let exact = -0.5 * p * p * 7.0 / 3.0 * (1.0 - 0.3 * 0.3) * 2.0 / 200.0;
        assert!((mean / exact - 1.0).abs() < 1e-9, "{mean} for {exact}");
    }
}

#[test]
fn points_that_fail_stay_in_the_table_with_their_message() {
    let sweep = solved(vary(&["material.young=-1,200,'p*q'"]), 2);
    assert_eq!(sweep.counts(), [1, 0, 2, 0]);
    let csv = sweep.csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[1].starts_with("0,-1,failed,,,,") && lines[1].contains("positive"), "{}", lines[1]);
    assert!(lines[2].starts_with("1,200,solved,"), "{}", lines[2]);
    assert!(lines[3].starts_with("2,p*q,failed,") && lines[3].contains("unknown name q"), "{}", lines[3]);
}

#[test]
fn keys_without_effect_and_too_many_points_are_refused() {
    let refused = |texts: &[&str]| {
        let (document, points) = (document(), vary(texts));
        let observer = Observer { interrupts: &AtomicUsize::new(0), keep: &mut |_, _| Ok(()) };
        solve_points(&document, &points, &[0], 1, observer).unwrap_err()
    };
    assert!(refused(&["parameters.q=1,2"]).to_string().contains("parameters.q has no effect"));
    assert!(refused(&["mthd.degree=1,2"]).to_string().contains("unknown key mthd"));
    match refused(&["parameters.p=1:2:1000", "material.young=1:2:1000"]) {
        SweepError::TooMany { count: 1_000_000, most: MOST_POINTS, seconds, .. } => assert!(seconds > 0.0),
        other => panic!("{other}"),
    }
}

#[test]
fn parts_merge_to_the_same_bytes_and_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let points = || vary(&["parameters.p=1:2:5"]);
    write(&solved(points(), 2), &path("whole.h5"), false).unwrap();
    for part in [1, 2] {
        let mut sweep = Sweep::new(&document(), points());
        solve(&mut sweep, [part, 2], part, None);
        write(&sweep, &path(&format!("{part}.h5")), false).unwrap();
    }
    let mut merged = read(&path("2.h5")).unwrap();
    assert_eq!(merged.counts(), [2, 0, 0, 3]);
    merged.take(read(&path("1.h5")).unwrap(), ["2.h5", "1.h5"]).unwrap();
    write(&merged, &path("merged.h5"), false).unwrap();
    assert!(std::fs::read(path("merged.h5")).unwrap() == std::fs::read(path("whole.h5")).unwrap());

    let other = Sweep::new(&document(), vary(&["parameters.p=1:2:6"]));
    let error = merged.take(other, ["merged.h5", "other.h5"]).unwrap_err();
    assert!(matches!(&error, SweepError::Other { what: "points", .. }), "{error}");
    let mut wrong = read(&path("1.h5")).unwrap();
    wrong.outcomes[0] = Some(Outcome::Failed("spoilt".to_owned()));
    let error = merged.take(wrong, ["merged.h5", "wrong.h5"]).unwrap_err();
    assert!(matches!(&error, SweepError::Conflict { point: 0, .. }), "{error}");
}

#[test]
fn a_journal_that_was_cut_off_gives_its_whole_lines() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("sweep.h5");
    let points = || vary(&["parameters.p=1:2:4"]);
    let mut sweep = Sweep::new(&document(), points());
    let mut journal = Journal::begin(&out, &mut sweep, false, false).unwrap();
    solve(&mut sweep, [1, 1], 1, Some(&mut journal));
    let second = Journal::begin(&out, &mut Sweep::new(&document(), points()), true, false);
    assert!(matches!(second, Err(SweepError::Busy { .. })));
    drop(journal);
    let path = folder.path().join("sweep.h5.journal");
    let whole = std::fs::read(&path).unwrap();
    let again = Journal::begin(&out, &mut Sweep::new(&document(), points()), false, false);
    assert!(matches!(again, Err(SweepError::Unfinished { kept: 4, .. })));

    // cut off anywhere, all whole lines count and the rest is solved again to the same bits
    for cut in [whole.len() - 1, whole.len() / 2, whole.len() / 3] {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let lines = whole[..cut].split(|b| *b == b'\n').count() - 1;
        let mut resumed = Sweep::new(&document(), points());
        let mut journal = Journal::begin(&out, &mut resumed, true, false).unwrap();
        let kept = resumed.outcomes.iter().flatten().count();
        // a last line that lacks nothing but its end is whole
        assert!(kept == lines - 1 || cut + 1 == whole.len() && kept == lines, "{kept} of {lines} lines");
        solve(&mut resumed, [1, 1], 2, Some(&mut journal));
        assert_eq!(resumed, sweep);
        drop(journal);
        let mut third = Sweep::new(&document(), points());
        Journal::begin(&out, &mut third, true, false).unwrap().end().unwrap();
        assert_eq!(third, sweep);
    }
    assert!(!path.exists());
}

#[test]
fn a_sweep_that_is_stopped_finishes_what_runs() {
    let (document, points) = (document(), vary(&["parameters.p=1:2:2000"]));
    let interrupts = AtomicUsize::new(0);
    let mut finished = 0;
    let mut keep = |_: usize, _: &Outcome| {
        finished += 1;
        interrupts.store(1, Ordering::Relaxed);
        Ok(())
    };
    let wanted: Vec<usize> = (0..2000).collect();
    solve_points(&document, &points, &wanted, 2, Observer { interrupts: &interrupts, keep: &mut keep }).unwrap();
    assert!((1..2000).contains(&finished), "{finished}");
}
