"""The one place where errors become a line."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim import cli
from trecsim import export as exporting
from trecsim.errors import CalibrationError, ConfigError, InputError, SetupError

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[BaseException], None]:
    """Return a function that makes `trecsim export` raise an error."""

    def fail_with(error: BaseException) -> None:
        def export(*_: object, **__: object) -> None:
            raise error

        monkeypatch.setattr(exporting, "export_tracks", export)

    return fail_with


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["trakc"], "there is no command 'trakc'; did you mean 'track'? See: trecsim --help"),
        (
            ["xyzzy"],
            "there is no command 'xyzzy'; there are: assess, audit, backup, ",
        ),
        (["rig", "shoow"], "there is no command 'shoow'; did you mean 'show'? See: trecsim rig"),
        (["--quickly"], "there is no option '--quickly'. See: trecsim --help"),
        (["export", "a.csv"], 'Command "export" parameter OUT requires an argument.'),
        (["export", "a.csv", "b.csv", "--jsno"], "Unknown option: --jsno. Did you mean --json?"),
        (["export", "a", "b", "c"], "Unused Tokens: ['c']."),
        (
            ["track", "r", "p", "--lag-s", "long"],
            'Invalid value for --lag-s: unable to convert "long"',
        ),
    ],
)
def test_wrong_arguments_are_one_line_with_the_nearest_name(
    trecsim: Command, arguments: list[str], message: str
) -> None:
    code, out, err = trecsim(*arguments)
    assert (code, out) == (2, "")
    assert err.startswith("trecsim: ")
    assert err.count("\n") == 1
    assert message in err
    assert "See: trecsim" in err


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (InputError("wrong"), 2),
        (CalibrationError("wrong"), 2),
        (ConfigError("wrong"), 2),
        (SetupError("wrong"), 1),
    ],
)
def test_an_expected_error_is_its_text_and_its_exit_code(
    trecsim: Command,
    failing: Callable[[BaseException], None],
    error: Exception,
    code: int,
) -> None:
    failing(error)
    assert trecsim("export", "a.csv", "b.csv", "--json") == (code, "", "trecsim: wrong\n")


def test_a_fault_of_ours_asks_for_a_report(
    trecsim: Command, failing: Callable[[BaseException], None]
) -> None:
    failing(ZeroDivisionError("division\nby zero"))
    code, out, err = trecsim("export", "a.csv", "b.csv")
    assert (code, out) == (1, "")
    assert "internal error: ZeroDivisionError: division by zero; set TRECSIM_DEBUG=1 to see" in err
    assert err.count("\n") == 1


def test_a_fault_of_ours_shows_its_traceback_on_request(
    failing: Callable[[BaseException], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    failing(ZeroDivisionError())
    monkeypatch.setenv("TRECSIM_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        cli.main(["export", "a.csv", "b.csv"])


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (KeyboardInterrupt(), "stopped"),
        (KeyboardInterrupt("stopped; kept in x"), "stopped; kept in x"),
    ],
)
def test_ctrl_c_is_a_line_and_exit_code_1(
    trecsim: Command,
    failing: Callable[[BaseException], None],
    error: BaseException,
    message: str,
) -> None:
    failing(error)
    assert trecsim("export", "a.csv", "b.csv") == (1, "", f"trecsim: {message}\n")


def test_help_imports_neither_numpy_nor_any_command() -> None:
    script = """
import sys
from trecsim import cli
try:
    cli.main(["--help"])
except SystemExit as ended:
    assert ended.code == 0
heavy = {"numpy", "numba", "pydantic", "pyarrow", "av", "openvino", "matplotlib", "jaxtyping"}
loaded = heavy & set(sys.modules) | {name for name in sys.modules if "trecsim.cli." in name}
assert not loaded, loaded
"""
    subprocess.run([sys.executable, "-c", script], check=True, stdout=subprocess.DEVNULL)


def test_a_reader_that_goes_away_is_no_fault(tmp_path: Path) -> None:
    command = f"{sys.executable} -c 'from trecsim.cli import main; main()' site schema | head -1"
    ended = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert ended.stdout == "{\n"
    assert ended.stderr == ""


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_is_installed_for_the_shell(
    trecsim: Command, shell: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    code, out, _ = trecsim("--install-completion", "--shell", shell)
    assert code == 0
    scripts = [path for path in tmp_path.rglob("*trecsim*") if path.is_file()]
    assert len(scripts) == 1
    assert str(scripts[0]) in out
    assert "--lag-s" in scripts[0].read_text()
    assert "simulate" in scripts[0].read_text()
