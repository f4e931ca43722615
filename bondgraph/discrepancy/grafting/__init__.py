"""Effects grown into graphs: where they can go, and what changes.

`sites` lists the places, `graft` makes a new graph. `local` tells an effect what its site is,
`units` what its coefficients are measured in, `edits` what changed.
"""

from .edits import Edit, edits_of
from .grown import Grafted, graft
from .places import Site, find_site, sites

__all__ = ["Edit", "Grafted", "Site", "edits_of", "find_site", "graft", "sites"]
