"""Verification commands, one module each: `python -m tests.verification.NAME`."""
