"""The types that the package declares are those that it has."""

import pathlib
import subprocess
import sys

import pytest

import steklov

pytest.importorskip("mypy")
PROGRAM = """
import numpy
import steklov
from steklov import blocks

result = steklov.solve({"title": "block"}, progress=lambda text, share: print(text, share), parameters__w=3.0)
energy: float = result.quantities["energy"]
state = result.at(numpy.zeros((3, 2)))
bound = result.energy
if bound is not None:
    value, uncertainty = bound
swept = steklov.sweep("block.toml", {"parameters.w": [1, 2]}, progress=True)
table = swept.frame()
wrong: int = result.summary
steklov.solve(3.0)
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    """Settings by which the second test reads the types of NumPy that the first one has read."""
    folder = tmp_path_factory.mktemp("mypy")
    path = folder / "mypy.ini"
    path.write_text(f"[mypy]\nincremental = True\ncache_dir = {folder / 'cache'}\n", encoding="utf-8")
    return str(path)


def run(*arguments):
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True)


def test_the_stubs_are_those_of_the_extension(config):
    ran = run("mypy.stubtest", "--mypy-config-file", config, "steklov._steklov")
    assert ran.returncode == 0, ran.stdout


def test_a_program_is_checked_by_the_types_of_the_package(config, tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM, encoding="utf-8")
    ran = run("mypy", "--config-file", config, str(program))
    told = [line for line in ran.stdout.splitlines() if "error" in line and "program.py" in line]
    assert [line.split(":")[1] for line in told] == ["14", "15"], ran.stdout
    assert (pathlib.Path(steklov.__file__).parent / "py.typed").exists()
