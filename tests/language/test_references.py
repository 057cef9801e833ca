"""Names that a spec defines and refers to."""

from __future__ import annotations

import copy
import json
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from canwright.diagnostics.diagnostic import DocumentPath, SpecError
from canwright.document.document import parse_document
from canwright.language.decoder import decode
from canwright.language.edition import EditionSpec
from canwright.language.findings import Names
from canwright.language.references import MAX_USES, check_references

from ..spec_texts import MINIMAL, findings
from ..untrusted.everything import filled


def names_of(text: str) -> Names:
    return decode(parse_document("x.yaml", text), EditionSpec).names


def with_every_key() -> str:
    """A spec with every key of the language."""
    with tempfile.TemporaryDirectory() as folder:
        filled(lambda: "text", Path(folder))
        return (Path(folder) / "lamp.yaml").read_text("utf-8")


SPEC = with_every_key()
NAMES = names_of(SPEC)


def at(data: Any, path: DocumentPath) -> Any:
    for step in path:
        data = data[step]
    return data


def test_every_kind_is_defined_and_referred_to() -> None:
    defined = {definition.kind for definition in NAMES.definitions}
    referred = {reference.kind for reference in NAMES.references}
    assert defined - referred == {"neighbour", "state"}
    assert referred - defined == {"unit", "path"}


def test_every_definition_and_reference_is_at_its_path() -> None:
    data = yaml.load(SPEC, yaml.CSafeLoader)
    for definition in NAMES.definitions:
        assert definition.name in (definition.path[-1], str(at(data, definition.path))), definition
    for reference in NAMES.references:
        written = str(reference.path[-1] if reference.key else at(data, reference.path))
        assert re.search(rf"(?<![a-z]){re.escape(reference.name)}(?![a-z])", written), reference


def scalars(data: Any, path: DocumentPath = ()) -> Iterator[tuple[DocumentPath, str]]:
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    if isinstance(data, str):
        yield path, data
    for step, value in items:
        yield from scalars(value, (*path, step))


def test_every_value_that_is_the_name_of_a_definition_is_a_reference() -> None:
    defined = {definition.name for definition in NAMES.definitions if not definition.owner}
    known = {reference.path for reference in NAMES.references}
    known |= {definition.path for definition in NAMES.definitions}
    values = {path: value for path, value in scalars(yaml.load(SPEC, yaml.CSafeLoader)) if value in defined}
    assert len(values) > 20
    assert {path: value for path, value in values.items() if path not in known} == {("family",): "lamp"}


@pytest.mark.parametrize(
    "kind", sorted({definition.kind for definition in NAMES.definitions} - {"neighbour", "state", "value"})
)
def test_a_renamed_definition_leaves_unknown_references(kind: str, tmp_path: Path) -> None:
    used = {reference.name for reference in NAMES.references if reference.kind == kind}
    definition = next(d for d in NAMES.definitions if d.kind == kind and d.name in used)
    data = copy.deepcopy(yaml.load(SPEC, yaml.CSafeLoader))
    owner = at(data, definition.path[:-1])
    renamed = {"renamed" if key == definition.name else key: value for key, value in owner.items()}
    owner.clear()
    owner.update(renamed)
    users = [r for r in NAMES.references if (r.kind, r.name) == (kind, definition.name)]
    with pytest.raises(SpecError) as refused:
        check_references(parse_document("x.yaml", json.dumps(data)), names_of(json.dumps(data)))
    reported = [finding for finding in refused.value.diagnostics if f"{kind} `{definition.name}`" in finding.message]
    assert len(reported) == (len(users) if len(users) <= MAX_USES else 1)


def test_a_name_that_many_items_refer_to_is_reported_once(tmp_path: Path) -> None:
    fields = "".join(f"f{n}: {{at: {n}, type: levl}}, " for n in range(1, 5))
    (finding,) = findings(tmp_path, MINIMAL.replace("{level: {at: 2, type: level}}", f"{{{fields}}}"))
    assert finding.message == "there is no type `levl`, to which 4 items refer"
    assert finding.hint == "did you mean `level`?"


def test_references_are_known_even_if_a_definition_is_missing() -> None:
    document = parse_document("x.yaml", MINIMAL.replace("type: level", "type: levl"))
    names = decode(document, EditionSpec).names
    (reference,) = (use for use in names.references if use.kind == "type")
    assert reference.path == ("commands", "dim", "request", "level", "type")
    with pytest.raises(SpecError, match="there is no type `levl`"):
        check_references(document, names)
