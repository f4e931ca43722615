"""The table of all effects, by their contract names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from ...errors import LawError, suggestion
from .flows import FLOWS
from .friction import FRICTION
from .heat import HEAT
from .inertia import INERTIAS
from .signals import SIGNALS
from .springs import SPRINGS
from .value import Effect

EFFECTS: Mapping[str, Effect] = MappingProxyType(
    {effect.name: effect for effect in (*FRICTION, *SPRINGS, *FLOWS, *SIGNALS, *INERTIAS, *HEAT)}
)


def effects(*names: str | Effect, more: Iterable[Effect] = ()) -> tuple[Effect, ...]:
    """Return effects to be tried: of the table by name, all of it unless named, and more.

    Parameters
    ----------
    *names : str or Effect
    more : iterable of Effect
        The user's own; one of a name of the table takes its place.

    Returns
    -------
    tuple of Effect

    Raises
    ------
    LawError
        For a name that is not in the table.

    Examples
    --------
    >>> [effect.name for effect in effects("leakage", "overflow")]
    ['leakage', 'overflow']
    """
    chosen: dict[str, Effect] = {}
    for name in names or EFFECTS:
        if isinstance(name, str) and name not in EFFECTS:
            raise LawError(
                f"there is no effect {name!r}; {suggestion(name, EFFECTS) or ', '.join(EFFECTS)}"
            )
        effect = EFFECTS[name] if isinstance(name, str) else name
        chosen[effect.name] = effect
    return tuple((chosen | {effect.name: effect for effect in more}).values())
