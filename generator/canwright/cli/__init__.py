"""The command line: one command a module, listed here."""

from __future__ import annotations

import click

from .. import __version__
from .copy import copy
from .diff import diff, editions
from .explain import explain
from .generate import check, generate
from .identify import identify
from .schema import schema
from .show import show
from .site import site


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, "-V", "--version", message="canwright %(version)s")
def main() -> None:
    """Bindings and documents from one YAML description of a CAN protocol.

    \b
    Start here:
      canwright generate                              everything in spec/ into generated/
      canwright check                                 is generated/ what spec/ says?
      canwright explain RULE                          what a finding means
      canwright copy OLD NEW                          start a new edition
      canwright diff OLD NEW                          what changed between editions, and who is hit
      canwright identify LOG                          which edition a recorded exchange fits
      canwright show COMMAND                          one command, in the terminal
      canwright generate --spec my.yaml --out out     your own protocol, in any folder

    Exit status: 0 when all is well, 1 when there are findings, 2 when it could not run.
    """


for command in (generate, check, copy, diff, editions, identify, explain, show, site, schema):
    main.add_command(command)
