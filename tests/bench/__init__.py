"""Benchmarks beside the code that they are measured against, one module a command; the exit status follows the bars."""
