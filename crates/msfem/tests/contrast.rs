//! Laminates and inclusions of high contrast against the reference file.

use crate::common::{Cantilever, close, kind, number, plate, reference};
use steklov_msfem::{Basis, CoarseMesh, crossing_contrast};

/// Every length of the periods in one of the directions, or with `STEKLOV_TESTS=full` in both.
#[test]
fn laminates_resonate_as_published() {
    let data = reference("laminate");
    let tolerance = number(&data["tol_rel"]);
    let mut checked = 0;
    let full = std::env::var("STEKLOV_TESTS").is_ok_and(|value| value == "full");
    for (name, diagonal) in [("straight", false), ("diagonal", true)] {
        for periods in [4, 8, 16, 32] {
            if !full && [8, 32].contains(&periods) != diagonal {
                continue;
            }
            let period = 256 / periods;
            let layer = |c: usize| {
                let (i, j) = (c / 256, c % 256);
                let phase = if diagonal { i + 2 * j + 1 } else { i };
                if phase % period < period / 2 { 10.0 } else { 1.0 }
            };
            let problem = Cantilever::new([1.0; 2], [256; 2], (0..256 * 256).map(layer).collect());
            let fine = problem.fine();
            for coarse in [4, 8, 16, 32, 64] {
                let cells = 256 / coarse;
                for word in ["q1", "b", "c", "d"] {
                    let key = format!("{name}_eps1/{periods}_H1/{coarse}_{word}");
                    let Some(wanted) = data["data"].get(&key) else { continue };
                    let solved = problem.multiscale([cells; 2], kind(word, cells / 2), false);
                    close(&key, problem.errors(&solved, &fine)[0], number(wanted), tolerance);
                    checked += 1;
                }
            }
        }
    }
    let all = data["data"].as_object().unwrap().len();
    assert_eq!(checked, if full { all } else { all / 2 });
}

#[test]
fn inclusions_of_high_contrast_fail_as_published() {
    let data = reference("high_contrast");
    let tolerance = number(&data["tol_rel"]);
    for (name, mask, contrast) in [
        ("stiff_inside", "inside", 1e4),
        ("stiff_crossing", "crossing", 1e4),
        ("stiff_channel", "channel", 1e4),
        ("soft_inside", "inside", 1e-4),
        ("soft_crossing", "crossing", 1e-4),
    ] {
        let problem = plate(mask, contrast);
        let fine = problem.fine();
        let wanted = &data["data"][name];
        let work: f64 = fine.iter().zip(&problem.load).map(|(u, f)| u * f).sum();
        close(name, work, number(&wanted["fine_compliance"]), tolerance);
        for word in ["q1", "a", "b", "c", "d8"] {
            let basis = if word == "d8" { Basis::Oversampled(8) } else { kind(word, 0) };
            let solved = problem.multiscale([16; 2], basis, false);
            let what = format!("{name} {word}");
            close(&what, problem.errors(&solved, &fine)[0], number(&wanted[word]["energy_err"]), tolerance);
            close(&what, solved.compliance, number(&wanted[word]["compliance"]), tolerance);
        }
    }
}

#[test]
fn what_crosses_coarse_edges_is_seen() {
    for (name, crosses) in [("inside", false), ("crossing", true), ("channel", true)] {
        for contrast in [1e4, 1e-4, 1.0] {
            let problem = plate(name, contrast);
            let mesh = CoarseMesh::uniform(&problem.body.grid, [16; 2]).unwrap();
            let found = crossing_contrast(&problem.body, &mesh, 1e3);
            let wanted = if crosses { f64::max(contrast, 1.0 / contrast) } else { 1.0 };
            close(name, found.largest, wanted, 1e-12);
            assert_eq!(found.share > 0.0, crosses && contrast != 1.0, "{name} {contrast}: {found:?}");
        }
    }
    // the channels cross the seven inner lines in each of four rows, of 9 · 4 + 8 · 5 sides
    let problem = plate("channel", 1e4);
    let mesh = CoarseMesh::uniform(&problem.body.grid, [16; 2]).unwrap();
    let found = crossing_contrast(&problem.body, &mesh, 1e3);
    close("share", found.share, 28.0 / 76.0, 1e-12);
    // the lowest of the leftmost line
    assert_eq!(found.at, [0.25, 0.125]);
    assert_eq!(crossing_contrast(&problem.body, &mesh, 1e4 * 1.001).share, 0.0);
}

#[test]
fn stiff_coarse_cells_do_no_harm() {
    // a board of stiff and soft coarse cells: nothing varies along a side, and the error is that of a soft body
    let board = |contrast: f64| {
        let young = |c: usize| if (c / 64 / 16 + c % 64 / 16) % 4 == 1 { contrast } else { 1.0 };
        Cantilever::new([2.0, 1.0], [128, 64], (0..128 * 64).map(young).collect())
    };
    let error = |problem: &Cantilever, fine: usize| {
        let solved = problem.multiscale([fine; 2], Basis::Coupled, false);
        (problem.errors(&solved, &problem.fine())[0], crossing_contrast(&problem.body, &solved.problem.mesh, 1e3))
    };
    let (soft, _) = error(&board(1.0), 16);
    let (aligned, seen) = error(&board(1e4), 16);
    assert_eq!((seen.largest, seen.share), (1.0, 0.0));
    assert!(aligned < 2.0 * soft, "{aligned} against {soft}");
}
