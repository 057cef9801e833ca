"""The arguments that `generate` and `check` have in common: specs, targets, and the options that targets declare."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import click

from ..diagnostics.diagnostic import Diagnostic
from ..model.types import Assignment
from ..output.writer import Content
from ..project.pipeline import generate
from ..targets.base import EditionInput
from ..targets.options import OptionError, Options
from ..targets.registry import TargetError, declared_options, default_targets, selected_options, target, target_names
from .common import OfSpecs, format_option, load, spec_option, stop
from .run_record import Printed, RunRecord
from .settings import assignment

Command = TypeVar("Command", bound=Callable[..., Any])

_OPTION = "option_"
"""Start of the names that the options of targets have in click, so that they differ from all others."""


class Generation(NamedTuple):
    """What a run generates, with the warnings of its specs."""

    specifications: Sequence[EditionInput]
    warnings: Sequence[Diagnostic]
    targets: Sequence[str]
    set_parameters: Assignment
    options: Mapping[str, Options]
    has_specs: bool
    """Whether the user gave the specs."""
    printer: str
    record: RunRecord | None

    @property
    def editions(self) -> str:
        """`lamp v1, lamp v2`."""
        return ", ".join(f"{item.edition.family} {item.edition.name}" for item in self.specifications)

    def content(self) -> Content:
        """The files. Raises TargetError."""
        return generate(self.specifications, self.targets, self.set_parameters, self.options)

    def notices(self) -> Sequence[str]:
        """What the output of the targets lacks because of its size. Raises TargetError."""
        editions = [item.edition for item in self.specifications]
        return [text for name in self.targets for text in target(name).notices(editions, self.options[name])]

    def save(self, out: Path, content: Content, printed: Printed) -> None:
        """Records the run, unless the user does not want that."""
        if self.record is not None:
            self.record.save(out, content, printed)


set_option = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="Fix a parameter in the DBC files, for example --set size=12.",
)


def generation_options(function: Command) -> Command:
    """Options that a GenerationCommand passes as a Generation, with `--target` and those of targets above `--set`."""
    for option in (format_option, set_option, spec_option):
        function = option(function)
    return function


class GenerationCommand(OfSpecs):
    """A command with `generation_options` and the options that the installed targets declare.

    It passes them as one argument, `generation`. Errors are printed and exit the command.
    """

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        own = super().get_params(ctx)
        taken = {text for option in own for text in option.opts}
        at = [option.name for option in own].index("settings")
        return [*own[:at], *_options(frozenset(taken)), *own[at:]]

    def invoke(self, ctx: click.Context) -> Any:
        given = ctx.params
        texts = {name.removeprefix(_OPTION): given.pop(name) for name in list(given) if name.startswith(_OPTION)}
        names = ("specs", "targets", "settings", "printer", "no_cache")
        arguments = {name: given.pop(name) for name in names}
        chosen = {name: text for name, text in texts.items() if text}
        given["generation"] = _generation(**arguments, options=chosen, record=ctx.ensure_object(RunRecord))
        return super().invoke(ctx)


@functools.cache
def _options(taken: frozenset[str]) -> Sequence[click.Option]:
    """`--target` and the options of the targets; `taken` are those of the command. Raises TargetError."""
    excluded = ", ".join(name for name in target_names() if name not in default_targets())
    default = f"all except {excluded}" if excluded else "all"
    options = [
        click.Option(
            ["--target", "targets"],
            multiple=True,
            type=click.Choice(target_names()),
            help=f"A target; may be given several times.  [default: {default}]",
        )
    ]
    for name, declared in declared_options().items():
        if f"--{name}" in taken:
            raise TargetError(
                f"the target `{declared[0][0]}` declares the option --{name}, which canwright has already"
            )
        option = declared[0][1]
        options.append(
            click.Option([f"--{name}", f"{_OPTION}{name}"], default="", metavar=option.metavar, help=option.help)
        )
    return options


def _generation(
    *,
    specs: Sequence[Path],
    targets: Sequence[str],
    settings: Sequence[str],
    options: Mapping[str, str],
    printer: str,
    no_cache: bool,
    record: RunRecord,
) -> Generation:
    loaded = load(specs, printer, record)
    specifications = [item.specification for item in loaded]
    names = targets or default_targets()
    set_parameters = assignment(specifications, settings)
    try:
        selected = selected_options(names, options, [item.edition for item in specifications])
    except OptionError as error:
        stop(str(error))
    return Generation(
        specifications=specifications,
        warnings=[warning for item in loaded for warning in item.warnings],
        targets=names,
        set_parameters=set_parameters,
        options=selected,
        has_specs=bool(specs),
        printer=printer,
        record=None if no_cache else record,
    )
