"""The target `wireshark`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.types import Assignment
from ...templating.environment import environment
from ..base import EditionInput, Output, Target
from ..options import NO_OPTIONS, Options
from . import text
from .family import Filters, family_view, preference

RUNTIME = Path(__file__).parent / "runtime"
"""The code that is the same for every protocol."""


class WiresharkTarget(Target):
    """Generates dissectors for Wireshark."""

    title = "Wireshark"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options = NO_OPTIONS
    ) -> Iterator[Output]:
        """A dissector for each family, and a README.md with instructions."""
        env = environment("wireshark", {"lua": text.printed, "quoted": text.quoted})
        editions: dict[str, list[Edition]] = {}
        for item in specifications:
            editions.setdefault(item.edition.family, []).append(item.edition)
        families = [family_view(members) for members in editions.values()]
        runtime = {file.stem: file.read_text("utf-8") for file in sorted(RUNTIME.glob("*.lua"))}
        for family in families:
            dissector = env.get_template("dissector.lua.j2")
            yield Output(f"{family['name']}.lua", dissector.render(family=family, runtime=runtime))
        yield Output("README.md", env.get_template("README.md.j2").render(families=families))

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """The names of fields in filters, and of preferences."""
        shared = Filters([edition]).names
        yield from ((("parameters", p.name), preference(p.name)) for p in edition.parameters)
        for field in (f for message in edition.all_messages() for f in message.layout.fields if f.name in shared):
            yield field.path, f"{edition.family}.{shared[field.name]}"


TARGET = WiresharkTarget()
