"""Answers from programs that know no bond graphs, for the same systems.

ngspice (a program: ``apt-get install ngspice``)
    solves circuits written as netlists: `circuits` holds each circuit twice, as a netlist and as a
    bond graph, and `ngspice` runs the program.
sympy.physics.mechanics (comes with sympy)
    derives Lagrange's and Kane's equations of the pendulums of `pendulums` from frames and points:
    `lagrange`.
MuJoCo (from PyPI, in the extra ``test``)
    simulates the same pendulums from a description of bodies and joints: `multibody`.

A test that needs an engine skips, by its name, only where it is not installed; where the
environment sets ``HALFARROW_REQUIRE_ENGINES=1``, as `.ci/run` does, it fails instead (`presence`).
"""
