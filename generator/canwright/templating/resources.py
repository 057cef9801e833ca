"""The data files of canwright: templates, units, synonyms and the JSON Schema.

An installed package contains them; in a clone, they are in the folders beside `generator/`.
"""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent
_INSTALLED = PACKAGE / "data"
_ROOT = _INSTALLED if _INSTALLED.is_dir() else PACKAGE.parent.parent

TEMPLATES = _ROOT / "templates"
SPECS = _ROOT / "spec"
"""The editions that come with canwright, for commands that read logs."""
UNITS = SPECS / "units.yaml"
SYNONYMS = SPECS / "synonyms.yaml"
"""Words with one meaning, for the search of the documents."""
QUESTIONS = SPECS / "questions.yaml"
"""Questions of users with answers, by family, for the documents."""
NO_ANSWER = SPECS / "no_answer.yaml"
"""Why a device does not answer, by family, for the documents."""
QUICK_START = SPECS / "quickstart.yaml"
"""The first steps with a device, by family, for the documents."""
SCHEMA = SPECS / "canwright.schema.json"

EXAMPLES = PACKAGE / "rules" / "examples"
"""A folder for each rule, with an invalid spec, a valid one, and the expected findings."""

CHANGE_EXAMPLES = PACKAGE / "compare" / "examples"
"""A folder for each kind of change, with an edition before and after it."""
