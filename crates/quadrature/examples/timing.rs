//! tmp
use num_complex::Complex64;
use steklov_quadrature::legendre_q;
fn main() {
    for (rho, n) in
        [(3.0f64, 10usize), (6.0, 10), (30.0, 10), (2.2, 14), (1.05, 14), (1.005, 14), (3.0, 66), (1.012, 64)]
    {
        let mut q = vec![Complex64::ZERO; n + 1];
        let zs: Vec<_> = (0..1000)
            .map(|i| {
                let w = rho * Complex64::cis(i as f64 * 0.00628 + 0.001);
                0.5 * (w + w.inv())
            })
            .collect();
        let t = std::time::Instant::now();
        let mut s = Complex64::ZERO;
        for _ in 0..100 {
            for &z in &zs {
                legendre_q(z - 1.0, z + 1.0, &mut q);
                s += q[n];
            }
        }
        println!("rho {rho} n {n}: {:.1} ns  {s:.1e}", t.elapsed().as_nanos() as f64 / 1e5);
    }
}
