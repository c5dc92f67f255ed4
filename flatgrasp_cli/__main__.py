"""`python -m flatgrasp_cli`."""

from flatgrasp_cli.cli import main

main()
