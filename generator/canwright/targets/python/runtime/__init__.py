"""The runtime of generated Python packages: the code that is the same for every protocol.

`generate` copies the other modules of this package, with a header line in front, into the package of each family. They
therefore import the standard library and one another only; `python_can` needs python-can as well.
"""
