"""Benchmarks beside their peers; `python -m tests.bench.NAME` runs one, and its exit status follows the bars."""
