"""The Python target: an installable, typed package with one module for each edition and one class for each message."""
