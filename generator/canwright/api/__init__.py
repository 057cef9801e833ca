"""Classes that only programs use, not canwright itself; `import canwright` exports them."""
