"""Which known name is suggested for an unknown one."""

import pytest

from trecsim.toml_models.toml_reading import nearest


@pytest.mark.parametrize(
    ("name", "known", "told"),
    [
        ("fsp", ["fps", "start_s"], "did you mean 'fps'?"),
        ("by_deg", ["by_rad", "to_m"], "did you mean 'by_rad'?"),
        ("zones", ["poses", "rig"], "known: poses, rig"),
    ],
)
def test_a_misspelt_name_is_suggested_and_another_word_is_not(
    name: str, known: list[str], told: str
) -> None:
    assert nearest(name, known) == told
