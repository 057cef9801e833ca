"""The group of all commands: `canwright`."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any

import click

from .. import __version__
from ..diagnostics.diagnostic import nearest
from . import COMMANDS, COULD_NOT_RUN, HELP, INTERRUPTED
from .terminal import print_text


class _Commands(click.Group):
    def main(self, *args: Any, **extra: Any) -> Any:
        """Runs a command; a target of another package that cannot be used is an error line, not a traceback."""
        try:
            return super().main(*args, **extra)
        except Exception as error:
            from ..targets.registry import TargetError  # only after an error, since it imports the model

            if not isinstance(error, TargetError):
                raise
            print_text(f"canwright: {error}\n", error=True)
            sys.exit(COULD_NOT_RUN)

    def invoke(self, ctx: click.Context) -> Any:
        """Runs a command; an interrupt ends with the status that shells expect, and not with the one of findings."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            ctx.exit(INTERRUPTED)

    def get_help(self, ctx: click.Context) -> str:
        return HELP.rstrip("\n")

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module, _ = COMMANDS[cmd_name]
        command: click.Command = getattr(import_module(f".{module}", __package__), cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            ctx.fail(f"there is no command `{args[0]}`; {nearest(args[0], COMMANDS)}")
        return super().resolve_command(ctx, args)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, "-V", "--version", message="canwright %(version)s")
def main() -> None:
    """The command line; `HELP` describes it."""
