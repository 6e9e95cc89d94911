"""The report of a day: visits, crossings, alerts with what was decided, and the page."""

import json
from collections.abc import Iterator
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from made_hall import BODY_M
from made_rigs import ring
from made_tracks import snapshot
from trecsim.calibration import write_rig
from trecsim.cli import main
from trecsim.cloud_events import event_of, numbered
from trecsim.errors import InputError
from trecsim.lab.day.day_building import day_report
from trecsim.lab.day.day_crowds import Crowds
from trecsim.lab.day.episodes import alerts_of, rule_days
from trecsim.lab.day.trips import NOT_SEEN, Passage, nested, trips
from trecsim.lab.day.visits import Visit, Visits, journeys
from trecsim.safety.directed_lines import Line
from trecsim.safety.polygons import Polygon
from trecsim.store.ledger import Ledger
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recordings import tracks_recorder
from trecsim.values import Snapshot

BEGIN_S = 1_796_043_600.0  # 2026-11-30 13:00 UTC
TEXT = """\
format = "trecsim.site/1"
name = "hall"
timezone = "Europe/Zurich"
rig = "rig.toml"
poses = "a.poses.jsonl"

[zones.west]
polygon_m = [[-4.0, -2.0], [0.0, -2.0], [0.0, 2.0], [-4.0, 2.0]]

[zones.east]
polygon_m = [[2.0, -2.0], [6.0, -2.0], [6.0, 2.0], [2.0, 2.0]]

[lines.gate]
points_m = [[1.0, 2.0], [1.0, -2.0]]

[portals.west-door]
points_m = [[-1.0, 2.0], [-1.0, -2.0]]

[portals.east-door]
points_m = [[3.0, -2.0], [3.0, 2.0]]

[[rules]]
id = "east"
kind = "zone.enter"
zone = "east"

[[rules]]
id = "running"
kind = "speed.running"
"""
SQUARE = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]))


def walk_over() -> Iterator[Snapshot]:
    """Two people: one goes from the west to the east in 10 s, one stays in the west."""
    feet_m = np.array([0.0, BODY_M[15:17, 1].mean(), 0.0])
    for n in range(300):
        t_s = n / 25
        x = -2.0 + 6.0 * min(max(t_s - 1.0, 0.0) / 10.0, 1.0)
        bodies_m = [BODY_M - feet_m + [x, 0.0, 0.0], BODY_M - feet_m + [-3.0, 0.5, 0.0]]
        yield snapshot(BEGIN_S + t_s, [3, 7], np.stack(bodies_m))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_rig(ring(3), tmp_path / "rig.toml")
    (tmp_path / "site.toml").write_text(TEXT)
    recording = tmp_path / "recordings" / "today"
    recording.mkdir(parents=True)
    with tracks_recorder(recording, TracksInfo(rig_sha256="")) as tracks:
        for moment in walk_over():
            tracks.write(moment)
    return tmp_path


def test_a_visit_lasts_from_likely_inside_to_not_and_only_sure_ones_count() -> None:
    visits = Visits("strip")
    for t_s, inside in enumerate([0.0, 0.6, 0.95, 0.6, 0.2, 0.7, 0.3]):
        visits.step(float(t_s), [5], [inside])
    assert visits.close() == [Visit(5, "strip", 1.0, 4.0)]


def test_a_gap_of_two_seconds_is_bridged_and_who_is_lost_has_not_left() -> None:
    visits = Visits("strip")
    visits.step(0.0, [5], [1.0])
    visits.step(1.9, [], [])
    visits.step(2.0, [5], [1.0])
    visits.step(4.1, [], [])
    assert visits.close() == [Visit(5, "strip", 0.0, 2.0, is_over=False)]


def test_people_go_from_their_first_place_to_their_last_one() -> None:
    visits = [
        Visit(1, "door", 0, 1), Visit(1, "hall", 2, 9), Visit(1, "exit", 9, 9),
        Visit(2, "hall", 3, 5),
    ]  # fmt: skip
    assert journeys(visits) == {("door", "exit"): 1, ("hall", "hall"): 1}


def test_trips_lead_from_the_portal_by_which_somebody_came_to_that_by_which_they_left() -> None:
    passages = [
        Passage(1, "north", "in", 1.0), Passage(1, "south", "out", 9.0),
        Passage(1, "south", "in", 20.0), Passage(1, "south", "out", 30.0),
        Passage(2, "north", "out", 5.0),  # was inside at the beginning
        Passage(3, "north", "in", 5.0),  # still there at the end
        Passage(4, "north", "in", 6.0), Passage(4, "north", "in", 7.0),
    ]  # fmt: skip
    counted = trips(reversed(passages))
    assert counted == {
        ("north", "south"): 1, ("south", "south"): 1, (NOT_SEEN, "north"): 1,
        ("north", NOT_SEEN): 3,
    }  # fmt: skip
    assert nested(counted)["north"] == {NOT_SEEN: 3, "south": 1}


def test_crossings_visits_and_time_are_counted_in_one_reading() -> None:
    zones = {
        "west": Polygon(np.array([[-4.0, -2.0], [0.0, -2.0], [0.0, 2.0], [-4.0, 2.0]])),
        "east": Polygon(np.array([[2.0, -2.0], [6.0, -2.0], [6.0, 2.0], [2.0, 2.0]])),
    }
    crowds = Crowds(zones, {"gate": Line(np.array([[1.0, 2.0], [1.0, -2.0]]))})
    crowds.read(walk_over())
    assert crowds.people == {3, 7}
    assert crowds.watched_s == pytest.approx(11.8, abs=0.21)
    assert {way: len(times) for way, times in crowds.crossings["gate"].items()} == {"in": 1}
    assert crowds.crossings["gate"]["in"][0] == pytest.approx(BEGIN_S + 6.0, abs=0.05)
    (over,) = [one for one in crowds.visits if one.person == 3 and one.place == "west"]
    assert over.is_over
    assert over.dwell_s == pytest.approx(1.0 + 10.0 / 3.0, abs=0.25)
    assert sum(crowds.person_s.values()) == pytest.approx(2 * crowds.watched_s)
    grid, (x0, x1, y0, y1) = crowds.heat()
    assert grid.sum() / 16 == pytest.approx(2 * crowds.watched_s)
    assert (x0, x1) == (pytest.approx(-3.0), pytest.approx(4.25))
    assert grid.shape == (round(4 * (y1 - y0)), round(4 * (x1 - x0)))
    t_s, density, inside = crowds.density["west"][0]
    assert (t_s, inside) == (BEGIN_S, 2)
    assert density == pytest.approx(2 / 16)


def test_voronoi_densities_are_those_of_pedpy() -> None:
    pedpy = pytest.importorskip("pedpy")
    pandas = pytest.importorskip("pandas")
    from trecsim.safety.conditions.density import voronoi_density

    rng = np.random.default_rng(3)
    crowds = [rng.uniform(-2.0, 6.0, (count, 2)) for count in (3, 10, 40, 90)]
    rows = [
        (person, frame, *xy_m)
        for frame, people in enumerate(crowds)
        for person, xy_m in enumerate(people)
    ]
    data = pandas.DataFrame(rows, columns=["id", "frame", "x", "y"])
    trajectories = pedpy.TrajectoryData(data=data, frame_rate=1.0)
    far = [(-50, -50), (50, -50), (50, 50), (-50, 50)]
    cells = pedpy.compute_individual_voronoi_polygons(
        traj_data=trajectories,
        walkable_area=pedpy.WalkableArea(far),
        cut_off=pedpy.Cutoff(radius=1.0, quad_segments=12),
    )
    area = pedpy.MeasurementArea([tuple(corner) for corner in SQUARE.corners_m])
    theirs, _ = pedpy.compute_voronoi_density(individual_voronoi_data=cells, measurement_area=area)
    ours = [voronoi_density(SQUARE, people) for people in crowds]
    np.testing.assert_allclose(ours, theirs["density"].to_numpy(), atol=1e-6)


def test_a_report_has_the_reasons_rates_and_times_of_the_ledger(folder: Path) -> None:
    recorded = folder / "recordings"
    with Ledger(recorded, now=lambda: BEGIN_S + 30.0) as ledger:
        for number in range(3):
            data = {
                "event": f"e{number}", "phase": "new", "severity": "warning", "zone": "east",
                "rule": {"id": "east", "kind": "zone.enter"}, "t_start_s": BEGIN_S + number,
                "t_detect_s": BEGIN_S + number, "t_end_s": None,
            }  # fmt: skip
            ledger.append_event(numbered(event_of("hall", data, BEGIN_S + number), 0))
        ledger.act("e0", "ack", "kim")
        ledger.act("e0", "close", "kim", reason="false", note="a <trolley>")
    made = day_report(folder / "site.toml", recorded, folder / "day.html", day=date(2026, 11, 30))
    camera_days = 3 * made.watched_s / 86400.0
    assert made.rules["east"] == {
        "alerts": 3, "false": 1, "false_per_camera_day": pytest.approx(1 / camera_days, rel=1e-4),
    }  # fmt: skip
    assert made.rules["running"]["alerts"] == 0
    assert made.lines == {"gate": {"in": 1, "out": 0}}
    assert made.portals == {"west-door": {"east-door": 1}}
    assert "came by \\ left by" in made.out.read_text()
    assert made.zones["west"]["visits"] == 2
    text = made.out.read_text()
    assert "a &lt;trolley&gt;" in text
    assert "30.0 s" in text  # to the acknowledgement
    assert "http" not in text.replace("http-equiv", "")
    assert "14:00:00" in text  # local time


def test_without_kept_events_the_rules_are_judged_on_the_recordings(folder: Path) -> None:
    made = day_report(folder / "site.toml", folder / "recordings", folder / "day.html")
    assert made.date == "2026-11-30"
    assert made.alerts == 1
    assert "No events were kept" in made.remarks[0]


def test_a_rule_that_could_not_be_judged_is_told_in_the_report(folder: Path) -> None:
    gate = (
        '[lines.left]\npoints_m = [[0.0, 0.0], [1.0, 0.0]]\n[feeds.gate]\nfile = "gate.jsonl"\n'
        '[[rules]]\nid = "tail"\nkind = "access.tailgate"\nline = "left"\nfeed = "gate"\n'
    )
    (folder / "site.toml").write_text(TEXT + gate)
    made = day_report(folder / "site.toml", folder / "recordings", folder / "day.html")
    said = "Rule tail could not judge some of the time, and told nothing of it: feed gate has sent"
    assert any(remark.startswith(said) for remark in made.remarks)
    assert said in (folder / "day.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--date", "30.11.2026"], "expected a day as 2026-11-30"),
        (["--date", "2026-11-29"], "nothing was recorded on 2026-11-29"),
        (["--recordings", "nowhere"], "expected recordings"),
    ],
)
def test_what_cannot_be_reported_is_said_in_a_line(
    folder: Path, options: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    default = [] if "--recordings" in options else ["--recordings", str(folder / "recordings")]
    with pytest.raises(SystemExit) as ended:
        main(["day-report", str(folder / "site.toml"), *default, *options])
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_the_command_prints_one_object(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recorded = str(folder / "recordings")
    with pytest.raises(SystemExit) as ended:
        main(["day-report", str(folder / "site.toml"), "--recordings", recorded, "--json"])
    assert ended.value.code == 0
    assert json.loads(capsys.readouterr().out)["people"] == 2
    assert (folder / "recordings" / "day-report.html").is_file()


def test_a_reopened_alert_is_open_and_severity_only_rises() -> None:
    def event(phase: str, **said: object) -> dict:
        rule = {"id": "a", "kind": "zone.enter"}
        return {"data": {"event": "e", "phase": phase, "rule": rule, "t_start_s": 1.0, **said}}

    (alert,) = alerts_of([
        event("new", severity="warning"), event("update", severity="alarm"),
        event("end", severity="warning", t_end_s=4.0), event("close", reason="true"),
        event("reopen"),
    ])  # fmt: skip
    assert (alert.severity, alert.end_s, alert.reason) == ("alarm", 4.0, None)
    (day,) = rule_days([alert], 0.0, {})
    assert day.open == 1
    assert np.isnan(day.false_per_camera_day)


def test_a_day_that_is_not_one_of_a_dated_recording_is_told(tmp_path: Path) -> None:
    write_rig(ring(3), tmp_path / "rig.toml")
    (tmp_path / "site.toml").write_text(TEXT)
    recording = tmp_path / "recordings" / "old"
    recording.mkdir(parents=True)
    with tracks_recorder(recording, TracksInfo(rig_sha256="")) as tracks:
        tracks.write(snapshot(1.0, [3]))
    with pytest.raises(InputError, match="do not know their date"):
        day_report(
            tmp_path / "site.toml", tmp_path / "recordings", tmp_path / "x.html",
            day=date(2026, 11, 30),
        )  # fmt: skip
