"""How far a solution is, as people like to see it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Union

Tell = Callable[[str, float], object]
Progress = Union[Tell, bool, None]


@contextlib.contextmanager
def told_to(progress: Progress) -> Iterator[Tell | None]:
    """The callback for a text and the share that is done: that of the caller, or a bar where `progress` is True; None for no progress."""
    if progress is None or progress is False:
        yield None
    elif progress is not True:
        yield progress
    else:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            yield line
            print(file=sys.stderr)
            return
        with tqdm(total=1.0, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}") as bar:

            def show(text: str, share: float) -> None:
                bar.set_description_str(text, refresh=False)
                bar.n = share
                bar.refresh()

            yield show


def line(text: str, share: float) -> None:
    """Writes the progress over the last one."""
    print(f"\r{text:<40} {share:4.0%}", end="", file=sys.stderr, flush=True)
