"""CSV files as recordings: what is read, and how malformed files are named."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bondgraph.discrepancy.measurement import Measurement, read_all
from bondgraph.errors import MeasurementError

DATA = Path(__file__).parents[1] / "data"
GOOD = "time [s],F [N],v [m/s]\n0,1,0\n0.1,2,0.5\n0.2,,1\n"


@pytest.fixture
def file(tmp_path):
    def made(content, name="run.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return made


@pytest.mark.parametrize(
    "content",
    [
        GOOD,
        "# made by hand\n\n" + GOOD.replace("0.1,2", "  # within\n0.1,2"),
        b"\xef\xbb\xbf" + GOOD.encode(),
        GOOD.replace("\n", "\r\n"),
        GOOD.replace("\n", "\r"),
        GOOD.replace(",", ";"),
        GOOD.replace(",", "\t"),
        GOOD.replace(",", " , "),
        GOOD.rstrip("\n"),
        '"time [s]","F [N]","v [m/s]"\n"0","1","0"\n"0.1","2","0.5"\n"0.2","","1"\n',
        "time [ms],F [kN],v [m/s]\n0,1e-3,0\n100,2E-3,.5\n200,,1.\n",
    ],
)
def test_one_recording_in_many_spellings(file, content):
    run = Measurement.read(file(content))
    assert run.name == "run.csv" and list(run.columns) == ["F", "v"]
    np.testing.assert_allclose(run.t, [0, 0.1, 0.2], rtol=1e-15)
    scale = 1000 if run.units["F"] == "kN" else 1
    np.testing.assert_allclose(run.columns["F"] * scale, [1, 2, np.nan], rtol=1e-15)
    assert run.columns["v"].tolist() == [0, 0.5, 1]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", ["run.csv", "is empty"]),
        ("# only\n", ["comments only"]),
        ("time [s],v\n", ["no rows below the header"]),
        ("0,1\n1,2\n", ["line 1", "begins with numbers where a header is wanted"]),
        ("t [s],v\n0,1\n1,2\n", ["no column 'time'", "t, v", "time=..."]),
        ("# a\ntime,v,v\n0,1,1\n1,2,2\n", ["column 'v' is there twice"]),
        ("time,\n0,1\n", ["column 2", "no column's name"]),
        ("time,v [furlongz]\n0,1\n1,2\n", ["column 'v'", "'furlongz' is not known"]),
        ("time [m],v\n0,1\n1,2\n", ["column 'time'", "does not measure"]),
        ("time,v\n0,1\n1,oops\n", ["line 3", "column 'v'", "'oops' is no number"]),
        ("time,v\n0,1\n# c\n\n1,oops\n", ["line 5"]),
        (
            "time,v\n0,nan\n1,2\n",
            ["line 2", "column 'v'", "nan is not a finite", "empty for a gap"],
        ),
        ("time,v\n0,1\n1,-inf\n", ["line 3", "-inf is not a finite"]),
        ("time,v\n0,1\n1,1e999\n", ["line 3", "1e999 is not a finite"]),
        ("time,v\n0,1\n1,1_000\n", ["line 3", "'1_000' is no number"]),
        ("time;v\n0;1,5\n1;2,5\n", ["line 2", "'1,5' is no number", "write 1.5"]),
        ("time,v\n0,1\n2,1\n1,2\n", ["line 4", "runs backwards", "2 s, then 1 s", "segment"]),
        ("time,v\n0,1\n0,2\n", ["line 3", "stands still"]),
        ("time,v\n0,1\n,2\n", ["line 3", "a row without a time"]),
        ("time,v\n0,1\n1\n", ["line 3", "1 cell where the header has 2"]),
        ("time,v\n0,1,5\n1,2,5\n", ["line 2", "3 cells", "no decimal point"]),
        ("time,v\n0;1\n1;2\n", ["line 2", "separated by commas, the row by semicolons"]),
        ("time;v,w\n0;1\n", ["line 1", "commas and semicolons", "not clear"]),
        ("time,v\n0,1\n", ["line 2", "one row"]),
        ("time,v\n0,\n1,\n", ["column 'v'", "no value in any row"]),
        ("time\n0\n1\n", ["no column beside time"]),
        ('time,"v\n0,1\n', ["line 1", "quotes"]),
        (b"\xff\xfet\0i\0", ["UTF-16"]),
        (b"time,v\n0,\xe9\n", ["line 2", "0xe9 is not UTF-8"]),
        (b"time,v\n0,1\0\n", ["line 2", "zero byte"]),
        (b"PK\x03\x04rest", ["spreadsheet", "export it as CSV"]),
    ],
)
def test_malformed_files_are_named(file, content, words):
    path = file(content)
    with pytest.raises(MeasurementError) as caught:
        Measurement.read(path)
    for word in [str(path), *words]:
        assert word in str(caught.value)


def test_what_is_no_file(tmp_path):
    with pytest.raises(MeasurementError, match=r"nowhere\.csv: cannot be read"):
        Measurement.read(tmp_path / "nowhere.csv")
    with pytest.raises(MeasurementError, match="is a folder"):
        Measurement.read(tmp_path)
    with pytest.raises(MeasurementError, match=r"holds no \.csv"):
        read_all(tmp_path)
    with pytest.raises(MeasurementError, match="no file"):
        read_all([])


def test_names_of_the_model_and_what_else_is_said(file):
    path = file("time,force,speed\n0,1,0\n1,2,3\n")
    run = Measurement.read(
        path,
        rename={"F": "force", "v": "speed"},
        holds={"F": "zero"},
        initial={"m.p": 2.0},
        units={"v": "km/h"},
        name="drive",
    )
    assert list(run.columns) == ["F", "v"] and dict(run.units) == {"v": "km/h"}
    assert run.holds == {"F": "zero"} and run.initial == {"m.p": 2.0} and run.name == "drive"


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"rename": {"F": "forse"}}, "no column 'forse' to take as 'F'; did you mean force"),
        ({"rename": {"F": "force", "G": "force"}}, "taken as 'F' and as 'G'"),
        ({"rename": {"speed": "force"}}, "would be a second 'speed'"),
        ({"holds": {"forc": "zero"}}, "hold is given for 'forc', no column; did you mean force"),
        ({"holds": {"force": "cubic"}}, "hold 'cubic' is not known; use zero, linear, band"),
        ({"units": {"force": "kN"}}, "is in N, but units= says kN"),
        ({"units": {"speed": "knotz"}}, "column 'speed': unit 'knotz' is not known"),
        ({"time": "tine"}, "no column 'tine'; did you mean time"),
    ],
)
def test_what_is_said_wrongly(file, said, words):
    path = file("time,force [N],speed\n0,1,0\n1,2,3\n")
    with pytest.raises(MeasurementError, match=words):
        Measurement.read(path, **said)


def test_segments_by_numbers_and_two_columns(file):
    path = file("ball,drop,time,h\na,1,0,5\na,1,1,4\na,2,0,6\na,2,1,3\nb,1,7,9\nb,1,8,1\n")
    runs = read_all(path, segment=["ball", "drop"], initial={"run.csv:a:2": {"fall.q": 6.0}})
    assert [run.name for run in runs] == ["run.csv:a:1", "run.csv:a:2", "run.csv:b:1"]
    assert [run.start for run in runs] == [0, 0, 7]
    assert [dict(run.initial) for run in runs] == [{}, {"fall.q": 6.0}, {}]
    numbered = file("seg,time,h\n1,0,5\n1,1,4\n2,0,6\n2,1,3\n", "numbers.csv")
    assert [run.columns["h"].tolist() for run in read_all(numbered, segment="seg")] == [
        [5, 4],
        [6, 3],
    ]
    with pytest.raises(MeasurementError, match=r"'segg' to tell segments by; did you mean seg"):
        read_all(numbered, segment="segg")
    with pytest.raises(MeasurementError, match=r"line 4.*runs backwards"):
        read_all(numbered)
    with pytest.raises(MeasurementError, match="'x': no such recording"):
        read_all(numbered, segment="seg", initial={"x": {}})


def test_folder_of_files(file, tmp_path):
    file(GOOD, "b.csv"), file(GOOD, "a.csv"), file("no data", "notes.txt")
    assert [run.name for run in read_all(tmp_path)] == ["a.csv", "b.csv"]


def test_real_pendulum():
    runs = read_all(
        DATA / "pendulum_single_uw.csv",
        segment="seg",
        time="t_s",
        rename={"theta": "theta_rad"},
        units={"theta": "rad"},
    )
    assert [run.name.split(":")[1] for run in runs] == ["id0", "id1", "id2", "id3", "vad0", "vad1"]
    assert {len(run) for run in runs} == {1834} and runs[4].start == 36.668
    assert runs[0].columns["theta"][:2].tolist() == [1.523164, 1.533454]


def test_real_drops_fall_as_gravity_says():
    drops = read_all(DATA / "ball_drops.csv", segment=("ball", "drop"), time="t_s")
    assert len(drops) == 22 and sum(map(len, drops)) == 1064
    falls: dict[str, list[float]] = {}
    for run in drops:
        late = run.between(0.5, 2.0)
        bend = -2 * np.polyfit(late.t, late.columns["height_m"], 2)[0]
        falls.setdefault(run.name.split(":")[1], []).append(bend)
    assert abs(np.mean(falls["Bowling_Ball"]) - 9.81) < 0.5
    assert max(np.mean(fall) for ball, fall in falls.items() if "Whiffle" in ball) < 7  # air


finite = st.floats(allow_nan=False, allow_infinity=False)
names = st.text("abcXYZ_ .äß,;#\"'", min_size=1, max_size=6).filter(
    lambda name: name == name.strip() and not name.startswith("#")
)


@st.composite
def recordings(draw):
    t = sorted(draw(st.lists(finite, min_size=2, max_size=8, unique=True)))
    cell = st.one_of(finite, st.just(float("nan")))
    columns = {
        name: [*draw(st.lists(cell, min_size=len(t) - 1, max_size=len(t) - 1)), draw(finite)]
        for name in draw(st.lists(names, min_size=1, max_size=4, unique=True))
    }
    units = {name: draw(st.sampled_from(["m/s", "1", "N*m/rad"])) for name in list(columns)[:2]}
    return Measurement(t, columns, units)


@given(run=recordings())
def test_written_and_read_back_to_the_bit(run, tmp_path_factory):
    again = Measurement.read(run.write(tmp_path_factory.mktemp("back") / "run.csv"))
    assert again.t.tobytes() == run.t.tobytes() and dict(again.units) == dict(run.units)
    assert list(again.columns) == list(run.columns)
    for name in run.columns:
        np.testing.assert_array_equal(again.columns[name], run.columns[name])


def test_what_cannot_be_written(tmp_path):
    with pytest.raises(MeasurementError, match=r"'v\[0\]' cannot be written"):
        Measurement([0, 1], {"v[0]": [1, 2]}).write(tmp_path / "run.csv")
    with pytest.raises(MeasurementError, match="cannot write"):
        Measurement([0, 1], {"v": [1, 2]}).write(tmp_path / "none" / "run.csv")
