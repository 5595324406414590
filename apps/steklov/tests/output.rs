//! The result file of the command: it appears whole or not at all, harms no other file, and is shown again.

use std::fs;
use std::process::Command;
use std::time::Duration;

use crate::place::{Place, Ran, Running, names};
use serde_json::json;

#[test]
fn an_existing_file_is_refused_unless_forced() {
    let place = Place::new();
    place.write("block.vtkhdf", "old");
    let before = fs::metadata(place.path("block.vtkhdf")).unwrap().modified().unwrap();
    let ran = place.run(["solve", "block.toml"]).demand(1);
    assert!(ran.err.contains("block.vtkhdf exists") && ran.err.contains("--force"), "{}", ran.err);
    assert_eq!(place.read("block.vtkhdf"), b"old");
    assert_eq!(fs::metadata(place.path("block.vtkhdf")).unwrap().modified().unwrap(), before);
    place.run(["solve", "block.toml", "--force"]).demand(0);
    steklov_io::open(place.path("block.vtkhdf")).unwrap();
    place.run(["solve", "block.toml"]).demand(1);
    place.run(["solve", "block.toml", "--out", "other.vtkhdf"]).demand(0);
    assert_eq!(place.names(), ["block.toml", "block.vtkhdf", "other.vtkhdf"]);
}

/// The default name is that of the scene, in the current folder and not in the scene's.
#[test]
fn the_result_is_written_into_the_current_folder() {
    let place = Place::new();
    fs::create_dir(place.path("scenes")).unwrap();
    place.write("scenes/two.words.toml", crate::place::BLOCK);
    let o = place.json(0, &["scenes/two.words.toml"]);
    assert_eq!(o["file"], "two.words.vtkhdf");
    assert_eq!(place.names(), ["block.toml", "scenes", "two.words.vtkhdf"]);
    assert_eq!(names(&place.path("scenes")), ["two.words.toml"]);
}

#[test]
fn outputs_that_cannot_be_written_are_named_before_anything_is_solved() {
    let place = Place::new();
    fs::create_dir(place.path("folder")).unwrap();
    let mut cases = vec![("none/x.vtkhdf", "none"), ("folder", "is a folder"), ("block.toml/x.vtkhdf", "block.toml")];
    if cfg!(target_os = "linux") {
        cases.push(("/proc/x.vtkhdf", "/proc")); // closed to root too
    }
    for (out, part) in cases {
        for force in [&[][..], &["--force"]] {
            let ran = place.run(["solve", "block.toml", "--out", out].iter().chain(force)).demand(1);
            assert!(ran.err.starts_with("error: ") && ran.err.contains(part), "{out}: {}", ran.err);
        }
    }
    assert_eq!(place.names(), ["block.toml", "folder"]);
    // The scene itself is never replaced, whatever its name looks like.
    for out in ["block.toml", "./folder/../block.toml"] {
        let ran = place.run(["solve", "block.toml", "--force", "--out", out]).demand(1);
        assert!(ran.err.contains("is the scene itself"), "{}", ran.err);
    }
    assert_eq!(place.read("block.toml"), crate::place::BLOCK.as_bytes());
}

/// Solves where no file may be larger than so many blocks of 512 bytes, which plays a disk that fills up: the error names the
/// file and what helps, and nothing but it is left.
#[cfg(unix)]
fn on_a_full_disk(place: &Place, blocks: u32, arguments: &[&str]) {
    let before = place.names();
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' XFSZ; ulimit -f $0; exec \"$@\"", &blocks.to_string(), env!("CARGO_BIN_EXE_steklov")]);
    shell.args(["solve", "block.toml"]).args(arguments).current_dir(place.path(""));
    let ran = Ran::new(shell.output().unwrap()).demand(1);
    for part in ["error: cannot write /", "block.vtkhdf: ", "raise the limit of file sizes, or write to another place"]
    {
        assert!(ran.err.contains(part), "{blocks} blocks, {arguments:?}: no {part:?} in {}", ran.err);
    }
    assert!(!ran.err.contains(".part") && ran.err.lines().count() == 1, "{}", ran.err);
    assert_eq!(place.names(), before);
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing() {
    let place = Place::new();
    on_a_full_disk(&place, 40, &[]);
    place.write("block.vtkhdf", "old");
    on_a_full_disk(&place, 40, &["--force"]);
    assert_eq!(place.read("block.vtkhdf"), b"old");
}

/// The disk fills up within a stage, while the run goes on, at the beginning or when most is written; an older file that is gone on
/// from keeps its steps.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_while_stages_are_saved_leaves_the_older_file() {
    let place = Place::new();
    place.write("block.toml", crate::place::BLOCK.replace("refine = \"none\"\n", "tolerance = 1e-4\n"));
    let save = ["--save", "all", "--json", "--quiet"];
    place.run(["solve", "block.toml", "--out", "whole.vtkhdf"].iter().chain(&save)).demand(0);
    let whole = fs::metadata(place.path("whole.vtkhdf")).unwrap().len() as u32 / 512;
    let blocks = [2, whole / 4, whole - 100];
    for blocks in blocks {
        on_a_full_disk(&place, blocks, &save);
    }
    place.run(["solve", "block.toml", "--set", "method.max_steps=2"].iter().chain(&save)).demand(3);
    let old = place.read("block.vtkhdf");
    for blocks in blocks {
        on_a_full_disk(&place, blocks, &[&save[..], &["--resume"]].concat());
        on_a_full_disk(&place, blocks, &[&save[..], &["--force"]].concat());
    }
    // without leave to replace it, nothing is solved
    place.run(["solve", "block.toml"].iter().chain(&save)).demand(1);
    assert!(place.read("block.vtkhdf") == old);
    // its steps are those that a run with room goes on from
    let told = place.run(["solve", "block.toml", "--resume"].iter().chain(&save)).demand(0).json();
    let shown = place.run(["show", "whole.vtkhdf", "--json"]).demand(0).json();
    assert_eq!((&told["energy"], &told["steps"]), (&shown["energy"], &shown["steps"]));
}

/// A run of many steps that has some of them on disk.
#[cfg(unix)]
fn long(place: &Place) -> Running {
    let many = ["--set", "method.refine=\"uniform-h\"", "--set", "method.max_dofs=100000", "--save", "matrices"];
    let mut command = place.command();
    command.args(["solve", "block.toml", "--json", "--quiet"]).args(many);
    let run = Running::start(command);
    run.wait_for_output(place, 1 << 20);
    run
}

#[cfg(unix)]
fn check_interrupted(place: &Place, ran: &Ran) {
    let o = ran.json();
    assert_eq!(
        (&o["reason"], &o["converged"], &o["file"]),
        (&json!("interrupted"), &json!(false), &json!("block.vtkhdf"))
    );
    assert_eq!(ran.err, "", "quiet");
    assert_eq!(place.names(), ["block.toml", "block.vtkhdf"]);
    let shown = place.run(["show", "block.vtkhdf", "--json"]).demand(0).json();
    assert_eq!((&shown["reason"], &shown["dofs"], &shown["energy"]), (&o["reason"], &o["dofs"], &o["energy"]));
    let file = steklov_io::open(place.path("block.vtkhdf")).unwrap();
    let steps = file.group("steps").unwrap().member_names().unwrap();
    assert_eq!(json!(steps.len()), o["steps"]);
    assert!(file.link_exists("matrices/S") && file.link_exists("solution/displacement"));
}

/// Ctrl-C, the polite `kill`, and the end of the terminal.
#[cfg(unix)]
#[test]
fn an_interrupted_run_stores_the_step_that_it_finishes() {
    for signal in ["INT", "TERM", "HUP"] {
        let place = Place::new();
        let run = long(&place);
        run.signal(signal);
        check_interrupted(&place, &run.end().demand(3));
        // what is there can be gone on from, which is said before that it can be replaced
        let again = place.run(["solve", "block.toml"]).demand(1).err;
        let [resume, force] = ["(interrupted): --resume goes on", "--force"].map(|word| again.find(word));
        assert!(resume.is_some() && resume < force, "{again}");
    }
}

/// A killed run cannot clean up behind itself; the next one does.
#[cfg(unix)]
#[test]
fn the_half_written_file_of_a_killed_run_goes_with_the_next() {
    let place = Place::new();
    let run = long(&place);
    run.signal("KILL");
    run.wait();
    assert!(place.names().iter().any(|name| name.ends_with(".part")), "{:?}", place.names());
    place.run(["solve", "block.toml"]).demand(0);
    assert_eq!(place.names(), ["block.toml", "block.vtkhdf"]);
    let again = place.run(["solve", "block.toml"]).demand(1).err;
    assert!(again.contains("exists; choose another --out, or --force") && !again.contains("--resume"), "{again}");
}

/// The second signal does not wait for the step; the steps before it are stored, and nothing half-written stays.
#[cfg(unix)]
#[test]
fn a_run_interrupted_twice_stores_the_steps_before() {
    for signals in [["INT", "INT"], ["TERM", "TERM"], ["INT", "TERM"]] {
        let place = Place::new();
        let run = long(&place);
        run.signal(signals[0]);
        std::thread::sleep(Duration::from_millis(20)); // two equal signals at once are one
        run.signal(signals[1]);
        check_interrupted(&place, &run.end().demand(3));
    }
}

/// A device, played by a pipe, is never replaced by a file, nor read.
#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_never_replaced() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let place = Place::new();
    assert!(Command::new("mkfifo").arg(place.path("pipe")).status().unwrap().success());
    symlink("pipe", place.path("link")).unwrap();
    for out in ["pipe", "link", "./pipe"] {
        for option in ["--force", "--resume", "--quiet"] {
            let ran = place.run(["solve", "block.toml", "--out", out, option]).demand(1);
            assert!(ran.err.contains("pipe") || ran.err.contains("link"), "{}", ran.err);
            assert!(ran.err.contains("no regular file") && ran.err.contains("--out"), "{}", ran.err);
        }
    }
    assert!(fs::symlink_metadata(place.path("pipe")).unwrap().file_type().is_fifo());
    assert!(fs::symlink_metadata(place.path("link")).unwrap().file_type().is_symlink());
    assert_eq!(place.names(), ["block.toml", "link", "pipe"]);
    // a link to a regular file is replaced
    place.write("old.vtkhdf", "old");
    symlink("old.vtkhdf", place.path("new.vtkhdf")).unwrap();
    place.run(["solve", "block.toml", "--out", "new.vtkhdf", "--force"]).demand(0);
    steklov_io::open(place.path("new.vtkhdf")).unwrap();
    assert_eq!(place.read("old.vtkhdf"), b"old");
}

/// Another program makes the output while a run goes on: it stays, and the message says what to do.
#[cfg(unix)]
#[test]
fn an_output_that_appears_meanwhile_is_not_replaced() {
    let place = Place::new();
    let run = long(&place);
    place.write("block.vtkhdf", "of another program");
    run.signal("INT");
    let ran = run.end().demand(1);
    assert!(ran.err.contains("block.vtkhdf exists now") && ran.err.contains("--force"), "{}", ran.err);
    assert_eq!(place.read("block.vtkhdf"), b"of another program");
    assert_eq!(place.names(), ["block.toml", "block.vtkhdf"]);
}

/// What `show` says of a file is what `solve` said, but for the file's name and the seconds that writing it took.
#[test]
fn show_tells_what_solve_told() {
    let place = Place::new();
    let solved = place.run(["solve", "block.toml", "--json"]).demand(0).out;
    fs::rename(place.path("block.vtkhdf"), place.path("renamed.vtkhdf")).unwrap();
    let shown = place.run(["show", "renamed.vtkhdf", "--json"]).demand(0).out;
    assert!(shown.contains("\"file\": \"renamed.vtkhdf\""));
    assert_eq!(solved.lines().count(), shown.lines().count());
    for (told, stored) in solved.lines().zip(shown.lines()).filter(|(told, stored)| told != stored) {
        let key = told.split(':').next().unwrap().trim();
        assert!(["\"file\"", "\"total\"", "\"write\""].contains(&key), "{told} and {stored}");
    }
    let text = place.run(["show", "renamed.vtkhdf", "--plan"]).demand(0).out;
    for part in
        ["A block", "boundary elements", "floor with Tresca friction F", "16 dofs, 1 step: solved", "renamed.vtkhdf"]
    {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
}

/// First what was solved, then forces, contact and stresses, then the energy; zeros and small numbers as people write them.
#[test]
fn the_summary_has_the_order_in_which_readers_ask() {
    let place = Place::new();
    let summary = place.run(["solve", "block.toml"]).demand(0).out;
    let mut heads: Vec<&str> = summary.lines().skip(2).filter_map(|line| line.split("  ").next()).collect();
    heads.retain(|head| !head.is_empty());
    heads.dedup();
    let wanted = ["doubt", "reaction", "contact", "stress", "probe", "energy J", "error", "audit", "seconds", "result"];
    assert_eq!(heads, wanted, "{summary}");
    assert!(!summary.contains("e0") && !summary.contains("0e"), "{summary}");
    let o = place.run(["show", "block.vtkhdf", "--json"]).demand(0).json();
    let force: f64 = summary
        .split("force on the body (")
        .nth(1)
        .and_then(|s| s.split([',', ')']).nth(1)?.split_whitespace().next())
        .unwrap()
        .parse()
        .unwrap();
    let exact = o["contact"]["force"][1].as_f64().unwrap();
    assert!((force - exact).abs() <= 5e-7 * exact.abs(), "{force} for {exact}");
}

/// The cells of a row of a table of Markdown.
fn cells(line: &str) -> Vec<&str> {
    line.trim_matches('|').split(" | ").map(str::trim).collect()
}

/// The same numbers as in the JSON object, each with its unit; LaTeX has their rows and letters that it takes.
#[test]
fn tables_for_documents_have_the_numbers_of_the_result() {
    let place = Place::new();
    let block = String::from_utf8(place.read("block.toml")).unwrap();
    place.write("block.toml", block + "\n[units]\nlength = \"mm\"\nstress = \"MPa\"\n");
    let o = place.json(0, &["block.toml"]);
    let markdown = place.run(["show", "block.vtkhdf", "--format", "markdown"]).demand(0).out;
    let rows: Vec<Vec<&str>> = markdown.lines().map(cells).collect();
    assert!(rows.iter().all(|row| row.len() == 4), "{markdown}");
    let row =
        |name: &str| rows.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("no {name:?} in\n{markdown}"));
    for (name, value, unit) in [
        ("strain energy", &o["strain_energy"], "MPa mm²"),
        ("contact: length", &o["contact"]["length"], "mm"),
        ("contact: largest pressure", &o["contact"]["max_pressure"], "MPa"),
        ("estimated error, energy norm", &o["estimate"], "(MPa mm²)^½"),
    ] {
        let (told, exact) = (row(name)[1].parse::<f64>().unwrap(), value.as_f64().unwrap());
        assert!((told - exact).abs() <= 5e-4 * exact.abs(), "{name}: {told} for {exact}");
        assert_eq!(row(name)[2], unit, "{name}");
    }
    let at = rows.iter().find(|row| row[0].starts_with("displacement at (")).unwrap();
    assert_eq!(at[2], "mm");
    let latex = place.run(["show", "block.vtkhdf", "--format", "latex"]).demand(0).out;
    assert!(latex.is_ascii(), "{latex}");
    assert_eq!(latex.lines().filter(|line| line.ends_with(r"\\")).count(), rows.len() - 2, "{latex}");
    assert!(latex.lines().filter(|line| line.contains(" & ")).all(|line| line.matches(" & ").count() == 3), "{latex}");
    let solved = place.run(["solve", "block.toml", "--force", "--format", "markdown"]).demand(0).out;
    assert_eq!(solved.lines().count(), rows.len());
    // a run that is not to be trusted says so in the table, and what to do about it on stderr
    let far = ["--force", "--set", "sides.floor.contact.gap=1e9"];
    let ran = place.run(["solve", "block.toml", "--format", "markdown"].iter().chain(&far)).demand(3);
    assert!(ran.out.contains("| run | NOT CONVERGED: solver |"), "{}", ran.out);
    assert!(ran.err.contains("nearer to each other"), "{}", ran.err);
    assert!(
        place
            .run(["show", "block.vtkhdf", "--json", "--format", "latex"])
            .demand(2)
            .err
            .contains("cannot be used with")
    );
}

#[test]
fn pictures_and_tables_are_written() {
    let place = Place::new();
    let solved = place.run(["solve", "block.toml", "--plots", "drawn"]).demand(0);
    let wanted = ["block-body.png", "block-body.svg", "block-contact-floor.png", "block-contact-floor.svg"];
    assert_eq!(names(&place.path("drawn")), wanted);
    assert!(wanted.iter().all(|name| solved.out.contains(name)), "{}", solved.out);
    let shown = place.run(["show", "block.vtkhdf", "--plots", "new/shown", "--csv", "tables"]).demand(0);
    assert_eq!(names(&place.path("new/shown")), wanted);
    for name in wanted {
        assert!(place.read(&format!("drawn/{name}")) == place.read(&format!("new/shown/{name}")), "{name} differs");
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("drawn/{name}")).starts_with(start), "{name}");
    }
    let tables = ["block-contact.csv", "block-displacement.csv", "block-traction.csv"];
    assert_eq!(names(&place.path("tables")), tables);
    assert!(tables.iter().all(|name| shown.out.contains(name)), "{}", shown.out);
    // The table holds the contact force: Σ pressure weight = 2.
    let table = String::from_utf8(place.read("tables/block-contact.csv")).unwrap();
    let (head, rows) = table.split_once('\n').unwrap();
    assert_eq!(head, "side,x,y,gap,u_n,u_t,pressure,shear,bound,weight,status");
    let force: f64 = rows
        .lines()
        .map(|row| row.split(',').skip(1).map(|v| v.parse::<f64>().unwrap()).collect::<Vec<_>>())
        .map(|row| row[5] * row[8])
        .sum();
    assert!((force - 2.0).abs() < 1e-12, "{force}");
    // A file is no folder.
    for option in ["--plots", "--csv"] {
        let ran = place.run(["show", "block.vtkhdf", "--json", option, "block.toml"]);
        assert_eq!((ran.status, ran.out.as_str()), (1, ""), "{option}: {}", ran.err);
        assert!(ran.err.contains("block.toml"), "{}", ran.err);
    }
}

/// A side's name is free text; in file names and HDF5 paths it must not lead elsewhere.
#[test]
fn names_of_sides_are_no_paths() {
    let place = Place::new();
    let text =
        crate::place::BLOCK.replace("\"floor\"", "\"../a/b c\"").replace("[sides.floor]", "[sides.\"../a/b c\"]");
    let text = text.replace("\"left\"", "\".\"").replace("\"right\"", "\".._a_b c\"");
    place.write(
        "odd.toml",
        text + "[sides.\".\"]\ndisplacement = [0, \"free\"]\n[sides.\".._a_b c\"]\ncontact = { gap = \"1 + s\" }\n",
    );
    let o = place.json(0, &["odd.toml", "--plots", "drawn"]);
    let mut sides: Vec<&String> = o["reactions"].as_object().unwrap().keys().collect();
    sides.sort();
    assert_eq!(sides, [".", "../a/b c", ".._a_b c"]);
    assert_eq!(place.names(), ["block.toml", "drawn", "odd.toml", "odd.vtkhdf"]);
    assert_eq!(names(&place.path("drawn")).len(), 6);
    let shown = place.run(["show", "odd.vtkhdf", "--json"]).demand(0).json();
    assert_eq!(shown["reactions"], o["reactions"]);
}

#[test]
fn files_that_are_no_results_are_refused() {
    let place = Place::new();
    place.run(["solve", "block.toml"]).demand(0);
    let whole = place.read("block.vtkhdf");
    place.write("empty.vtkhdf", "");
    place.write("text.vtkhdf", "no HDF5 at all");
    for (name, end) in [("cut1.vtkhdf", whole.len() / 2), ("cut2.vtkhdf", whole.len() - 1), ("cut3.vtkhdf", 100)] {
        place.write(name, &whole[..end]);
    }
    for name in
        ["none.vtkhdf", ".", "empty.vtkhdf", "text.vtkhdf", "block.toml", "cut1.vtkhdf", "cut2.vtkhdf", "cut3.vtkhdf"]
    {
        for json in [&[][..], &["--json"]] {
            let ran = place.run(["show", name].iter().chain(json)).demand(1);
            assert!(ran.err.starts_with("error: ") && ran.err.contains(name), "{name}: {}", ran.err);
        }
    }
    // A file of another program, and one that has our mark but no result.
    steklov_io::File::create(place.path("foreign.vtkhdf")).unwrap();
    steklov_io::create_atomically(place.path("bare.vtkhdf"), false, |_| Ok::<(), steklov_io::IoError>(())).unwrap();
    for (name, part) in [("foreign.vtkhdf", "no result of steklov"), ("bare.vtkhdf", "has no /summary")] {
        let ran = place.run(["show", name]).demand(1);
        assert!(ran.err.contains(name) && ran.err.contains(part), "{}", ran.err);
    }
}

/// One byte altered anywhere: either it is noticed, or what is shown is the same to the last digit.
#[test]
fn altered_bytes_are_noticed_or_do_no_harm() {
    let place = Place::new();
    place.run(["solve", "block.toml"]).demand(0);
    let whole = place.read("block.vtkhdf");
    let truth = place.run(["show", "block.vtkhdf", "--json"]).demand(0).out;
    let (mut noticed, count) = (0, 60);
    for k in 0..count {
        let mut bytes = whole.clone();
        let at = (k * 7919 + 13) * whole.len() / (count * 7919 + 26);
        bytes[at] ^= 0x55;
        place.write("block.vtkhdf", &bytes);
        let ran = place.run(["show", "block.vtkhdf", "--json"]);
        match ran.status {
            0 => assert_eq!(ran.out, truth, "byte {at}"),
            _ => {
                noticed += 1;
                assert!(ran.demand(1).err.contains("block.vtkhdf"), "byte {at}");
            }
        }
    }
    assert!(noticed > 0, "no altered byte was noticed");
}
