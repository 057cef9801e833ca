"""`--set`, `--nodes` and `--comments`: what is fixed in the output, and selected from it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..language import notation
from ..model.edition import Edition
from ..model.message import Direction
from ..model.types import Assignment
from ..resolve import number_parameters
from ..targets.base import EditionInput, Options, TargetWithOptions
from ..targets.registry import target, target_names
from .common import stop


def assignment(specifications: Sequence[EditionInput], settings: Sequence[str]) -> Assignment:
    """`--set` as an assignment; each name and value must be valid in some edition."""
    result: dict[str, str] = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        check_value([one.edition for one in specifications], setting, name, value, "")
        if result.setdefault(name, value) != value:
            stop(f"--set {setting}: `{name}` is already set to {result[name]}; remove one")
    return result


def options(specifications: Sequence[EditionInput], targets: Sequence[str], nodes: str, language: str) -> Options:
    """`--nodes` and `--comments`; each node must exist in every edition that has nodes, and each target must accept them."""
    if nodes or language:
        option = "--nodes" if nodes else "--comments"
        accepting = [name for name in target_names() if isinstance(target(name), TargetWithOptions)]
        if not targets or not set(targets).issubset(accepting):
            stop(f"{option} affects only the target {' and '.join(accepting)}; add --target {accepting[0]}")
    for name in targets if language else ():
        one = target(name)
        known = one.languages if isinstance(one, TargetWithOptions) else ()
        if language not in known:
            stop(f"--comments {language}: the target `{name}` has comments in {', '.join(known)}")
    return Options(tuple(_nodes(specifications, nodes)) if nodes else (), language)


def _nodes(specifications: Sequence[EditionInput], written: str) -> Sequence[int]:
    """The nodes of `5,7` and `1..8`, in ascending order."""
    selected: set[int] = set()
    for part in written.split(","):
        try:
            selected |= {*notation.nodes(part if ".." in part else f"{part}..{part}")}
        except ValueError:
            stop(f"--nodes {written}: `{part}` is not a node; write nodes as 5,7 or 1..8")
    for one in specifications:
        edition = one.edition
        rules = [address.rule(direction) for address in edition.addresses for direction in Direction]
        existing = {node for rule in rules for node in rule.nodes or ()}
        missing = sorted(selected - existing)
        if existing and missing:
            nodes = f"{min(existing)}..{max(existing)}"
            stop(f"--nodes {written}: {edition.family} {edition.name} has no node {missing[0]}; its nodes are {nodes}")
    return sorted(selected)


def check_value(editions: Sequence[Edition], setting: str, name: str, value: str, others: str) -> None:
    """Stops unless a parameter has this value in some edition; `others` are further settings that are possible."""
    owners = [(edition, p) for edition in editions for p in edition.parameters if p.name == name]
    numbers = [(edition, p) for edition, p in owners if not p.is_choice]
    for edition, parameter in numbers:
        try:
            number_parameters.number(edition, parameter, value)
        except ValueError as error:
            stop(f"--set {setting}: {error}")
    if not numbers and not any(v.name == value for _, p in owners for v in p.values):
        wanted = "; ".join(filter(None, (others, known_values(editions))))
        remedy = f"use one of: {wanted}" if wanted else "the spec has no parameters"
        stop(f"--set {setting} is not a parameter and its value; {remedy}")


def known_values(editions: Iterable[Edition], only: str = "") -> str:
    """Every parameter, or one, with its possible values."""
    known: dict[str, set[str]] = {}
    for edition in editions:
        for parameter in edition.parameters:
            if only in ("", parameter.name):
                values = {v.name for v in parameter.values} if parameter.is_choice else {"NUMBER"}
                known.setdefault(parameter.name, set()).update(values)
    return "; ".join(f"{name}={'|'.join(sorted(values))}" for name, values in sorted(known.items()))
