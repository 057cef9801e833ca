from collections.abc import Iterator, Sequence

from canwright import Assignment, EditionInput, Options, Output, Target


class CommandList(Target):
    title = "List of commands"

    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output]:
        for edition, _ in specifications:
            names = "\n".join(command.name for command in edition.commands)
            yield Output(f"{edition.family}-{edition.name}.txt", names + "\n")


TARGET = CommandList()
