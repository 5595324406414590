"""Runs a script like docs/check_result.py on files in one process: SCRIPT FILE...; prints `== FILE STATUS` and what it says of each."""

import contextlib
import importlib.util
import io
import sys

spec = importlib.util.spec_from_file_location("check_result", sys.argv[1])
script = importlib.util.module_from_spec(spec)
spec.loader.exec_module(script)
for file in sys.argv[2:]:
    script.worst.clear()
    script.left.clear()
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        status = script.main(file)
    print(f"== {file} {status}\n{said.getvalue()}", end="")
