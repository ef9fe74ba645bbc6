"""Tests of the scripts beside this file, in the environment of tilupy: python3 validation/tests.py [RESULT.nc]

Without RESULT.nc the demo is run. No AvaFrame is needed.
"""

import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

from environment import enter, guarded
from locate import program
from tilupy_reader import TILUPY

RESULT = None


def demo(folder):
    subprocess.run([program(), "demo", "--out", str(folder / "demo")], check=True, capture_output=True)
    return folder / "demo" / "result.nc"


class Scores(unittest.TestCase):
    def test_areas_count_cells(self):
        import numpy
        import scores

        reference, run = numpy.array([[2.0, 2, 0], [0, 1, 0]]), numpy.array([[0.0, 2, 2], [0, 1, 0.9]])
        found = scores.areas(reference, run, 1.0, 10.0)
        self.assertEqual((found.reference, found.run, found.missed, found.false), (300, 300, 100, 100))
        self.assertEqual((found.jaccard, found.covered), (0.5, 2 / 3))
        self.assertTrue(math.isnan(scores.areas(reference, run, 9.0, 10.0).jaccard))

    def test_runout_is_the_line_from_the_highest_released_cell(self):
        import numpy
        import scores
        from rasterio.transform import from_origin

        heights = numpy.array([[100.0, 90, 80, 70]])
        released = numpy.array([[True, True, False, False]])
        length, angle = scores.runout(numpy.array([[5.0, 5, 5, 0.5]]), heights, released, from_origin(0, 10, 10, 10))
        self.assertEqual(length, 20)
        self.assertAlmostEqual(angle, 45)
        self.assertEqual(scores.runout(numpy.zeros((1, 4)), heights, released, from_origin(0, 10, 10, 10)), (None, None))


class Entrainment(unittest.TestCase):
    def test_the_layer_lies_on_data_that_no_release_touches(self):
        import entrainment
        import numpy
        import rasterio
        from rasterio.transform import from_origin

        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            heights = numpy.full((3, 4), 100.0, "float32")
            heights[2, 3] = -9999
            with rasterio.open(folder / "dem.tif", "w", driver="GTiff", width=4, height=3, count=1, dtype="float32", nodata=-9999,
                               transform=from_origin(0, 30, 10, 10)) as file:
                file.write(heights, 1)
            release = {"type": "Polygon", "coordinates": [[[2, 22], [8, 22], [8, 28], [2, 28], [2, 22]]]}
            path = entrainment.layer(folder / "layer.tif", folder / "dem.tif", [release], 0.25)
            with rasterio.open(path) as file:
                values = file.read(1)
            self.assertEqual(values.sum(), 0.25 * 10)
            self.assertEqual((values[0, 0], values[2, 3], values[0, 1]), (0, 0, 0.25))

    def test_what_com1dfa_entrained_is_what_its_mass_grew_by(self):
        import types

        import entrainment

        with tempfile.TemporaryDirectory() as folder:
            outputs = pathlib.Path(folder) / "Outputs" / "com1DFA"
            outputs.mkdir(parents=True)
            (outputs / "mass_a.txt").write_text("time, current, entrained\n0.1, 100.0, 0.0\n0.2, 130.5, 30.5\n0.3, 150.5, 20.0\n", encoding="utf-8")
            run = types.SimpleNamespace(version="AvaFrame 2.1", folder=pathlib.Path(folder))
            self.assertEqual(entrainment.entrained(run), 50.5)


class Similarity(unittest.TestCase):
    def test_without_friction_the_half_axis_is_a_root(self):
        import numpy
        import similarity

        cap = similarity.Cap(math.radians(35), 0.0)
        times = numpy.array([0.0, 1.0, 5.0])
        (p, dp, q, dq), place, _ = similarity.solution(cap, times)
        k = 2 * cap.gravity * math.cos(cap.zeta) * cap.height / cap.length**2
        numpy.testing.assert_allclose(p, numpy.sqrt(1 + k * times**2), rtol=1e-6)
        numpy.testing.assert_allclose(q, p, rtol=1e-9)
        numpy.testing.assert_allclose(dp, k * times / p, rtol=1e-6, atol=1e-12)
        numpy.testing.assert_allclose(place, cap.gravity * math.sin(cap.zeta) * times**2 / 2)

    def test_friction_narrows_the_cap_and_keeps_its_volume(self):
        import numpy
        import similarity

        cap = similarity.Cap(math.radians(35), math.radians(25))
        x, y = similarity.grids(cap, 2.0, 5)
        frames = similarity.fields(cap, numpy.array([0.0, 5.0]), x, y)
        volumes = [frame[0].sum() * 4 / math.cos(cap.zeta) for frame in frames]
        numpy.testing.assert_allclose(volumes, math.pi / 2 * cap.height * cap.length**2, rtol=2e-3)
        (p, _, q, _), _, _ = similarity.solution(cap, numpy.array([5.0]))
        self.assertLess(q[0], p[0])


class Tilupy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        import netCDF4
        import tilupy.read
        import tilupy_reader

        tilupy_reader.register()
        cls.run_read = tilupy.read.get_results("granflow", file=RESULT)
        cls.data = netCDF4.Dataset(RESULT)

    def test_arrays_are_those_of_the_file_rows_from_the_north_time_last(self):
        import numpy

        own = numpy.nan_to_num(numpy.ma.filled(self.data["thickness"][:].astype(float), 0.0))
        numpy.testing.assert_array_equal(self.run_read.h, own[:, ::-1].transpose(1, 2, 0))
        place = numpy.unravel_index(numpy.argmax(self.run_read.get_output("h_final").d), self.run_read.zinit.shape)
        north = self.run_read.y[::-1][place[0]]
        self.assertEqual(north, self.data["y"][:][numpy.unravel_index(numpy.argmax(own[-1]), own[-1].shape)[0]])

    def test_peaks_see_every_step(self):
        import numpy

        frames = numpy.where(self.run_read.h > 0.02, self.run_read.h, 0).max(-1)
        self.assertTrue((self.run_read.h_max >= frames * (1 - 1e-6)).all())
        self.assertGreater(self.run_read.h_max.max(), 0)

    def test_volume_by_its_slopes_is_ours(self):
        import json

        summary = json.loads((pathlib.Path(RESULT).parent / "summary.json").read_text(encoding="utf-8"))
        volume = self.run_read.get_output("volume").d
        self.assertAlmostEqual(volume[0] / summary["mass_initial"], 1, delta=0.01)
        self.assertAlmostEqual(volume[-1] / summary["mass_final"], 1, delta=0.01)

    def test_a_copy_in_shaltops_layout_reads_the_same(self):
        import numpy
        import tilupy.read

        run = self.run_read
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "data2").mkdir()
            half = run.dx / 2
            (folder / "params.txt").write_text(f"nx {run.nx}\nny {run.ny}\nper {run.nx * run.dx}\npery {run.ny * run.dy}\n"
                                               f"x0 {run.x[0] - half}\ny0 {run.y[0] - half}\nfile_z_init z.d\n", encoding="utf-8")
            numpy.savetxt(folder / "z.d", run.zinit[::-1].ravel())
            numpy.savetxt(folder / "data2" / "z.d", run.zinit[::-1].ravel())
            run.h[::-1].transpose(1, 0, 2).astype("float32").ravel(order="F").tofile(folder / "data2" / "rho.bin")
            numpy.savetxt(folder / "data2" / "time_im.d", run.tim)
            other = tilupy.read.get_results("shaltop", folder=str(folder))
            numpy.testing.assert_allclose(other.x, run.x)
            numpy.testing.assert_allclose(other.zinit, run.zinit)
            numpy.testing.assert_array_equal(other.get_output("h").d, run.h.astype("float32"))

    def test_tilupys_index_is_our_index_of_jaccard(self):
        import scores
        import tilupy.calibration

        first, last = self.run_read.get_output("h_init").d, self.run_read.h_max
        _, (index,) = tilupy.calibration.CSI(self.run_read, observation=first > 0.5, h_threshs=[0.5], state="h_max")
        self.assertAlmostEqual(index, scores.areas(first, last, 0.5, 1.0).jaccard)
        self.assertLess(index, 1)

    def test_calibration_takes_the_code_by_its_name(self):
        import pandas
        import tilupy.calibration

        table = tilupy.calibration.eval_simus(pandas.DataFrame({"file": [str(RESULT)]}), "CSI", [0.5],
                                              {"observation": self.run_read.h_max > 0.5, "state": "h_max"}, model_name="granflow")
        self.assertEqual(table["CSI"].iloc[0], 1.0)
        self.assertAlmostEqual(table["delta1"].iloc[0], math.degrees(math.atan(0.4)))

    def test_what_is_no_avalanche_is_refused_with_a_cure(self):
        import netCDF4
        import tilupy_reader
        from environment import Refusal

        with tempfile.TemporaryDirectory() as name:
            path = pathlib.Path(name) / "result.nc"
            netCDF4.Dataset(path, "w").close()
            with self.assertRaisesRegex(Refusal, "thickness(.|\n)*cure: "):
                tilupy_reader.Results(file=path)


def main():
    global RESULT
    enter("tilupy", TILUPY)
    with tempfile.TemporaryDirectory() as name:
        RESULT = sys.argv[1] if len(sys.argv) > 1 else str(demo(pathlib.Path(name)))
        return not unittest.main(argv=[sys.argv[0]], exit=False).result.wasSuccessful()


if __name__ == "__main__":
    guarded(main)
