"""The Jinja2 environment."""
