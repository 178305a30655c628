"""`railjoule study robust`."""

import json

import pandas as pd

from railjoule.dashboard.command.cli import OK, main

ASKED = ["study", "robust", "liashenko-ii", "--probability", "0.8", "--candidates", "8"]
DRAWS = ["--set", "montecarlo.runs=300"]


def test_the_robust_plan_stands_beside_the_nominal_one(capsys, tmp_path):
    table, run = tmp_path / "plans.csv", tmp_path / "run.csv"
    assert main([*ASKED, "-o", str(table), "--trajectory", str(run), "--json", *DRAWS]) == OK
    answer = json.loads(capsys.readouterr().out)
    robust, nominal = answer["robust"], answer["nominal"]
    assert answer["is_held"]
    assert robust["check"]["runs"] == 300
    assert robust["check"]["share_on_time"] > 0.8 > nominal["check"]["share_on_time"]
    plans = pd.read_csv(table)
    assert len(plans) == answer["candidates"] == 9
    assert plans[plans.is_chosen == 1].iloc[0].expected_kwh == robust["search"]["expected_kwh"]
    assert pd.read_csv(run)["time_s"].iloc[-1] == robust["planned_time_s"]


def test_for_people_it_is_a_table(capsys, tmp_path):
    assert main([*ASKED, "-o", str(tmp_path / "plans.csv"), *DRAWS]) == OK
    text = capsys.readouterr().out
    assert "robust plan, on time with 80.0 %" in text
    assert "it is on time in at least 80.0 % of the runs" in " ".join(text.split())
