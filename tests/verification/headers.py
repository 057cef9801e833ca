"""The generated headers of all specs, and C files that include them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count
from pathlib import Path
from typing import TypeVar

from canwright.project.loader import specification
from canwright.targets.base import EditionInput
from canwright.targets.c.target import CTarget

from ..spec_texts import SPECS

T = TypeVar("T")
SUFFIXES = ("", "_float", "_print")


@dataclass(frozen=True, kw_only=True)
class Header:
    """A generated header below the folder `include`, and a C file that includes it; `name` is `FAMILY/EDITION.h`."""

    specification: EditionInput
    name: str
    include: Path
    unit: Path

    @property
    def text(self) -> str:
        return (self.include / self.name).read_text("utf-8")

    @property
    def part(self) -> str:
        """What the header contains: `float` conversions, functions to `print`, or else the edition."""
        ending = self.name.removesuffix(".h").rsplit("_", 1)[-1]
        return ending if f"_{ending}" in SUFFIXES else ""


def write_headers(folder: Path, specs: Sequence[Path] = SPECS) -> list[Header]:
    """Writes the headers of specs; each family has its own folder, with all of its editions."""
    specifications = [specification(spec) for spec in specs]
    headers = []
    for family in dict.fromkeys(item.edition.family for item in specifications):
        members = [item for item in specifications if item.edition.family == family]
        for output in CTarget().generate(members, {}):
            file = folder / family / output.path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(output.text, "utf-8")
        for item in members:
            for suffix in SUFFIXES:
                name = f"{family}/{item.edition.identifier}{suffix}.h"
                unit = folder / family / f"{item.edition.identifier}{suffix}.c"
                unit.write_text(f"#include <{name}>\n", "utf-8")
                include = folder / family / "include"
                headers.append(Header(specification=item, name=name, include=include, unit=unit))
    return headers


def each(work: Callable[[Header], T], headers: Sequence[Header]) -> list[T]:
    """The results of `work` for every header, one process of a tool for each core at a time."""
    with ThreadPoolExecutor(cpu_count()) as pool:
        return list(pool.map(work, headers))
