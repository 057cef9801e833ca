from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from canwright import EditionInput, Output, Target


class CommandList(Target):
    title = "List of commands"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Mapping[str, str | Fraction]
    ) -> Iterator[Output]:
        for edition, _ in specifications:
            names = "\n".join(command.name for command in edition.commands)
            yield Output(f"{edition.family}-{edition.name}.txt", names + "\n")


TARGET = CommandList()
