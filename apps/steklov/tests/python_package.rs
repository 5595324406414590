//! The Python package beside the command, by the tests in `python/tests`.

use std::path::Path;
use std::process::Command;

use crate::place::{Place, Ran};

#[test]
fn the_python_package_gives_what_the_command_gives() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let place = Place::new();
    // the package as pip would install it: its modules, and the extension that cargo has built beside this program
    let package = place.path("steklov");
    std::fs::create_dir(&package).unwrap();
    for entry in std::fs::read_dir(root.join("python/steklov")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ["py", "pyi", "typed"].iter().any(|own| ending == *own)) {
            std::fs::copy(&path, package.join(path.file_name().unwrap())).unwrap();
        }
    }
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    std::fs::copy(folder.join("lib_steklov.so"), package.join("_steklov.abi3.so")).unwrap();
    let python = std::env::var_os("STEKLOV_PYTHON").unwrap_or_else(|| root.join("target/python/bin/python").into());
    let tests = root.join("python/tests");
    let modules = ["steklov/__init__.py", "steklov/blocks.py", "steklov/profiles.py"];
    let arguments = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--doctest-modules"];
    let ran = Command::new(python)
        .args(arguments)
        .args(modules)
        .arg(tests)
        .current_dir(place.path(""))
        .env("PYTHONPATH", place.path(""))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("STEKLOV", env!("CARGO_BIN_EXE_steklov"))
        .env("ROOT", &root)
        .output();
    print!("{}", Ran::new(ran.unwrap()).demand(0).out);
}
