"""Bond graphs beside balances written by hand from mechanics and circuit theory.

A `Case` holds a graph and its balances in ordinary quantities (speeds, currents, voltages); `hand`
solves these for the rates of the graph's states without any causality, and for the eigenvalues from
the exact determinant of their pencil.
"""
