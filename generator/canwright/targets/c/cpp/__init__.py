"""The C++17 headers, a layer over those of C: `header` is what the template of an edition prints."""

from pathlib import Path

SHARED_CXX = Path(__file__).with_name("canwright.hpp")
"""The header that is the same for every protocol."""
