"""Numbers for equations: parameters that are used, and initial states by many names."""

import math

import pytest
import sympy

from bondgraph import C, I, One, R, Se, assemble, derive
from bondgraph.errors import ParameterError
from bondgraph.values import initial_values, parameter_values

b, c, spare = sympy.symbols("b c spare", positive=True)


@pytest.fixture(scope="module")
def equations():
    v = One("v")
    mass, spring = I("m", 2, initial=b), C("k", 1)
    return derive(
        assemble(
            "g",
            Se("s", 1) >> v >> (mass, spring, R("r", b)),
            parameters={b: 3, spare: None},
            outputs={
                "speed": (mass.f, "m/s"),
                "shifted": 2 * spring.q + b,
                "square": spring.q**2,
                "sum": spring.q + mass.p,
                "constant": b,
            },
        )
    )


def start(equations, **given):
    names = {"m": "m.p", "k": "k.q"}
    return initial_values(
        equations, {"b": 3.0}, {names.get(key, key): value for key, value in given.items()}
    )


def test_parameters_that_are_not_used_need_no_value(equations):
    assert parameter_values(equations) == {"b": 3.0}
    assert parameter_values(equations, {"spare": 2}) == {"b": 3.0, "spare": 2.0}


def test_parameters_that_are_used_do():
    graph = assemble("g", Se("s", c) >> One("v") >> (I("m", 1), R("r", b)))
    with pytest.raises(ParameterError, match="'g' needs a value for c, b"):
        parameter_values(derive(graph))
    with pytest.raises(ParameterError, match="needs a value for b"):
        parameter_values(derive(graph), {"c": 1})


def test_defaults_come_from_the_elements(equations):
    assert start(equations) == [3.0, 0.0]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"m": 5}, [5, 0]),
        ({"k": (3, "mm")}, [3, 0.003]),
        ({"speed": 5}, [10, 0]),
        ({"shifted": 7}, [3, 2]),
        ({"m": 1, "k": 2}, [1, 2]),
    ],
)
def test_states_and_outputs_that_fix_one(equations, given, expected):
    assert start(equations, **given) == pytest.approx(expected)


def test_symbols_as_keys(equations):
    state = equations.states[1]
    assert initial_values(equations, {"b": 3.0}, {state: 4}) == [3.0, 4.0]


@pytest.mark.parametrize("output", ["square", "sum", "constant"])
def test_outputs_that_do_not_fix_one_state(equations, output):
    with pytest.raises(
        ParameterError, match=r"does not fix one state; give states instead: m\.p, k\.q"
    ):
        start(equations, **{output: 1})


@pytest.mark.parametrize(
    "value", [None, "3", True, math.nan, -math.inf, b, [1], 1j, (None, "m")], ids=repr
)
def test_what_is_no_number(equations, value):
    with pytest.raises(ParameterError, match=r"k\.q"):
        start(equations, k=value)


def test_unknown_names(equations):
    with pytest.raises(ParameterError, match=r"state 'k\.p' is not known; did you mean"):
        initial_values(equations, {"b": 3.0}, {"k.p": 1})
