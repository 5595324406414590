"""Plane elasticity with contact, friction, cracks and random input by hp boundary elements.

>>> import steklov
>>> scene = {
...     "body": {"corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["floor", "right", "top", "left"]},
...     "material": {"young": 200, "poisson": 0.3},
...     "parameters": {"p": 1.0},
...     "sides": {"floor": {"contact": {"gap": "0"}}, "top": {"pressure": "p"}},
... }
>>> result = steklov.solve(scene, parameters__p=3)
>>> round(result.quantities["contact.force.y"], 9)
6.0
"""

from __future__ import annotations

import json
from typing import Any

from . import _steklov, blocks
from .errors import BlockError, SceneError, SolveError, SteklovError
from .result import Quantities, Result
from .profiles import profile
from .progress import Progress, told_to
from .scene import Scene, settings_of, text_of
from .studies import Study, study
from .sweeps import Sweep, sweep

__all__ = ["BlockError", "Quantities", "Result", "SceneError", "SolveError", "SteklovError", "Study", "Sweep", "blocks", "plan", "profile", "solve", "study", "sweep", "text_of"]


def solve(scene: Scene, *, progress: Progress = None, client: Any = None, **overrides: Any) -> Result:
    """Solves a scene: a dictionary, TOML text, or the path of a file.

    Keyword arguments change keys of the scene, two underscores standing for a point: `parameters__load=2`, `method__tolerance=1e-5`, or
    `**{"sides.top.pressure": "2*x"}`. `progress` is called with a text and the share that is done, from 0 to 1;
    True shows a bar.

    `client` is one of Dask, whose workers then solve the outcomes of random input, to the same bits.

    Raises SceneError where the scene is wrong or has no solution, with place and remedy, and KeyboardInterrupt after Ctrl-C.
    """
    text, name = text_of(scene)
    settings, elsewhere = settings_of(overrides), None
    if client is not None:
        from .cluster import Outcomes

        elsewhere = Outcomes(client, (text, name, tuple(settings)))
    with told_to(progress) as tell:
        return Result(_steklov.solve(text, name, settings, tell, elsewhere))


def plan(scene: Scene, **overrides: Any) -> dict[str, Any]:
    """What would be modelled and why, what is left out, and what the first mesh costs, as a dictionary; solves nothing."""
    text, name = text_of(scene)
    return json.loads(_steklov.plan(text, name, settings_of(overrides)))
