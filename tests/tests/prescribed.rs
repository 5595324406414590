//! Prescribed displacements: which are continuous, and which are small.

use std::path::Path;

use steklov::plan::plan;
use steklov::record::Record;
use steklov_tests::{adapt, parse};

#[test]
fn steep_displacements_are_no_jumps() {
    let text = |u: &str| {
        format!(
            "body.corners = [[0,0],[1,0],[1,1],[0,1]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 1.0, poisson = 0.3 }}\nsides.floor.displacement = [\"0\", \"{u}\"]\n"
        )
    };
    for u in
        ["-0.01*s^0.1", "0.01*abs(s-0.3)^0.1", "0.01*sqrt(abs(s-0.3))", "0.01*(1-s)^0.02", "0.01*max(0,s-0.5)^0.05"]
    {
        assert!(parse(&text(u), &[]).is_ok(), "{u}");
    }
    for u in ["if(s<0.3,0,0.01)", "0.01*sign(s-0.7)", "0.01*sign(s-0.7)-0.5*s", "if(s<0.5,s,0.4)", "if(s<0.5,s^0.1,1)"]
    {
        let error = parse(&text(u), &[]).err().unwrap_or_else(|| panic!("{u}"));
        assert!(error.render().contains("jumps from"), "{u}: {}", error.render());
    }
}

/// A part of 120 pushed 50 deep is not described by small strains; one pushed 0.5 deep is, and so is one that turns as a whole
/// by little.
#[test]
fn deformations_beyond_small_strains_are_doubted() {
    let pressed = |gap: f64| {
        let text = format!(
            "body.corners = [[0,0],[120,0],[120,40],[0,40]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 210000.0, poisson = 0.3 }}\nsides.top.displacement = [\"0\",\"0\"]\n\
             sides.floor.contact = {{ gap = \"{gap:?}\" }}\nmethod.tolerance = 1e-2\n"
        );
        let scene = parse(&text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let run = adapt(&scene).unwrap_or_else(|e| panic!("{e}"));
        let record = Record::new(&scene, plan(&scene), run, None, Path::new("none.vtkhdf"), 0.0);
        record.summary.estimate_doubts.contains(&"large".to_owned())
    };
    assert!(pressed(-50.0) && !pressed(-0.5));
}
