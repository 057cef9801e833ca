"""Measurements; `python -m tests.benchmarks.NAME` prints one."""
