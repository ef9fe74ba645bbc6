"""Cases: from a path, a text, keywords; arrays and geometries in the place of files; errors."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import xarray as xr

import granflow


def test_a_path_a_text_and_keywords_are_the_same_case(silo, tmp_path):
    path = tmp_path / "silo.toml"
    path.write_text(silo.text)
    words = granflow.Case(
        title="A silo breaks",
        model="savage_hutter",
        grid={"x": {"from": -6.0, "to": 6.0, "cells": 240}},
        material={"friction": {"coulomb": {"angle": "18 deg"}}},
        initial={"thickness": {"steps": {"at": np.array([-1.0, 1.0]), "values": [0.3, 2.3, 0.3]}}},
        time={"until": "rest"},
    )
    assert granflow.Case(path).to_toml() == silo.to_toml() == words.to_toml()
    assert granflow.Case(str(path)).to_toml() == silo.to_toml()


def test_set_changes_a_key_and_nothing_where_it_fails(silo):
    before = silo.copy()
    assert silo.set("material.friction.coulomb", {"mu": np.float32(0.25)}) is silo
    assert "mu = 0.25" in silo.to_toml() and "mu = 0.25" not in before.to_toml()
    text = silo.text
    with pytest.raises(granflow.CaseError):
        silo.set("grid.x.cels", 12)
    assert silo.text == text
    for key, value in {"title": 'a "b" \\ c\n\x7fé', "time.end": 1e300, "time.until": "rest"}.items():
        silo.set(key, value)
    assert silo.copy().text == silo.text


def test_an_error_has_its_place_and_cure(silo, tmp_path):
    path = tmp_path / "silo.toml"
    path.write_text(silo.text.replace("cells", "cels"))
    with pytest.raises(ValueError) as caught:
        granflow.Case(path)
    error = caught.value
    assert isinstance(error, granflow.CaseError)
    assert (error.file, error.line, error.key) == (str(path), 4, "grid.x.cels")
    assert "did you mean `cells`?" in error.help and "unknown key" in error.message
    assert str(error).startswith(f"{path}:4:")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.line == 4
    with pytest.raises(granflow.CaseError, match="found -0.4, expected"):
        granflow.Case(silo.text).set("material.friction.coulomb", {"mu": -0.4}).check()


def test_a_missing_file_is_a_missing_file(silo, tmp_path):
    (tmp_path / "silo.toml").write_text(silo.text)
    with pytest.raises(FileNotFoundError, match=r"did you mean .*silo\.toml"):
        granflow.Case(tmp_path / "sillo.toml")
    with pytest.raises(FileNotFoundError) as caught:
        silo.set("initial.thickness", {"file": "nowhere.npy"}).check()
    assert isinstance(caught.value, granflow.CaseError) and caught.value.key.startswith("initial.thickness")


@pytest.mark.parametrize(
    "given, part",
    [
        (object(), "no value of type object"),
        (None, "no value of type NoneType"),
        (1j, "no value of type complex"),
    ],
)
def test_what_toml_has_no_word_for_is_refused(silo, given, part):
    with pytest.raises(TypeError, match=part):
        silo.set("title", given)


def test_a_line_and_a_plane_from_arrays(silo):
    x = np.linspace(-5.975, 5.975, 240)
    h = np.where(abs(x) < 1.0, 2.3, 0.3)
    ds = granflow.run(silo.set("initial.thickness", h), progress=False)
    assert np.array_equal(ds.thickness[0], h)
    plane = silo.copy().set("grid.y", {"from": 0.0, "to": 1.0, "cells": 3}).set("time", {"steps": 2})
    h = np.arange(720.0).reshape(3, 240) / 720.0
    ds = granflow.run(plane.set("initial.thickness", h), progress=False)
    assert np.array_equal(ds.thickness[0], h)
    with pytest.raises(ValueError, match=r"shape \(2, 240\), the grid needs \(3, 240\)"):
        plane.set("initial.thickness", h[:2]).check()


def test_rasters_come_in_every_order_of_rows(mountain):
    south = mountain.raster()
    north = granflow.Raster(mountain.bed[::-1], 10.0, crs="EPSG:31287", first_row="north")
    rows, _ = mountain.bed.shape
    affine = granflow.Raster.from_transform(mountain.bed[::-1], (10, 0, 0, 0, -10, 10.0 * rows), 31287)
    array = xr.DataArray(mountain.bed, {"y": mountain.y, "x": mountain.x}, ("y", "x"))
    array = array.assign_coords(spatial_ref=((), 0, {"spatial_ref": "EPSG:31287"}))
    falling = array.isel(y=slice(None, None, -1)).expand_dims(band=1)
    cases = [mountain.case(dem=dem) for dem in (south, north, affine, array, falling)]
    first, *others = (granflow.run(case.set("time", {"steps": 3}), progress=False) for case in cases)
    for other in others:
        assert np.array_equal(first.bed, other.bed) and first.crs.attrs == other.crs.attrs
        assert np.array_equal(first.x, other.x) and np.array_equal(first.y, other.y)


def test_what_is_masked_or_declared_is_nodata(mountain):
    hole = np.zeros(mountain.bed.shape, dtype=bool)
    hole[:, -20:] = True
    masked = np.ma.masked_array(np.where(hole, -9999.0, mountain.bed), hole)
    declared = xr.DataArray(masked.data.T, {"x": mountain.x, "y": mountain.y}, ("x", "y"), attrs={"_FillValue": -9999.0})
    for dem in (granflow.Raster(masked, 10.0), declared):
        ds = granflow.run(mountain.case(dem=dem).set("time", {"steps": 1}), progress=False)
        assert np.array_equal(np.isnan(ds.bed.values), hole)


def test_rioxarray_says_the_system(mountain):
    pytest.importorskip("rioxarray")
    array = xr.DataArray(mountain.bed, {"y": mountain.y, "x": mountain.x}, ("y", "x")).rio.write_crs("EPSG:32632")
    assert granflow.Raster.from_dataarray(array).system() == "EPSG:32632"
    assert "EPSG:32632" in mountain.case(dem=array).describe()


def test_releases_from_geometries(mountain):
    shapely = pytest.importorskip("shapely")
    disc = shapely.Point(200.0, 300.0).buffer(60.0)
    volumes = []
    for release in (
        [{"polygons": disc, "thickness": 1.5, "measured": "vertical"}],
        [{"polygons": [disc, shapely.Point(200.0, 300.0).buffer(5.0)], "thickness": 1.5, "measured": "vertical"}],
        [{"polygons": disc.__geo_interface__, "thickness": 1.5, "measured": "vertical"}],
    ):
        case = mountain.case().set("release", release).set("time", {"steps": 1})
        volumes.append(granflow.run(case, progress=False).granflow.summary["mass_initial"])
    assert np.allclose(volumes, 1.5 * disc.area, rtol=1e-12)
    with pytest.raises(granflow.CaseError, match="thickness"):
        mountain.case().set("release", [{"polygons": disc}]).check()


def test_a_geodataframe_brings_attributes_and_system(mountain):
    geopandas = pytest.importorskip("geopandas")
    shapely = pytest.importorskip("shapely")
    frame = geopandas.GeoDataFrame(
        {"thickness": [1.0, 2.0], "observed": [np.nan, 3.0]},
        geometry=[shapely.box(150, 250, 200, 300), shapely.box(200, 250, 250, 300)],
        crs="EPSG:31287",
    )
    release = [{"polygons": frame, "thickness": {"attribute": "thickness"}, "measured": "vertical"}]
    case = mountain.case().set("release", release).set("time", {"steps": 1})
    assert np.isclose(granflow.run(case, progress=False).granflow.summary["mass_initial"], 7500.0)
    with pytest.raises(ValueError, match="EPSG:32632"):
        granflow.run(case.set("release", [{**release[0], "polygons": frame.set_crs(32632, allow_override=True)}]))


def test_parameters_in_space(mountain):
    uniform = granflow.run(mountain.case(), progress=False)
    field = np.full(mountain.bed.shape, 0.35)
    same = granflow.run(mountain.case().set("material.friction.coulomb.mu", field), progress=False)
    assert np.allclose(uniform.deposit.fillna(0.0), same.deposit.fillna(0.0), atol=1e-4)
    field[:, 60:] = 0.7
    rough = granflow.run(mountain.case().set("material.friction.coulomb.mu", field), progress=False)
    assert rough.granflow.summary["runout"] < 0.9 * uniform.granflow.summary["runout"]
    with pytest.raises(granflow.CaseError, match=r"found -0\.175 at \(5, 5\), expected a number >= 0"):
        granflow.run(mountain.case().set("material.friction.coulomb.mu", -field / 2))


def test_what_says_no_place_is_refused(mountain):
    with pytest.raises(ValueError, match=r"granflow\.Raster\(values, cell=5\.0"):
        mountain.case(dem=mountain.bed)
    with pytest.raises(ValueError, match=r"shape \(2, 2\)"):
        mountain.case().set("release", [{"raster": np.ones((2, 2))}])
    with pytest.raises(ValueError, match="has no coordinates"):
        mountain.case(dem=xr.DataArray(mountain.bed, dims=("y", "x")))
    with pytest.raises(ValueError, match="number > 0"):
        granflow.Raster(mountain.bed, 0.0)
    with pytest.raises(ValueError, match="square"):
        granflow.Raster.from_transform(mountain.bed, (10, 0, 0, 0, -5, 0))
    with pytest.raises(ValueError, match="gdalwarp"):
        granflow.run(mountain.case(dem=granflow.Raster(mountain.bed, 1e-3, 11.0, 47.0, 4326)))


def test_a_case_keeps_what_it_was_given(mountain):
    bed = mountain.bed.copy()
    case = mountain.case(dem=granflow.Raster(bed, 10.0)).set("time", {"steps": 1})
    bed[:] = 0.0
    assert float(granflow.run(case, progress=False).bed.max()) > 600.0


def test_a_case_that_is_sent_on_keeps_what_it_was_given(mountain):
    bed, release = mountain.bed.copy(), mountain.thickness.copy()
    case = granflow.Case(
        terrain={"dem": granflow.Raster(bed[::-1], 10.0, first_row="north")},
        material={"density": 200.0, "friction": {"coulomb": {"mu": 0.35}}},
        release=[{"raster": release[::-1]}],
        time={"steps": 1},
    )
    before = granflow.run(case, progress=False)
    bed[:], release[:] = 0.0, 0.0
    sent = granflow.run(pickle.loads(pickle.dumps(case)), progress=False)
    assert np.array_equal(sent.bed, before.bed) and np.array_equal(sent.thickness, before.thickness)
    assert float(before.bed.max()) > 600.0 and float(before.thickness.max()) > 0.0


def test_messages_on_what_is_in_memory_have_a_cure_in_python(mountain):
    undeclared = np.where(mountain.bed > 650.0, -9999.0, mountain.bed)
    with pytest.raises(ValueError, match=r"in Python: numpy\.where"):
        granflow.run(mountain.case(dem=granflow.Raster(undeclared, 10.0)), progress=False)
    with pytest.raises(granflow.CaseError, match=r"Case\.set replaces the whole choice") as caught:
        mountain.case().set("material.friction.coulom.mu", 0.3)
    assert "--set" not in caught.value.help
    array = xr.DataArray(mountain.bed, {"y": mountain.y, "x": mountain.x}, ("y", "x"))
    with pytest.raises(ValueError, match="sortby"):
        granflow.Raster.from_dataarray(array.isel(x=slice(None, None, -1)))
    with pytest.raises(TypeError, match="a Dataset has several variables"):
        mountain.case(dem=array.to_dataset(name="elevation"))


@pytest.mark.parametrize("name, value", [("cell", "5"), ("cell", float("inf")), ("west", float("nan"))])
def test_a_raster_lies_somewhere(mountain, name, value):
    with pytest.raises(ValueError, match=f"{name} = .*a number, in metres"):
        granflow.Raster(mountain.bed, **{"cell": 10.0, name: value})


def test_what_is_no_case_is_refused(silo):
    for given in ("", b"silo.toml", 3):
        with pytest.raises(TypeError, match="a case is a path"):
            granflow.Case(given)
    with pytest.raises(ValueError, match="threads = -1"):
        granflow.run(silo, threads=-1)
    sim = granflow.Simulation(silo)
    sim.until(0.5)
    with pytest.raises(ValueError, match="time 0.1 is over"):
        sim.until(0.1)
