"""The C target: headers for host and node, freestanding, without heap; floats only in separate headers."""
