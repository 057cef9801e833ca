"""Verification that takes long or needs tools: each module is a command, `python -m tests.assurance.NAME`."""
