"""canwright: bindings and documents from one YAML description of a CAN protocol."""

__version__ = "0.1.0"
