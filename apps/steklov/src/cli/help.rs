//! What `--help` tells besides the options: examples, which run as they stand, and exit statuses.

pub(super) const STEKLOV: &str = "\
A first scene:
  steklov new > block.toml
  steklov solve block.toml --plots pictures
  steklov show block.vtkhdf

Exit status: 0 solved, or done; 1 the scene or a file is wrong, or the problem has no solution;
2 the arguments are wrong; 3 solved and stored, but the tolerance, the solver's criterion or an
entry of [expect] is not met, or the run was interrupted. Messages go to stderr, results to stdout.
steklov help COMMAND has examples of each command.";

pub(super) const SWEEP: &str = "\
Examples:
  steklov new > block.toml
  steklov sweep block.toml --vary parameters.load=1:3:5 --plots pictures
  steklov sweep block.toml --vary parameters.load=1:3:5 --vary material.poisson=0.2,0.3 --out both.h5
  steklov sweep block.toml --vary parameters.load=1:3:5 --part 1/2 --out first.h5
  steklov sweep block.toml --vary parameters.load=1:3:5 --part 2/2 --out second.h5
  steklov merge first.h5 second.h5 --out whole.h5

Each point is what `steklov solve` gives with --set KEY=VALUE, to the same bits. A sweep that is stopped, killed
or out of disk keeps its finished points: --resume goes on.

Exit status: 0 all points are solved; 1 the scene or a file is wrong; 2 the arguments are wrong;
3 a point failed or did not reach its aim, or the sweep was interrupted: the table says which.";

pub(super) const COMPARE: &str = "\
Examples:
  steklov new > block.toml
  steklov solve block.toml --out coarse.vtkhdf
  steklov solve block.toml --out fine.vtkhdf --set method.tolerance=1e-5
  steklov compare coarse.vtkhdf fine.vtkhdf --plots both

Exit status: 0 compared; 1 a file is wrong; 2 the arguments are wrong.";

pub(super) const MERGE: &str = "\
Examples:
  steklov new > block.toml
  steklov sweep block.toml --vary parameters.load=1:3:5 --part 1/2 --out first.h5
  steklov sweep block.toml --vary parameters.load=1:3:5 --part 2/2 --out second.h5
  steklov merge first.h5 second.h5 --out whole.h5

The whole has the same bits as one sweep over all points.

Exit status: 0 joined, all points are solved; 1 a file is wrong, or of another sweep; 2 the arguments
are wrong; 3 joined, but a point failed, did not reach its aim, or is missing.";

pub(super) const SOLVE: &str = "\
Examples:
  steklov new > block.toml
  steklov solve block.toml
  steklov solve block.toml --out fine.vtkhdf --set method.tolerance=1e-5 --set parameters.load=2
  steklov solve block.toml --force --quiet --json > block.json
  steklov solve block.toml --force --plots pictures --field xx --window=-0.5:0,-0.5:0
  steklov solve block.toml --out fine.vtkhdf --resume --set method.tolerance=1e-6 --set parameters.load=2

Exit status: 0 solved, the tolerance is reached; 1 the scene or a file is wrong, or the problem has
no solution; 2 the arguments are wrong; 3 solved and stored, but the tolerance, the solver's
criterion or an entry of [expect] is not met, or the run was interrupted.";

pub(super) const PLAN: &str = "\
Examples:
  steklov scenes two-cylinders > cylinders.toml
  steklov plan cylinders.toml
  steklov plan cylinders.toml --set method.tolerance=1e-6 --json > plan.json

Exit status: 0 the scene can be solved; 1 the scene is wrong; 2 the arguments are wrong.";

pub(super) const STUDY: &str = "\
Examples:
  steklov scenes l-shape > l.toml
  steklov study l.toml --strategies uniform-h,hp --repeat 1 --out l-study
  steklov scenes wedge-gap > wedge.toml
  steklov study wedge.toml --what inf-sup --out wedge-inf-sup
  steklov report l-study/study.h5 --out l-page

Exit status: 0 studied and stored; 1 the scene or a file is wrong, or nothing can be studied;
2 the arguments are wrong; 3 interrupted.";

pub(super) const GALLERY: &str = "\
Examples:
  steklov gallery --out figures --only fig-2-3
  steklov gallery --out gallery

Exit status: 0 all numbers hold; 1 a name or a folder is wrong; 2 the arguments are wrong;
3 a number is off or missing, or the run was interrupted.";

pub(super) const SHOW: &str = "\
Examples:
  steklov new > block.toml
  steklov solve block.toml
  steklov show block.vtkhdf
  steklov show block.vtkhdf --plots pictures --field principal-1 --range=-5:5
  steklov show block.vtkhdf --csv tables
  steklov show block.vtkhdf --format latex > block.tex
  steklov show block.vtkhdf --json > block.json

Exit status: 0 shown; 1 the file is no result, or cannot be read; 2 the arguments are wrong.";

pub(super) const REPORT: &str = "\
Examples:
  steklov new > block.toml
  steklov solve block.toml
  steklov report block.vtkhdf --out page

Exit status: 0 the page is written; 1 the file is no result, or the folder is not empty;
2 the arguments are wrong.";

pub(super) const NEW: &str = "\
Examples:
  steklov new > block.toml
  steklov new --kind crack > crack.toml";

pub(super) const SCENES: &str = "\
Examples:
  steklov scenes
  steklov scenes hertz > hertz.toml
  steklov solve hertz.toml

Exit status: 0; 1 there is no scene of this name.";

pub(super) const SCHEMA: &str = "\
Examples:
  steklov schema > steklov.schema.json

Editors with Taplo (Even Better TOML in VS Code) read it where the first line of a scene is
  #:schema ./steklov.schema.json";

pub(super) const COMPLETIONS: &str = "\
Examples:
  steklov completions bash > steklov.bash
  steklov completions zsh > _steklov
  steklov completions fish > steklov.fish

bash reads such a file from ~/.local/share/bash-completion/completions, fish from
~/.config/fish/completions, zsh from a folder of its fpath.";

pub(super) const MAN: &str = "\
Examples:
  steklov man > steklov.1
  steklov man solve > steklov-solve.1";
