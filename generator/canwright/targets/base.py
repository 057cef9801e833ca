"""The interface of a target, and what goes into and comes out of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from .. import __version__
from ..diagnostics.diagnostic import DocumentPath, Severity
from ..model.edition import Edition
from ..model.message import Command, Message
from ..model.types import Assignment, Parameter, Type
from .options import Options, TargetOption

if TYPE_CHECKING:
    from ..model.golden_frames import GoldenFrame, GoldenFrames

PACKAGE_VERSION = __version__
"""The version of generated packages: that of canwright, since the names in generated code depend on it."""


class EditionInput(NamedTuple):
    """An edition with its golden frames, where it has any: the input of a target."""

    edition: Edition
    frames: GoldenFrames | None


class Output(NamedTuple):
    """A generated file: its path below the folder of the target, with `/`, and its text."""

    path: str
    text: str

    @property
    def content(self) -> bytes:
        """The bytes of the file."""
        return self.text.encode("utf-8")


class BinaryOutput(NamedTuple):
    """A generated file that is not a text."""

    path: str
    content: bytes


class WorkedExchange(NamedTuple):
    """A command with golden frames for an example: a request, a reply, or both, with the parameters of both."""

    command: Command
    request: GoldenFrame | None
    reply: GoldenFrame | None
    parameters: Assignment
    is_answered: bool
    """Whether the reply answers the request."""


class CodeExample(NamedTuple):
    """A complete program; `language` is its name in a code block, such as `python`."""

    language: str
    text: str
    essence: str = ""
    """The statements of the program that encode and decode, one a line; empty if the program is a single line."""


class ItemNames(NamedTuple):
    """The names that programs write for a parameter or a type, and for its values or members by their names in the spec.

    `type` is the name of its type in the language; empty without one.
    """

    name: str
    type: str
    members: Mapping[str, str]


class CodeNames(NamedTuple):
    """What programs write to use an edition through the output of a target; `language` as in `CodeExample`."""

    language: str
    source: str
    """The header or the module of the edition."""
    parameters_type: str
    messages: Mapping[Message, str]
    needs_parameters: frozenset[Message]
    """The messages whose constructor or encoder has the parameters as an argument."""
    fields: Mapping[str, str]
    parameters: Mapping[Parameter, ItemNames]
    types: Mapping[Type, ItemNames]
    """The types with named values; empty if programs write raw integers."""
    frame: str = ""
    """The type of a frame; empty if programs do not declare one."""


class NameProblem(NamedTuple):
    """A name that the language of a target cannot use (an error), or that the target changes (a warning)."""

    path: DocumentPath
    message: str
    hint: str
    severity: Severity = Severity.ERROR
    other: tuple[DocumentPath, str] | None = None
    """The path of another item with that name, and what it is."""


Named = tuple[str, str, DocumentPath]
"""A name in a language, the item that has it, and the path of the item."""


def clashes(
    names: Iterable[Named], language: str, taken: Mapping[str, str] = MappingProxyType({})
) -> Iterator[NameProblem]:
    """The names of two items, or of an item and what is `taken` everywhere."""
    owners: dict[str, tuple[str, DocumentPath]] = {name: (what, ()) for name, what in taken.items()}
    for name, what, path in names:
        owner, at = owners.setdefault(name, (what, path))
        if owner != what:
            text = f"{what} and {owner} would both be `{name}` in {language}"
            yield NameProblem(path, text, "rename one of them", other=(at, owner) if at else None)


class Target(ABC):
    """A kind of output. An instance is registered in the entry point group `canwright.targets`, under its name.

    The name of the entry point is the name on the command line and the folder in the output.
    """

    title: ClassVar[str]
    """What reports call the target, such as `C`."""
    options: ClassVar[Sequence[TargetOption[Any]]] = ()
    """Options of `canwright generate` and `canwright check` that this target has."""
    is_default: ClassVar[bool] = True
    """Whether a run that names no targets generates this one."""

    @abstractmethod
    def generate(
        self, specifications: Sequence[EditionInput], set_parameters: Assignment, options: Options
    ) -> Iterator[Output | BinaryOutput]:
        """The files for the editions, which may be of several families.

        `set_parameters` are values of parameters to fix in the output, by name; a target that leaves them to its user
        ignores them. `options` has a value for each option of the target. The output depends on the arguments alone:
        no date, host, path or order of hashes.
        """

    def problems(self, edition: Edition) -> Iterator[NameProblem]:
        """Names of one edition that this target cannot use or changes; `canwright check` reports them."""
        yield from ()

    def collisions(self, editions: Sequence[Edition]) -> Iterator[tuple[Edition, str]]:
        """Names that two editions of one run share: the later edition, and a message."""
        yield from ()

    def notices(self, editions: Sequence[Edition], options: Options) -> Iterator[str]:
        """What the output lacks because of its size, and the option to get it; `canwright generate` prints them."""
        yield from ()

    def exported_names(self, edition: Edition) -> Iterator[tuple[DocumentPath, str]]:
        """Every name that users of the output write, with the path of its item in the spec; for `canwright diff`.

        A name that disappears has to be replaced in programs. The first name of an item stands for it in reports.
        """
        yield from ()

    def code_names(self, edition: Edition) -> CodeNames | None:
        """What programs write to use an edition, for tools that write programs; None if they cannot."""
        return None

    def example(self, edition: Edition, worked: WorkedExchange) -> CodeExample | None:
        """A program with the output of this target that encodes the request and decodes the reply, for documents.

        None if there is none.
        """
        return None


def header(edition: Edition) -> str:
    """The line that every generated file starts with, to be put into a comment."""
    return f"{edition.family} {edition.name}. Generated by canwright, do not edit."
