"""A scene as a model of the UM-Bridge protocol, over HTTP: `python -m steklov.umbridge SCENE [options]`.

The model `forward` has one input vector, the values of keys of the scene, and one output vector, numbers of the result. An evaluation
has the bits of `steklov.solve`; one that did not converge, or that is in doubt, is answered by an error.
"""

import argparse
import contextlib
import http.server
import json
import math
import os
import pathlib
import signal
import socketserver
import sys
import threading
import time
import traceback

from . import _steklov
from .errors import SceneError, SolveError, SteklovError, near
from .result import Result
from .scene import settings_of, text_of

NAME = "forward"
LARGEST_BODY = 1 << 20
LARGEST_WHOLE = 1 << 53
FEATURES = ("Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian")
ENDPOINTS = ("Info", "ModelInfo", "InputSizes", "OutputSizes", *FEATURES)


class Refused(SteklovError):
    """A server that does not start."""


class Answered(Exception):
    """A request that is answered by an error of the protocol."""

    def __init__(self, kind, message, status=400):
        super().__init__(message)
        self.kind, self.status = kind, status


def number_of(value):
    """A value as a finite number, None if it is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        value = float(value)
    except OverflowError:
        return None
    return value if math.isfinite(value) else None


def table_of(text):
    """The keys of a scene, as dictionaries and lists."""
    try:
        import tomllib
    except ModuleNotFoundError:
        try:
            import tomli as tomllib
        except ModuleNotFoundError:
            raise Refused("Python 3.10 has no reader of TOML: pip install tomli, or give each key a value by --vary KEY=VALUE") from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise Refused(f"the scene is no TOML: {error}") from None


def numbers_of(value, path=""):
    """All numbers of a scene by their dotted keys."""
    if isinstance(value, (dict, list)):
        entries = value.items() if isinstance(value, dict) else enumerate(value)
        parts = (numbers_of(entry, f"{path}.{name}" if path else str(name)) for name, entry in entries)
        return {key: number for part in parts for key, number in part.items()}
    return {} if number_of(value) is None else {path: value}


def start_of(asked, text, name):
    """The keys of --vary, or all numbers of [parameters], each with the value to start from."""
    found, known = {}, None
    for entry in (entry for entries in asked for entry in entries.split(",")):
        key, given, value = (part.strip() for part in entry.partition("="))
        key = key if "." in key else key.replace("__", ".")
        if not key or key in found:
            raise Refused(f"--vary names {key!r} twice" if key else f"--vary {entry!r} has no key: write --vary parameters.load")
        if given:
            with contextlib.suppress(ValueError):
                found[key] = int(value)
            if key not in found:
                try:
                    found[key] = float(value)
                except ValueError:
                    raise Refused(f"--vary {entry!r}: {value!r} is no number") from None
            if number_of(found[key]) is None:
                raise Refused(f"--vary {entry!r}: {value!r} is not finite")
            continue
        known = numbers_of(table_of(text)) if known is None else known
        if key not in known:
            try:
                _steklov.plan(text, name, settings_of({key: 1}))
            except SceneError as error:
                raise Refused(f"the scene has no number {key}, and takes no 1 there: {error.message}\nhelp: {error.help}") from None
            raise Refused(f"the scene has no number {key} to start from: write --vary {key}=VALUE")
        found[key] = known[key]
    if not asked:
        found = {key: value for key, value in numbers_of(table_of(text)).items() if key.startswith("parameters.")}
        if not found:
            raise Refused("the scene has no numbers in [parameters]: name keys to vary, such as --vary material.young")
    return found


class Model:
    """The scene of a file, the values of its varied keys to numbers of its result."""

    def __init__(self, path, vary, quantities, allow_doubts, jobs):
        try:
            self.text, self.name = text_of(pathlib.Path(path))
        except (OSError, UnicodeDecodeError) as error:
            raise Refused(f"cannot read the scene {path}: {getattr(error, 'strerror', None) or 'it is no text in UTF-8'}") from None
        _steklov.plan(self.text, self.name, [])
        self.start = start_of(vary, self.text, self.name)
        _steklov.plan(self.text, self.name, settings_of(self.start))
        self.keys, self.quantities, self.allow_doubts = list(self.start), quantities, allow_doubts
        self.slots, self.stopped = threading.Semaphore(jobs), threading.Event()

    def solve(self, values, settings=()):
        """A result at values of the keys, with settings KEY=VALUE of others; given up where the server stops."""
        own = dict(zip(self.keys, values))
        for key, value in own.items():
            if isinstance(self.start[key], int) and value.is_integer() and abs(value) <= LARGEST_WHOLE:
                own[key] = int(value)  # some keys take whole numbers only

        def look(*_):
            if self.stopped.is_set():
                raise Answered("Stopped", "the server was stopped before the evaluation had ended", 503)

        with self.slots:
            look()
            return Result(_steklov.solve(self.text, self.name, [*settings, *settings_of(own)], look))

    def stop(self):
        """Lets all evaluations end by an error: those that wait, one after the other, and those that run at their next step."""
        self.stopped.set()
        self.slots.release()

    def outputs_of(self, result):
        """The quantities of a result that is to be trusted."""
        if not result.converged:
            failure = result.summary.get("failure")
            raise Answered(
                "ModelError",
                f"not converged: the run ended by {result.summary['reason']}{f' ({failure})' if failure else ''}\n"
                "help: a larger method.tolerance or a higher limit such as method.max_dofs, in the scene or in the config",
                500,
            )
        if result.doubts and not self.allow_doubts:
            raise Answered(
                "ModelError",
                f"the result is in doubt: {', '.join(result.doubts)}\n"
                "help: a smaller method.tolerance removes most doubts; --allow-doubts of the server answers in spite of them",
                500,
            )
        outputs = []
        for path in self.quantities:
            if path not in result.quantities:
                raise Answered("ModelError", f"{path!r} is no number of this result{near(path, result.quantities)}", 500)
            outputs.append(result.quantities[path])
            if not math.isfinite(outputs[-1]):
                raise Answered("ModelError", f"{path} is {outputs[-1]}", 500)
        return outputs

    def inputs_of(self, request):
        """The values of the keys."""
        inputs, count = request.get("input"), len(self.keys)
        wanted = f"write one list of {count} number(s) in a list: {', '.join(self.keys)}"
        if not isinstance(inputs, list) or not all(isinstance(vector, list) for vector in inputs):
            raise Answered("InvalidInput", f"input is no list of lists: {wanted}")
        if len(inputs) != 1:
            raise Answered("InvalidInput", f"input has {len(inputs)} vectors and not 1: {wanted}")
        if len(inputs[0]) != count:
            raise Answered("InvalidInput", f"input[0] has {len(inputs[0])} numbers and not {count}: {wanted}")
        for k, (key, value) in enumerate(zip(self.keys, inputs[0])):
            if number_of(value) is None:
                kind = "not finite" if isinstance(value, (int, float)) and not isinstance(value, bool) else "no number"
                raise Answered("InvalidInput", f"input[0][{k}], the value of {key}, is {kind}: {json.dumps(value)[:80]}")
        return [float(value) for value in inputs[0]]

    def settings_of(self, request):
        """Settings KEY=VALUE of keys that are no inputs."""
        config = request.get("config") or {}
        if not isinstance(config, dict):
            raise Answered("InvalidInput", "config is no object: write {\"method.tolerance\": 1e-4}")
        for key in config:
            if "=" in key or not key.isprintable():
                raise Answered("InvalidInput", f"config has the key {key!r}: write a key of the scene, such as \"method.tolerance\"")
            full = key.strip() if "." in key else key.strip().replace("__", ".")
            for own in self.keys:
                if f"{own}.".startswith(f"{full}."):
                    raise Answered("InvalidInput", f"config sets {key}, but {own} is an input: leave it out of config, or do not --vary it")
        try:
            return settings_of(config)
        except (TypeError, ValueError, RecursionError) as error:  # values that no scene has
            raise Answered("InvalidInput", f"config: {error}") from None

    def evaluate(self, request):
        values, settings = self.inputs_of(request), self.settings_of(request)
        try:
            return [self.outputs_of(self.solve(values, settings))]
        except SceneError as error:
            raise Answered("InvalidInput", f"{error.message}\nhelp: {error.help}") from None
        except SolveError as error:
            raise Answered("ModelError", str(error), 500) from None

    def answer(self, endpoint, request):
        """The object that answers a request."""
        if not isinstance(request, dict) or not isinstance(request.get("name"), str):
            raise Answered("InvalidInput", f"the request names no model: write {{\"name\": \"{NAME}\"}}")
        if request["name"] != NAME:
            raise Answered("ModelNotFound", f"there is no model {request['name']!r}: the model is {NAME!r}")
        if endpoint == "ModelInfo":
            return {"support": {feature: feature == "Evaluate" for feature in FEATURES}}
        if endpoint == "InputSizes":
            return {"inputSizes": [len(self.keys)]}
        if endpoint == "OutputSizes":
            return {"outputSizes": [len(self.quantities)]}
        if endpoint == "Evaluate":
            return {"output": self.evaluate(request)}
        raise Answered("UnsupportedFeature", f"{endpoint} is not supported: the solver has no derivatives; use differences of Evaluate")


class Handler(http.server.BaseHTTPRequestHandler):
    """Requests of one connection."""

    protocol_version = "HTTP/1.1"
    server_version = "steklov"
    disable_nagle_algorithm = True
    wbufsize = -1
    timeout = 600  # seconds until a connection that is silent is closed

    def reply(self, status, answer, close=False):
        body = json.dumps(answer).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        if close:
            self.send_header("Connection", "close")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def send_error(self, code, message=None, explain=None):
        self.reply(code, {"error": {"type": "InvalidRequest", "message": message or self.responses[code][0]}}, close=True)

    def log_message(self, *_):
        pass

    def handle_expect_100(self):
        goes_on = super().handle_expect_100()
        self.wfile.flush()
        return goes_on

    def body(self):
        """The body of a request, None once it was refused."""
        told = self.headers.get("Content-Length", "")
        if not (told.isascii() and told.isdigit()) or len(told) > 15:
            return self.send_error(400, "the request has no Content-Length that is a number")
        length = int(told)
        if length <= LARGEST_BODY:
            return self.rfile.read(length)
        for _ in range(64):  # a client reads the answer once it has sent its body
            length -= len(self.rfile.read(min(LARGEST_BODY, length)))
        self.send_error(400, f"the body is larger than {LARGEST_BODY} bytes")

    def do_GET(self):
        endpoint = self.path.partition("?")[0].strip("/")
        if endpoint == "Info":
            return self.reply(200, {"protocolVersion": 1.0, "models": [NAME]})
        if endpoint in ENDPOINTS:
            return self.send_error(405, f"/{endpoint} takes POST")
        self.send_error(404, f"there is no /{endpoint[:80]}: there are {', '.join('/' + known for known in ENDPOINTS)}")

    do_HEAD = do_GET

    def do_POST(self):
        endpoint = self.path.partition("?")[0].strip("/")
        body = self.body()
        if body is None:
            return None
        if endpoint not in ENDPOINTS[1:]:
            return self.do_GET()
        with self.server.busy():
            try:
                try:
                    request = json.loads(body)
                except (ValueError, RecursionError) as error:
                    raise Answered("InvalidInput", f"the body is no JSON: {error}") from None
                answer, status = self.server.model.answer(endpoint, request), 200
            except Answered as error:
                answer, status = {"error": {"type": error.kind, "message": str(error)}}, error.status
            except BaseException as error:  # a panic of the extension is no Exception
                traceback.print_exc()
                answer, status = {"error": {"type": "InternalError", "message": f"{type(error).__name__}: {error}"}}, 500
            self.reply(status, answer)
            self.wfile.flush()


class Server(http.server.ThreadingHTTPServer):
    """A thread for each connection."""

    daemon_threads = True
    request_queue_size = 128
    allow_reuse_address = os.name == "posix"

    def __init__(self, host, port):
        if ":" in host:
            self.address_family = socketserver.socket.AF_INET6
        super().__init__((host, port), Handler, bind_and_activate=False)
        self.model, self.requests, self.counts = None, 0, threading.Lock()

    @contextlib.contextmanager
    def busy(self):
        """Counts a request until it is answered."""
        with self.counts:
            self.requests += 1
        try:
            yield
        finally:
            with self.counts:
                self.requests -= 1

    def server_bind(self):
        socketserver.TCPServer.server_bind(self)  # without a look-up of the host's name
        self.server_name, self.server_port = self.server_address[:2]

    def handle_error(self, request, client_address):
        if not isinstance(sys.exc_info()[1], (ConnectionError, TimeoutError)):  # of a client that has left
            super().handle_error(request, client_address)


@contextlib.contextmanager
def taking(host, port):
    """Tells plainly why an address cannot be had."""
    try:
        yield
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Refused(f"cannot listen at {host}:{port}: {reason}; choose another port by --port or $PORT") from None


def processors():
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def serve(arguments):
    """Serves until a signal; returns whether all requests are answered."""
    host, port = arguments.host, arguments.port
    with taking(host, port):
        server = Server(host, port)
    with contextlib.closing(server.socket):
        with taking(host, port):
            server.server_bind()
        model = Model(arguments.scene, arguments.vary, arguments.quantity or ["energy"], arguments.allow_doubts, arguments.jobs)
        values = ", ".join(f"{key} = {value}" for key, value in model.start.items())
        print(f"solving {arguments.scene} once, with {values}", flush=True)
        result = model.solve([float(value) for value in model.start.values()])
        for path in model.quantities:
            if path not in result.quantities:
                names = ", ".join(result.quantities)
                raise Refused(f"{path!r} is no number of this result{near(path, result.quantities)}\nIts numbers are {names}")
        try:
            model.outputs_of(result)
        except Answered as error:
            print(f"warning: with these values evaluations are refused: {error}", file=sys.stderr, flush=True)
        server.model = model
        with taking(host, port):
            server.server_activate()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: threading.Thread(target=server.shutdown).start())
        shown = f"[{host}]" if ":" in host else host
        print(f"input: {values}")
        print(f"output: {', '.join(f'{path} = {result.quantities[path]!r}' for path in model.quantities)}")
        print(f"listening at http://{shown}:{server.server_port}", flush=True)
        server.serve_forever(poll_interval=0.1)
    model.stop()
    end = time.monotonic() + 3
    while server.requests and time.monotonic() < end:
        time.sleep(0.02)
    return not server.requests


def whole(low, high):
    """A whole number in bounds, as an argument."""

    def parse(text):
        if not (text.isascii() and text.isdigit() and low <= int(text) <= high):
            raise argparse.ArgumentTypeError(f"{text!r} is no whole number from {low} to {high}")
        return int(text)

    return parse


def parser():
    made = argparse.ArgumentParser(
        prog="python -m steklov.umbridge",
        description="Serves a scene as the model `forward` of the UM-Bridge protocol: keys of the scene in, numbers of the result out.",
    )
    made.add_argument("scene", metavar="SCENE", help="path of the scene")
    made.add_argument(
        "--vary",
        metavar="KEY",
        action="append",
        default=[],
        help="a key that is an input, such as parameters.load, or several with commas; KEY=VALUE where the scene has no number there to "
        "start from (default: all numbers of [parameters])",
    )
    made.add_argument(
        "--quantity",
        metavar="PATH",
        action="append",
        help="a number of the result that is an output, such as contact.force.y (default: energy)",
    )
    made.add_argument("--host", default="127.0.0.1", help="the address to listen at (default: 127.0.0.1; 0.0.0.0 for other machines)")
    made.add_argument(
        "--port",
        type=whole(0, 65535),
        default=os.environ.get("PORT") or "4242",
        help="the port; 0 takes a free one (default: $PORT, or 4242)",
    )
    made.add_argument("--jobs", type=whole(1, 10000), default=processors(), help="evaluations at once (default: one for each processor)")
    made.add_argument("--allow-doubts", action="store_true", help="answer also with results that are in doubt")
    return made


def main(arguments=None):
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        ended = serve(parser().parse_args(arguments))
    except (SteklovError, OSError) as error:
        print(str(error).rstrip() if isinstance(error, SceneError) else f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    if not ended:  # the interpreter cannot end threads of the extension
        sys.stdout.flush()
        os._exit(0)
    return 0


if __name__ == "__main__":
    sys.exit(main())
