"""The command line: one module for each command, listed here.

Belongs here: arguments, exit statuses, and how results are printed. Imports every other package.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any

import click

from .. import __version__
from ..diagnostics.diagnostic import nearest

COULD_NOT_RUN = 2

COMMANDS = {
    **{name: name for name in ("generate", "copy", "diff", "identify", "explain", "show", "site", "schema")},
    "check": "generate",
    "editions": "diff",
}
"""The module of each command: only that one is imported."""


class _Commands(click.Group):
    def main(self, *args: Any, **extra: Any) -> Any:
        """Runs a command; a target of another package that cannot be used is an error line, not a traceback."""
        try:
            return super().main(*args, **extra)
        except Exception as error:
            from ..targets.registry import TargetError  # only after an error, since it imports the model

            if not isinstance(error, TargetError):
                raise
            click.echo(f"canwright: {error}", err=True)
            sys.exit(COULD_NOT_RUN)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f".{COMMANDS[cmd_name]}", __package__), cmd_name)
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
    """Generate bindings and documents from one YAML description of a CAN protocol.

    \b
    Start here:
      canwright generate                              generate everything in spec/ into generated/
      canwright check                                 compare generated/ with spec/
      canwright explain RULE                          explain a rule or a key
      canwright copy OLD NEW                          start a new edition
      canwright diff OLD NEW                          show changes between editions and who is affected
      canwright identify LOG                          identify the edition of recorded frames
      canwright editions                              list the editions
      canwright show COMMAND                          show one command in the terminal
      canwright site                                  build the pages into a website
      canwright generate --spec my.yaml --out out     generate your own protocol

    Exit status: 0 without findings, 1 with findings, 2 if the command could not run.
    """
