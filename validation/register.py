"""Writes the tables in crates/granflow-geo/src/raster/register from the database that pyproj carries.

The EPSG Geodetic Parameter Dataset may be copied and embedded under its terms of use (epsg.org); the names that
ESRI gives to its datums come from the same database (PROJ, MIT).
"""

import collections
import pathlib
import re
import sqlite3

import pyproj

FOLDER = pathlib.Path(__file__).parent.parent / "crates/granflow-geo/src/raster/register"


def plain(name):
    """The name as `plain` in raster/register.rs makes it."""
    return re.sub(r"[^a-z0-9+]", "", re.sub(r"^d_", "", name.lower()))


def write(name, heading, rows):
    text = "".join("\t".join(str(cell) for cell in row) + "\n" for row in sorted(rows))
    (FOLDER / name).write_text(f"# {heading}\n{text}")
    print(name, len(text), "bytes")


def main():
    database = sqlite3.connect(pathlib.Path(pyproj.datadir.get_data_dir()) / "proj.db")
    metadata = dict(database.execute("select key, value from metadata"))
    source = f"EPSG {metadata['EPSG.VERSION']}, {metadata['ESRI.VERSION']}; see validation/register.py"

    datums = collections.defaultdict(set)
    named = "select name, code from geodetic_datum where auth_name = 'EPSG'"
    alias = "select alt_name, code from alias_name where table_name = 'geodetic_datum' and auth_name = 'EPSG'"
    for query in (named, alias):
        for name, code in database.execute(query):
            datums[plain(name).removesuffix("ensemble")].add(int(code))
    rows = [(name, ",".join(str(code) for code in sorted(codes))) for name, codes in datums.items() if name and not name.isdigit()]
    write("datums.tsv", f"Datums: plain name, EPSG codes ({source})", rows)

    verticals = """select v.code, u.conv_factor, a.orientation from vertical_crs v
        join axis a on a.coordinate_system_code = v.coordinate_system_code
            and a.coordinate_system_auth_name = v.coordinate_system_auth_name
        join unit_of_measure u on u.code = a.uom_code and u.auth_name = a.uom_auth_name where v.auth_name = 'EPSG'"""
    rows = [
        (int(code), metres if way == "up" else -metres) for code, metres, way in database.execute(verticals)
    ]
    write("heights.tsv", f"Vertical systems: code, metres upward of one unit ({source})", rows)

    units = "select code, conv_factor, name from unit_of_measure where type = 'length' and auth_name = 'EPSG' and conv_factor > 0"
    rates = re.compile(" per |^Bin ")
    rows = [(int(code), repr(metres), name) for code, metres, name in database.execute(units) if not rates.search(name)]
    write("lengths.tsv", f"Units of length: code, metres, name ({source})", rows)

    # GeoTIFFs carry these codes as if they were the EPSG's; its own codes of projected systems begin at 2000 and leave them free.
    maps = "select code from projected_crs where auth_name = 'ESRI' and code between '53000' and '54999' and length(code) = 5"
    rows = [(int(code), pyproj.CRS.from_authority("ESRI", code).to_wkt("WKT1_ESRI")) for (code,) in database.execute(maps)]
    write("maps.tsv", f"Maps of the world: ESRI's code, definition ({source})", rows)


main()
