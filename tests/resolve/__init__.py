"""Spec to model."""
