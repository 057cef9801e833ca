"""The columns target: a typed package that decodes whole recordings into NumPy and Arrow columns, one module an edition."""
