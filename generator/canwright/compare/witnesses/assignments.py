"""The parameter values under which frames are compared."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from ...model import formatting
from ...model.edition import Edition
from ...model.types import Assignment, Parameter

MOST = 64
"""So many combinations of parameter values are tried for one message; beyond, each parameter is varied alone."""
_PRIMES = (7, 11, 13, 17, 19, 23)


class Assignments:
    """The values of the parameters of two editions; those that both have, of a number one value of its own."""

    def __init__(self, old: Edition, new: Edition) -> None:
        self._values: dict[str, Sequence[str]] = {}
        before, after = ({p.name: p for p in edition.parameters} for edition in (old, new))
        for number, name in enumerate({**before, **after}):
            present = [p[name] for p in (before, after) if name in p]
            self._values[name] = _values(present, _PRIMES[number % len(_PRIMES)])
        self.first: Assignment = {name: values[0] for name, values in self._values.items() if values}

    def of(self, names: Iterable[str]) -> Iterator[Assignment]:
        """Every combination of the values of some parameters; at most `MOST`, or each varied alone."""
        values = {name: self._values[name] for name in dict.fromkeys(names) if self._values.get(name)}
        count = 1
        for of_one in values.values():
            count *= len(of_one)
        if count <= MOST:
            yield from (dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values()))
            return
        first = {name: of_one[0] for name, of_one in values.items()}
        yield first
        for name, of_one in values.items():
            yield from ({**first, name: value} for value in of_one[1:])


def _values(parameters: Sequence[Parameter], prime: int) -> Sequence[str]:
    if all(p.is_choice for p in parameters):
        return [v.name for v in parameters[0].values if all(v.name in _names(p) for p in parameters)]
    number = Fraction(prime)
    for parameter in parameters:
        if parameter.maximum is not None:
            number = min(number, parameter.maximum)
        if parameter.minimum is not None:
            number = max(number, parameter.minimum)
    return [formatting.exact(number)] if not any(p.is_choice for p in parameters) else []


def _names(parameter: Parameter) -> Mapping[str, object]:
    return {value.name: value for value in parameter.values}
