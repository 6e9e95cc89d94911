"""What belongs to tracks and is shown with them."""

from pathlib import Path

from trecsim.film_places import film_input


def test_a_line_an_edge_and_a_wall_of_one_name_are_all_shown(tmp_path: Path) -> None:
    (tmp_path / "site.toml").write_text(
        'format = "trecsim.site/1"\nname = "hall"\n'
        "[lines.door]\npoints_m = [[0.0, 0.0], [1.0, 0.0]]\n"
        "[edges.door]\npoints_m = [[0.0, 1.0], [1.0, 1.0]]\n"
        "[walls.door]\npoints_m = [[0.0, 2.0], [1.0, 2.0]]\n"
    )
    shown = film_input(tmp_path / "tracks.csv", site=tmp_path / "site.toml")
    assert sorted(line_m[0, 1] for line_m in shown.lines.values()) == [0.0, 1.0, 2.0]
