"""The Wireshark target: one Lua dissector for each family, with the tables of all its editions.

The decoder is plain Lua without Wireshark's functions; the dissector adds its results to the tree.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ...model.edition import Edition
from ...model.types import Assignment
from ...templating.environment import environment
from ..base import EditionInput, Output
from . import text
from .family import FamilyView

RUNTIME = Path(__file__).parent / "runtime"
"""The code that is the same for every protocol."""


def generate(specifications: Sequence[EditionInput], set_parameters: Assignment) -> Iterator[Output]:
    """A dissector for each family, and a README.md with instructions."""
    env = environment("wireshark", {"lua": text.printed, "quoted": text.quoted})
    editions: dict[str, list[Edition]] = {}
    for item in specifications:
        editions.setdefault(item.edition.family, []).append(item.edition)
    families = [FamilyView(members) for members in editions.values()]
    runtime = {file.stem: file.read_text("utf-8") for file in sorted(RUNTIME.glob("*.lua"))}
    for family in families:
        dissector = env.get_template("dissector.lua.j2")
        yield Output(f"{family.name}.lua", dissector.render(family=family, runtime=runtime))
    yield Output("README.md", env.get_template("README.md.j2").render(families=families))
