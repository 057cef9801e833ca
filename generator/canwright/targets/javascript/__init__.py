"""The JavaScript target: an npm package with one ES module for each edition, and its types.

The runtime interprets the tables of an edition: types, layouts, messages and the dispatch plan.
"""
