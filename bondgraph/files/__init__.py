"""Model files: a bond graph as TOML, read and written without running any code.

The format is described in docs/model_files.md. Elements keep their qualified
names: submodels are written flat, and states keep their names.

A new kind of element is a row in `kinds`; if its laws have several forms,
`elements` says which one is written. Multiport fields, one row for several
elements, are in `fields` (read) and `field_laws` (written); `rows` says which
elements each row makes, in which order. A new table or key goes into `read`
and `write`. `entries` checks single entries and says where an error arose, `names`
tells what names mean, `assumptions` is the key ``assume``, `syntax` knows
TOML, `disk` the file system.
"""

from .disk import MAX_BYTES, load, save
from .fields import FIELDS, FieldKind
from .kinds import KINDS, Kind
from .read import SCHEMA, loads
from .write import dumps

__all__ = [
    "FIELDS",
    "FieldKind",
    "KINDS",
    "Kind",
    "MAX_BYTES",
    "SCHEMA",
    "dumps",
    "load",
    "loads",
    "save",
]
