"""The Wireshark target: one Lua dissector for each family, with the tables of all its editions.

The decoder is plain Lua without Wireshark's functions; the dissector adds its results to the tree.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ...diagnostics.unicode_safety import visible
from ...model.types import Assignment
from ...templating.environment import environment
from ..base import EditionInput, Output, header
from . import text
from .family import family_view
from .guide import guide

RUNTIME = Path(__file__).parent / "runtime"
"""The code that is the same for every protocol."""


def generate(specifications: Sequence[EditionInput], set_parameters: Assignment) -> Iterator[Output]:
    """A dissector for each family, and a README.md with instructions."""
    env = environment("wireshark", {"lua": text.printed, "quoted": text.quoted})
    families: dict[str, list[EditionInput]] = {}
    for one in specifications:
        families.setdefault(one.edition.family, []).append(one)
    runtime = {file.stem: file.read_text("utf-8") for file in sorted(RUNTIME.glob("*.lua"))}
    for name, members in families.items():
        editions = [one.edition for one in members]
        headers = [visible(header(edition)) for edition in editions]
        dissector = env.get_template("dissector.lua.j2")
        yield Output(f"{name}.lua", dissector.render(family=family_view(editions), headers=headers, runtime=runtime))
    yield Output("README.md", env.get_template("README.md.j2").render(guide=guide(specifications)))
