"""The docs target: Markdown pages, readable on their own or as a site, in every language of the spec."""
