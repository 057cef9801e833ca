"""The documentation site: the pages of the docs target, built by Sphinx in all languages, without external requests.

Belongs here: menus, search and appearance of the site. What the pages say belongs to the target `docs`.
"""

from .build import LANGUAGES, SiteError, build

__all__ = ["LANGUAGES", "SiteError", "build"]
