"""Independent answers the framework is held to.

Nothing here imports the package under test: the brake is integrated by scipy from the paper's
equations, the belt is closed form, and the stored figures say where they come from.
"""

from __future__ import annotations
