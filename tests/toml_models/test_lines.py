"""The line of every key is found, however TOML was written."""

import tomllib
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from often import often
from trecsim.toml_models.lines import KeyPath, key_lines, line_of

DOCUMENT = '''\
# a comment with [brackets] and key = value
name = "a" # [x]
"quo ted".b = 3
a.b.c = [4,
  {d = 5, "e" = [ 5,
     6]}, # x ]
  """ ]
  c = 1""", 'x]', ]

[sources.north]
video = "n.mp4"
[[zones]]
k = 13
[zones.sub]
x = {}
[[zones]]
k = []
[ zones . sub ]
y = { a.b = 19, c = "}" }
[[zones.deep]]
z = 1979-05-27T07:32:00Z
[[zones.deep]]
z = 23
'''


def test_keys_tables_and_elements_are_found() -> None:
    lines = key_lines(DOCUMENT)
    assert lines["name",] == 2
    assert lines["a", "b", "c", 1, "e", 1] == 6
    assert lines["a", "b", "c", 3] == 8
    assert lines["sources", "north"] == 10
    assert lines["zones", 1] == 16
    assert lines["zones", 1, "sub", "y", "a", "b"] == 19
    assert lines["zones", 1, "deep", 1, "z"] == 23


def test_what_has_no_line_gets_that_of_the_table_around_it() -> None:
    lines = key_lines(DOCUMENT)
    assert line_of(lines, ("sources", "north", "missing")) == 10
    assert line_of(lines, ("elsewhere",)) == 1


def leaves(value: Any, path: KeyPath = ()) -> list[tuple[KeyPath, Any]]:
    if isinstance(value, dict):
        return [leaf for key, item in value.items() for leaf in leaves(item, (*path, key))]
    if isinstance(value, list):
        return [leaf for i, item in enumerate(value) for leaf in leaves(item, (*path, i))]
    return [(path, value)]


TREE = st.recursive(
    st.just(None),
    lambda inner: st.one_of(
        st.lists(inner, min_size=1, max_size=3),
        st.dictionaries(st.sampled_from(["a", "b", "c d", "e.f"]), inner, min_size=1, max_size=3),
    ),
    max_leaves=8,
)


@st.composite
def documents(draw: st.DrawFn) -> str:
    """Draw documents in which every number says on which line it stands."""
    out = ""

    def number() -> str:
        return str(out.count("\n") + 1)

    def put(text: str) -> None:
        nonlocal out
        out += text

    def put_value(value: Any) -> None:
        if value is None:
            put(number())
            return
        opening, closing = "{}" if isinstance(value, dict) else "[]"
        put(opening)
        for i, item in enumerate(value):
            put(", " if i else " ")
            if isinstance(value, list):
                put(draw(st.sampled_from(["", "\n", " # ]\n", "\n\n  "])))
            else:
                put(f'"{item}" = ')
            put_value(value[item] if isinstance(value, dict) else item)
        put(closing)

    for i in range(draw(st.integers(1, 4))):
        put(draw(st.sampled_from(["", "\n", "# [x]\n"])))
        put(draw(st.sampled_from([f"[t{i}]\n", f'["t {i}" . "x"]\n', "[[many]]\n"])))
        for key in draw(st.lists(st.sampled_from(["k", '"q r"', "m . n"]), unique=True)):
            put(f"{key} = ")
            put_value(draw(TREE))
            put(draw(st.sampled_from(["\n", " # = 3\n", "\r\n"])))
    return out


@given(documents())
@settings(max_examples=often(200))
def test_every_value_of_any_document_is_found_on_its_line(text: str) -> None:
    lines = key_lines(text)
    for path, line in leaves(tomllib.loads(text)):
        assert lines[path] == line
