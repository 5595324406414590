"""What a solution gives."""

import json
from collections.abc import Mapping


class Quantities(Mapping):
    """All numbers of a result by their paths in the JSON object: `quantities["contact.force.y"]`."""

    def __init__(self, numbers):
        self._numbers = dict(numbers)

    def __getitem__(self, path):
        try:
            return self._numbers[path]
        except KeyError:
            import difflib

            near = difflib.get_close_matches(path, self._numbers, n=1)
            raise KeyError(f"{path!r} is no number of this result" + (f": did you mean {near[0]!r}?" if near else "")) from None

    def __iter__(self):
        return iter(self._numbers)

    def __len__(self):
        return len(self._numbers)

    def __repr__(self):
        return "\n".join(f"{path} = {value!r}" for path, value in self._numbers.items())

    def series(self, name=None):
        """The numbers as a row of pandas."""
        import pandas

        return pandas.Series(self._numbers, name=name)


class Result:
    """A scene that is solved.

    `summary` is the JSON object of `steklov solve --json`, `quantities` its numbers by their paths, `contact` the table of all contact
    nodes as a dictionary of numpy arrays. Trust the numbers to their errors where `converged` holds and `doubts` is empty.
    """

    def __init__(self, answer):
        self.summary = json.loads(answer.json())
        self.quantities = Quantities(answer.numbers())
        self.contact = answer.contact()

    @property
    def converged(self):
        """Whether the run reached its aim."""
        return self.summary["converged"]

    @property
    def doubts(self):
        """Why the estimate is not to be trusted, words; empty if it is."""
        return self.summary["estimate_doubts"]

    @property
    def interfaces(self):
        """The interfaces between bodies, a dictionary for each."""
        return self.summary.get("interfaces", [])

    @property
    def energy(self):
        """J and how far the exact one may be from it: (value, uncertainty), None without an estimate."""
        value, uncertainty = self.summary["energy_extrapolated"], self.summary["energy_uncertainty"]
        return None if value is None else (value, uncertainty)

    def __repr__(self):
        doubts = f", doubts: {', '.join(self.doubts)}" if self.doubts else ""
        return f"<steklov.Result {self.summary['title']!r}: {self.summary['dofs']} dofs, {self.summary['reason']}{doubts}>"
