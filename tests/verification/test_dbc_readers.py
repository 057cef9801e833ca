"""A sample of the readers of DBC files on the golden frames, and defects that they must notice."""

from __future__ import annotations

import functools

import pytest
from canwright.project.loader import specification
from canwright.targets.dbc.printer import printed
from canwright.targets.dbc.selection import NODES
from canwright.targets.options import Options

from ..spec_texts import ROOT
from .dbc_readers import differences, samples, violations
from .readers import Case, Reader
from .readers.programs import Qt
from .readers.python import PYTHON

EDITIONS = {
    "v2.35": ["mwd_motor-v2.35-MG-reply-node1", "mwd_motor-v2.35-MG-command-node1"],
    "v2.36-2025-03": ["mwd_motor-v2.36-2025-03-MG-node1", "mwd_motor-v2.36-2025-03-stored-settings-pid-node1"],
}


@functools.cache
def sample(name: str) -> tuple[str, list[Case]]:
    """The text of a file for one node, and the golden frames that it describes."""
    edition = next(edition for edition, names in EDITIONS.items() if name in names)
    item = specification(ROOT / f"spec/mwd_motor/{edition}.yaml")
    (chosen,) = ((printed(file), cases) for file, cases in samples(item, Options({NODES: (1,)})) if file.name == name)
    return chosen[0], list(chosen[1])


def is_noticed(text: str, cases: list[Case]) -> bool:
    return any(violations(text)) or any(line for reader in PYTHON for line in differences(reader, text, cases))


@pytest.mark.parametrize("name", [name for names in EDITIONS.values() for name in names])
@pytest.mark.parametrize(
    "reader",
    [pytest.param(reader, id=reader.name, marks=pytest.mark.interop(reader.package)) for reader in PYTHON],
)
def test_golden_frames_have_their_values_in_a_reader(reader: Reader, name: str) -> None:
    text, cases = sample(name)
    assert len(cases) > 10
    assert not list(violations(text))
    assert not list(differences(reader, text, cases))


@pytest.mark.tools
@pytest.mark.parametrize("name", [name for names in EDITIONS.values() for name in names])
def test_golden_frames_have_their_values_in_qt(name: str) -> None:
    if not Qt().is_installed():
        raise SystemExit("Qt SerialBus is not installed; pip install PySide6-Addons")
    assert not list(differences(Qt(), *sample(name)))


@pytest.mark.interop(*(reader.package for reader in PYTHON))
@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" SG_ r9C_speed m156 :", " SG_ r9C_speed m156M :"),
        (" SG_ rA1_iq m161 :", " SG_ rA1_speed m161 :"),
        ('VERSION "v2.35 ', 'VERSION "v2.35, '),
        (" SG_ r92_angle m146 : 8|56@1- ", " SG_ r92_angle m146 : 8|56@1+ "),
        (" SG_ r9A_voltage m154 : 24|16@1+ (0.1,0)", " SG_ r9A_voltage m154 : 24|16@1+ (0.01,0)"),
    ],
    ids=["nested multiplexor", "duplicate name", "comma in VERSION", "sign", "scale"],
)
def test_a_defect_is_noticed(old: str, new: str) -> None:
    text, cases = sample("mwd_motor-v2.35-MG-reply-node1")
    assert old in text
    assert is_noticed(text.replace(old, new), cases)
