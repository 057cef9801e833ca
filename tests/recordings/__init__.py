"""Logs of a bus."""
