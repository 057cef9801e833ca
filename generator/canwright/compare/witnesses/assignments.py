"""The parameter values under which frames are compared."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from types import MappingProxyType

from ...model import formatting
from ...model.edition import Edition
from ...model.types import Assignment, Parameter
from ...semantics.encoder import Encoder, Encoders

MOST = 64
"""So many combinations of parameter values are tried for one message; beyond, each parameter is varied alone."""
_PRIMES = (7, 11, 13, 17, 19, 23)


class Assignments:
    """The values of the parameters of two editions; those that both have, of a number one value of its own and its maximum."""

    def __init__(self, old: Edition, new: Edition) -> None:
        self._values: dict[str, Sequence[str]] = {}
        before, after = ({p.name: p for p in edition.parameters} for edition in (old, new))
        for number, name in enumerate({**before, **after}):
            present = [p[name] for p in (before, after) if name in p]
            self._values[name] = _values(present, _PRIMES[number % len(_PRIMES)])
        self.first: Assignment = {name: values[0] for name, values in self._values.items() if values}
        self._encoders = Encoders()

    def encoder(self, known: Assignment = MappingProxyType({})) -> Encoder:
        """An encoder under some values; other parameters have their first ones."""
        return self._encoders.for_parameters({**self.first, **known})

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
    if any(p.is_choice for p in parameters):
        return []
    lowest = max((p.minimum for p in parameters if p.minimum is not None), default=None)
    highest = min((p.maximum for p in parameters if p.maximum is not None), default=None)
    number = Fraction(prime) if highest is None else min(Fraction(prime), highest)
    number = number if lowest is None else max(number, lowest)
    return [formatting.exact(end) for end in dict.fromkeys((number, number if highest is None else highest))]


def _names(parameter: Parameter) -> Mapping[str, object]:
    return {value.name: value for value in parameter.values}
