use std::sync::atomic::AtomicUsize;
use steklov::scene::{Refine, Scene};
use steklov::study::{reference, strategy};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let scene =
        Scene::read(std::path::Path::new(&args[1]), &args[2..].to_vec()).unwrap_or_else(|e| panic!("{}", e.render()));
    let stop = AtomicUsize::new(0);
    let r = match reference(&scene, &stop) {
        Ok(r) => r,
        Err(e) => {
            println!("{} REFERENCE FAILED {e}", args[1]);
            return;
        }
    };
    println!("{} reference J {:.14e} dofs {} est {:.1e}", args[1], r.energy, r.dofs, r.estimate);
    let s = match strategy(&scene, scene.method.refine, "hp", &r, 1, &stop) {
        Ok(s) => s,
        Err(e) => {
            println!("{} FAILED {e}", args[1]);
            return;
        }
    };
    for (k, p) in s.points.iter().enumerate() {
        println!(
            "{k:2} n={:3} dofs={:5} e={:.1e} E={:.2e} est={:.2e} eff={:5.2} Jx/J {:+.2} unc/true {:.2} {:?} {:.1e} {:.1e} {:.1e}",
            p.mesh.len(),
            p.dofs,
            p.energy_error,
            p.error,
            p.estimate,
            p.estimate / p.error,
            (p.extrapolated[0] - p.energy) / (r.energy - p.energy),
            p.extrapolated[1] / (p.extrapolated[0] - r.energy).abs(),
            p.doubts,
            p.parts[0],
            p.parts[1],
            p.parts[2]
        );
    }
    println!("{:?}", s.reason);
    let _ = Refine::Hp;
}
