// Files that a user gives: an elevation model, releases, what stands beside them; a zip of them is unpacked.
import { unzip } from './zip.js'

// Name and bytes of every file that was chosen or dropped.
export async function read(list) {
  const files = []
  for (const file of list) {
    const bytes = new Uint8Array(await file.arrayBuffer())
    if (!/\.zip$/i.test(file.name)) {
      files.push([file.name, bytes])
      continue
    }
    try {
      files.push(...await unzip(bytes))
    } catch (error) {
      throw { message: `${file.name} cannot be unpacked: ${error.message}`, help: ['unpack it and drop the files in it, or pack them again'] }
    }
  }
  return files
}

// Whether a file stands beside another one: the same name, whatever comes after the last dot of the other.
export const isBeside = (name, other) => name.startsWith(other.replace(/\.[^.]*$/, '.'))
export const isElevation = name => /\.(asc|tiff?|txt|grd|agr)$/i.test(name)
export const isRelease = name => /\.(geojson|json|shp)$/i.test(name)

// The rings of a GeoJSON file or a shapefile, to be drawn; none of what the engine will refuse.
export function rings(name, bytes) {
  try {
    return /\.shp$/i.test(name) ? ofShapefile(new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)) : ofGeoJson(JSON.parse(new TextDecoder().decode(bytes)))
  } catch {
    return []
  }
}

function ofGeoJson(value) {
  if (value?.type === 'Polygon') return value.coordinates
  if (value?.type === 'MultiPolygon') return value.coordinates.flat()
  return [value?.geometry, ...(value?.features ?? []), ...(value?.geometries ?? [])].filter(Boolean).flatMap(ofGeoJson)
}

// Polygons (types 5, 15, 25): after a box of 32 bytes the numbers of parts and points, where parts begin, and the points.
function ofShapefile(view) {
  const found = []
  for (let at = 100; at + 12 <= view.byteLength; at += 8 + 2 * view.getInt32(at + 4)) {
    if (view.getInt32(at + 8, true) % 10 !== 5) continue
    const [parts, points] = [view.getInt32(at + 44, true), view.getInt32(at + 48, true)]
    const begins = Array.from({ length: parts }, (_, k) => view.getInt32(at + 52 + 4 * k, true)).concat(points)
    const point = k => [0, 8].map(offset => view.getFloat64(at + 52 + 4 * parts + 16 * k + offset, true))
    for (let k = 0; k < parts; k++) found.push(Array.from({ length: begins[k + 1] - begins[k] }, (_, n) => point(begins[k] + n)))
  }
  return found
}
