"""The spec language and messages about mistakes."""
