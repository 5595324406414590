"""Studies of the package: the tables are those of the command."""

import json
import os
import pathlib
import signal
import subprocess
import threading

import pytest

import steklov
ROOT = pathlib.Path(os.environ["ROOT"])
SCENE = ROOT / "scenes" / "19-l-shape.toml"


def without_seconds(frame):
    return frame[[column for column in frame.columns if "seconds" not in column and "memory" not in column]]


def test_a_study_has_the_tables_of_the_command(tmp_path):
    shares = []
    found = steklov.study(SCENE, strategies=["h", "hp"], folder=tmp_path / "own", progress=lambda text, share: shares.append(share), method__max_dofs=100)
    arguments = [os.environ["STEKLOV"], "study", SCENE, "--strategies", "h,hp", "--set", "method.max_dofs=100", "--out", tmp_path / "other", "--json", "--quiet", "--repeat", "1"]
    ran = subprocess.run(arguments, cwd=tmp_path, capture_output=True, text=True, check=True)
    names = sorted(file.name for file in (tmp_path / "other").iterdir())
    assert sorted(file.name for file in (tmp_path / "own").iterdir()) == names == sorted(map(os.path.basename, found.files))
    for name in found.tables:
        other = steklov.Study(found.summary, "", {name: (tmp_path / "other" / name).read_text()}, [])
        assert without_seconds(found.frame(name)).equals(without_seconds(other.frame())), name
    own, other = found.summary, json.loads(ran.stdout)
    assert own["title"] == other["title"] and own["complete"] and own["settings"] == other["settings"]
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] <= 1
    assert "L-shape" in str(found) or own["title"] in str(found)
    # the rate of hp on a re-entrant corner is beyond that of h
    frame = found.frame("study.csv")
    assert {"h", "hp"} <= set(frame["strategy"])
    with pytest.raises(KeyError, match="is no table of this study"):
        found.frame("stud.csv")


def test_wrong_studies_are_refused(tmp_path):
    for keywords, told in [
        ({"what": "convergences"}, "no study; known are convergence, inf-sup"),
        ({"strategies": ["q"]}, "no strategy; known are"),
        ({"multipliers": ["biorthogonal"]}, "no side of the scene is in contact: leave it out"),
        ({"what": "stability", "strategies": ["h"]}, "strategies belongs to the study"),
        ({"repeat": 0}, "repeat is 0"),
    ]:
        with pytest.raises(ValueError, match=told):
            steklov.study(SCENE, **keywords)
    with pytest.raises(ValueError, match="take the study \"multiscale\""):
        steklov.study(ROOT / "scenes" / "34-laminate.toml")
    with pytest.raises(steklov.SceneError, match="inf-sup|contact"):
        steklov.study(SCENE, "inf-sup")
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="nothing can be written"):
        steklov.study(SCENE, strategies=["h"], folder=tmp_path / "file", method__max_dofs=60)


def test_a_study_is_stopped_by_ctrl_c():
    def stop(text, share):
        if threading.current_thread() is threading.main_thread() and share > 0:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        steklov.study(SCENE, progress=stop, method__max_dofs=400)
