"""A plan as a JSON document, a table for the terminal, and figures."""
