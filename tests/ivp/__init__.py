"""Circuits of the test set for initial value problem solvers, drawn as bond graphs.

Each module holds a graph, the equations as the test set prints them, and its reference solution.

Source: F. Mazzia, C. Magherini, Test Set for Initial Value Problem Solvers, release 2.4,
University of Bari and INdAM, 2008 (facts and figures).
"""
