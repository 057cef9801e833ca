"""The handover target: each edition in each language as one HTML file, as Excel, and its command matrix as CSV."""
