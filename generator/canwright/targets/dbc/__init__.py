"""The DBC target: a file for each value of the parameters with named values, and for each direction if they share ids.

A parameter with numbers does not multiply the files: its fields are raw unless the parameter is set. If it is set, its
value is part of the file name.
"""
