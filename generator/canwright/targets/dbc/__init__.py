"""The DBC target: one file for each direction and each value of the parameters with named values.

A parameter with numbers does not multiply the files: its fields are raw unless the parameter is set. If it is set, its
value is part of the file name.
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
    """The files of every edition, and a README.md with instructions."""
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
