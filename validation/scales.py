"""Compares the scale of maps, as granflow computes it, with the factors of PROJ (pyproj).

Every projected system of the EPSG register in metres, in order, at nine places of its area of use and at places a thousand and three
thousand kilometres beyond: the largest and the smallest length on the map of a length on the ground.

    validation/venv/bin/python validation/scales.py

Exit status 1 if a factor differs by more than TOLERANCE where PROJ's own place comes back from its coordinates.
"""

import collections
import json
import math
import pathlib
import subprocess
import sys

import pyproj

READ = pathlib.Path(__file__).parent.parent / "target/release/examples/read"
# 0.5 and 2 % are the bounds that the factors are held against.
TOLERANCE = 1e-4
# Computed otherwise on purpose: PROJ's factors of web maps are those on a sphere, ours those on the ellipsoid; and an equidistant
# cylindrical map takes the arc of the meridian to 0.2 degrees.
COARSE = {"Popular Visualisation Pseudo Mercator": 7e-3, "Equidistant Cylindrical": 1e-3}


def places(area):
    """Of the area of use, and beyond it, in degrees."""
    east = area.east if area.east > area.west else area.east + 360
    middle = [0.5 * (area.west + east), 0.5 * (area.south + area.north)]
    inside = [(x, y) for x in (area.west, middle[0], east) for y in (area.south, middle[1], area.north)]
    beyond = [(middle[0] + dx, middle[1] + dy) for dx, dy in ((9, 0), (-27, 0), (0, 9), (0, -27), (18, 18))]
    return inside, beyond


def systems():
    kinds = (pyproj.enums.PJType.PROJECTED_CRS,)
    for info in pyproj.database.query_crs_info(auth_name="EPSG", pj_types=kinds):
        if info.area_of_use and 2000 <= int(info.code) <= 32767:
            crs = pyproj.CRS.from_epsg(int(info.code))
            metres = all(axis.unit_conversion_factor == 1 for axis in crs.axis_info)
            if metres:
                yield int(info.code), crs, info.area_of_use


def main():
    asked, lines = [], []
    for code, crs, area in systems():
        try:
            proj = pyproj.Proj(crs)
        except pyproj.exceptions.ProjError:
            continue
        meridian = math.degrees(crs.prime_meridian.longitude * crs.prime_meridian.unit_conversion_factor)
        for beyond, group in enumerate(places(area)):
            for longitude, latitude in group:
                if not -89 < latitude < 89:
                    continue
                x, y = proj(longitude, latitude)
                back = proj(x, y, inverse=True) if abs(x) < 1e8 and abs(y) < 1e8 else (1e9, 1e9)
                if abs(back[1] - latitude) > 1e-7 or abs((back[0] - longitude + 180) % 360 - 180) > 1e-7:
                    continue
                # Factors count from the system's own prime meridian, places from Greenwich.
                found = proj.get_factors(longitude - meridian, latitude)
                expected = [found.tissot_semimajor, found.tissot_semiminor]
                if not all(0.01 < factor < 100 for factor in expected):
                    continue
                asked.append((code, crs.coordinate_operation.method_name, beyond, expected, (longitude, latitude)))
                lines.append(f"EPSG:{code}\t{x!r}\t{y!r}\n")
    answer = subprocess.run([READ, "scales"], input="".join(lines), text=True, capture_output=True, check=True)
    table = collections.defaultdict(lambda: [0, 0, 0, [0.0, 0.0]])
    wrong = []
    for (code, method, beyond, expected, place), found in zip(asked, json.loads(answer.stdout), strict=True):
        row = table[method]
        if found is None:
            row[1] += 1
            continue
        row[0] += 1
        error = max(abs(a / b - 1) for a, b in zip(found, expected))
        row[3][beyond] = max(row[3][beyond], error)
        if error > COARSE.get(method, TOLERANCE):
            row[2] += 1
            wrong.append((code, method, place, found, expected))
    print(f"{'method':52} places  not computed  wrong  largest error within and beyond the area")
    for method, (places_, none, bad, largest) in sorted(table.items()):
        print(f"{method:52} {places_:6} {none:13} {bad:6}  {largest[0]:.1e} {largest[1]:.1e}")
    for line in wrong[:20]:
        print("wrong:", *line)
    computed = {code for (code, *_), found in zip(asked, json.loads(answer.stdout), strict=True) if found}
    print(f"{len({code for code, *_ in asked})} systems, {len(computed)} computed; {len(wrong)} of {len(asked)} places wrong")
    sys.exit(1 if wrong else 0)


main()
