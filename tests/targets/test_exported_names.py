"""The names that targets export, for `canwright diff`, are names of the generated files."""

from __future__ import annotations

import re

import pytest
from canwright.project.loader import load
from canwright.targets.registry import target

from ..spec_texts import SPECS


@pytest.mark.parametrize("name", ["c", "javascript", "python"])
def test_exported_names_are_in_the_output(name: str) -> None:
    for file in SPECS:
        specification = load(file, golden=False).specification
        edition = specification.edition
        words = set[str]()
        for output in target(name).generate([specification], {}):
            words |= set(re.findall(r"\w+", output.text))
        prefix = f"{edition.family}_{edition.identifier}_".lower()
        plain = words | {word.lower().removeprefix(prefix) for word in words} | {w[len(prefix) :] for w in words}
        for path, exported in target(name).exported_names(edition).items():
            known = exported.strip('."…_').removesuffix("_to_milli")
            assert known in plain or any(f"_{known}" in word for word in words), (file.name, path, exported)
