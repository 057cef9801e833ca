"""The modules that every generated columns package contains. They import only each other, NumPy and Arrow."""
