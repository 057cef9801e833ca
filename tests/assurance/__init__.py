"""Commands that verify generated code with tools beyond PyPI, one module a command."""
