import math
import re
import time

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.config import yaml_reader
from benchnav.config.yaml_reader import (
    MAX_BYTES,
    MAX_DEPTH,
    MAX_NODES,
    read_yaml,
    read_yaml_text,
)
from benchnav.errors import ScenarioError
from tests.scenario.files import SHIPPED


def refusal(text):
    with pytest.raises(ScenarioError) as caught:
        read_yaml_text(text, "f.yaml")
    return str(caught.value)


def complaint_of(text):
    """The text of the refusal; an empty place where the text is accepted."""
    try:
        read_yaml_text(text, "f.yaml")
    except ScenarioError as error:
        return str(error)
    return "f.yaml:0: "


def test_scalars_follow_yaml_1_2():
    text = "[1, -2, 1e3, .5, 1., true, null, ~, yes, no, on, 012, 0x1F, 1_000, '7', 1:30, .inf]"
    assert read_yaml_text(text, "f").data == [
        1, -2, 1000.0, 0.5, 1.0, True, None, None, "yes", "no", "on", "012", "0x1F", "1_000",
        "7", "1:30", math.inf,
    ]  # fmt: skip


def test_keys_are_text():
    assert read_yaml_text("{1: a, true: b, null: c, ~: d}", "f").data == {
        "1": "a", "true": "b", "null": "c", "~": "d",
    }  # fmt: skip


def test_lines():
    document = read_yaml_text("a: 1\nb:\n  - x\n  - {c: 2,\n     d: 3}\n", "f")
    assert document.line(()) == 1
    assert document.line(("b", 0)) == 3
    assert document.line(("b", 1, "d")) == 5
    assert document.line(("b", 1, "missing", "deeper")) == 4
    assert document.where(("b", 1, "d")) == "f:5: b[1].d"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: &x 1", "f.yaml:1: anchors are not allowed; got &x."),
        ("a:\n  - *x", "f.yaml:2: aliases are not allowed; got *x."),
        ("a: !!python/name:os.system x", "f.yaml:1: tags are not allowed"),
        ("a: !mine [1]", "f.yaml:1: tags are not allowed; got !mine."),
        ("a: 1\nb: 2\na: 3", "f.yaml:3: the key 'a' is repeated; first in line 1."),
        ("a: 1\n---\nb: 1", "f.yaml:2: the file must hold one document."),
        ("? [1]\n: 2", "f.yaml:1: a key must be text; got a list or a mapping."),
        ("a: [1, 2", "f.yaml:1: not valid YAML"),
        ("\n\ta: 1", "f.yaml:2: not valid YAML"),
        ("a: \x01", "f.yaml:1: not valid YAML"),
        ("a: " + "9" * 5000, "f.yaml:1: the number 99999999999999999999… has too many digits."),
        ("a: 1\n\ud800", "f.yaml:2: the text contains half a surrogate pair."),
        ("x" * 300 + ": 1", "f.yaml:1: a key has at most 200 characters."),
    ],
)
def test_refusals(text, message):
    assert refusal(text).startswith(message)


def test_depth_is_bounded():
    assert read_yaml_text("[" * MAX_DEPTH + "]" * MAX_DEPTH, "f").data is not None
    assert "nested at most 32 deep" in refusal("[" * (MAX_DEPTH + 1) + "]" * (MAX_DEPTH + 1))


def test_nodes_are_bounded():
    assert len(read_yaml_text("\n".join(["- 1"] * (MAX_NODES - 1)), "f").data) == MAX_NODES - 1
    assert refusal("\n".join(["- 1"] * MAX_NODES)).startswith("f.yaml:50000: at most 50000")


def test_files(tmp_path):
    path = tmp_path / "f.yaml"
    path.write_bytes(b"a: 1\nb: \xff\n")
    with pytest.raises(ScenarioError, match=r"f\.yaml:2: the file must be UTF-8; byte 8 is 0xff\."):
        read_yaml(path)
    path.write_bytes(b"\xef\xbb\xbfa: 1")
    assert read_yaml(path).data == {"a": 1}
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    with pytest.raises(ScenarioError, match=r"f\.yaml:1: the file must be at most 1048576 bytes"):
        read_yaml(path)
    with pytest.raises(ScenarioError, match=r"none\.yaml:1: cannot be read: No such file"):
        read_yaml(tmp_path / "none.yaml")
    with pytest.raises(ScenarioError, match="cannot be read"):
        read_yaml(tmp_path)
    with pytest.raises(ScenarioError, match="cannot be read"):
        read_yaml("a\0b")


@pytest.mark.parametrize(
    "text",
    [
        "[" * 500_000, "{a: " * 200_000, "- " * 500_000, "? " * 500_000, "&a " * 300_000,
        "!" * 1_000_000, "a: '" + "\n" * 1_000_000, '"' + "\\x41" * 250_000 + '"',
        "a: |\n" + " x\n" * 300_000, "[a, " * 20 + "b," * 90_000, "#" * 1_000_000,
        "%TAG ! !\n" * 100_000, "{" + "a: [], " * 90_000, "a:\n" * 300_000, "*a\n" * 300_000,
    ],
    ids=range(15),
)  # fmt: skip
def test_hostile_texts_end_quickly(text):
    begin = time.process_time()
    complaint = complaint_of(text)
    assert time.process_time() - begin < 1.0
    assert re.match(r"f\.yaml:\d+: ", complaint)


@settings(max_examples=500, deadline=None)
@given(st.text(max_size=200) | st.text("[]{}:,-?&*!|>'\"%#\n \tab1.e", max_size=80))
def test_any_text_is_data_or_a_complaint(text):
    assert re.match(r"f\.yaml:\d+: ", complaint_of(text))


_PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**12), 10**12)
    | st.floats(allow_nan=False, allow_infinity=False, min_value=-1e15, max_value=1e15)
    | st.text("abc xyz:-#'\"\n", max_size=12),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.text("abcdef", min_size=1, max_size=8), inner, max_size=4)
    ),
    max_leaves=12,
)


@settings(max_examples=300, deadline=None)
@given(_PLAIN)
def test_reads_what_was_written(data):
    class Plain(yaml.SafeDumper):
        def ignore_aliases(self, data):
            return True

    assert read_yaml_text(yaml.dump(data, Dumper=Plain), "f").data == data


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_the_slow_parser_reads_the_same(path, monkeypatch):
    fast = read_yaml(path)
    monkeypatch.setattr(yaml_reader, "_LOADER", yaml.SafeLoader)
    slow = read_yaml(path)
    assert slow.data == fast.data
    assert slow.place == fast.place
    with pytest.raises(ScenarioError, match=r"^f:1: not valid YAML"):
        read_yaml_text("a: \x01", "f")
