"""From claims to the effort of each region, and to what contradicts it."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Collection, Iterable, Mapping
from types import MappingProxyType

from .forms import DISPLAY, TEMPERATURE, UNKNOWN, Form, domain_of, named_unit, per, raised, times
from .reader import Claim


class Solver:
    """Lets what stands in a region vote on its effort, then goes through two-ports.

    Attributes
    ----------
    effort : dict of int to Form
        By region; regions that nothing is known of are left out.
    origin : dict of int to str
        Who decided the effort of a region.
    signals : frozenset of int
        Numbers that stand for what a signal block says, and for no effort.
    """

    def __init__(
        self,
        claims: Iterable[Claim],
        pseudo: Mapping[int, str] = MappingProxyType({}),
        signals: Collection[int] = (),
    ) -> None:
        self.claims = list(claims)
        self.signals = frozenset(signals)
        self.effort: dict[int, Form] = dict.fromkeys(pseudo, TEMPERATURE)
        self.origin: dict[int, str] = dict(pseudo)
        for firm in (True, False):
            self._vote(firm)
        self._propagate()

    def resolved(self, form: Form) -> Form:
        """Put in the efforts that are known."""
        rest = {key: power for key, power in form.items() if key not in self.effort}
        known = [key for key in form if key in self.effort]
        return times(rest, *(raised(self.effort[key], form[key]) for key in known))

    def domain(self, region: int) -> str:
        """Name the domain of a region."""
        return domain_of(self.effort.get(region))

    def problems(self) -> list[str]:
        """Say which claims do not hold."""
        broken = [claim for claim in self.claims if not self._holds(claim)]
        return list(dict.fromkeys(map(self._message, broken)))

    def _vote(self, firm: bool) -> None:
        """Let claims on one region decide it: most voices, then a named domain, then the first."""
        voices: dict[int, dict[tuple[str, str], Form]] = {}
        for claim in self.claims:
            found = _solved(per(claim.left, claim.right)) if claim.firm is firm else None
            if found is not None and found[0] not in self.effort:
                voices.setdefault(found[0], {})[claim.origin, claim.words] = found[1]
        for region, said in voices.items():
            count = Counter(frozenset(form.items()) for form in said.values())
            self.effort[region], self.origin[region] = max(
                ((form, origin) for (origin, _), form in said.items()),
                key=lambda item: (count[frozenset(item[0].items())], domain_of(item[0]) != UNKNOWN),
            )

    def _propagate(self) -> None:
        """Carry efforts to further regions, until nothing changes."""
        waiting: dict[str | int, list[Claim]] = {}
        for claim in self.claims:
            for key in {*claim.left, *claim.right}:
                waiting.setdefault(key, []).append(claim)
        ready = deque(self.effort)
        while ready:
            for claim in waiting.pop(ready.popleft(), []):
                found = _solved(self.resolved(per(claim.left, claim.right)))
                if found is not None:
                    self.effort[found[0]], self.origin[found[0]] = found[1], claim.origin
                    ready.append(found[0])

    def _holds(self, claim: Claim) -> bool:
        rest = self.resolved(per(claim.left, claim.right))
        return not rest or any(isinstance(key, int) for key in rest)

    def _message(self, claim: Claim) -> str:
        if claim.two_port:
            return self._two_port_message(claim)
        asked = _solved(per(claim.left, claim.right))
        if asked is not None and claim.firm and asked[0] not in self.signals:
            mine, here = DISPLAY.get(domain_of(asked[1])), DISPLAY.get(self.domain(asked[0]))
            if mine is not None and here is not None:
                return (
                    f"{claim.origin} takes effort in {mine[0]} and flow in {mine[1]}, "
                    f"but {self.origin[asked[0]]} makes it {here[0]} and {here[1]} here"
                )
        left, right = _shown(self.resolved(claim.left)), _shown(self.resolved(claim.right))
        words = claim.words.replace("<left>", left).replace("<right>", right)
        used = per(claim.left, claim.right)
        because = self._because({key: used[key] for key in used.keys() - self.signals})
        heard = self._because({key: used[key] for key in used.keys() & self.signals})
        return (
            f"{claim.origin} {words}"
            + (f"; effort is in {because}" if because else "")
            + (f"; the signal is in {heard}" if heard else "")
        )

    def _two_port_message(self, claim: Claim) -> str:
        sides = self._because(claim.left) or "two sides of one effort"
        needed, given = (_shown(self.resolved(form)) for form in (claim.left, claim.right))
        return f"{claim.origin} joins efforts in {sides}; that takes a ratio in {needed}, not in {given}"

    def _because(self, form: Form) -> str:
        regions = sorted(key for key in form if isinstance(key, int))
        return " and in ".join(
            f"{_shown(self.effort[region])} by {self.origin[region]}" for region in regions
        )


def _solved(rest: Form) -> tuple[int, Form] | None:
    """Solve ``rest = 1`` for the effort of its only region.

    None where it has none or more, or where the effort would take roots of
    units: then effort times flow is no power, as in pseudo bond graphs.
    """
    regions = [key for key in rest if isinstance(key, int)]
    if len(regions) != 1:
        return None
    known = {key: value for key, value in rest.items() if key != regions[0]}
    effort = raised(known, -1 / rest[regions[0]])
    whole = all(exponent.denominator == 1 for exponent in effort.values())
    return (regions[0], effort) if whole else None


def _shown(form: Form) -> str:
    return named_unit(form) or "1"
