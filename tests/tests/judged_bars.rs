//! Error bars of all numbers at all steps of some scenes, judged by true errors.

use std::sync::atomic::AtomicUsize;

use steklov_study::Watch;
use steklov_study::quantities::{Judged, Shares, study};
use steklov_tests::document;

#[test]
fn bars_of_scenes_are_near_their_errors() {
    let mut points: Vec<Judged> = Vec::new();
    for (name, changes) in [
        ("elliptic-hole", &["probe.points=[[3, 0.5], [0.2, 1.4]]"][..]),
        ("kirsch-on-a-circle", &[]),
        ("lame-tube", &["method.refine=\"hp\"", "probe.points=[[1, 0], [1.2, 0.4]]"]),
        ("l-shape", &["probe.points=[[0.2, 0.3], [-0.3, 0.2]]"]),
        ("half-block", &[]),
        ("numbers-by-names", &[]),
        ("stick-and-slip", &[]),
        ("tied-blocks", &["probe.points=[[0.31, 0.2], [0.1, -0.4]]"]),
        ("crack-in-the-plane", &[]),
        ("coulomb-wedge", &[]),
    ] {
        let settings: Vec<&str> = changes.iter().copied().chain(["method.tolerance=1e-4", "expect={}"]).collect();
        let document = document(name, &settings);
        let tell = &mut |_: &str, _: &str| {};
        let interrupts = AtomicUsize::new(0);
        let found = study(&document.scene, &document.source, &mut Watch::new(&interrupts, tell)).unwrap();
        assert!(found.complete(), "{name}");
        let own = || found.series.iter().flat_map(|series| &series.points);
        println!("{name}: {:?}", Shares::new(own().filter(|point| point.doubts.is_empty())));
        points.extend(own().cloned());
    }
    let [plain, doubted] =
        [false, true].map(|d| Shares::new(points.iter().filter(|point| point.doubts.is_empty() != d)));
    println!("without doubts {plain:?}\nin doubt {doubted:?}");
    assert!(plain.count > 200 && plain.least >= 0.1, "{plain:?}");
    assert!(plain.above[0] >= 0.97 && plain.above[1] >= 0.99, "{plain:?}");
    assert!(plain.below[0] >= 0.65 && plain.below[1] >= 0.9, "{plain:?}");
    assert!(doubted.above[1] >= 0.95, "{doubted:?}");
}
