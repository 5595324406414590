//! The command as a user runs it, in a folder of its own.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// A block pressed on a floor with friction: one mesh of 16 dofs, solved in a few hundredths of a second.
pub const BLOCK: &str = r#"title = "A block"
[body]
corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
sides = ["floor", "right", "top", "left"]
[material]
young = 200.0
poisson = 0.3
[parameters]
F = 0.3
[sides.floor]
contact = { gap = "0", friction = { tresca = "F" } }
[sides.top]
traction = ["0", "-1"]
[probe]
points = [[1.0, 0.5], [2.0, 0.5]]
[method]
refine = "none"
elements = 8
"#;

/// The script that checks a result file by itself.
pub const CHECK_RESULT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/check_result.py");

/// A new folder with the scene `block.toml`; it goes when this is dropped.
pub struct Place(tempfile::TempDir);

/// What a run of the command gave.
pub struct Ran {
    pub status: i32,
    pub out: String,
    pub err: String,
}

impl Place {
    pub fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write("block.toml", BLOCK);
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// Names of all files here, hidden ones too.
    pub fn names(&self) -> Vec<String> {
        names(self.0.path())
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_steklov"));
        command.current_dir(self.0.path());
        command
    }

    pub fn run<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Ran {
        Ran::new(self.command().args(arguments).output().unwrap())
    }

    /// Runs a script in the private Python environment, which must be there.
    pub fn python(&self, script: &str, arguments: &[&str]) -> Ran {
        let of_workspace = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/python/bin/python");
        let python = std::env::var_os("STEKLOV_PYTHON").map_or_else(of_workspace, PathBuf::from);
        let remedy = "`scripts/python-env` makes the environment";
        let run = Command::new(&python).arg(script).args(arguments).current_dir(self.path("")).output();
        let ran = Ran::new(run.unwrap_or_else(|e| panic!("no Python at {}: {e}; {remedy}", python.display())));
        assert!(!ran.err.contains("ModuleNotFoundError"), "{remedy}\n{}", ran.err);
        ran
    }

    /// Runs `solve --json` with more arguments, demands a status, and gives the object.
    pub fn json(&self, status: i32, arguments: &[&str]) -> Value {
        self.run(["solve", "--json", "--force"].iter().chain(arguments)).demand(status).json()
    }
}

pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

impl Ran {
    pub fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let status = output.status.code().expect("it was killed by a signal");
        Self { status, out: text(output.stdout), err: text(output.stderr) }
    }

    /// The status; never a panic, and nothing on stdout with 1 or 2.
    pub fn demand(self, status: i32) -> Self {
        assert_eq!(self.status, status, "{}\n{}", self.out, self.err);
        assert!(!self.err.contains("panicked"), "{}", self.err);
        if status == 1 || status == 2 {
            assert!(self.out.is_empty() && !self.err.is_empty(), "{}", self.out);
        }
        self
    }

    /// stdout as one JSON object.
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {}", self.out));
        assert!(value.is_object());
        value
    }
}

/// A run in the background that gets signals.
#[cfg(unix)]
pub struct Running(Child);

#[cfg(unix)]
impl Running {
    pub fn start(mut command: Command) -> Self {
        Self(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
    }

    /// Waits until the half-written file is there and larger than so many bytes.
    pub fn wait_for_output(&self, place: &Place, bytes: u64) {
        let start = Instant::now();
        let grown = |name: &String| {
            name.ends_with(".part") && std::fs::metadata(place.path(name)).is_ok_and(|file| file.len() >= bytes)
        };
        while !place.names().iter().any(grown) {
            assert!(start.elapsed() < Duration::from_secs(60), "nothing is written: {:?}", place.names());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Sends INT, TERM or HUP.
    pub fn signal(&self, name: &str) {
        let kill = Command::new("sh").args(["-c", "kill -$1 $0", &self.0.id().to_string(), name]).status().unwrap();
        assert!(kill.success());
    }

    /// Waits until it has ended, however it does.
    pub fn wait(mut self) {
        self.0.wait().unwrap();
    }

    pub fn end(self) -> Ran {
        Ran::new(self.0.wait_with_output().unwrap())
    }
}
