"""The command line: one module for each command, listed here.

Belongs here: arguments, exit statuses, and how results are printed. Imports every other package.
The text of `canwright --help` is here, and `main` is imported when it is first used, so that help appears at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .group import main

__all__ = ["COMMANDS", "COULD_NOT_RUN", "HELP", "INTERRUPTED", "main"]

COULD_NOT_RUN = 2
INTERRUPTED = 130
"""Of 128 and SIGINT, as in shells."""


COMMANDS = {
    "check": ("generate", "Check the specs, and compare the output with them."),
    "copy": ("copy", "Copy an edition with its golden frames: start a new one, or edit one of the package."),
    "decode": ("decode", "Decode a log or a bus, or explain one frame."),
    "diff": ("diff", "Show what changed from OLD to NEW, and who is affected."),
    "editions": ("diff", "List the editions: family, name, date, commands, title."),
    "encode": ("encode", "Print the frame of a COMMAND, ready for cansend, and what it means."),
    "explain": ("explain", "Explain a RULE by example, or the meaning of a KEY."),
    "frames": ("frames", "Print an entry for each request and reply of SPEC without a golden frame."),
    "generate": ("generate", "Write the bindings and documents of the specs."),
    "handover": ("handover", "Write documents to hand over: HTML, PDF, Excel, and the command matrix as CSV."),
    "identify": ("identify", "Show which editions a recorded exchange fits, and why."),
    "init": ("init", "Start the spec of a new protocol FAMILY, with golden frames."),
    "monitor": ("monitor", "Show the nodes of a bus or a LOG with their latest values."),
    "request": ("request", "Send a COMMAND to nodes on a bus, and print the replies in units."),
    "scan": ("scan", "Find the nodes on a bus, and show which editions each of them fits."),
    "schema": ("schema", "Print the JSON Schema of the language, for editors."),
    "show": ("show", "Show one COMMAND, by name, by code (0x10), or by the CAN id of a broadcast."),
    "simulate": ("simulate", "Answer on a bus as nodes of an EDITION do, without hardware."),
    "site": ("site", "Build the pages into a website with search, in every language."),
    "test": ("test", "Replay the golden frames of the specs through generated code."),
}
"""The module of each command, and the first line of its help. Only the module of the command that runs is imported."""

HELP = """Usage: canwright [OPTIONS] COMMAND [ARGS]...

  Generate bindings and documents from one YAML description of a CAN protocol.

  Start here:
    canwright generate                              generate everything in spec/ into generated/
    canwright check                                 compare generated/ with spec/
    canwright explain RULE                          explain a rule or a key
    canwright copy OLD NEW                          start a new edition
    canwright copy FAMILY/EDITION                   copy an edition of the package
    canwright decode LOG                            decode a log, both directions
    canwright encode COMMAND FIELD=VALUE            print the frame of a command
    canwright scan                                  find the nodes on a bus, and their editions
    canwright request COMMAND FIELD=VALUE           send it on a bus, and print the reply
    canwright monitor                               show the nodes on a bus and their values
    canwright simulate EDITION --node 1..4          answer on a bus as nodes do
    canwright diff OLD NEW                          show changes between editions and who is affected
    canwright identify LOG                          identify the edition of recorded frames
    canwright editions                              list the editions
    canwright show COMMAND                          show one command in the terminal
    canwright site                                  build the pages into a website
    canwright init FAMILY                           start the spec of your own protocol
    canwright frames SPEC                           print golden frames to fill in
    canwright test                                  test generated code with your golden frames
    canwright generate --spec my.yaml --out out     generate your own protocol

  `canwright COMMAND --help` lists the options of a command.

  Exit status: 0 without findings, 1 with findings, 2 if the command could not run.

Options:
  -V, --version  Show the version and exit.
  -h, --help     Show this message and exit.

Commands:
""" + "".join(f"  {name:<8}  {text}\n" for name, (_, text) in COMMANDS.items())


def __getattr__(name: str) -> object:
    if name != "main":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .group import main

    return main
