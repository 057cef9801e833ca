"""Name collisions: items of a spec that would have the same name in Python."""

from __future__ import annotations

import keyword
import sys
from collections.abc import Iterator

from ...diagnostics.diagnostic import DocumentPath
from ...model.edition import Edition
from ...model.layout import Layout
from ..base import Named, NameProblem, clashes
from . import text
from .imports import NAMES
from .module import CONSTANTS, SHARED

OTHER_VERSIONS = (
    "aifc annotationlib asynchat asyncore audioop binhex cgi cgitb chunk compression crypt distutils imghdr imp lib2to3 "
    "mailcap msilib nis nntplib ossaudiodev pipes smtpd sndhdr spwd sunau telnetlib tomllib uu xdrlib"
)
"""Modules that only some versions from Python 3.10 to 3.14 have."""
UNLISTED = "idlelib sitecustomize test turtledemo usercustomize"
"""Modules that `sys` does not list, and those that Python imports if they exist."""
STANDARD_LIBRARY = sys.stdlib_module_names.union(OTHER_VERSIONS.split(), UNLISTED.split())
PACKAGES = frozenset({"can", "canwright", "numpy", "pip", "pyarrow", "setuptools", "typing_extensions", "wheel"})
"""Packages that generated code or its installation imports, and canwright."""


def problems(edition: Edition) -> Iterator[NameProblem]:
    """The collisions of one edition."""
    yield from _modules(edition)
    yield from clashes(_module_names(edition), "Python", dict.fromkeys((*NAMES, *CONSTANTS), "a name in every module"))
    for layout in dict.fromkeys(m.layout for m in edition.all_messages()):
        yield from clashes(_attributes(layout), "Python")
    for type_ in edition.types:
        key = "enum" if type_.enum else "flags"
        members = [
            (text.member_name(m.name), f"`{m.name}`", (*type_.path, key, m.name)) for m in type_.enum or type_.flags
        ]
        yield from clashes(members, "Python")
    for parameter in edition.parameters:
        at: DocumentPath = ("parameters", parameter.name, "values")
        values = [(text.member_name(v.name), f"`{v.name}`", (*at, v.name)) for v in parameter.values]
        if not parameter.is_numeric:
            yield from clashes(values, "Python")


def _modules(edition: Edition) -> Iterator[NameProblem]:
    """Names that `import` cannot have, packages that hide another, modules in place of those of every package."""
    family, module = edition.family, edition.identifier
    if keyword.iskeyword(family):
        text = f"the Python package `{family}` cannot be imported, because `{family}` is a keyword of Python"
        yield NameProblem(("family",), text, f"choose another name, for example {family}_protocol")
    if keyword.iskeyword(module):
        text = f"the Python module `{module}` cannot be imported, because `{module}` is a keyword of Python"
        yield NameProblem(("edition",), text, f"choose another name, for example v{edition.name}")
    if family in STANDARD_LIBRARY or family in PACKAGES:
        owner = "of the standard library" if family in STANDARD_LIBRARY else "that other programs need"
        text = f"the Python package `{family}` would replace the module `{family}` {owner}"
        yield NameProblem(("family",), text, f"choose another name, for example {family}_protocol")
    if f"{module}.py".lower() in SHARED:
        text = f"the Python package already contains a module `{module.lower()}`"
        yield NameProblem(("edition",), text, f"choose another name, for example v-{edition.name}")


def _module_names(edition: Edition) -> Iterator[Named]:
    for parameter in edition.parameters:
        if parameter.is_choice and not parameter.is_numeric:
            yield text.class_name(parameter.name), f"the parameter `{parameter.name}`", ("parameters", parameter.name)
    for type_ in edition.types:
        what = f"the type `{type_.name}`"
        if type_.enum or type_.flags:
            yield text.class_name(type_.name), what, type_.path
        else:
            yield text.member_name(type_.name), what, type_.path
    for message in edition.all_messages():
        yield text.class_name(message.name), f"the {message.direction.value} of `{message.command}`", message.path
        if len(edition.of_layout(message.layout)) > 1 and message.layout.fields:
            yield text.class_name(message.layout.name), f"the layout `{message.layout.name}`", message.layout.path


def _attributes(layout: Layout) -> Iterator[Named]:
    for field in layout.fields:
        for ending in ("", "_raw"):
            yield text.attribute(field.name) + ending, f"the field `{field.name}`", field.path
