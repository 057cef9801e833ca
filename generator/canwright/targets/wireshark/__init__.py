"""The Wireshark target: one Lua dissector for each family, with the tables of all its editions.

The decoder is plain Lua without Wireshark's functions; the dissector adds its results to the tree.
"""
