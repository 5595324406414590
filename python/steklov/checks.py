"""Data of building blocks: refused with their place and a remedy."""

import operator

import numpy

from .errors import BlockError, near


def word(name, value, words):
    """The value, if it is one of the words."""
    if not (isinstance(value, str) and value in list(words)):
        hint = near(value, words) if isinstance(value, str) else ""
        raise BlockError(f"{name} is {value!r}{hint}: it is one of {', '.join(map(repr, words))}")
    return value


def count(name, value, least=0):
    """A whole number that is not below the least one."""
    try:
        number = operator.index(value)
    except TypeError:
        raise BlockError(f"{name} is {value!r}: it is a whole number") from None
    if not least <= number < 2**31:
        raise BlockError(f"{name} is {number}: it is at least {least} and below 2^31")
    return number


def numbers(name, value, shape=None, *, infinite=False):
    """Finite numbers of a shape, an axis of any length being None; a shape of None is any."""
    try:
        found = numpy.asarray(value)
        found = numpy.array(found, dtype=float) if found.dtype.kind in "biuf" or not found.size else None
    except (TypeError, ValueError):
        found = None
    if found is None:
        raise BlockError(f"{name} is no array of real numbers: make one by numpy.array, with rows of equal lengths")
    if shape is not None and not (found.ndim == len(shape) and all(s in (None, n) for s, n in zip(shape, found.shape))):
        wanted = ", ".join("any" if s is None else str(s) for s in shape)
        raise BlockError(f"{name} has the shape {found.shape}: it must be ({wanted})")
    bad = numpy.argwhere(numpy.isnan(found) if infinite else ~numpy.isfinite(found))
    if len(bad):
        at, place = tuple(int(i) for i in bad[0]), "".join(f"[{i}]" for i in bad[0])
        raise BlockError(f"{name}{place} is {found[at]}: it must be {'a number' if infinite else 'finite'}")
    return found


def number(name, value):
    """A finite number."""
    return float(numbers(name, value, ()))


def spread(name, value, shape, **how):
    """Numbers of a shape, from fewer where they repeat along the first axes."""
    found = numbers(name, value, **how)
    try:
        return numpy.broadcast_to(found, shape)
    except ValueError:
        raise BlockError(f"{name} has the shape {found.shape}: it must be {shape}, or one for all") from None


def own(value):
    """An array that cannot be written."""
    found = numpy.asarray(value)
    found.setflags(write=False)
    return found


def of_kind(name, value, kind):
    """The value, if it is a block of this kind."""
    if not isinstance(value, kind):
        raise BlockError(f"{name} is a {type(value).__name__}: it must be a blocks.{kind.__name__}")
    return value


def entries(name, value, what):
    """The entries of anything but a text; `what` tells what they are."""
    try:
        return list(None if isinstance(value, str) else value)
    except TypeError:
        raise BlockError(f"{name} is {value!r}: it lists {what}") from None


def array(name, value):
    """An array of any kind."""
    try:
        return numpy.asarray(value)
    except ValueError:
        raise BlockError(f"{name} is no array: its rows have different lengths") from None
