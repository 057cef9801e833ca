"""Loading, checking and generating; what is committed, installed and published."""
