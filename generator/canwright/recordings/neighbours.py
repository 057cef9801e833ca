"""What editions state about ids on the bus that are not theirs, as sentences."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

from ..model import formatting
from ..model.edition import Edition
from ..targets.columns.runtime._candump import MAX_ID

_SHOWN = 4
"""How many ids are listed."""


def neighbours(editions: Sequence[Edition], ids: Iterable[tuple[int, bool, bool]]) -> Iterator[str]:
    """A sentence for each neighbour of the bus among some ids: numbers, whether of 29 bits, and whether of a remote frame."""
    stated: dict[str, dict[str, None]] = {}
    for id_, edition in itertools.product(ids, editions):
        number, extended, _ = id_
        for neighbour in edition.bus.neighbours:
            if number in neighbour.ids and extended is (number > MAX_ID[False]):
                texts = filter(None, map(formatting.english, (neighbour.title, neighbour.about)))
                stated.setdefault(". ".join(texts), {})[formatting.bus_id(*id_)] = None
    for sentence, named in stated.items():
        listed = ", ".join(itertools.islice(named, _SHOWN)) + (", ..." if len(named) > _SHOWN else "")
        yield f"{listed}: {sentence}"
