"""Verification commands, one module each: `python -m tests.assurance.NAME`."""
