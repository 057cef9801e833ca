"""The names that targets export, for `canwright diff`, are names of the generated files."""

from __future__ import annotations

import re

import pytest
from canwright.project.loader import load
from canwright.targets.options import NO_OPTIONS
from canwright.targets.registry import default_targets, target

from ..spec_texts import SPECS


@pytest.mark.parametrize("name", default_targets())
def test_exported_names_are_in_the_output(name: str) -> None:
    for file in SPECS:
        specification = load(file, for_output=False).specification
        edition = specification.edition
        words = set[str]()
        for output in target(name).generate([specification], {}, NO_OPTIONS):
            words |= set(re.findall(r"\w+", output.content.decode("utf-8")))
        prefix = f"{edition.family}_{edition.identifier}_".lower()
        for path, exported in target(name).exported_names(edition):
            starts = (prefix, prefix.upper()) if exported.startswith("…_") else ("",)
            known = exported.strip('."').removeprefix("…_").removeprefix(f"{edition.family}.")
            parts = known.split(".") if name == "wireshark" else [known[:32] if name == "dbc" else known]
            assert all(any(start + part in words for start in starts) for part in parts), (file.name, path, exported)
