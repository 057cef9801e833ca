"""`python -m canwright`."""

from .cli import main

main()
