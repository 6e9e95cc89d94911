"""What `evaluate` says of files where no truth is known."""

import json

import numpy as np
import pytest

from made_people import STANDING_M, snapshots, track
from trecsim.cli import main
from trecsim.lab.evaluation.evaluating import evaluate
from trecsim.lab.evaluation.limbs import LIMBS
from trecsim.store.tracks import tracks_writer

STEP_S = 0.04


@pytest.fixture
def recording(tmp_path):
    """Return tracks of somebody who got another identity half a second after losing the first."""
    early, late = np.arange(50) * STEP_S, 2.48 + np.arange(50) * STEP_S
    beside_m = STANDING_M + np.array([0.4, 0.0, 0.0])
    people = [track(0, early), track(3, late, np.array([beside_m] * 50), support=1)]
    with tracks_writer(tmp_path / "tracks.csv") as writer:
        for snapshot in snapshots(people):
            writer.write(snapshot)
    return tmp_path / "tracks.csv"


@pytest.fixture
def measured(tmp_path):
    path = tmp_path / "measured.toml"
    path.write_text(
        'format = "trecsim.limbs/1"\n[subjects.one]\npeople = [0]\n'
        'lengths_cm = { "left shin" = 42, "waist" = 20 }\n'
    )
    return path


def test_lives_breaks_and_lengths_are_told(recording, measured):
    result = evaluate(recording, lengths=measured)
    assert [(life.person, life.moments, life.gaps) for life in result.lifetimes] == [
        (0, 50, 0),
        (3, 50, 0),
    ]
    assert [(one.ended, one.began) for one in result.fragmentations] == [(0, 3)]
    assert result.fragmentations[0].pause_s == pytest.approx(0.52)
    shin = result.limbs[LIMBS.index("left shin")]
    assert (shin.person, shin.n) == (0, 50)
    assert shin.difference_m == pytest.approx(-0.02, abs=1e-6)
    assert result.limb_summary.difference_m == pytest.approx(0.01, abs=1e-6)
    assert result.limb_summary.sd_m == pytest.approx(0.0, abs=1e-6)
    assert result.jitter[0].jitter_m == pytest.approx(0.0, abs=1e-6)
    assert result.support[0].shares == (0.0, 0.5, 0.0, 0.5)


def test_the_command_tells_them_too(recording, measured, capsys):
    with pytest.raises(SystemExit) as end:
        main(["evaluate", str(recording), "--lengths", str(measured), "--json"])
    assert end.value.code == 0
    (facts,) = json.loads(capsys.readouterr().out)["tracks"]
    assert [life["person"] for life in facts["lifetimes"]] == [0, 3]
    assert [(one["ended"], one["began"]) for one in facts["breaks"]] == [(0, 3)]
    assert facts["fragmentations"] == facts["breaks"]
    rows = {(row["person"], row["limb"]): row for row in facts["limbs"]["rows"]}
    assert rows[0, "left shin"]["difference_cm"] == pytest.approx(-2.0, abs=1e-4)
    assert rows[3, "left shin"]["difference_cm"] is None
    assert facts["reprojection"] is None
