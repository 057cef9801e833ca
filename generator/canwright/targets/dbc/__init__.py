"""The DBC target: a file for each value of the parameters with named values, and for each direction if they share ids.

A parameter with numbers does not multiply the files: its fields are raw unless the parameter is set. If it is set, its
value is part of the file name.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model.types import Assignment
from ...templating.environment import environment
from ..base import EditionInput, Output
from ..options import NO_OPTIONS, Options
from .files import files, traffics
from .guide import Made, guide
from .printer import printed


def generate(
    specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options = NO_OPTIONS
) -> Iterator[Output]:
    """The files of every edition, and a README.md with instructions."""
    made = [_made(specification, set_parameters, options) for specification in specifications]
    for product in made:
        for file in product.files:
            yield Output(f"{file.name}.dbc", printed(file))
    env = environment("dbc", {})
    yield Output("README.md", env.get_template("README.md.j2").render(guide=guide(made)))


def _made(specification: EditionInput, set_parameters: Assignment, options: Options) -> Made:
    both = traffics(specification.edition)
    own = tuple(files(specification.edition, both, set_parameters, options))
    return Made(specification, both, own, set_parameters)
