"""Markers of tests that need more than the extra `test` installs."""

from __future__ import annotations

import pytest

from .conftest import OPTIONAL, pytest_runtest_setup


@pytest.mark.parametrize("marker", sorted(OPTIONAL))
def test_a_package_that_is_not_installed_is_an_error_with_the_command(
    marker: str, request: pytest.FixtureRequest
) -> None:
    request.node.add_marker(getattr(pytest.mark, marker)("pytest", "no_such_package"))
    with pytest.raises(pytest.fail.Exception, match=r"^not installed: no_such_package; run: .* '\.\[test-interop\]'$"):
        pytest_runtest_setup(request.node)
