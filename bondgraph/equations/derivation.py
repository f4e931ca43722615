"""Derivation: each element writes its equations, then all are put in order and solved."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import replace

import sympy

from ..blocks import SingularLoopError, order_and_solve
from ..blocks.residues import PRIME, Residues
from ..causality import CausalGraph, assign_causality
from ..codegen.collector import held_back
from ..elements import (
    TF,
    C,
    DryFriction,
    EffortSource,
    Element,
    FlowSource,
    One,
    R,
    SignalBlock,
    Storage,
    Switched,
    TwoPort,
    Zero,
)
from ..errors import CausalConflictError, LawError
from ..graph import BondGraph
from ..rates import Rates
from ..terms import renamed, signed_sum
from .accounts import Accounts
from .nets import Nets
from .value import Contact, Equations, assert_closed

# So many sets of storages are tried as dependent where a loop of junctions binds states.
MAX_DEPENDENT_CHOICES = 60


@held_back()
def derive(graph: BondGraph | CausalGraph) -> Equations:
    """Derive the state equations.

    Parameters
    ----------
    graph : BondGraph or CausalGraph
        Causality is assigned first where it is not yet.

    Returns
    -------
    Equations

    Raises
    ------
    BondGraphError
        A named diagnosis: causal conflict, singular loop, unusable law.

    Examples
    --------
    >>> from bondgraph import I, One, R, Se, assemble
    >>> v = One("v")
    >>> equations = derive(assemble("cart", Se("F", 6) >> v >> (I("m", 2), R("b", 4))))
    >>> [str(rate) for rate in equations.explicit().values()]
    ['6 - 2*m.p']
    """
    causal = graph if isinstance(graph, CausalGraph) else assign_causality(graph)
    return _with_hidden_constraints(causal)


def _with_hidden_constraints(causal: CausalGraph) -> Equations:
    """Derive; where a loop of junctions turns out to bind states, make one of them dependent.

    Strokes do not know signs and ratios: terms that cancel round a loop can relate storages
    that causality takes for independent.
    """
    try:
        return _Derivation(causal).equations()
    except SingularLoopError as singular:
        queue: list[tuple[tuple[str, ...], SingularLoopError]] = [((), singular)]
        tried: set[frozenset[str]] = set()
        while queue and len(tried) < MAX_DEPENDENT_CHOICES:
            chosen, loop = queue.pop()
            for more in _bound(causal.graph, loop, chosen):
                dependent = (*chosen, more)
                if frozenset(dependent) in tried:
                    continue
                tried.add(frozenset(dependent))
                try:
                    revised = assign_causality(causal.graph, dependent)
                    return _Derivation(revised).equations(checked=True)
                except SingularLoopError as deeper:
                    queue.append((dependent, deeper))
                except (CausalConflictError, _NotDependentError):
                    continue
        raise


def _bound(graph: BondGraph, loop: SingularLoopError, chosen: tuple[str, ...]) -> list[str]:
    """Return the storages that a singular loop binds, the last written first, then the switches.

    What open switches decide may be bound as well: then one of them has to decide its other
    variable.
    """
    names = {symbol.name.rpartition(".")[0] for symbol in loop.bound if symbol.is_Symbol}
    stores = [name for name, _ in graph.of(Storage) if name in names and name not in chosen]
    switches = [name for name, _ in graph.of(Switched) if name in names and name not in chosen]
    return [*stores[::-1], *switches[::-1]]


class _NotDependentError(Exception):
    """A storage said to be dependent has a state that its own answer decides."""


class _Derivation:
    """Builds the tables of variables, then orders and solves them."""

    def __init__(self, causal: CausalGraph) -> None:
        self.causal = causal
        self.graph = causal.graph
        self.integral = frozenset(causal.integral)
        self.nets = Nets(self.graph)
        self.explicit: dict[sympy.Symbol, sympy.Expr] = {}
        self.implicit: dict[sympy.Symbol, sympy.Expr] = {}
        self.states: dict[sympy.Symbol, sympy.Symbol] = {}
        self.initial: list[sympy.Expr] = []
        self.contacts: list[Contact] = []
        self.dependent: dict[str, sympy.Expr] = {}
        self.storage: dict[str, sympy.Symbol] = {}
        self.switches: dict[str, sympy.Symbol] = {}
        self.effort_out: dict[int, str] = {
            index: stroke.effort_out_of for index, stroke in enumerate(causal.strokes)
        }
        self.names = self._port_variables()
        self.answers = {
            self._conjugate(element)
            for name, element in self.graph.of(Storage)
            if name not in self.integral
        }
        self.signals: dict[sympy.Symbol, sympy.Symbol] = {}

    def equations(self, checked: bool = False) -> Equations:
        """Write all equations, order them, and check that nothing is left over.

        With ``checked``, dependent storages are not taken for dependent on the word of strokes.
        """
        for name, element in self.graph.elements.items():
            self._write(name, self._listening(element))
        if checked:
            self._check_dependence()
        heard = {signal: variable for variable, signal in self.signals.items()}
        rates = Rates(
            self.explicit, self.implicit, self.states, self.graph.inputs, self.answers, heard
        )
        self._dependent_storages(rates)
        rates.finish()
        self._forget_signals()
        accounts = Accounts(self.graph, self.nets, self._local)
        energies = accounts.energies()
        supplied = accounts.supplied() | self._modulated_storages(rates, energies)
        outputs = {
            name: self._local(output.expression) for name, output in self.graph.outputs.items()
        }
        ordered = order_and_solve(self.explicit, self.implicit)
        inputs = (*self.graph.inputs, *rates.input_rates.values())
        result = Equations(
            name=self.graph.name,
            states=tuple(self.states),
            inputs=inputs,
            parameters=self._used_parameters(
                (expression for _, expression in ordered.assignments),
                ordered.residuals,
                outputs.values(),
                (energy for energy in energies.values() if energy is not None),
            ),
            algebraic=ordered.algebraic,
            residuals=ordered.residuals,
            assignments=ordered.assignments,
            derivatives=tuple(self.states.values()),
            outputs=outputs,
            initial=tuple(self.initial),
            contacts=tuple(self.contacts),
            supplied=supplied,
            dissipated=accounts.dissipated(),
            energies=energies,
            dependent=self.dependent,
            loops=ordered.loops,
            causal=self.causal,
            ports=self._ports(),
            input_rates=dict(rates.input_rates),
            switches=self.switches,
        )
        assert_closed(result)
        return result

    def _port_variables(self) -> dict[sympy.Basic, sympy.Symbol]:
        """Map the elements' own symbols to the variables of this graph."""
        names: dict[sympy.Basic, sympy.Symbol] = {}
        for name, element in self.graph.elements.items():
            if isinstance(element, Zero):
                names[element.e] = self.nets.symbol("e", self.nets.at[name][0])
            elif isinstance(element, One):
                names[element.f] = self.nets.symbol("f", self.nets.at[name][0])
            elif isinstance(element, SignalBlock):
                names[element.y] = sympy.Symbol(f"{name}.y", real=True)
            elif not isinstance(element, TwoPort):
                bond = self.nets.at[name][0]
                names[element.e] = self.nets.symbol("e", bond)  # type: ignore[attr-defined]
                names[element.f] = self.nets.symbol("f", bond)  # type: ignore[attr-defined]
                if isinstance(element, Storage):
                    letter = "q" if isinstance(element, C) else "p"
                    names[element.state] = sympy.Symbol(f"{name}.{letter}", real=True)
                if isinstance(element, DryFriction):
                    names[element.speed] = sympy.Symbol(f"{name}.speed", real=True)
        for name, element in self.graph.of(TwoPort):
            self._two_port_variables(name, element, names)
        return names

    def _two_port_variables(
        self, name: str, element: TwoPort, names: dict[sympy.Basic, sympy.Symbol]
    ) -> None:
        """Name a two-port's ports; a bond drawn against its side reverses the flow."""
        into, out = self._sides(name)
        names[element.e_in] = self.nets.symbol("e", into)
        names[element.e_out] = self.nets.symbol("e", out)
        names[element.f_in] = self._towards(name, into) * self.nets.symbol("f", into)
        names[element.f_out] = -self._towards(name, out) * self.nets.symbol("f", out)

    def _sides(self, name: str) -> tuple[int, int]:
        """Return in bond and out bond: by arrows, by order where arrows do not tell."""
        first, second = self.nets.at[name]
        if self._towards(name, first) < 0 < self._towards(name, second):
            return second, first
        return first, second

    def _towards(self, name: str, bond: int) -> int:
        """Return +1 for a bond whose arrow points to the element, -1 for one that leaves it."""
        return 1 if self.graph.bonds[bond].head == name else -1

    def _local(self, expression: sympy.Expr) -> sympy.Expr:
        return renamed(expression, self.names)

    def _conjugate(self, storage: Storage) -> sympy.Symbol:
        """Return the variable that is the rate of a storage's state."""
        return self.names[storage.f if isinstance(storage, C) else storage.e]

    def _listening(self, element: Element) -> Element:
        """Let laws use a stand-in for what they hear of other elements.

        For rates a signal is not a bond: what a dependent storage answers comes back along
        bonds without effect on its own state, but not along signals. The ports of a field
        hear each other as they would through bonds.
        """
        if not self.answers:
            return element
        own = set(element.symbols.values())
        if isinstance(element, Storage | R):
            own |= set(element.partners)
        heard = {}
        for symbol in set().union(*(law.free_symbols for law in element.laws.values())) - own:
            for variable in self.names.get(symbol, sympy.S.Zero).free_symbols:
                signal = self.signals.setdefault(variable, sympy.Dummy(variable.name, real=True))
                heard[symbol] = self.names[symbol].xreplace({variable: signal})
        return element.replaced(heard) if heard else element

    def _forget_signals(self) -> None:
        """Put the variables heard back in place of their stand-ins."""
        if not self.signals:
            return
        heard = {signal: variable for variable, signal in self.signals.items()}
        for table in (self.explicit, self.implicit, self.dependent):
            for key, expression in table.items():
                table[key] = expression.xreplace(heard)
        self.initial = [expression.xreplace(heard) for expression in self.initial]
        self.contacts = [
            replace(contact, breakaway=contact.breakaway.xreplace(heard))
            for contact in self.contacts
        ]

    def _write(self, name: str, element: object) -> None:
        if isinstance(element, Zero | One):
            self._write_junction(name, element)
        elif isinstance(element, TwoPort):
            self._write_two_port(name, element)
        elif isinstance(element, Storage):
            self._write_storage(name, element)
        elif isinstance(element, DryFriction):
            self._write_friction(name, element)
        elif isinstance(element, Switched):
            self._write_switch(name, element)
        elif isinstance(element, R):
            self._write_dissipator(name, element)
        elif isinstance(element, SignalBlock):
            self._write_block(name, element)
        elif isinstance(element, EffortSource | FlowSource):
            self._write_source(name, element)
        else:
            raise LawError(f"no equations are known for {element!r}", elements=[name])

    def _write_junction(self, name: str, junction: Zero | One) -> None:
        """Write the sum of the variable that is not shared, for the one bond that does not bring its own."""
        summed = "f" if isinstance(junction, Zero) else "e"
        bonds = self.nets.at[name]
        strong = next(
            bond for bond in bonds if (self.effort_out[bond] == name) == isinstance(junction, One)
        )
        sign = self._towards(name, strong)
        plus: list[sympy.Symbol] = []
        minus: list[sympy.Symbol] = []
        for bond in bonds:
            if bond != strong:
                side = minus if self._towards(name, bond) == sign else plus
                side.append(self.nets.symbol(summed, bond))
        self.explicit[self.nets.symbol(summed, strong)] = signed_sum(plus, minus)

    def _write_two_port(self, name: str, element: TwoPort) -> None:
        into, out = self._sides(name)
        e_in, e_out = self.nets.symbol("e", into), self.nets.symbol("e", out)
        f_in, f_out = self.nets.symbol("f", into), self.nets.symbol("f", out)
        s_in, s_out = self._towards(name, into), -self._towards(name, out)
        ratio = self._local(element.ratio)
        gives_in, gives_out = self.effort_out[into] == name, self.effort_out[out] == name
        if isinstance(element, TF) and gives_in:
            self.explicit[e_in] = ratio * e_out
            self.explicit[f_out] = s_out * ratio * s_in * f_in
        elif isinstance(element, TF):
            self.explicit[e_out] = e_in / ratio
            self.explicit[f_in] = s_in * s_out * f_out / ratio
        elif gives_in and gives_out:
            self.explicit[e_in] = ratio * s_out * f_out
            self.explicit[e_out] = ratio * s_in * f_in
        else:
            self.explicit[f_out] = s_out * e_in / ratio
            self.explicit[f_in] = s_in * e_out / ratio

    def _write_storage(self, name: str, element: Storage) -> None:
        state = self.names[element.state]
        self.storage[name] = state
        if name in self.integral:
            self.explicit[self.names[element.coenergy]] = self._local(element.law)
            self.states[state] = self._conjugate(element)
            self.initial.append(self._local(element.initial))
        elif element.inverse is not None:
            self.dependent[name] = self.explicit[state] = self._local(element.inverse)
        else:
            self.implicit[state] = self.names[element.coenergy] - self._local(element.law)
            self.dependent[name] = state

    def _write_source(self, name: str, element: EffortSource | FlowSource) -> None:
        if isinstance(element, EffortSource):
            self.explicit[self.names[element.e]] = self._local(element.effort)
        else:
            self.explicit[self.names[element.f]] = self._local(element.flow)

    def _write_block(self, name: str, element: SignalBlock) -> None:
        """A signal block's state has its rate by a law."""
        state, rate = self.names[element.y], sympy.Symbol(f"{name}.rate", real=True)
        self.explicit[rate] = self._local(element.rate)
        self.states[state] = rate
        self.initial.append(self._local(element.initial))

    def _write_switch(self, name: str, element: Switched) -> None:
        """What a switch decides is open until its mode is known."""
        gives_effort = self.effort_out[self.nets.at[name][0]] == name
        self.switches[name] = self.names[element.e if gives_effort else element.f]

    def _write_dissipator(self, name: str, element: R) -> None:
        effort, flow = self.names[element.e], self.names[element.f]
        gives_effort = self.effort_out[self.nets.at[name][0]] == name
        known = element.effort if gives_effort else element.flow
        other = element.flow if gives_effort else element.effort
        given, wanted = (flow, effort) if gives_effort else (effort, flow)
        if known is not None:
            self.explicit[wanted] = self._local(known)
        else:
            assert other is not None
            if other.free_symbols.isdisjoint({element.e, element.f}):
                raise LawError(
                    f"R {name!r} has a constant {'flow' if gives_effort else 'effort'} and is asked for the other "
                    f"variable, which its law does not determine; use a source, or another causality",
                    elements=[name],
                )
            self.implicit[wanted] = given - self._local(other)

    def _write_friction(self, name: str, element: DryFriction) -> None:
        if self.effort_out[self.nets.at[name][0]] != name:
            if element.smoothing is not None:
                raise LawError(
                    f"{element.kind} {name!r} is made to decide its flow, which its smooth law cannot; "
                    f"add a compliance or inertia beside it",
                    elements=[name],
                )
            self._write_switch(name, element)
            return
        if element.smoothing is not None:
            self.explicit[self.names[element.e]] = self._local(element.smoothed())
            return
        direction = sympy.Symbol(f"{name}.direction", real=True)
        self.contacts.append(
            Contact(
                name,
                direction,
                self.names[element.f],
                self.names[element.e],
                self._local(element.breakaway),
            )
        )
        self.explicit[self.names[element.e]] = self._local(element.slipping(direction))

    def _dependent_storages(self, rates: Rates) -> None:
        """Close storages in derivative causality: the conjugate is the rate of their state."""
        for name in self.causal.derivative:
            element = self.graph.elements[name]
            assert isinstance(element, Storage)
            self.explicit[self._conjugate(element)] = rates.later(self.storage[name])

    def _check_dependence(self) -> None:
        """Raise unless the states of dependent storages are free of what these answer."""
        ordered = order_and_solve(self.explicit, self.implicit)
        if ordered.algebraic:
            raise _NotDependentError
        residues = Residues()
        slopes: dict[sympy.Basic, dict[sympy.Basic, int]] = {
            answer: {answer: 1} for answer in self.answers
        }
        for symbol, expression in ordered.assignments:
            residues.define(symbol, expression)
            total: dict[sympy.Basic, int] = {}
            for inner in expression.free_symbols & slopes.keys():
                slope = residues.of(sympy.diff(expression, inner))
                for answer, value in slopes[inner].items():
                    total[answer] = (total.get(answer, 0) + slope * value) % PRIME
            slopes[symbol] = {answer: value for answer, value in total.items() if value}
        if any(slopes[self.storage[name]] for name in self.causal.derivative):
            raise _NotDependentError

    def _modulated_storages(
        self, rates: Rates, energies: Mapping[str, sympy.Expr | None]
    ) -> dict[str, sympy.Expr]:
        """Count the work that a modulation does on a storage, at constant state, as supplied."""
        supplied = {}
        constant = frozenset(self.graph.parameters)
        for name, energy in energies.items():
            if energy is None:
                continue
            outside = energy.free_symbols - self._states_of(name) - constant
            work = sympy.Add(
                *(
                    sympy.diff(energy, symbol) * rates.full.of(symbol)
                    for symbol in sorted(outside, key=str)
                )
            )
            if work != 0:
                supplied[f"{name} (modulation)"] = work
        return supplied

    def _states_of(self, name: str) -> set[sympy.Symbol]:
        """Return the states that an energy is a function of: a storage's, or all of a field's."""
        if name in self.storage:
            return {self.storage[name]}
        return {
            state
            for label, state in self.storage.items()
            if label.rpartition(".")[0] == name and self.graph.elements[label].partners  # type: ignore[attr-defined]
        }

    def _ports(self) -> dict[str, sympy.Expr]:
        return {
            f"{name}.{key}": self.names[symbol]
            for name, element in self.graph.elements.items()
            for key, symbol in element.symbols.items()
            if key != "speed"
        }

    def _used_parameters(self, *groups: Iterable[sympy.Expr]) -> tuple[sympy.Symbol, ...]:
        if not self.graph.parameters:
            return ()
        breakaways = (contact.breakaway for contact in self.contacts)
        laws = (law for _, element in self.graph.of(Switched) for law in element.laws.values())
        used: set[sympy.Basic] = set()
        for expression in itertools.chain(*groups, self.initial, breakaways, laws):
            used |= expression.free_symbols
        return tuple(symbol for symbol in self.graph.parameters if symbol in used)
