"""Variants of rasters and shapefiles, read by granflow and by rasterio or fiona; pairs of systems, compared by granflow and pyproj."""

import json
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import warnings

import fiona
import numpy
import pyproj
import rasterio
from fiona.transform import transform_geom
from rasterio.transform import Affine, from_origin

warnings.simplefilter("ignore")
READ = pathlib.Path(__file__).parent.parent / "target/release/examples/read"
ROWS, COLUMNS, CELL = 40, 48, 5.0
PLACE = from_origin(500000.0, 5200000.0, CELL, CELL)
FEET = {"metre": 1.0, "foot": 0.3048, "ft": 0.3048, "us-ft": 1200 / 3937, "US survey foot": 1200 / 3937, "cm": 0.01, "m": 1.0}
results = []


def granflow(*words, stdin=None):
    done = subprocess.run([READ, *map(str, words)], input=stdin, capture_output=True, text=True, check=False)
    return json.loads(done.stdout)


def ground():
    y, x = numpy.mgrid[0:ROWS, 0:COLUMNS]
    return (1500 + 2.0 * x - 1.5 * y + 5 * numpy.sin(x / 3)).astype("float32")


def tiff(path, values=None, **profile):
    values = ground() if values is None else values
    values = values if values.ndim == 3 else values[None]
    base = dict(driver="GTiff", width=COLUMNS, height=ROWS, count=len(values), dtype=values.dtype, transform=PLACE)
    with rasterio.open(path, "w", **{**base, "crs": "EPSG:25832", **profile}) as file:
        file.write(values)
    return path


def holes(value, dtype="float32"):
    values = ground().astype(dtype)
    values[5:15, 20:30] = value
    return values


def sidecar(path, band="", top=""):
    text = f'<PAMDataset>{top}<PAMRasterBand band="1">{band}</PAMRasterBand></PAMDataset>'
    path.with_name(path.name + ".aux.xml").write_text(text)
    return path


def grid(path, head=None, values=None, separator=" ", **change):
    entries = dict(ncols=COLUMNS, nrows=ROWS, xllcorner=500000, yllcorner=5199800, cellsize=5, NODATA_value=-9999)
    entries = {key: value for key, value in {**entries, **change}.items() if value is not None}
    head = head or "".join(f"{key} {value}\n" for key, value in entries.items())
    values = ground() if values is None else values
    path.write_text(head + "\n".join(separator.join(f"{z:.3f}" for z in row) for row in values) + "\n")
    return path


def metres(file):
    """Metres of one unit of the values, by rasterio's unit of the band and pyproj's reading of the system."""
    if file.units[0]:
        return FEET[file.units[0]]
    if file.crs:
        parts = pyproj.CRS.from_wkt(file.crs.to_wkt()).sub_crs_list
        for part in parts:
            if part.is_vertical:
                return part.axis_info[0].unit_conversion_factor
    return 1.0


def expected(path):
    """The raster as GDAL reads it: values in metres south first, west, south, cell."""
    with rasterio.open(path) as file:
        values = file.read(1, masked=True).astype("float64").filled(numpy.nan)
        values = (values * file.scales[0] + file.offsets[0]) * metres(file)
        south = file.transform.f + min(file.transform.e, 0.0) * file.height
        values = values[::-1] if file.transform.e < 0 else values
        return values, file.transform.c, south, file.transform.a


def near(path):
    """A system in metres that is true at the place of a variant, as a user would choose it: those in feet are in North Carolina."""
    if path.suffix not in (".tif", ".asc"):
        return "EPSG:25832"
    with rasterio.open(path) as file:
        return "EPSG:32617" if file.transform.c == 1000000 else "EPSG:25832"


def cure(answer, path, after):
    """Runs the command that a refusal offers and reads what it writes; what came of it, in words."""
    commands = re.findall(r"^  ((?:gdal|ogr)\S+ .*)$", answer["refused"], re.M)
    if not commands:
        return "refused, a step by hand"
    for command in commands:
        command = command.replace("EPSG:xxxx", near(path)).replace("THIS_FILE", str(path))
        words = command.split()
        if shutil.which(words[0]) is None:
            return f"refused, {words[0]} is not here"
        done = subprocess.run(command, shell=True, cwd=path.parent, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(f"the cure fails: {command}: {done.stderr or done.stdout}")
    written = [path.parent / word for word in words if word.endswith((".tif", ".shp", ".geojson", ".asc", ".prj"))]
    last = written[0] if words[0].startswith("ogr") else written[-1]
    return after(last)


def raster(name, make, wanted=None, crs=(), refused=None):
    """A variant; `wanted` where GDAL cannot read it or reads it otherwise; `refused` where it must be, with these words."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            path = make(pathlib.Path(folder) / "dem.tif")
            answer = granflow("raster", path, *crs)
            if "refused" in answer:
                assert refused and refused in answer["refused"], answer["refused"]
                again = lambda last: "refused, cured" if "values" in granflow("raster", last) else f"the cure is refused: {granflow('raster', last)['refused']}"
                outcome = cure(answer, path, again)
                assert not outcome.startswith("the cure"), outcome
            else:
                assert not refused, "it is read, and was to be refused"
                values, west, south, cell = expected(path) if wanted is None else (wanted(), 500000.0, 5199800.0, 5.0)
                own = numpy.array([numpy.nan if z is None else z for z in answer["values"]]).reshape(values.shape)
                assert numpy.allclose(own, values, rtol=1e-6, atol=1e-3, equal_nan=True), "values differ"
                assert abs(answer["west"] - west) + abs(answer["south"] - south) + abs(answer["cell"] - cell) < 1e-6
                outcome = "equal"
        except AssertionError as error:
            outcome = f"FAILED: {error}"
    results.append((name, outcome))


def masked(path, internal):
    tiff(path, nodata=None)
    mask = numpy.full((ROWS, COLUMNS), 255, "uint8")
    mask[3:9, 10:20] = 0
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=internal), rasterio.open(path, "r+") as file:
        file.write_mask(mask)
    return path


def alpha(path, bands=1, kind="uint16"):
    values = numpy.stack([ground()] * bands + [numpy.full((ROWS, COLUMNS), 255)]).astype(kind)
    values[-1, 2:8, 2:12] = 0
    tiff(path, values)
    with rasterio.open(path, "r+") as file:
        file.colorinterp = [rasterio.enums.ColorInterp.gray] + [rasterio.enums.ColorInterp.undefined] * (bands - 1) + [rasterio.enums.ColorInterp.alpha]
    return path


def scaled(path, unit=None, scale=None):
    tiff(path, (ground() * 10).astype("int32"), nodata=-9999)
    with rasterio.open(path, "r+") as file:
        if scale:
            file.scales, file.offsets = (scale,), (7.0,)
        if unit:
            file.units = (unit,)
    return path


def sparse(path, **profile):
    tiles = dict(tiled=True, blockxsize=16, blockysize=16) if profile.pop("tiles", True) else dict(blockysize=4)
    base = dict(driver="GTiff", width=COLUMNS, height=ROWS, count=1, dtype="float32", transform=PLACE, crs="EPSG:25832")
    with rasterio.open(path, "w", SPARSE_OK=True, **tiles, **base, **profile) as file:
        window = rasterio.windows.Window(0, 0, 32, 16)
        file.write(ground()[:16, :32], 1, window=window)
    return path


def asc(make):
    return lambda path: make(path.with_suffix(".asc"))


def with_prj(path, text):
    path.with_suffix(".prj").write_text(text)
    return path


def south_first():
    return ground()[::-1].astype("float64")


def world(path):
    tiff(path, crs=None, transform=None)
    path.with_suffix(".tfw").write_text("5\n0\n0\n-5\n500002.5\n5199997.5\n")
    return path


def transparent():
    values = ground()
    values[2:8, 2:12] = numpy.nan
    return values[::-1]


def rasters():
    for kind in ["uint8", "int16", "uint16", "int32", "float32", "float64"]:
        raster(f"{kind}, nodata 7", lambda p: tiff(p, holes(7, kind), nodata=7))
    for compress in ["lzw", "deflate", "zstd", "packbits"]:
        raster(f"{compress}", lambda p: tiff(p, holes(-9999), nodata=-9999, compress=compress))
    raster("predictor 3, tiles", lambda p: tiff(p, compress="deflate", predictor=3, tiled=True, blockxsize=16, blockysize=16))
    raster("BigTIFF", lambda p: tiff(p, holes(-1), nodata=-1, BIGTIFF="YES"))
    raster("big endian", lambda p: tiff(p, holes(-1), nodata=-1, ENDIANNESS="BIG"))
    raster("nodata nan", lambda p: tiff(p, holes(numpy.nan), nodata=numpy.nan))
    raster("nodata of float", lambda p: tiff(p, holes(-3.4028234663852886e38), nodata=-3.4028234663852886e38))
    raster("pixel is point", lambda p: tiff(p, AREA_OR_POINT="Point", tiled=True, blockxsize=16, blockysize=16))
    raster("sparse tiles, nodata", lambda p: sparse(p, nodata=-9999))
    raster("sparse tiles, no nodata", sparse)
    raster("sparse strips, nodata", lambda p: sparse(p, nodata=-9999, tiles=False))
    raster("sparse tiles, deflate, nodata 0", lambda p: sparse(p, nodata=0, compress="deflate"))
    raster("internal mask", lambda p: masked(p, True))
    raster("mask file", lambda p: masked(p, False))
    raster("alpha band", alpha)
    raster("alpha band of floats, which GDAL leaves to the user", lambda p: alpha(p, 1, "float32"), wanted=transparent)
    raster("three bands and alpha", lambda p: alpha(p, 3), refused="-b 1 -mask 4")
    raster("two bands", lambda p: tiff(p, numpy.stack([ground()] * 2)), refused="gdal_translate -b 1")
    raster("sidecar nodata", lambda p: sidecar(tiff(p, holes(0)), "<NoDataValue>0</NoDataValue>"))
    raster("sidecar over inner nodata", lambda p: sidecar(tiff(p, holes(0), nodata=-9999), "<NoDataValue>0</NoDataValue>"))
    raster("sidecar scale, offset, unit", lambda p: sidecar(tiff(p), "<UnitType>ft</UnitType><Offset>3</Offset><Scale>2</Scale>"))
    raster("sidecar place and system", lambda p: sidecar(tiff(p), "", "<SRS>EPSG:31287</SRS><GeoTransform>1000,5,0,9000,0,-5</GeoTransform>"))
    raster("sidecar in pieces", lambda p: sidecar(tiff(p), "<NoDataValue>x</NoDataValue>"), refused="NoDataValue is a number")
    raster("scale and offset", lambda p: scaled(p, scale=0.1))
    raster("unit ft", lambda p: scaled(p, unit="ft", scale=0.1))
    raster("unit us-ft", lambda p: scaled(p, unit="us-ft", scale=0.1))
    raster("unit cm", lambda p: scaled(p, unit="cm"))
    raster("unit ells", lambda p: scaled(p, unit="ells", scale=0.1), refused="`ells`")
    raster("heights NAVD88 ftUS", lambda p: tiff(p, crs="EPSG:26910+6360"))
    raster("heights NAVD88 m", lambda p: tiff(p, crs="EPSG:26910+5703"))
    raster("heights NAVD88 ft by code", lambda p: tiff(p, crs="EPSG:26910+8228"))
    raster("grid, heights by the key", asc(grid), wanted=lambda: south_first() * 1200 / 3937, crs=["EPSG:26910+6360"])
    raster("state plane in feet", lambda p: tiff(p, crs="EPSG:2264", transform=from_origin(1000000, 800000, 15, 15)), refused="gdalwarp -s_srs EPSG:2264")
    raster("grid in feet by the key", asc(lambda p: grid(p, xllcorner=1000000, yllcorner=800000)), crs=["EPSG:2264"], refused="gdalwarp -s_srs EPSG:2264")
    raster("web map", lambda p: tiff(p, crs="EPSG:3857", transform=from_origin(1250000, 6000000, 5, 5)), refused="too long eastward")
    raster("degrees", lambda p: tiff(p, crs="EPSG:4326", transform=from_origin(11, 47, 1e-4, 1e-4)), refused="in degrees")
    raster("system by parameters", lambda p: tiff(p, crs="+proj=lcc +lat_1=46 +lat_2=49 +lat_0=47.5 +lon_0=13.333 +x_0=400000 +y_0=400000 +ellps=bessel +units=m", transform=from_origin(500000, 480000, 5, 5)))
    raster("world file", world, refused="gdal_translate -a_srs")
    raster("nodata -32768 undeclared", lambda p: tiff(p, holes(-32768)), refused="gdal_edit.py -a_nodata -32768")
    raster("another system than the key", tiff, crs=["EPSG:31287"], refused="gdalwarp -t_srs EPSG:31287")
    raster("complex numbers", lambda p: tiff(p, ground().astype("complex64")), refused="gdal_translate -ot Float32")
    raster("rotated", lambda p: tiff(p, transform=PLACE @ Affine.rotation(10)), refused="gdalwarp")
    raster("not square", lambda p: tiff(p, transform=from_origin(500000, 5200000, 5, 6)), refused="gdalwarp -tr 5 5")
    raster("south first", lambda p: tiff(p, transform=Affine(5, 0, 500000, 0, 5, 5199800)))
    raster("grid", asc(grid))
    raster("grid, centres", asc(lambda p: grid(p, xllcorner=None, yllcorner=None, xllcenter=500002.5, yllcenter=5199802.5)), wanted=south_first)
    raster("grid, number first", asc(lambda p: grid(p, f"{COLUMNS} ncols\n{ROWS} nrows\n500000 xllcorner\n5199800 yllcorner\n5 cellsize\n")), wanted=south_first)
    raster("grid, one line", asc(lambda p: grid(p, f"ncols {COLUMNS} nrows {ROWS} xllcorner 500000 yllcorner 5199800 cellsize 5\n")))
    raster("grid, decimal comma", asc(lambda p: grid_with_comma(p)))
    raster("grid, nodata null", asc(lambda p: grid(p, NODATA_value="null", values=holes(-3.4028234663852886e38))))
    raster("grid, nodata -9999 undeclared", asc(lambda p: grid(p, NODATA_value=None, values=holes(-9999))), wanted=lambda: numpy.where(holes(-9999)[::-1] == -9999, numpy.nan, holes(-9999)[::-1]))
    raster("grid, sidecar unit", asc(lambda p: sidecar(grid(p), "<UnitType>ft</UnitType><Scale>2</Scale>")))
    raster("grid, semicolons", asc(lambda p: grid(p, separator=";")), refused="separated by blanks")
    raster("grid, cut off", asc(lambda p: grid(p, nrows=ROWS + 1)), refused="fetch the file again")
    esri = {code: pyproj.CRS.from_epsg(code).to_wkt("WKT1_ESRI") for code in (25832, 2264)}
    vertical = 'VERTCS["EVRF",VDATUM["E"],PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",1.0],UNIT["Foot",0.3048]]'
    raster("grid, .prj and VERTCS in feet", asc(lambda p: with_prj(grid(p), f"{esri[25832]},{vertical}")), wanted=lambda: south_first() * 0.3048)
    raster("grid, .prj in feet", asc(lambda p: with_prj(grid(p, xllcorner=1000000, yllcorner=800000), esri[2264])), refused="one unit of its coordinates")
    raster("grid, .prj no system", asc(lambda p: with_prj(grid(p), "Projection UTM")), refused="is not a coordinate reference system")


def grid_with_comma(path):
    grid(path, cellsize="5,0")
    path.write_text(path.read_text().replace(".", ","))
    return path


def square(west, south=5199850.0, side=40.0):
    ring = [(west, south), (west, south + side), (west + side, south + side), (west + side, south), (west, south)]
    return {"type": "Polygon", "coordinates": [ring]}


def shapes(path, rows, kind="float", crs="EPSG:25832"):
    schema = {"geometry": "Polygon", "properties": {"d": kind}}
    with fiona.open(path, "w", driver="ESRI Shapefile", crs=crs, schema=schema) as file:
        for shape, thickness in rows:
            file.write({"type": "Feature", "geometry": shape, "properties": {"d": thickness}})
    return path


def delete(path, row):
    table = path.with_suffix(".dbf")
    content = bytearray(table.read_bytes())
    start, length = (int.from_bytes(content[k : k + 2], "little") for k in (8, 10))
    content[start + row * length] = ord("*")
    table.write_bytes(content)
    return path


def volume(path):
    """Area times thickness over what fiona reads, in the system of the terrain."""
    total = 0.0
    with fiona.open(path) as file:
        for feature in file:
            if feature.geometry is not None:
                ring = transform_geom(file.crs, "EPSG:25832", feature.geometry).coordinates[0]
                x, y = numpy.array(ring).T
                area = abs(numpy.dot(x[:-1], y[1:]) - numpy.dot(x[1:], y[:-1])) / 2
                total += area * float(str(feature.properties["d"]).replace(",", "."))
    return total


def release(name, make, refused=None):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        try:
            dem = tiff(folder / "dem.tif")
            path = make(folder / "release.shp")
            answer = granflow("release", path, dem, "d")
            if "refused" in answer:
                assert refused and refused in answer["refused"], answer["refused"]
                # Only what is read by fiona as it stands has a volume to compare with.
                wanted = volume(path) if refused in ("datum", "longitude of origin", "degrees") else None
                again = lambda last: granflow("release", path if last.suffix == ".prj" else last, dem, "d")
                outcome = cure(answer, path, lambda last: again(last))
                if isinstance(outcome, dict):
                    assert "volume" in outcome, f"the cure is refused: {outcome['refused']}"
                    assert wanted is None or abs(outcome["volume"] - wanted) < 1e-3 * wanted, (outcome, wanted)
                    outcome = "refused, cured"
            else:
                assert not refused, "it is read, and was to be refused"
                assert abs(answer["volume"] - volume(path)) < 1e-6 * volume(path), (answer, volume(path))
                outcome = "equal"
        except AssertionError as error:
            outcome = f"FAILED: {error}"
    results.append((name, outcome))


def moved(code, vertical=""):
    """The squares in another system, on the same ground."""

    def make(path):
        there = [transform_geom("EPSG:25832", f"EPSG:{code}", square(500050.0 + 60 * k)) for k in range(2)]
        shapes(path, [(shape, 1.5) for shape in there], crs=f"EPSG:{code}")
        path.with_suffix(".prj").write_text(pyproj.CRS.from_epsg(code).to_wkt("WKT1_ESRI") + vertical)
        return path

    return make


def releases():
    two = [(square(500050.0), 1.5), (square(500110.0), 2.0)]
    release("polygons", lambda p: shapes(p, two))
    release("a deleted row", lambda p: delete(shapes(p, two), 0))
    release("a null shape", lambda p: shapes(p, [*two, (None, 3.0)]))
    release("a null shape without thickness", lambda p: shapes(p, [*two, (None, None)]))
    release("a NULL thickness", lambda p: shapes(p, [*two, (square(500170.0), None)]), refused="feature 3: d is not given (NULL)")
    release("a text thickness", lambda p: shapes(p, [(s, str(d)) for s, d in two], "str"))
    release("a text thickness with a comma", lambda p: shapes(p, [(s, str(d).replace(".", ",")) for s, d in two], "str"))
    release("a text that is no number", lambda p: shapes(p, [(square(500050.0), "1 m")], "str"), refused="feature 1: d = `1 m` is not a thickness")
    release("ESRI's text of the same system", moved(25832))
    release("with a vertical system", moved(25832, ',VERTCS["E",VDATUM["E"],PARAMETER["Direction",1.0],UNIT["Meter",1.0]]'))
    for code, words in [(23032, "datum"), (32632, "datum"), (31467, "datum"), (25833, "longitude of origin"), (4258, "degrees")]:
        release(f"EPSG:{code} on EPSG:25832", moved(code), refused=words)
    release("zone 33 with a vertical system", moved(25833, ',VERTCS["E",VDATUM["E"],UNIT["Meter",1.0]]'), refused="longitude of origin")
    release("a ring that crosses itself", bow_tie, refused="-makevalid")
    release("GeoJSON with a code", lambda p: named(p, "urn:ogc:def:crs:EPSG::25832"))
    release("GeoJSON with a name that is not understood", lambda p: named(p, "Here"), refused="`crs`")
    release("a geopackage", package, refused="ogr2ogr release.geojson")
    release("PROJ text in the .prj", lambda p: with_prj(shapes(p, two), "+proj=utm +zone=32 +ellps=GRS80"), refused="release.prj")


def bow_tie(path):
    ring = [(500050.0, 5199850.0), (500090.0, 5199890.0), (500090.0, 5199850.0), (500050.0, 5199890.0), (500050.0, 5199850.0)]
    return shapes(path, [({"type": "Polygon", "coordinates": [ring]}, 1.5)])


def named(path, name):
    """A GeoJSON file whose `crs` has this name."""
    path = path.with_suffix(".geojson")
    features = [{"type": "Feature", "geometry": square(500050.0), "properties": {"d": 1.5}}]
    system = {"type": "name", "properties": {"name": name}}
    path.write_text(json.dumps({"type": "FeatureCollection", "crs": system, "features": features}))
    return path


def package(path):
    path = path.with_suffix(".gpkg")
    schema = {"geometry": "Polygon", "properties": {"d": "float"}}
    with fiona.open(path, "w", driver="GPKG", crs="EPSG:25832", schema=schema) as file:
        file.write({"type": "Feature", "geometry": square(500050.0), "properties": {"d": 1.5}})
    return path


def systems():
    """Each code of a projected system against its own texts, and against others by pyproj's judgement."""
    codes = [int(one.code) for one in pyproj.database.query_crs_info("EPSG", [pyproj.enums.PJType.PROJECTED_CRS])]
    pairs, wanted = [], []
    random.seed(1)
    codes = random.sample(codes, 800)
    for code in codes:
        system = pyproj.CRS.from_epsg(code)
        for version in ("WKT1_GDAL", "WKT1_ESRI", "WKT2_2019"):
            try:
                text = system.to_wkt(version)
            except pyproj.exceptions.CRSError:
                continue
            bare = re.sub(r",\s*(AUTHORITY|ID)\[\"EPSG\",\"?\d+\"?\](?=\]$)", "", text)
            pairs.append(f"EPSG:{code}\t{bare}")
            wanted.append((code, version, True))
    for one, other in zip(codes, codes[1:]):
        same = pyproj.CRS.from_epsg(one).equals(pyproj.CRS.from_epsg(other), ignore_axis_order=True)
        pairs.append(f"EPSG:{one}\t{pyproj.CRS.from_epsg(other).to_wkt()}")
        wanted.append((one, other, same))
    answers = granflow("systems", stdin="\n".join(pair.replace("\n", " ") for pair in pairs) + "\n")
    counts = {}
    for (code, other, same), answer in zip(wanted, answers):
        key = ("one system" if same else "two systems", answer.split(":")[0])
        counts[key] = counts.get(key, 0) + 1
        if not same and answer == "same":
            results.append((f"EPSG:{code} and EPSG:{other}", "FAILED: two systems taken for one"))
    for (kind, answer), count in sorted(counts.items()):
        print(f"{count:5} pairs of {kind}: {answer}")
    refused = sum(count for (kind, answer), count in counts.items() if kind == "one system" and answer == "different")
    outcome = "equal" if refused < 0.01 * len(wanted) else f"FAILED: {refused} of {len(wanted)} taken for two"
    results.append(("systems", outcome))


rasters()
releases()
systems()
for name, outcome in results:
    print(f"{name:52} {outcome}")
failed = [name for name, outcome in results if outcome.startswith("FAILED")]
print(f"{len(results)} variants, {len(failed)} failed")
sys.exit(bool(failed))
