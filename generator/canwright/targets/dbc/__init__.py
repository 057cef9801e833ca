"""DBC files for CAN analysers: two for an edition, one a direction, for each value of the parameters that decide.

A choice among names splits the set. A choice among numbers, or a number, is left open and its fields stay raw, unless
it is set: then the files are a variant with it in their name.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.types import Assignment
from ...templating.environment import environment
from ..base import Described, Output
from .files import files, traffics
from .guide import Made, guide
from .text import text


def generate(described: Sequence[Described], set_parameters: Assignment) -> Iterator[Output]:
    """The files of every edition, and a README.md that says which to load and how."""
    env = environment("dbc", {"text": text})
    template = env.get_template("file.dbc.j2")
    made = [_made(one, set_parameters) for one in described]
    for one in made:
        for file in one.files:
            yield Output(f"{file.name}.dbc", template.render(file=file))
    yield Output("README.md", env.get_template("README.md.j2").render(guide=guide(made)))


def _made(described: Described, set_parameters: Assignment) -> Made:
    both = traffics(described.edition)
    return Made(described, both, tuple(files(described.edition, both, set_parameters)))
