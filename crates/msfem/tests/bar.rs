//! The bar 6 × 1 of the reference file: fine and multiscale solutions, their errors and stresses.

use crate::common::{Cantilever, MESHES, bar, bar_moduli, close, kind, number, reference};
use steklov_msfem::{Basis, CoarseCell, CoarseMesh};

#[test]
fn the_moduli_are_those_of_the_generator() {
    let young = bar_moduli(true, 1);
    let wanted = &reference("bar")["rand"]["E_first_cells"];
    for (k, cell) in [0, 1, 32, 191 * 32 + 31].into_iter().enumerate() {
        close("modulus", young[cell], number(&wanted[k]), 1e-9);
    }
}

#[test]
fn homogeneous_and_random_bar_have_the_published_digits() {
    let data = reference("bar");
    let tolerance = number(&data["tol_rel"]);
    for (random, name, kinds) in
        [(false, "hom", &["q1", "a", "b", "d"][..]), (true, "rand", &["q1", "a", "b", "c", "d"])]
    {
        let problem = bar(random, 1);
        let fine = problem.fine();
        let wanted = &data[name]["fine"];
        let work: f64 = fine.iter().zip(&problem.load).map(|(u, f)| u * f).sum();
        let von_mises = problem.von_mises(&fine);
        close("compliance", work, number(&wanted["compliance"]), tolerance);
        close("energy", problem.body.energy(&fine, &fine), number(&wanted["energy"]), tolerance);
        close("tip", problem.tip(&fine), number(&wanted["tip"]), tolerance);
        close("vm_max", von_mises.iter().fold(0.0, |m: f64, v| m.max(*v)), number(&wanted["vm_max"]), tolerance);
        close("vm_center", von_mises[96 * 32], number(&wanted["vm_center_i96_j0"]), tolerance);
        for (mesh, cells) in MESHES {
            for word in kinds {
                let wanted = &data[name][format!("{word}_{mesh}")];
                let solved = problem.multiscale([cells; 2], kind(word, cells), false);
                let what = |quantity: &str| format!("{name} {word} {mesh} {quantity}");
                let [energy, l2] = problem.errors(&solved, &fine);
                close(&what("energy_err"), energy, number(&wanted["energy_err"]), tolerance);
                // a small difference of two fields that have lost eight digits to the slender bar
                close(&what("l2_err"), l2, number(&wanted["l2_err"]), 10.0 * tolerance);
                close(&what("compliance"), solved.compliance, number(&wanted["compliance"]), tolerance);
                let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
                close(&what("tip"), problem.tip(&u), number(&wanted["tip"]), tolerance);
                let stresses = problem.von_mises(&u);
                let largest = stresses.iter().fold(0.0, |m: f64, v| m.max(*v));
                close(&what("vm_max"), largest, number(&wanted["vm_max"]), tolerance);
                let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
                let difference: Vec<f64> = stresses.iter().zip(&von_mises).map(|(a, b)| a - b).collect();
                close(
                    &what("vm_l2_err"),
                    norm(&difference) / norm(&von_mises),
                    number(&wanted["vm_l2_err"]),
                    tolerance,
                );
                assert_eq!(
                    solved.problem.patterns(),
                    wanted["n_local_solves"].as_u64().unwrap() as usize,
                    "{word} {mesh}"
                );
                assert_eq!(solved.problem.dofs(), wanted["n_coarse"].as_u64().unwrap() as usize);
            }
        }
    }
}

#[test]
fn finer_meshes_in_the_same_cells_approach_the_limit() {
    let data = reference("bar");
    let (wanted, tolerance) = (&data["rand_refined_fine_compliance"], number(&data["tol_rel"]));
    for (parts, name) in [(1, "h=1/32"), (2, "h=1/64"), (4, "h=1/128")] {
        let problem = bar(true, parts);
        let fine = problem.fine();
        let work: f64 = fine.iter().zip(&problem.load).map(|(u, f)| u * f).sum();
        close(name, work, number(&wanted[name]), tolerance);
    }
}

#[test]
fn own_weight_with_and_without_bubbles() {
    let data = reference("body_force");
    let problem = Cantilever::with_weight([6.0, 1.0], [192, 32], bar_moduli(true, 1));
    let fine = problem.fine();
    let work: f64 = fine.iter().zip(&problem.load).map(|(u, f)| u * f).sum();
    close("compliance", work, number(&data["fine_compliance"]), 1e-8);
    for (mesh, cells) in MESHES {
        for word in ["q1", "b", "c"] {
            let wanted = &data[format!("{word}_{mesh}")];
            let error =
                |bubbles: bool| problem.errors(&problem.multiscale([cells; 2], kind(word, cells), bubbles), &fine)[0];
            close(&format!("{word} {mesh}"), error(false), number(&wanted["no_bubble"]), 1e-8);
            if word != "q1" {
                close(&format!("{word} {mesh} with bubbles"), error(true), number(&wanted["bubble"]), 1e-8);
            }
        }
    }
}

#[test]
fn coupled_functions_are_the_best_of_linear_traces() {
    // the fine field is nearer to coupled ones than to any field with the same traces
    let problem = bar(true, 1);
    let fine = problem.fine();
    let fine_work: f64 = fine.iter().zip(&problem.load).map(|(u, f)| u * f).sum();
    for (_, cells) in MESHES {
        let error = |basis| {
            let solved = problem.multiscale([cells; 2], basis, false);
            (problem.errors(&solved, &fine)[0], solved.compliance)
        };
        let ((q1, q1_work), (linear, _), (coupled, work)) =
            (error(Basis::Q1), error(Basis::Linear), error(Basis::Coupled));
        assert!(coupled < q1 && coupled < linear);
        assert!(q1_work < work && work < fine_work);
    }
}

#[test]
fn cells_of_different_sizes_conform() {
    // the left half split once, two of its cells once more: nested spaces, so that the work of the load grows
    let problem = bar(true, 1);
    let fine = problem.fine();
    let split = |cells: &[CoarseCell], which: &dyn Fn(&CoarseCell) -> bool| -> Vec<CoarseCell> {
        let quarter = |c: &CoarseCell| {
            let [m, n] = c.size.map(|s| s / 2);
            let [i, j] = c.first;
            [[i, j], [i + m, j], [i, j + n], [i + m, j + n]].map(|first| CoarseCell { first, size: [m, n] })
        };
        cells.iter().flat_map(|c| if which(c) { quarter(c).to_vec() } else { vec![*c] }).collect()
    };
    let coarse = CoarseMesh::uniform(&problem.body.grid, [16; 2]).unwrap().cells;
    let once = split(&coarse, &|c| c.first[0] < 96);
    let twice = split(&once, &|c| c.first[0] < 16);
    for basis in [Basis::Q1, Basis::Coupled, Basis::Oscillatory] {
        let mut last = f64::INFINITY;
        for cells in [&coarse, &once, &twice] {
            let mesh = CoarseMesh::new(&problem.body.grid, cells.clone()).unwrap();
            let solved = problem.on_mesh(mesh, basis, false);
            // a conforming field: the mean over cells has the energy of the broken field
            let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
            close("work is energy", problem.body.energy(&u, &u), solved.compliance, 1e-9);
            let error = problem.errors(&solved, &fine)[0];
            assert!(error < last, "{basis:?}: {error} after {last}");
            last = error;
        }
    }
}
