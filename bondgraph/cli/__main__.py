"""Lets ``python -m bondgraph.cli`` run the command line."""

from .main import main

main(prog_name="bondgraph")
