"""The options of the target: the nodes to list, and the language of comments."""

from __future__ import annotations

from collections.abc import Sequence

from ...model.edition import Edition
from ..options import TargetOption
from ..selected_nodes import selected_nodes
from .comments import ENGLISH, languages


def _language(written: str, editions: Sequence[Edition]) -> str:
    if written not in languages():
        raise ValueError(f"comments of DBC files are in {' or '.join(languages())}")
    return written


NODES: TargetOption[tuple[int, ...]] = TargetOption(
    name="nodes",
    metavar="NODES",
    help="List only these nodes in the DBC files, for example --nodes 5,7 or --nodes 1..8.",
    default=(),
    parse=selected_nodes,
)
"""The nodes to list, in ascending order; empty for all."""
COMMENTS = TargetOption(
    name="comments",
    metavar="LANGUAGE",
    help="The language of comments in DBC files, for example --comments zh. Files with non-English comments are UTF-8.",
    default=ENGLISH,
    parse=_language,
)
"""The language of comments."""
