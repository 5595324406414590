"""Points and outcomes solved by the workers of a Dask cluster."""

import functools
import os
import uuid

from . import _steklov
from .scene import settings_of

# tasks for each thread of the cluster, so that the last ones end nearly together
TASKS_A_THREAD = 8


def placed(name):
    """The name of a scene by which workers find the files that it names, wherever they run."""
    return os.path.abspath(name)


def parts(client, count, multiple=1):
    """Ranges of about equal length, a multiple of some number, several for each thread of the cluster."""
    threads = sum(client.nthreads().values()) or 1
    length = multiple * max(1, -(-count // (TASKS_A_THREAD * threads * multiple)))
    return [range(first, min(first + length, count)) for first in range(0, count, length)]


def gathered(client, futures, counts, what, tell):
    """The results of tasks in their order, told as they come."""
    from distributed import as_completed

    done, total, of = 0, sum(counts), dict(zip(futures, counts))
    try:
        for future in as_completed(futures):
            future.result()
            done += of[future]
            if tell is not None:
                tell(f"{what} {done} of {total}", done / total)
        return client.gather(futures)
    except BaseException:
        client.cancel(futures)
        raise


def solve_points(client, sweep, rows, tell):
    """What is known of the points of a sweep (text, name, settings, keys), a row of values for each."""
    text, name, settings, keys = sweep
    title = _steklov.title(text, name, settings)
    sweep = text, placed(name), [*settings, *settings_of({"title": title})], keys
    chunks = [[rows[k] for k in part] for part in parts(client, len(rows))]
    futures = client.map(points_of_task, chunks, sweep=sweep, pure=False)
    return [known for task in gathered(client, futures, [len(chunk) for chunk in chunks], "points", tell) for known in task]


def points_of_task(rows, sweep):
    """What a worker does: points one after the other by one thread."""
    return _steklov.sweep(*sweep, rows, 1).outcomes()


class Outcomes:
    """Asks the workers of a cluster for the outcomes of a scene (text, name, settings) by their germs."""

    def __init__(self, client, scene):
        text, name, settings = scene
        # files that a scene names may change between two solutions: a worker keeps it for one of them only
        self.client, self.scene, self.futures = client, (text, placed(name), settings, uuid.uuid4().hex), []

    def __call__(self, mesh, germs):
        # outcomes that begin where the last one ended stay together
        chunks = [germs[part.start : part.stop] for part in parts(self.client, len(germs), _steklov.TOGETHER)]
        self.futures = self.client.map(outcomes_of_task, chunks, scene=self.scene, mesh=mesh, pure=False)
        return gathered(self.client, self.futures, [len(chunk) for chunk in chunks], "outcomes", None)

    def cancel(self):
        """Gives up what was asked for."""
        self.client.cancel(self.futures)


@functools.lru_cache(maxsize=1)
def prepared(text, name, settings, solution, mesh):
    """The scene on the last mesh of its solution, once in each process for a solution."""
    from distributed import get_worker

    return _steklov.prepare(text, name, list(settings), mesh, get_worker().state.nthreads)


def outcomes_of_task(germs, scene, mesh):
    """What a worker does: outcomes one after the other."""
    return prepared(*scene, mesh).answers(germs)
