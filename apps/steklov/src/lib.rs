//! The command `steklov` as a library: from a scene file to a result file and its pictures.
//!
//! ```text
//! Scene ─► plan ─► run ─► solve (mesh by mesh) ─► Record ─► store (HDF5), summary (JSON), pictures
//!                                                   ▲
//!                                    show ─► read ──┘
//! Scene ─► Reference, then run by run (strategy by strategy) ─► Study ─► HDF5, CSV, JSON, charts and meshes
//! ```
//!
//! ```
//! use clap::Parser;
//!
//! let folder = std::env::temp_dir().join(format!("steklov-{}", std::process::id()));
//! std::fs::create_dir_all(&folder)?;
//! let (scene, result) = (folder.join("block.toml"), folder.join("block.vtkhdf"));
//! std::fs::write(&scene, r#"
//! body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = ["floor", "right", "top", "left"] }
//! material = { young = 200, poisson = 0.3 }
//! sides.floor.contact = { gap = "0" }
//! sides.top.pressure = 3
//! "#)?;
//! let arguments = ["steklov", "solve", "--quiet", &scene.to_string_lossy(), "--out", &result.to_string_lossy()];
//! assert_eq!(steklov::cli::Cli::try_parse_from(arguments)?.run(), 0);
//!
//! // pressed alike everywhere: J = -p² (1-ν²) A / 2E
//! let energy = steklov_result::store::read(&steklov_io::open(&result)?)?.summary.energy;
//! let exact = -0.5 * 9.0 * (1.0 - 0.3 * 0.3) * 2.0 / 200.0;
//! assert!((energy / exact - 1.0).abs() < 1e-10);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cli;
