"""The scene as a model of UM-Bridge, by the protocol's own client; ROOT is the root of the repository."""

import concurrent.futures
import http.client
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.parse

import pytest

import steklov

umbridge = pytest.importorskip("umbridge")

SCENE = pathlib.Path(os.environ["ROOT"]) / "scenes" / "block-on-floor.toml"
INPUTS = ["--vary", "parameters.F,material.young", "--vary", "method.elements=16"]
OUTPUTS = ["--quantity", "energy", "--quantity", "contact.force.y", "--quantity", "contact.length"]
PATHS = OUTPUTS[1::2]
LONG = {"method.tolerance": 1e-9, "method.refine": "uniform-h", "method.max_dofs": 100000}


class Server:
    """A server of its own, at a free port unless `port` is one."""

    def __init__(self, *arguments, port="0"):
        command = [sys.executable, "-m", "steklov.umbridge", *map(str, arguments)]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen(command, env={**os.environ, "PORT": port}, **pipes)
        self.told, self.url = [], None
        for line in self.process.stdout:
            self.told.append(line)
            if found := re.match(r"listening at (\S+)", line):
                self.url = found[1]
                break

    def __enter__(self):
        assert self.url, self.process.communicate()[1]
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    @property
    def model(self):
        return umbridge.HTTPModel(self.url, "forward")

    def request(self, method, path, body=None, headers=None):
        """Status and object of an answer."""
        connection = http.client.HTTPConnection(urllib.parse.urlsplit(self.url).netloc, timeout=30)
        connection.request(method, path, body if body is None or isinstance(body, bytes) else json.dumps(body), headers or {})
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        assert answer.getheader("Content-Length") == str(len(text)) and answer.version == 11
        return answer.status, json.loads(text)

    def end(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        return self.process.wait(10), self.process.stderr.read()


def refused(*arguments, port="0"):
    """What a server that does not start tells."""
    server = Server(*arguments, port=port)
    error = server.process.communicate(timeout=10)[1]
    assert server.url is None and server.process.returncode == 1 and "Traceback" not in error, error
    return error


@pytest.fixture(scope="module")
def server():
    with Server(SCENE, *INPUTS, *OUTPUTS, "--jobs", "2") as made:
        yield made


def test_what_the_model_is(server):
    assert umbridge.supported_models(server.url) == ["forward"]
    model = server.model
    assert model.get_input_sizes() == [3] and model.get_output_sizes() == [3]
    assert model.supports_evaluate()
    assert not (model.supports_gradient() or model.supports_apply_jacobian() or model.supports_apply_hessian())
    assert server.request("GET", "/Info") == (200, {"protocolVersion": 1.0, "models": ["forward"]})
    support = {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}
    assert server.request("POST", "/ModelInfo", {"name": "forward"}) == (200, {"support": support})
    told = "".join(server.told)
    assert "input: parameters.F = 0.3, material.young = 200.0, method.elements = 16\n" in told and "output: energy = -2.99" in told


def test_evaluations_have_the_bits_of_solve(server):
    for F, young, elements in [(0.1 + 0.2, 137.5, 16), (1, 1000 / 3, 24.0)]:
        result = steklov.solve(SCENE, parameters__F=F, material__young=young, method__elements=int(elements))
        assert server.model([[F, young, elements]]) == [[result.quantities[path] for path in PATHS]]


def test_several_at_once_have_these_bits_too(server):
    points, config = [[F, 200.0, 16.0] for F in (0.3, 0.4, 0.5)], {"method.tolerance": 3e-3}
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        found = list(pool.map(lambda point: server.model([point], config), points))
    assert found == [[[steklov.solve(SCENE, parameters__F=F, **config).quantities[path] for path in PATHS]] for F, _, _ in points]


def test_config_changes_other_keys(server):
    config = {"method.tolerance": 1e-3, "material.poisson": 0.25}
    result = steklov.solve(SCENE, **config)
    found = server.model([[0.3, 200.0, 16.0]], config)
    assert found == [[result.quantities[path] for path in PATHS]] != server.model([[0.3, 200.0, 16.0]], {})
    # clients in R send an empty list
    assert server.request("POST", "/Evaluate", {"name": "forward", "input": [[0.3, 200, 16]], "config": []})[0] == 200


@pytest.mark.parametrize(
    "point, config, kind, told",
    [
        ([0.3, 200.0, 16.0], {"method.tolerances": 1e-3}, "InvalidInput", "unknown key method.tolerances\nhelp: did you mean tolerance"),
        ([0.3, 200.0, 16.0], {"material.poisson": 0.7}, "InvalidInput", "Poisson's ratio is 0.7; it must lie in (-1, 1/2)\nhelp: "),
        ([0.3, 200.0, 16.0], {"method.tolerance": None}, "InvalidInput", "config: method.tolerance is None"),
        ([0.3, 200.0, 16.0], {"material.young": 1.0}, "InvalidInput", "material.young is an input"),
        ([0.3, 200.0, 16.0], {"material": {"young": 1.0, "poisson": 0.3}}, "InvalidInput", "material.young is an input"),
        ([0.3, 200.0, 16.0], {"material.poisson=0.1 #": 1}, "InvalidInput", "write a key of the scene"),
        ([0.3, 200.0, 16.0], ["tolerance"], "InvalidInput", "config is no object"),
        ([-0.3, 200.0, 16.0], {}, "InvalidInput", "the friction bound of side \"floor\" is -0.3"),
        ([0.3, 200.0, 16.5], {}, "InvalidInput", "method.elements takes a whole number"),
        ([0.3, 200.0], {}, "InvalidInput", "input[0] has 2 numbers and not 3: write one list of 3 number(s) in a list: parameters.F, "),
        ([0.3, "200", 16.0], {}, "InvalidInput", "input[0][1], the value of material.young, is no number: \"200\""),
        ([0.3, True, 16.0], {}, "InvalidInput", "input[0][1], the value of material.young, is no number: true"),
        ([0.3, 200.0, 16.0], {"method.max_steps": 2}, "ModelError", "not converged: the run ended by max_steps\nhelp: "),
        ([0.3, 200.0, 16.0], {"method.tolerance": 0.1}, "ModelError", "in doubt: sets\nhelp: "),
        ([0.3, 200.0, 16.0], {"sides.floor": {"displacement": ["0", "0"]}}, "InvalidInput", "no expression uses F"),
    ],
)
def test_what_is_wrong_is_an_error_of_the_protocol(server, point, config, kind, told):
    with pytest.raises(Exception, match=re.escape(f"Model returned error of type {kind}: ")) as caught:
        server.model([point], config)
    assert told in str(caught.value)


def test_a_quantity_that_a_result_does_not_have_is_an_error(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.read_text(encoding="utf-8").partition("[expect]")[0], encoding="utf-8")
    with Server(scene, "--vary", "material.poisson", "--quantity", "probe.0.displacement.x", "--allow-doubts") as server:
        with pytest.raises(Exception, match="ModelError: 'probe.0.displacement.x' is no number of this result"):
            server.model([[0.3]], {"probe.points": []})
        # a doubt is no error here, and Ctrl-C ends as SIGTERM does
        doubtful = steklov.solve(scene, method__tolerance=0.1)
        assert doubtful.doubts and server.model([[0.3]], {"method.tolerance": 0.1}) == [[doubtful.quantities["probe.0.displacement.x"]]]
        assert server.end(signal.SIGINT) == (0, "")


def test_malformed_requests_are_told_and_the_server_goes_on(server):
    evaluate = {"name": "forward", "input": [[0.3, 200.0, 16.0]]}
    cases = [
        ("POST", "/Evaluate", b'{"name": "forward", "input": [[NaN, 200, 16]]}', 400, "InvalidInput", "parameters.F, is not finite"),
        ("POST", "/Evaluate", b'{"name": "forward", "input": [[0.3, 1e999, 16]]}', 400, "InvalidInput", "material.young, is not finite"),
        ("POST", "/Evaluate", b'{"name": "forward", "input": [[0.3, 1' + b"0" * 400 + b", 16]]}", 400, "InvalidInput", "not finite"),
        ("POST", "/Evaluate", {"name": "forward", "input": [0.3]}, 400, "InvalidInput", "input is no list of lists"),
        ("POST", "/Evaluate", {"name": "forward", "input": [[0.3], [200.0]]}, 400, "InvalidInput", "input has 2 vectors and not 1"),
        ("POST", "/Evaluate", {"name": "forward"}, 400, "InvalidInput", "input is no list of lists"),
        ("POST", "/Evaluate", dict(evaluate, name="backward"), 400, "ModelNotFound", "the model is 'forward'"),
        ("POST", "/Evaluate", [], 400, "InvalidInput", "the request names no model"),
        ("POST", "/Evaluate", b'{"name": ', 400, "InvalidInput", "no JSON"),
        ("POST", "/Evaluate", b"[" * 100000, 400, "InvalidInput", "no JSON"),
        ("POST", "/Evaluate", b"\xff", 400, "InvalidInput", "no JSON"),
        ("POST", "/Evaluate", b" " * (3 << 20), 400, "InvalidRequest", "larger than 1048576 bytes"),
        ("POST", "/Gradient", {"name": "forward"}, 400, "UnsupportedFeature", "Gradient"),
        ("POST", "/ApplyJacobian", {"name": "forward"}, 400, "UnsupportedFeature", "ApplyJacobian"),
        ("POST", "/ApplyHessian", {"name": "forward"}, 400, "UnsupportedFeature", "ApplyHessian"),
        ("POST", "/TestShMem", {"name": "forward"}, 404, "InvalidRequest", "there is no /TestShMem"),
        ("GET", "/Evaluate", None, 405, "InvalidRequest", "takes POST"),
        ("PUT", "/Evaluate", evaluate, 501, "InvalidRequest", "PUT"),
    ]
    for method, path, body, status, kind, told in cases:
        found, answer = server.request(method, path, body)
        assert found == status and list(answer) == ["error"] and sorted(answer["error"]) == ["message", "type"], (path, body)
        assert answer["error"]["type"] == kind and told in answer["error"]["message"], answer
    assert server.request("POST", "/Evaluate", evaluate)[0] == 200


def test_a_connection_serves_several_requests(server):
    connection = http.client.HTTPConnection(urllib.parse.urlsplit(server.url).netloc, timeout=30)
    for body in [{"name": "forward"}, {"name": "backward"}, {"name": "forward"}]:
        connection.request("POST", "/InputSizes", json.dumps(body))
        socket_of = connection.sock
        answer = json.loads(connection.getresponse().read())
        assert connection.sock is socket_of is not None and answer.get("inputSizes", [3]) == [3]
    connection.close()


def test_others_are_answered_while_one_runs_and_a_signal_ends_it():
    with concurrent.futures.ThreadPoolExecutor(1) as pool, Server(SCENE, "--jobs", "2") as server:
        running = pool.submit(server.model, [[0.3]], LONG)
        time.sleep(0.3)
        began = time.monotonic()
        assert server.request("GET", "/Info")[0] == 200 and time.monotonic() - began < 2
        assert server.model([[0.3]]) == [[steklov.solve(SCENE).quantities["energy"]]]
        assert not running.done()
        assert server.end() == (0, "")
        assert running.exception(10) is not None


def test_what_is_wrong_at_the_start_is_told():
    assert "unknown key material.yuong\nhelp: did you mean young" in refused(SCENE, "--vary", "material.yuong")
    assert "write --vary method.max_dofs=VALUE" in refused(SCENE, "--vary", "method.max_dofs")
    assert "'enrgy' is no number of this result: did you mean 'energy'?" in refused(SCENE, "--quantity", "enrgy")
    assert refused("nowhere.toml") == "error: cannot read the scene nowhere.toml: No such file or directory\n"


def test_a_port_in_use_is_told_in_a_line():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        told = f"error: cannot listen at 127.0.0.1:{port}: Address already in use; choose another port by --port or $PORT\n"
        assert refused(SCENE, port=port) == told == refused(SCENE, "--port", port)


def test_a_start_that_is_in_doubt_is_warned_of(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.read_text(encoding="utf-8").replace("tolerance = 1e-4", "tolerance = 0.1"), encoding="utf-8")
    with Server(scene) as server:
        with pytest.raises(Exception, match="ModelError: the result is in doubt: sets"):
            server.model([[0.3]])
        scene.unlink()  # the scene is that of the start
        assert server.model([[0.3]], {"method.tolerance": 1e-4}) == [[steklov.solve(SCENE).quantities["energy"]]]
        status, told = server.end()
        assert status == 0 and told.startswith("warning: with these values evaluations are refused: the result is in doubt: sets")
