"""Pictures, and the program."""

from __future__ import annotations

import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest

import granflow


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def slide(request):
    mountain = request.getfixturevalue("mountain")
    return granflow.run(mountain.case(), progress=False)


def test_a_map_shows_the_values_in_their_places(slide):
    ax = slide.granflow.plot()
    mesh = ax.collections[-1]
    assert ax.images, "the shaded mountain lies below"
    assert np.nanmax(mesh.get_array()) == pytest.approx(float(slide.peak_thickness.max()))
    assert ax.get_xlabel() == "x (m)" and ax.get_title() == "A mountain"
    thickness = slide.granflow.map("thickness", time=20.0, ax=plt.figure().gca())
    assert thickness.get_title() == f"A mountain, t = {float(slide.time.sel(time=20.0, method='nearest')):.4g} s"
    with pytest.raises(KeyError, match="'depth'; there are"):
        slide.granflow.map("depth")


def test_a_section_follows_the_path(slide):
    path = slide.granflow.path()
    assert path.shape[1] == 2 and np.all(np.diff(path[:, 0]) >= 0.0) and np.allclose(path[:, 1], 300.0, atol=1.0)
    ax = slide.granflow.section(exaggeration=5.0)
    bed = ax.lines[0].get_ydata()
    assert bed[0] > bed[-1] + 100.0
    slide.granflow.section([[100.0, 300.0], [900.0, 300.0]], time=0.0)
    with pytest.raises(ValueError, match="points, 2"):
        slide.granflow.section([1.0, 2.0])


def test_lines_and_piles(silo):
    line = granflow.run(silo, progress=False)
    ax = line.granflow.plot(times=[0.0, 1.0])
    assert [one.get_label() for one in ax.lines] == ["t = 0", "t = 1"]
    with pytest.raises(ValueError, match="terrain"):
        line.granflow.section()
    pile = granflow.run(
        {
            "model": "hadeler_kuttler",
            "grid": {"x": {"from": 0.0, "to": 1.0, "cells": 12}, "y": {"from": 0.0, "to": 1.0, "cells": 12}},
            "table": {"open": "all"},
            "source": [{"rate": 0.5}],
            "time": {"until": "steady", "method": "direct"},
        },
        progress=False,
    )
    assert pile.granflow.plot().name == "3d"
    assert pile.granflow.map("rolling_layer").collections


def test_an_animation_plays(silo, slide):
    for ds in (granflow.run(silo, progress=False), slide):
        html = ds.isel(time=slice(0, 3)).granflow.animate().to_jshtml()
        assert html.count("data:image/png") >= 3


def test_the_program_is_the_same_program(tmp_path):
    def granflow_(*words):
        return subprocess.run([sys.executable, "-m", "granflow", *words], capture_output=True, text=True, cwd=tmp_path)

    assert granflow_("--version").stdout.strip() == f"granflow {granflow.__version__}"
    assert granflow_("new", "silo").returncode == 0 and (tmp_path / "silo.toml").exists()
    assert granflow_("run", "nowhere.toml").returncode == 4
    bad = granflow_("run", "silo.toml", "--set", "grid.boundry=open")
    assert bad.returncode == 2 and "did you mean `boundary`?" in bad.stderr
    assert granflow_("frobnicate").returncode == 2


def test_a_map_shows_what_is_thicker_than_the_threshold(slide):
    series = slide.granflow.map("thickness", time=20.0).collections[-1].get_array()
    instant = slide.thickness.sel(time=20.0, method="nearest").values
    assert np.array_equal(np.ma.getmaskarray(series), ~(instant > 0.01))
    backward = slide.assign(velocity_x=-slide.velocity_x)
    mesh = backward.granflow.map("velocity_x", time=20.0).collections[-1]
    assert np.nanmin(mesh.get_array()) < 0.0 and mesh.get_clim()[0] == -mesh.get_clim()[1]
    begin = slide.granflow.map("arrival_time").collections[-1].get_array()
    assert np.ma.count(begin) > 0 and begin.min() == 0.0, "the release is shown, which was there from the start"


def test_a_section_says_how_much_it_exaggerates(slide):
    assert ", thickness x " in slide.granflow.section().get_title()
    assert "thickness x" not in slide.granflow.section(exaggeration=1.0).get_title()


def test_the_mountain_is_drawn_with_what_lies_on_it(slide):
    ax = slide.granflow.surface(time=20.0)
    assert ax.get_zlabel() == "elevation (m)"
    colours = ax.collections[-1].get_facecolor()
    assert np.any(np.ptp(colours[:, :3], axis=1) > 0.2), "what flows is coloured on a grey mountain"


def test_an_ensemble_shows_how_probable_it_is(mountain):
    case = mountain.case().set("time", {"end": 3.0})
    vary = {"material.friction.coulomb.mu": {"uniform": [0.3, 0.4]}}
    case.set("ensemble", {"members": 2, "vary": vary, "exceed": {"peak_pressure": [1.0]}})
    ax = granflow.Ensemble(case).run(progress=False).granflow.plot()
    assert "exceeded 1 kPa" in ax.get_title() and ax.collections[-1].get_clim() == (0.0, 1.0)
