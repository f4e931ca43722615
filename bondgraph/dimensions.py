"""Dimensions: which unit every effort, flow and state of a graph has.

Efforts and flows of all bonds that meet at junctions have one dimension each,
and effort times flow is power on every bond. So a graph falls into regions
with one unknown, the dimension of effort; units of parameters, inputs and
outputs decide it, and two-ports carry it from region to region. What cannot be
known stays None; what contradicts itself is said in words.

A bare number in a law may carry any unit, so it tells nothing.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType

import sympy

from .elements import TF, C, Element, Friction, I, OnePort, R, Se, Sf, Storage, TwoPort
from .errors import ParameterError
from .graph import TIME, BondGraph
from .parameters import Parameter

UNKNOWN = "unknown"

# Units of effort, flow, displacement (of a C) and momentum (of an I).
DISPLAY: Mapping[str, tuple[str, str, str, str]] = MappingProxyType(
    {
        "translation": ("N", "m/s", "m", "N*s"),
        "rotation": ("N*m", "rad/s", "rad", "N*m*s"),
        "hydraulic": ("Pa", "m^3/s", "m^3", "Pa*s"),
        "electrical": ("V", "A", "C", "Wb"),
        "thermal": ("K", "W/K", "J/K", "K*s"),
    }
)

# A product of powers: exponent by base unit, and by region for an effort not yet known.
Form = dict[str | int, Fraction]

_BASE = {
    "[mass]": "kg",
    "[length]": "m",
    "[time]": "s",
    "[current]": "A",
    "[temperature]": "K",
    "[substance]": "mol",
    "[luminosity]": "cd",
}
_POWER: Form = {"kg": Fraction(1), "m": Fraction(2), "s": Fraction(-3)}
_SECOND: Form = {"s": Fraction(1)}
_DOMAIN_OF_EFFORT: Mapping[frozenset[tuple[str | int, int]], str] = MappingProxyType(
    {
        frozenset({("kg", 1), ("m", 1), ("s", -2)}): "translation",
        frozenset({("kg", 1), ("m", 2), ("s", -2)}): "rotation",
        frozenset({("kg", 1), ("m", -1), ("s", -2)}): "hydraulic",
        frozenset({("kg", 1), ("m", 2), ("s", -3), ("A", -1)}): "electrical",
        frozenset({("K", 1)}): "thermal",
    }
)
# Factors of geometry and calculus, as in pi d^4 / 32; any other number may hide a unit (9.81).
_PLAIN_NUMBERS = frozenset({1, 2, 3, 4, 6, 8, 12, 16, 32, 64, 128})
# Of a pure number, giving a pure number; and of anything, giving a pure number.
_PURE = (
    sympy.exp,
    sympy.log,
    sympy.erf,
    sympy.functions.elementary.trigonometric.TrigonometricFunction,
)
_PURE += (sympy.functions.elementary.trigonometric.InverseTrigonometricFunction,)
_PURE += (sympy.functions.elementary.hyperbolic.HyperbolicFunction,)
_PURE += (sympy.functions.elementary.hyperbolic.InverseHyperbolicFunction,)
_COUNTS = (sympy.sign, sympy.Heaviside, sympy.atan2)


@dataclass(frozen=True)
class Dimensions:
    """Units of a graph's variables, as far as its parameters' units tell them.

    Attributes
    ----------
    units : mapping of str to str or None
        SI unit of every port variable and state by qualified name, such as
        ``rear.mass.p``; None where nothing is known.
    domains : mapping of str to str
        ``translation``, ``rotation``, ``hydraulic``, ``electrical``,
        ``thermal`` or ``unknown`` by name of bond and of element; a two-port
        has its two sides', such as ``rotation>translation``.
    problems : tuple of str
        Where units contradict each other: the element and both claims.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> dimensions = infer(bicycle_brake.graph())
    >>> dimensions.units["rear.mass.p"], dimensions.units["wheel.spokes.q"]
    ('N*s', 'rad')
    >>> dimensions.domains["rotor_radius"], dimensions.problems
    ('rotation>translation', ())
    """

    units: Mapping[str, str | None]
    domains: Mapping[str, str]
    problems: tuple[str, ...] = ()


def infer(graph: BondGraph) -> Dimensions:
    """Infer the units of a graph's port variables and states.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    Dimensions
        Never an error: contradictions are reported in ``problems``.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import C, One, Sf, assemble
    >>> k, w = sympy.symbols("k w", positive=True)
    >>> shaft = Sf("motor", w) >> One("shaft") >> C("spring", stiffness=k)
    >>> infer(assemble("g", shaft, parameters={k: (3, "N*m/rad"), w: (1, "rad/s")})).units["spring.q"]
    'rad'
    >>> infer(assemble("g", shaft, parameters={k: (3, "N/m"), w: (1, "rad/s")})).problems[0]
    "C 'spring' (k in N/m) takes effort in N and flow in m/s, but Sf 'motor' (w in rad/s) makes it N*m and rad/s here"
    """
    regions = _Regions(graph)
    symbols = _Symbols(graph, regions)
    claims = _claims(graph, regions, symbols)
    solver = _Solver(claims)
    solver.run()
    units = {
        f"{name}.{key}": _display(symbol, element, symbols, solver)
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
        if key != "speed"
    }
    domains = {
        bond.name: solver.domain(regions.of_bond[index]) for index, bond in enumerate(graph.bonds)
    }
    domains |= {
        name: _domain(element, regions, name, solver) for name, element in graph.elements.items()
    }
    return Dimensions(
        MappingProxyType(units), MappingProxyType(domains), (*symbols.problems, *solver.problems)
    )


def _display(
    symbol: sympy.Symbol, element: Element, symbols: _Symbols, solver: _Solver
) -> str | None:
    form = solver.resolved(symbols.variables[symbol])
    region = next((key for key in symbols.variables[symbol] if isinstance(key, int)), None)
    if any(isinstance(key, int) for key in form):
        return None
    domain = DISPLAY.get(solver.domain(region)) if region is not None else None
    if domain is None:
        return _unit(form) if form else ""
    state = element.state if isinstance(element, Storage) else None
    if symbol is state:
        return domain[2] if isinstance(element, C) else domain[3]
    effort = symbols.variables[symbol] == {region: 1}
    return domain[0] if effort else domain[1]


def _domain(element: Element, regions: _Regions, name: str, solver: _Solver) -> str:
    if not isinstance(element, TwoPort):
        at = regions.at[name]
        return solver.domain(regions.of_bond[at[0]]) if at else UNKNOWN
    sides = [solver.domain(regions.of_bond[bond]) for bond in regions.sides(name)]
    return sides[0] if sides[0] == sides[1] else ">".join(sides)


def unit_of(form: Mapping[str | int, Fraction]) -> str:
    """Write a product of powers of base units as a unit.

    Examples
    --------
    >>> unit_of({"kg": Fraction(1), "s": Fraction(-2), "m": Fraction(2)})
    'kg*m^2/s^2'
    """
    order = {base: place for place, base in enumerate(_BASE.values())}
    items = sorted(
        form.items(), key=lambda item: (order.get(str(item[0]), len(order)), str(item[0]))
    )
    above = [_factor(base, power) for base, power in items if power > 0]
    below = [_factor(base, -power) for base, power in items if power < 0]
    bottom = below[0] if len(below) == 1 else f"({'*'.join(below)})"
    return ("*".join(above) or "1") + (f"/{bottom}" if below else "")


def _factor(base: str | int, power: Fraction) -> str:
    if power == 1:
        return str(base)
    return f"{base}^{power}" if power.denominator == 1 else f"{base}^({power})"


def _times(*forms: Mapping[str | int, Fraction]) -> Form:
    product: Form = {}
    for form in forms:
        for base, power in form.items():
            product[base] = product.get(base, Fraction(0)) + power
    return {base: power for base, power in product.items() if power}


def _power(form: Mapping[str | int, Fraction], power: Fraction | int) -> Form:
    return {base: value * power for base, value in form.items() if power}


def _per(above: Mapping[str | int, Fraction], below: Mapping[str | int, Fraction]) -> Form:
    return _times(above, _power(below, -1))


class _Regions:
    """Bonds that share the dimension of their effort: all that meet at junctions."""

    def __init__(self, graph: BondGraph) -> None:
        self.graph = graph
        self.at: dict[str, list[int]] = {name: [] for name in graph.elements}
        for index, bond in enumerate(graph.bonds):
            self.at[bond.tail].append(index)
            self.at[bond.head].append(index)
        self.of_bond = [-1] * len(graph.bonds)
        count = 0
        for start in range(len(graph.bonds)):
            if self.of_bond[start] < 0:
                self._flood(start, count)
                count += 1

    def _flood(self, start: int, region: int) -> None:
        stack = [start]
        while stack:
            index = stack.pop()
            if self.of_bond[index] >= 0:
                continue
            self.of_bond[index] = region
            bond = self.graph.bonds[index]
            for name in (bond.tail, bond.head):
                if not isinstance(self.graph.elements[name], TwoPort):
                    stack.extend(self.at[name])

    def sides(self, name: str) -> tuple[int, int]:
        """Return in and out bond of a two-port: by arrows, by order where arrows do not tell."""
        first, second = self.at[name]
        bonds = self.graph.bonds
        if bonds[first].tail == name and bonds[second].head == name:
            return second, first
        return first, second


class _Symbols:
    """Dimension of every symbol: port variables by region, parameters and inputs by unit."""

    def __init__(self, graph: BondGraph, regions: _Regions) -> None:
        self.graph = graph
        self.problems: list[str] = []
        self.claims: list[_Claim] = []
        self.variables: dict[sympy.Basic, Form] = {TIME: _SECOND}
        for name, element in graph.elements.items():
            self._element(name, element, regions)
        rows = graph.parameters
        self.speaks = any(row.unit for row in rows.values()) or any(graph.inputs.values())
        self.units: dict[sympy.Basic, str] = {
            symbol: row.unit for symbol, row in rows.items() if row.unit
        }
        self.units |= {symbol: unit for symbol, unit in graph.inputs.items() if unit}
        self.given: dict[sympy.Basic, Form | None] = {}
        for symbol, unit in self.units.items():
            self.given[symbol] = self.vector(unit, f"{symbol}")
        for symbol, row in rows.items():
            self._parameter(symbol, row)

    def _element(self, name: str, element: Element, regions: _Regions) -> None:
        bonds = regions.at[name]
        if not bonds:
            self.variables |= dict.fromkeys(element.symbols.values(), {})
            return
        pairs = [("", bonds[0])]
        if isinstance(element, TwoPort):
            pairs = list(zip(("_in", "_out"), regions.sides(name), strict=True))
        found = element.symbols
        for suffix, bond in pairs:
            effort: Form = {regions.of_bond[bond]: Fraction(1)}
            flow = _per(_POWER, effort)
            values = {"e": effort, "f": flow, "speed": flow}
            values |= {"q": _times(flow, _SECOND), "p": _times(effort, _SECOND)}
            self.variables |= {
                found[f"{key}{suffix}"]: form
                for key, form in values.items()
                if f"{key}{suffix}" in found
            }

    def _parameter(self, symbol: sympy.Symbol, row: Parameter) -> None:
        """Read a derived parameter's expression; check it against the unit it declares."""
        known = self.dimension(symbol)
        if not row.derived:
            return
        reader = _Reader(self, f"parameter {symbol.name!r}")
        found = reader.read(row.value)
        if row.unit and known is not None and found is not None and found.anchored:
            words = (f"is declared in {row.unit}, that is", f"but its expression {row.value} is in")
            reader.claim(known, found.form, *words)
        self.claims += reader.claims

    def dimension(self, symbol: sympy.Basic) -> Form | None:
        """Return the dimension of a parameter or input; None where its unit is not said."""
        if symbol not in self.given:
            self.given[symbol] = None  # a parameter defined in a circle has no dimension
            row = self.graph.parameters.get(symbol)
            if row is not None and row.derived:
                found = _Reader(self, f"parameter {symbol}").read(row.value)
                self.given[symbol] = found.form if found is not None and found.anchored else None
            elif row is not None and (row.meaning or row.source) and self.speaks:
                self.given[symbol] = {}  # documented, among others with units: a pure number
        return self.given[symbol]

    def vector(self, unit: str, user: str) -> Form | None:
        """Return a unit's dimension; a unit that cannot be read is a problem."""
        from .units import _parse

        try:
            dimension = _parse(unit).dimensionality
        except ParameterError as error:
            self.problems.append(f"{user}: {error}")
            return None
        return {
            _BASE.get(base, base): Fraction(power).limit_denominator(64)
            for base, power in dimension.items()
        }

    def shown(self, laws: Iterable[sympy.Expr]) -> str:
        """Name the units that laws rest on, for messages."""
        used = {symbol for law in laws for symbol in law.free_symbols if symbol in self.units}
        names = [f"{symbol} in {self.units[symbol]}" for symbol in sorted(used, key=str)]
        return f" ({', '.join(names[:3])}{', ...' if len(names) > 3 else ''})" if names else ""


@dataclass(frozen=True)
class _Claim:
    """Two forms that must have one dimension, and who says so.

    A firm claim is an element's law; others decide only where no law does.
    """

    left: Form
    right: Form
    origin: str
    words: tuple[str, str]
    firm: bool = False
    two_port: bool = False


@dataclass(frozen=True)
class _Value:
    """What an expression's dimension is, and whether a unit that somebody declared says so."""

    form: Form
    anchored: bool


class _Reader:
    """Walks expressions; None stands for a dimension that is not known."""

    def __init__(self, symbols: _Symbols, origin: str) -> None:
        self.symbols = symbols
        self.origin = origin
        self.claims: list[_Claim] = []

    def claim(self, left: Form, right: Form, *words: str, **marks: bool) -> None:
        """Ask that two forms agree."""
        self.claims.append(_Claim(left, right, self.origin, (words[0], words[1]), **marks))

    def read(self, expression: sympy.Basic) -> _Value | None:
        """Return the dimension of an expression."""
        if expression.is_Symbol:
            return self._symbol(expression)
        if expression.is_number:
            return _Value({}, False) if _is_plain(expression) else None
        if isinstance(expression, sympy.Mul):
            return self._product(expression)
        if isinstance(expression, _PURE):
            self._pure(expression)
            return _Value({}, False)
        if isinstance(expression, sympy.Pow):
            return self._power(expression)
        if isinstance(expression, sympy.Abs):
            return self.read(expression.args[0])
        if isinstance(expression, sympy.Add | sympy.Min | sympy.Max):
            return self._alike(expression.args, expression)
        if isinstance(expression, _COUNTS):
            self._alike(
                expression.args[:2] if isinstance(expression, sympy.atan2) else (), expression
            )
            return _Value({}, False)
        if isinstance(expression, sympy.Piecewise):
            return self._piecewise(expression)
        return None

    def _symbol(self, symbol: sympy.Basic) -> _Value | None:
        if symbol in self.symbols.variables:
            return _Value(self.symbols.variables[symbol], False)
        known = self.symbols.dimension(symbol)
        return None if known is None else _Value(known, True)

    def _product(self, expression: sympy.Mul) -> _Value | None:
        values = [self.read(factor) for factor in expression.args]
        known = [value for value in values if value is not None]
        if len(known) < len(values):
            return None
        anchored = any(value.anchored for value in known)
        number = expression.as_coeff_Mul()[0]
        if not anchored and number not in (1, -1):
            return None
        return _Value(_times(*(value.form for value in known)), anchored)

    def _power(self, expression: sympy.Pow) -> _Value | None:
        base, exponent = expression.args
        if isinstance(exponent, sympy.Rational):
            value = self.read(base)
            fraction = Fraction(int(exponent.p), int(exponent.q))
            return None if value is None else _Value(_power(value.form, fraction), value.anchored)
        self._must_be_pure(exponent, f"the exponent {exponent}")
        if base.is_number:
            return _Value({}, False)
        value = self.read(base)
        return value if value is not None and not value.form else None

    def _pure(self, expression: sympy.Expr) -> None:
        for argument in expression.args:
            self._must_be_pure(argument, f"the argument of {expression.func.__name__}")

    def _must_be_pure(self, argument: sympy.Basic, what: str) -> None:
        value = self.read(argument)
        if value is not None and value.anchored:
            self.claim(value.form, {}, f"has {what} in", "where a pure number is wanted:")

    def _alike(self, terms: Iterable[sympy.Basic], whole: sympy.Basic) -> _Value | None:
        """Return the dimension that all terms of a sum have."""
        known = [(term, value) for term in terms if (value := self.read(term)) is not None]
        firm = [(term, value) for term, value in known if value.anchored]
        for term, value in firm[1:]:
            if value.form != firm[0][1].form:
                words = (f"has {firm[0][0]} in", f"joined to {term} in")
                self.claim(firm[0][1].form, value.form, *words)
        rest = [value for term, value in known if not term.is_number]
        return firm[0][1] if firm else (rest[0] if len(rest) == len(known) and rest else None)

    def _piecewise(self, expression: sympy.Piecewise) -> _Value | None:
        for _, condition in expression.args:
            for relation in condition.atoms(sympy.core.relational.Relational):
                self._alike(relation.args, relation)
        return self._alike([value for value, _ in expression.args], expression)


def _is_plain(number: sympy.Expr) -> bool:
    """Whether a number is one of geometry and calculus, which carry no unit."""
    rational, rest = number.as_coeff_Mul()
    if not isinstance(rational, sympy.Rational) or abs(rational.p) not in _PLAIN_NUMBERS | {0}:
        return False
    if rational.q not in _PLAIN_NUMBERS:
        return False
    return all(
        base in (sympy.pi, sympy.S.One) or base in (2, 3)
        for base in (factor.as_base_exp()[0] for factor in sympy.Mul.make_args(rest))
    )


def _claims(graph: BondGraph, regions: _Regions, symbols: _Symbols) -> list[_Claim]:
    """Gather what parameters, laws and outputs say, in the order written."""
    claims = list(symbols.claims)
    for name, element in graph.elements.items():
        if not regions.at[name]:
            continue
        laws = _laws(element)
        users = [element.ratio] if isinstance(element, TwoPort) else [law for _, law, _ in laws]
        reader = _Reader(symbols, f"{element.kind} {name!r}{symbols.shown(users)}")
        if isinstance(element, TwoPort):
            _two_port_claims(element, reader)
        for variable, law, what in laws:
            value = reader.read(law)
            if value is not None and value.anchored:
                words = (f"has {what} in", "but its law gives")
                reader.claim(symbols.variables[variable], value.form, *words, firm=what in _FIRM)
        claims += reader.claims
    for name, output in graph.outputs.items():
        unit = symbols.vector(output.unit, f"output {name!r}") if output.unit else None
        reader = _Reader(symbols, f"output {name!r}")
        value = reader.read(output.expression)
        if unit is not None and value is not None:
            words = (f"is declared in {output.unit}, that is", "but its expression is in")
            reader.claim(unit, value.form, *words)
        claims += reader.claims
    return claims


_FIRM = ("effort", "flow")


def _laws(element: Element) -> list[tuple[sympy.Symbol, sympy.Expr, str]]:
    """Return variable, law and what it is, once for each independent law of a one-port."""
    if not isinstance(element, OnePort):
        return []
    laws: list[tuple[sympy.Symbol, sympy.Expr | None, str]] = []
    if isinstance(element, Storage):
        main = "effort" if isinstance(element, C) else "flow"
        laws = [
            (element.coenergy, element.law, main),
            (element.state, element.initial, "its initial state"),
        ]
    elif isinstance(element, Friction):
        laws = [(element.e, element.kinetic, "effort")]
        if element.breakaway != element.kinetic.xreplace({element.speed: sympy.S.Zero}):
            laws.append((element.e, element.breakaway, "its breakaway"))
        laws.append((element.f, element.smoothing, "its smoothing width"))
    elif isinstance(element, Se):
        laws = [(element.e, element.effort, "effort")]
    elif isinstance(element, Sf):
        laws = [(element.f, element.flow, "flow")]
    elif isinstance(element, R):
        laws = [(element.e, element.effort, "effort")]
        if element.effort is None:
            laws = [(element.f, element.flow, "flow")]
    return [(variable, law, what) for variable, law, what in laws if law is not None]


def _two_port_claims(element: TwoPort, reader: _Reader) -> None:
    value = reader.read(element.ratio)
    if value is None or not value.anchored:
        return
    variables = reader.symbols.variables
    above = variables[element.e_in]
    below = variables[element.e_out if isinstance(element, TF) else element.f_out]
    reader.claim(_per(above, below), value.form, "", "", two_port=True)


class _Solver:
    """Finds the effort of each region: by vote of what stands in it, then through two-ports."""

    def __init__(self, claims: list[_Claim]) -> None:
        self.claims = claims
        self.effort: dict[int, Form] = {}
        self.origin: dict[int, str] = {}
        self.problems: list[str] = []

    def run(self) -> None:
        """Solve, then check every claim."""
        self._vote()
        self._propagate()
        for claim in self.claims:
            if not self._holds(claim):
                self.problems.append(self._message(claim))
        self.problems = list(dict.fromkeys(self.problems))

    def resolved(self, form: Form) -> Form:
        """Put in the efforts that are known."""
        regions = [key for key in form if isinstance(key, int) and key in self.effort]
        rest = {key: power for key, power in form.items() if key not in regions}
        return _times(
            rest, *(_power(self.effort[key], form[key]) for key in regions if isinstance(key, int))
        )

    def domain(self, region: int) -> str:
        """Name the domain of a region."""
        return _domain_of(self.effort.get(region))

    def _vote(self) -> None:
        """Let the claims on a single region decide: most voices, then a named domain, then the first."""
        for firm in (True, False):
            voices: dict[int, dict[tuple[str, str], Form]] = {}
            for claim in self.claims:
                found = _solved(_per(claim.left, claim.right)) if claim.firm is firm else None
                if found is not None and found[0] not in self.effort:
                    voices.setdefault(found[0], {})[claim.origin, claim.words[0]] = found[1]
            for region, said in voices.items():
                count = Counter(frozenset(form.items()) for form in said.values())
                self.effort[region], self.origin[region] = max(
                    ((form, origin) for (origin, _), form in said.items()),
                    key=lambda item: (
                        count[frozenset(item[0].items())],
                        _domain_of(item[0]) != UNKNOWN,
                    ),
                )

    def _propagate(self) -> None:
        """Carry efforts to further regions, until nothing changes."""
        waiting: dict[int, list[_Claim]] = {}
        for claim in self.claims:
            for key in {*claim.left, *claim.right}:
                if isinstance(key, int):
                    waiting.setdefault(key, []).append(claim)
        ready = deque(self.effort)
        while ready:
            for claim in waiting.pop(ready.popleft(), []):
                found = _solved(self.resolved(_per(claim.left, claim.right)))
                if found is not None:
                    self.effort[found[0]], self.origin[found[0]] = found[1], claim.origin
                    ready.append(found[0])

    def _holds(self, claim: _Claim) -> bool:
        rest = self.resolved(_per(claim.left, claim.right))
        return not rest or any(isinstance(key, int) for key in rest)

    def _message(self, claim: _Claim) -> str:
        left, right = self.resolved(claim.left), self.resolved(claim.right)
        if claim.two_port:
            return self._two_port_message(claim, left, right)
        asked = _solved(_per(claim.left, claim.right))
        domains = set() if asked is None else {_domain_of(asked[1]), self.domain(asked[0])}
        if asked is not None and claim.firm and DISPLAY.keys() >= domains:
            mine, here = DISPLAY[_domain_of(asked[1])], DISPLAY[self.domain(asked[0])]
            return (
                f"{claim.origin} takes effort in {mine[0]} and flow in {mine[1]}, "
                f"but {self.origin[asked[0]]} makes it {here[0]} and {here[1]} here"
            )
        regions = [key for key in _per(claim.left, claim.right) if isinstance(key, int)]
        because = "; ".join(
            f"effort is in {_unit(self.effort[region])} here by {self.origin[region]}"
            for region in sorted(regions)
        )
        return f"{claim.origin} {claim.words[0]} {_unit(left)}, {claim.words[1]} {_unit(right)}" + (
            f" ({because})" if because else ""
        )

    def _two_port_message(self, claim: _Claim, left: Form, right: Form) -> str:
        regions = sorted(key for key in claim.left if isinstance(key, int))
        sides = " and ".join(
            f"effort in {_unit(self.effort[region])} by {self.origin[region]}" for region in regions
        )
        joined = sides or "two sides of one effort"
        return f"{claim.origin} joins {joined}, which takes a ratio in {_unit(left)}, not in {_unit(right)}"


def _solved(rest: Form) -> tuple[int, Form] | None:
    """Solve ``rest = 1`` for the effort of its only region.

    None where it has none or more, or where the effort would take roots of
    units: then effort times flow is no power, as in pseudo bond graphs.
    """
    regions = [key for key in rest if isinstance(key, int)]
    if len(regions) != 1:
        return None
    power = rest[regions[0]]
    known = {key: value for key, value in rest.items() if key != regions[0]}
    effort = _power(known, -1 / power)
    whole = all(exponent.denominator == 1 for exponent in effort.values())
    return (regions[0], effort) if whole else None


def _domain_of(effort: Form | None) -> str:
    return UNKNOWN if effort is None else _DOMAIN_OF_EFFORT.get(frozenset(effort.items()), UNKNOWN)


def _unit(form: Form) -> str:
    """Write a dimension for a message, by a name where there is one."""
    for efforts, flows, displacement, momentum in DISPLAY.values():
        for name in (efforts, flows, displacement, momentum):
            if _NAMED.get(name) == form:
                return name
    return "a pure number" if not form else unit_of(form)


def _named() -> dict[str, Form]:
    """Dimensions of the units that have a name of their own."""
    found: dict[str, Form] = {}
    for key, domain in _DOMAIN_OF_EFFORT.items():
        effort: Form = {base: Fraction(power) for base, power in key}
        flow = _per(_POWER, effort)
        forms = (effort, flow, _times(flow, _SECOND), _times(effort, _SECOND))
        found |= dict(zip(DISPLAY[domain], forms, strict=True))
    del found["rad"], found["rad/s"]
    return found


_NAMED = _named()
