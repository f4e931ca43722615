"""Model files: a bond graph as TOML, read and written without running any code.

The format is described in docs/model_files.md. Elements keep their qualified
names: submodels are written flat, and states keep their names.
"""

from __future__ import annotations

import difflib
import itertools
import json
import math
import re
import tomllib
from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import sympy

from .bonds import Bond
from .elements import GY, TF, C, Element, Friction, I, One, R, Se, Sf, Zero
from .errors import BondGraphError, GraphError, LawError, ModelError, ParameterError
from .expressions import parse, to_text
from .graph import TIME, BondGraph, assemble
from .laws import exact
from .parameters import Parameter
from .units import parse_unit

SCHEMA = 1
MAX_BYTES = 5_000_000


@dataclass(frozen=True)
class Kind:
    """How one kind of element stands in a file.

    Attributes
    ----------
    build : type
        The element's class.
    laws : mapping of str to str
        Keyword of the law, as in Python, to the variable that its text may
        use by its bare letter; empty where the law is no function.
    required : str
        The law that must be given, where there is no choice.

    Examples
    --------
    >>> KINDS["R"].laws["effort"]
    'f'
    """

    build: type[Any]
    laws: Mapping[str, str] = field(default_factory=dict)
    required: str = ""

    @property
    def variables(self) -> dict[str, dict[str, bool]]:
        """Port variables and states, with what their symbols assume."""
        names = [item.name for item in fields(self.build)]
        return {name: VARIABLES[name] for name in names if name in VARIABLES}


VARIABLES: Mapping[str, dict[str, bool]] = MappingProxyType(
    {
        "e": {"real": True},
        "f": {"real": True},
        "q": {"real": True},
        "p": {"real": True},
        "e_in": {"real": True},
        "f_in": {"real": True},
        "e_out": {"real": True},
        "f_out": {"real": True},
        "speed": {"nonnegative": True},
    }
)
KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "Se": Kind(Se, {"effort": "f"}, "effort"),
        "Sf": Kind(Sf, {"flow": "e"}, "flow"),
        "R": Kind(R, {"resistance": "", "effort": "f", "flow": "e"}),
        "C": Kind(
            C, {"capacitance": "", "stiffness": "", "effort": "q", "energy": "q", "initial": ""}
        ),
        "I": Kind(I, {"inertance": "", "flow": "p", "energy": "p", "initial": ""}),
        "Friction": Kind(
            Friction, {"kinetic": "speed", "breakaway": "", "smoothing": ""}, "kinetic"
        ),
        "TF": Kind(TF, {"ratio": ""}, "ratio"),
        "GY": Kind(GY, {"ratio": ""}, "ratio"),
        "Zero": Kind(Zero),
        "One": Kind(One),
    }
)
ALIASES: Mapping[str, str] = MappingProxyType({"0": "Zero", "1": "One"})
TABLES = ("ports", "parameters", "inputs", "outputs")
TOP = ("schema", "name", "elements", "bonds", *TABLES)
PARAMETER = ("value", "unit", "meaning", "source", "assume")
ASSUMPTIONS = (
    *("real", "positive", "nonnegative", "negative", "nonpositive", "nonzero", "zero"),
    *("integer", "even", "odd", "rational", "irrational", "finite", "complex", "commutative"),
)


def load(path: str | Path) -> BondGraph:
    """Read a bond graph from a model file.

    Parameters
    ----------
    path : str or Path
        A TOML file of at most 5 MB.

    Returns
    -------
    BondGraph

    Raises
    ------
    BondGraphError
        `ModelError`, `GraphError`, `ParameterError` or `LawError`: in one line
        the file, the table and key at fault, and the remedy.

    Examples
    --------
    >>> load("missing.toml")
    Traceback (most recent call last):
    ...
    bondgraph.errors.ModelError: missing.toml: there is no such file; check the path
    """
    return loads(_read(Path(path)), str(path))


def save(graph: BondGraph, path: str | Path) -> Path:
    """Write a bond graph to a model file that `load` reads again.

    Parameters
    ----------
    graph : BondGraph
    path : str or Path
        Overwritten if it exists.

    Returns
    -------
    Path

    Raises
    ------
    BondGraphError
        If a law cannot be written, or the file not be made.

    Examples
    --------
    >>> import tempfile
    >>> from bondgraph.models import mass_on_belt
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     load(save(mass_on_belt.graph(), Path(folder) / "belt.toml"))
    BondGraph('mass_on_belt', 7 elements, 6 bonds)
    """
    path = Path(path)
    text = dumps(graph)
    with _at(f"model {graph.name!r} would not load again"):
        loads(text, "as written")
    try:
        path.write_text(text, encoding="utf-8", newline="\n")
    except UnicodeError:
        raise ModelError(
            f"model {graph.name!r} holds characters that are no text; rename"
        ) from None
    except OSError as error:
        raise ModelError(f"{path}: cannot be written ({error.strerror}); check the path") from None
    return path


def loads(text: str, source: str = "model") -> BondGraph:
    """Read a bond graph from the text of a model file.

    Parameters
    ----------
    text : str
    source : str
        What error messages call the text.

    Returns
    -------
    BondGraph

    Raises
    ------
    BondGraphError
        As `load`.

    Examples
    --------
    >>> loads("schema = 2")
    Traceback (most recent call last):
    ...
    bondgraph.errors.ModelError: model: schema is 2; this program reads schema = 1
    """
    with _at(source):
        # tomllib's time grows with the square of a key's parts.
        unquoted = re.sub(r'"(?:[^"\\\n]|\\.)*+"?|\'[^\'\n]*+\'?', "q", text)
        if re.search(r"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){50}", unquoted):
            raise ModelError("a key has more than 50 parts; put names with dots in quotes")
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise ModelError(f"no valid TOML: {error}; correct it there") from None
        except RecursionError:
            raise ModelError("its TOML is nested too deep; model files have two levels") from None
        return _Reader(data).graph()


def dumps(graph: BondGraph) -> str:
    """Write a bond graph as the text of a model file.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    str

    Raises
    ------
    LawError
        If a law uses what the file cannot say.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> v = One("v")
    >>> text = dumps(assemble("rc", Se("E", 12) >> v >> (R("r", 2), C("c", 0.2))))
    >>> print(text.partition("elements")[2].partition("bonds")[0].strip())
    = [
      { name = "E", kind = "Se", effort = 12 },
      { name = "v", kind = "One" },
      { name = "r", kind = "R", resistance = 2 },
      { name = "c", kind = "C", stiffness = 5 },
    ]
    """
    return _Writer(graph).text()


@contextmanager
def _at(place: str) -> Iterator[None]:
    """Say where in the file an error arose, in one line."""
    try:
        yield
    except BondGraphError as error:
        message = " ".join(f"{place}: {error}".split())
        message = message if len(message) <= 1000 else f"{message[:997]}..."
        raise type(error)(message, elements=error.elements, bonds=error.bonds) from None


def _read(path: Path) -> str:
    try:
        if not path.exists():
            raise ModelError(f"{path}: there is no such file; check the path")
        if not path.is_file():
            raise ModelError(f"{path}: this is no file; give a .toml model file")
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ModelError(f"{path}: cannot be read ({reason}); check the path") from None
    if len(data) > MAX_BYTES:
        raise ModelError(f"{path}: larger than {MAX_BYTES // 10**6} MB; this is no model file")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError(f"{path}: byte {error.start} is not UTF-8; save it as UTF-8") from None


class _Names:
    """What names mean in a file: parameters, inputs, time and the elements' variables.

    ``parameters.x`` and ``inputs.x`` are the long forms, for when a short one
    may mean two things.
    """

    def __init__(
        self,
        variables: Mapping[str, sympy.Symbol],
        parameters: Mapping[str, sympy.Symbol],
        inputs: Mapping[str, sympy.Symbol] | None = None,
    ) -> None:
        self.meanings: dict[str, Any] = {}
        tables = {"parameters": parameters, "inputs": inputs or {}}
        for table in tables.values():
            self._add(table.items())
        if "t" not in self.meanings:
            self.meanings["t"] = TIME
        self._add(variables.items())
        if "pi" in self.meanings:  # the constant goes by the same name
            self.meanings["pi"] = _two_meanings("pi")
        for name, table in tables.items():
            self._add((f"{name}.{key}", symbol) for key, symbol in table.items())
        self._spellings: dict[Any, list[str]] = {}
        for name, meaning in self.meanings.items():
            if not isinstance(meaning, str):
                self._spellings.setdefault(meaning, []).append(name)

    def _add(self, items: Iterable[tuple[str, Any]]) -> None:
        for name, symbol in items:
            if self.meanings.setdefault(name, symbol) != symbol:
                self.meanings[name] = _two_meanings(name)

    def within(self, argument: str, symbol: Any) -> Mapping[str, Any]:
        """Add the bare letter of a law's argument."""
        if not argument:
            return self.meanings
        meaning = symbol if argument not in self.meanings else _two_meanings(argument)
        return ChainMap({argument: meaning}, self.meanings)

    def write(self, value: Any, argument: str = "", symbol: Any = None) -> Any:
        """Return a law as it stands in the file: a number, or text."""
        expression = exact(value)
        if (number := _number(expression)) is not None:
            return number
        meanings = self.within(argument, symbol)
        used = {argument: symbol} if symbol in expression.free_symbols else {}
        used = {key: value for key, value in used.items() if meanings[key] == symbol}
        for wanted in expression.free_symbols:
            for name in self._spellings.get(wanted, ()):
                if meanings[name] == wanted:
                    used.setdefault(name, wanted)
                    break
        if "pi" in self.meanings:
            used.setdefault("pi", self.meanings["pi"])
        return to_text(expression, used)


def _two_meanings(name: str) -> str:
    return (
        f"{name!r} may mean two things here; write 'parameters.{name}', 'inputs.{name}' "
        f"or the element's variable in full, such as 'spring.{name}'"
    )


def _number(expression: sympy.Expr) -> int | float | None:
    """Return a number as TOML holds it exactly; None where it cannot."""
    if not isinstance(expression, sympy.Rational):
        return None
    if expression.q == 1 and abs(expression.p) < 2**53:
        return int(expression.p)
    try:
        value = float(expression)
    except OverflowError:
        return None
    return value if math.isfinite(value) and exact(value) == expression else None


class _Reader:
    """Reads one file: symbols first, then laws, then the graph."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.data = data

    def graph(self) -> BondGraph:
        _check_keys(self.data, TOP, "")
        if self.data.get("schema") != SCHEMA or isinstance(self.data["schema"], bool):
            raise ModelError(
                f"schema is {_shown(self.data.get('schema', 'missing'))}; this program reads schema = 1"
            )
        for table in TABLES:
            _table(self.data.get(table, {}), table)
        rows = self._rows()
        parameters = self._symbols("parameters", PARAMETER)
        inputs = self._symbols("inputs", ("unit", "assume"))
        variables = {
            f"{label}.{key}": sympy.Dummy(f"{_local(label)}.{key}", **assumed)
            for label, (kind, _) in rows.items()
            for key, assumed in kind.variables.items()
        }
        names = _Names(variables, parameters, inputs)
        elements = {
            label: _element(label, kind, row, names, variables)
            for label, (kind, row) in rows.items()
        }
        graph = assemble(
            _text(self.data.get("name"), "name"),
            *elements.values(),
            *self._bonds(elements),
            ports=self._ports(elements),
            parameters=self._parameters(parameters),
            inputs=self._inputs(inputs),
            outputs=self._outputs(names),
        )
        return replace(graph, elements=MappingProxyType(_localised(graph.elements)))

    def _rows(self) -> dict[str, tuple[Kind, dict[str, Any]]]:
        given = self.data.get("elements")
        if not isinstance(given, list) or not given:
            raise ModelError(
                "elements is no list; write elements = [{ name = ..., kind = ... }, ...]"
            )
        rows: dict[str, tuple[Kind, dict[str, Any]]] = {}
        for index, row in enumerate(given, 1):
            if not isinstance(row, dict):
                raise ModelError(f"elements, entry {index}: expected a table, got {_shown(row)}")
            label = _text(row.get("name"), f"elements, entry {index}, name")
            if label in rows:
                raise GraphError(f"element {label!r} is there twice; rename one", elements=[label])
            if ">" in label or not all(part.strip() for part in label.split(".")):
                raise GraphError(f"element {label!r}: a name has no '>' and no empty part; rename")
            rows[label] = (self._kind(label, row), row)
        return rows

    def _kind(self, label: str, row: dict[str, Any]) -> Kind:
        name = row.get("kind")
        kind = KINDS.get(ALIASES.get(name, name)) if isinstance(name, str) else None
        if kind is None:
            raise ModelError(
                f"element {label!r}: kind {_shown(name)} is not known; {_nearest(name, KINDS)}"
            )
        where = f"element {label!r} ({ALIASES.get(str(name), name)})"
        _check_keys(row, ("name", "kind", *kind.laws), where)
        if kind.required and kind.required not in row:
            raise LawError(f"{where} needs the key {kind.required!r}", elements=[label])
        return kind

    def _symbols(self, table: str, keys: tuple[str, ...]) -> dict[str, sympy.Symbol]:
        given = self.data.get(table, {})
        symbols = {}
        for name, row in given.items():
            where = f"{table}, {name!r}"
            if table == "inputs" and name in self.data.get("parameters", {}):
                raise ParameterError(f"{where} is a parameter too; keep one of them")
            if not name.strip():
                raise ParameterError(f"{where}: the name is empty; give it a word")
            if not isinstance(row, dict):
                row = given[name] = {keys[0]: row}  # short for { value = ... } or { unit = ... }
            _check_keys(row, keys, where, name)
            symbols[name] = _symbol(name, row.get("assume", "real"), where)
        return symbols

    def _parameters(self, symbols: Mapping[str, sympy.Symbol]) -> dict[sympy.Symbol, Parameter]:
        names = _Names({}, symbols)
        table = {}
        for name, symbol in symbols.items():
            row, where = self.data["parameters"][name], f"parameters, {name!r}"
            value = row.get("value")
            with _at(f"{where}, value"):
                if isinstance(value, str):
                    value = parse(value, names.meanings)
                elif value is not None and (isinstance(value, bool) or not _is_finite(value)):
                    raise ParameterError(
                        f"expected a finite number or a formula, got {_shown(value)}"
                    )
            words = {key: _text(row.get(key, ""), f"{where}, {key}") for key in PARAMETER[1:4]}
            _check_unit(words["unit"], where)
            table[symbol] = Parameter(value, **words)
        return table

    def _inputs(self, symbols: Mapping[str, sympy.Symbol]) -> dict[sympy.Symbol, str]:
        units = {}
        for name, symbol in symbols.items():
            where = f"inputs, {name!r}"
            units[symbol] = _text(self.data["inputs"][name].get("unit", ""), f"{where}, unit")
            _check_unit(units[symbol], where)
        return units

    def _outputs(self, names: _Names) -> dict[str, tuple[sympy.Expr, str, str]]:
        outputs = {}
        for name, row in self.data.get("outputs", {}).items():
            where = f"outputs, {name!r}"
            row = row if isinstance(row, dict) else {"expression": row}
            _check_keys(row, ("expression", "unit", "meaning"), where, name)
            expression = _expression(row.get("expression"), names.meanings, f"{where}, expression")
            words = [_text(row.get(key, ""), f"{where}, {key}") for key in ("unit", "meaning")]
            _check_unit(words[0], where)
            outputs[name] = (expression, words[0], words[1])
        return outputs

    def _bonds(self, elements: Mapping[str, Element]) -> list[Bond]:
        given = self.data.get("bonds", [])
        if not isinstance(given, list):
            raise ModelError('bonds is no list; write bonds = ["a > b", ...]')
        bonds = []
        for index, text in enumerate(given, 1):
            where = f"bonds, entry {index}"
            ends = _text(text, where).split(">")
            if len(ends) != 2:
                raise ModelError(
                    f"{where}: {_shown(text)} is no bond; write 'a > b', power from a to b"
                )
            bonds.append(Bond(*(_end(end, elements, f"{where}, {text!r}") for end in ends)))
        return bonds

    def _ports(self, elements: Mapping[str, Element]) -> dict[str, Element]:
        given = self.data.get("ports", {})
        return {
            port: _end(_text(name, f"ports, {port!r}"), elements, f"ports, {port!r}")
            for port, name in given.items()
        }


def _element(
    label: str,
    kind: Kind,
    row: dict[str, Any],
    names: _Names,
    variables: Mapping[str, sympy.Symbol],
) -> Element:
    """Build an element whose symbols are the ones other laws already use."""
    laws = {}
    for key, argument in kind.laws.items():
        if key in row:
            symbol = variables[f"{label}.{argument}"] if argument else None
            where = f"element {label!r}, {key}"
            law = _expression(row[key], names.within(argument, symbol), where)
            laws[key] = _function(law, symbol) if argument else law
    with _at(f"element {label!r}"):
        try:
            element = kind.build(_local(label), **laws)
        except (TypeError, ValueError, ArithmeticError, RecursionError) as error:
            reason = " ".join(f"{type(error).__name__} {error}".split())[:80]
            raise LawError(f"its law cannot be worked out ({reason}); simplify it") from None
        own = {symbol: variables[f"{label}.{key}"] for key, symbol in _variables(element).items()}
        return element.replaced(own, name=label)


def _function(law: sympy.Expr, argument: Any) -> Callable[[Any], Any]:
    return lambda given: law.xreplace({argument: given})


def _expression(given: Any, meanings: Mapping[str, Any], where: str) -> sympy.Expr:
    with _at(where):
        if isinstance(given, str):
            return parse(given, meanings)
        if isinstance(given, bool) or not _is_finite(given):
            raise LawError(f"expected a finite number or a formula in quotes, got {_shown(given)}")
        return exact(given)


def _is_finite(value: Any) -> bool:
    try:
        return isinstance(value, int | float) and math.isfinite(value)
    except OverflowError:
        return False


def _symbol(name: str, assume: Any, where: str) -> sympy.Symbol:
    words = [assume] if isinstance(assume, str) else assume
    if not isinstance(words, list) or not all(word in ASSUMPTIONS for word in words):
        raise ParameterError(
            f"{where}: assume = {_shown(assume)} is not known; there are {', '.join(ASSUMPTIONS)}"
        )
    try:
        return sympy.Symbol(name, **dict.fromkeys(words, True))
    except ValueError:
        raise ParameterError(
            f"{where}: assume = {_shown(assume)} contradicts itself; keep one"
        ) from None


def _end(name: str, elements: Mapping[str, Element], where: str) -> Element:
    for label in (name, name.strip()):
        if label in elements:
            return elements[label]
    raise GraphError(
        f"{where}: there is no element {name.strip()!r}; {_nearest(name.strip(), elements)}"
    )


def _table(value: Any, where: str) -> None:
    if not isinstance(value, dict):
        raise ModelError(f"{where}: expected a table, got {_shown(value)}; write [{where}]")


def _text(value: Any, where: str) -> str:
    if not isinstance(value, str):
        said = "is missing" if value is None else f"is {_shown(value)}"
        raise ModelError(f"{where} {said}; give it as text in quotes")
    return value


def _check_keys(row: Mapping[str, Any], known: Iterable[str], where: str, name: str = "") -> None:
    for key in row:
        if key not in known:
            hint = _nearest(key, known)
            if name and not hint.startswith("did"):
                hint += f"; a name with a dot stands in quotes: '{name}.{key}'"
            raise ModelError(f"{where}{': ' * bool(where)}unknown key {_shown(key)}; {hint}")


def _check_unit(unit: str, where: str) -> None:
    if unit:
        with _at(where):
            parse_unit(unit)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _nearest(name: Any, known: Iterable[str]) -> str:
    names = list(known)
    near = difflib.get_close_matches(str(name), names, n=3)
    return f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(names[:20])}"


def _local(label: str) -> str:
    return label.rpartition(".")[2]


def _localised(elements: Mapping[str, Element]) -> dict[str, Element]:
    """Give elements of submodels their own short names again; the keys are qualified."""
    return {
        label: element.replaced({}, name=_local(label)) if "." in label else element
        for label, element in elements.items()
    }


class _Writer:
    """Writes one graph, one line an element, bond, parameter and output."""

    def __init__(self, graph: BondGraph) -> None:
        self.graph = graph
        variables = {
            f"{label}.{key}": symbol
            for label, element in graph.elements.items()
            for key, symbol in _variables(element).items()
        }
        self.parameters = {symbol.name: symbol for symbol in graph.parameters}
        inputs = {symbol.name: symbol for symbol in graph.inputs}
        self.names = _Names(variables, self.parameters, inputs)

    def text(self) -> str:
        elements = [self._element(*item) for item in self.graph.elements.items()]
        bonds = [f"{bond.tail} > {bond.head}" for bond in self.graph.bonds]
        lines = [f"schema = {SCHEMA}", f"name = {_toml(self.graph.name)}", ""]
        lines += ["elements = [", *(f"  {_toml(row)}," for row in elements), "]", ""]
        lines += ["bonds = [", *(f"  {_toml(bond)}," for bond in bonds), "]"]
        tables = {
            "ports": dict(self.graph.ports),
            "parameters": self._parameters(),
            "inputs": self._inputs(),
            "outputs": self._outputs(),
        }
        for name, table in tables.items():
            if table:
                lines += ["", f"[{name}]"]
                lines += [f"{_key(key)} = {_toml(value)}" for key, value in table.items()]
        return "\n".join(lines) + "\n"

    def _element(self, label: str, element: Element) -> dict[str, Any]:
        kind = type(element).__name__
        if kind not in KINDS:
            raise ModelError(
                f"element {label!r}: a {kind} has no form in a model file; keep this model in Python"
            )
        row = {"name": label, "kind": kind}
        with _at(f"element {label!r}"):
            for key, law in _laws(element).items():
                argument = KINDS[kind].laws[key]
                symbol = getattr(element, argument) if argument else None
                row[key] = self.names.write(law, argument, symbol)
        return row

    def _parameters(self) -> dict[str, Any]:
        names = _Names({}, self.parameters)
        table = {}
        for symbol, row in self.graph.parameters.items():
            with _at(f"parameter {symbol.name!r}"):
                value = None if row.value is None else names.write(row.value)
                if isinstance(row.value, float):
                    value = float(row.value)
                words = {"unit": row.unit, "meaning": row.meaning, "source": row.source}
                entry = {"value": value, **words, **_assumed(symbol)}
            table[symbol.name] = {
                key: item for key, item in entry.items() if item not in (None, "")
            }
        return table

    def _inputs(self) -> dict[str, Any]:
        return {
            symbol.name: {"unit": unit, **_assumed(symbol)}
            for symbol, unit in self.graph.inputs.items()
        }

    def _outputs(self) -> dict[str, Any]:
        table = {}
        for name, output in self.graph.outputs.items():
            with _at(f"output {name!r}"):
                entry = {"expression": self.names.write(output.expression), "unit": output.unit}
            table[name] = entry | ({"meaning": output.meaning} if output.meaning else {})
        return table


def _laws(element: Any) -> dict[str, sympy.Expr]:
    """Return the keywords that build an element's laws again."""
    if isinstance(element, Se):
        return {"effort": element.effort}
    if isinstance(element, Sf):
        return {"flow": element.flow}
    if isinstance(element, TF | GY):
        return {"ratio": element.ratio}
    if isinstance(element, Friction):
        return _friction_laws(element)
    forms: Iterable[dict[str, Any]] = ()
    if isinstance(element, R):
        forms = _resistor_forms(element)
    elif isinstance(element, C | I):
        forms = _storage_forms(element)
    forms = [{key: law for key, law in form.items() if law is not None} for form in forms]
    forms = [form for form in forms if form]
    chosen = next((form for form in forms if _builds(element, form)), forms[-1] if forms else {})
    initial = getattr(element, "initial", sympy.S.Zero)
    return chosen | ({"initial": initial} if initial != 0 else {})


def _friction_laws(element: Friction) -> dict[str, sympy.Expr]:
    laws = {"kinetic": element.kinetic}
    if element.breakaway != element.kinetic.xreplace({element.speed: sympy.S.Zero}):
        laws["breakaway"] = element.breakaway
    if element.smoothing is not None:
        laws["smoothing"] = element.smoothing
    return laws


def _resistor_forms(element: R) -> Iterator[dict[str, Any]]:
    if element.effort is not None:
        yield {"resistance": _slope(element.effort, element.f)}
        yield {"effort": element.effort}
    yield {"flow": element.flow}
    yield {"effort": element.effort}


def _storage_forms(element: C | I) -> Iterator[dict[str, Any]]:
    direct, inverse = ("effort", "capacitance") if isinstance(element, C) else ("flow", "inertance")
    slope = _slope(element.law, element.state)
    if slope is not None:
        compliance = None if slope == 0 else 1 / slope
        stiff = {"stiffness": slope} if isinstance(element, C) else {}
        simple = compliance is None or slope.count_ops() <= compliance.count_ops()
        yield stiff if simple else {inverse: compliance}
        yield {inverse: compliance}
    yield {direct: element.law}
    yield {"energy": element.energy}
    yield {direct: element.law}


def _slope(law: sympy.Expr, argument: sympy.Symbol) -> sympy.Expr | None:
    """Return the factor of a law that is proportional to its argument."""
    slope = law / argument
    return None if argument in slope.free_symbols else slope


def _builds(element: Any, form: dict[str, sympy.Expr]) -> bool:
    """Whether the keywords give an element with the very same laws."""
    arguments = KINDS[type(element).__name__].laws
    laws = {
        key: _function(law, getattr(element, arguments[key])) if arguments[key] else law
        for key, law in form.items()
    }
    try:
        twin = type(element)(_local(element.name), **laws)
    except (BondGraphError, TypeError, ValueError):
        return False
    own = {symbol: getattr(element, key) for key, symbol in _variables(twin).items()}
    twin = twin.replaced(own)
    return all(
        getattr(element, item.name) == getattr(twin, item.name)
        for item in fields(element)
        if item.name not in (*VARIABLES, "name", "initial")
    )


def _variables(element: Any) -> dict[str, sympy.Symbol]:
    """Return an element's port variables and states by attribute name."""
    return {
        item.name: getattr(element, item.name) for item in fields(element) if item.name in VARIABLES
    }


def _assumed(symbol: sympy.Symbol) -> dict[str, Any]:
    """Return the fewest words that give the symbol's assumptions; none for a real symbol."""
    true = [word for word in ASSUMPTIONS if symbol.assumptions0.get(word)]
    choices = (words for count in range(4) for words in itertools.combinations(true, count))
    for words in (("real",), *choices):
        if sympy.Symbol(symbol.name, **dict.fromkeys(words, True)) == symbol:
            if words == ("real",):
                return {}
            return {"assume": words[0] if len(words) == 1 else list(words)}
    raise ParameterError(
        f"{symbol.name!r} assumes what a file cannot say ({symbol.assumptions0}); "
        f"there are {', '.join(ASSUMPTIONS)}"
    )


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_toml(item)}' for key, item in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return repr(value)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _toml(name)
