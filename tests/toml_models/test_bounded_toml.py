"""Absurd TOML is refused before it is parsed; all else is parsed as ever."""

import tomllib

import pytest

from trecsim.toml_models import bounded_toml

DOTTED = {
    "fifty thousand levels": "a." * 50_000 + "a = 1",
    "twenty thousand lines of two hundred": "\n".join(
        200 * f"k{line}." + "a = 1" for line in range(20_000)
    ),
    "blanks between": " . ".join("a" * 30) + " = 1",
    "quoted parts": '"a b".' * 40 + "'c' = 1",
    "in a header": "x = 1\n[" + "a." * 20 + "b]",
    "in a header of an array": "[[" + "a." * 20 + "b]]",
    "after a string that ends with quotes": 'x = """y"""""  # \\\n' + "a." * 20 + "b = 1",
    "after a string that never ends": 'x = "y \\\n' + "a." * 20 + "b = 1",
    "in an inline table": "x = { y = 1, " + "a." * 20 + "b = 2 }",
}


@pytest.mark.parametrize("text", DOTTED.values(), ids=DOTTED)
def test_a_key_of_many_parts_is_refused_before_the_text_is_parsed(text, monkeypatch):
    monkeypatch.setattr(tomllib, "loads", lambda text: pytest.fail("parsed"))
    with pytest.raises(ValueError, match="nested too deeply"):
        bounded_toml.loads(text)


def test_the_line_of_the_key_is_told():
    with pytest.raises(ValueError, match="line 3: a key of more than 16 parts"):
        bounded_toml.loads("a = 1\nb = 2\n" + "c." * 17 + "d = 3")


@pytest.mark.parametrize(
    "text",
    [
        "a.b.c = 1.5\nd = 1979-05-27T07:32:00.999",
        'a = "' + "x." * 50 + '"',
        "a = '" + "x." * 50 + "' # " + "y." * 50,
        'a = """\n' + "x." * 50 + "\n" + '"""',
        "a = '''\n" + "x." * 50 + "'''",
        r'a = "\" ' + "x." * 50 + '"',
        ".".join("abcdefghijklmnop") + " = 1",
        "a" * 100_000 + " = 1",
        "[a]\n" * 1 + "b = [" + "1.5, " * 1000 + "]",
    ],
)
def test_all_else_is_read_as_the_standard_library_reads_it(text):
    assert bounded_toml.loads(text) == tomllib.loads(text)


@pytest.mark.parametrize("text", ["a = " + "[" * 100_000, "a = " + "{b = " * 100_000])
def test_values_nested_without_end_are_refused(text):
    with pytest.raises(ValueError, match="nested too deeply"):
        bounded_toml.loads(text)
