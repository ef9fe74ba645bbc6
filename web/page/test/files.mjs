// Files as other programs write them: ASCII grids, GeoTIFFs, zipped shapefiles.
import { crc32, deflateRawSync } from 'node:zlib'

const bytes = text => new TextEncoder().encode(text)

// A slope that levels out in the north, with a shallow gully; x from the middle, s from the south.
export const slope = (x, s) => 400 + 0.3 * (600 - s + Math.sqrt((600 - s) ** 2 + 150 ** 2)) + 0.0008 * x * x

// Heights of `columns` x `rows` cells, the first row in the north.
export function heights(columns, rows, cell, height = slope) {
  const z = new Float32Array(columns * rows)
  for (let k = 0; k < z.length; k++) {
    z[k] = height((k % columns + 0.5 - columns / 2) * cell, (rows - Math.floor(k / columns) - 0.5) * cell)
  }
  return z
}

export function asciiGrid({ columns, rows, cell, west = 0, south = 0, z, nodata = -9999 }) {
  const lines = [`ncols ${columns}`, `nrows ${rows}`, `xllcorner ${west}`, `yllcorner ${south}`, `cellsize ${cell}`, `NODATA_value ${nodata}`]
  for (let row = 0; row < rows; row++) lines.push(Array.from(z.subarray(row * columns, (row + 1) * columns), value => +value.toFixed(2)).join(' '))
  return bytes(lines.join('\n') + '\n')
}

const WIDTH = { 2: 1, 3: 2, 4: 4, 12: 8 } // bytes of ASCII, SHORT, LONG, DOUBLE

// A GeoTIFF of 32-bit floats in one strip; `epsg` of a map projection, or `degrees`; nothing is said without either.
export function geotiff({ columns, rows, cell, west = 0, south = 0, z, nodata, epsg, degrees }) {
  const keys = epsg ? [[1024, 0, 1, 1], [1025, 0, 1, 1], [3072, 0, 1, epsg]] : degrees ? [[1024, 0, 1, 2], [1025, 0, 1, 1], [2048, 0, 1, 4326]] : []
  const tags = [
    [256, 4, [columns]], [257, 4, [rows]], [258, 3, [32]], [259, 3, [1]], [262, 3, [1]], [273, 4, [0]], [277, 3, [1]], [278, 4, [rows]],
    [279, 4, [4 * z.length]], [339, 3, [3]], [33550, 12, [cell, cell, 0]], [33922, 12, [0, 0, 0, west, south + rows * cell, 0]],
    ...(keys.length ? [[34735, 3, [1, 1, 0, keys.length, ...keys.flat()]]] : []),
    ...(nodata === undefined ? [] : [[42113, 2, [...bytes(`${nodata}\0`)]]]),
  ]
  let end = 8 + 2 + 12 * tags.length + 4
  const places = tags.map(([, type, values]) => {
    const size = WIDTH[type] * values.length
    const at = end
    if (size > 4) end += size + size % 2
    return size > 4 ? at : null
  })
  tags.find(([tag]) => tag === 273)[2] = [end]
  const file = new Uint8Array(end + 4 * z.length)
  const view = new DataView(file.buffer)
  const put = (at, type, value) => ({ 2: () => view.setUint8(at, value), 3: () => view.setUint16(at, value, true), 4: () => view.setUint32(at, value, true), 12: () => view.setFloat64(at, value, true) })[type]()
  file.set([0x49, 0x49, 42, 0, 8, 0, 0, 0])
  view.setUint16(8, tags.length, true)
  for (const [k, [tag, type, values]] of tags.entries()) {
    const at = 10 + 12 * k
    view.setUint16(at, tag, true)
    view.setUint16(at + 2, type, true)
    view.setUint32(at + 4, values.length, true)
    if (places[k] !== null) view.setUint32(at + 8, places[k], true)
    values.forEach((value, n) => put((places[k] ?? at + 8) + n * WIDTH[type], type, value))
  }
  file.set(new Uint8Array(z.buffer, z.byteOffset, z.byteLength), end)
  return file
}

// A shapefile of one polygon, clockwise: its .shp and .dbf with a column of depths.
export function shapefile(ring, depth = 1.5) {
  const flat = ring.flat()
  const [xs, ys] = [0, 1].map(k => flat.filter((_, n) => n % 2 === k))
  const bounds = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)]
  const content = 44 + 4 + 16 * ring.length
  const shp = new Uint8Array(100 + 8 + content)
  const view = new DataView(shp.buffer)
  view.setInt32(0, 9994)
  view.setInt32(24, shp.length / 2)
  view.setInt32(28, 1000, true)
  view.setInt32(32, 5, true)
  bounds.forEach((value, k) => view.setFloat64(36 + 8 * k, value, true))
  view.setInt32(100, 1)
  view.setInt32(104, content / 2)
  view.setInt32(108, 5, true)
  bounds.forEach((value, k) => view.setFloat64(112 + 8 * k, value, true))
  view.setInt32(144, 1, true)
  view.setInt32(148, ring.length, true)
  flat.forEach((value, k) => view.setFloat64(156 + 8 * k, value, true))
  const dbf = new Uint8Array(32 + 32 + 1 + 1 + 10 + 1)
  const table = new DataView(dbf.buffer)
  dbf.set([3, 124, 1, 1])
  table.setUint32(4, 1, true)
  table.setUint16(8, 65, true)
  table.setUint16(10, 11, true)
  dbf.set(bytes('depth'), 32)
  dbf.set([...bytes('N'), 0, 0, 0, 0, 10, 2], 43)
  dbf[64] = 13
  dbf.set(bytes(' ' + depth.toFixed(2).padStart(10)), 65)
  dbf[76] = 26
  return { shp, dbf }
}

// A zip archive of { name: bytes }, deflated, as programs write it.
export function zip(files) {
  const parts = []
  const directory = []
  let at = 0
  for (const [name, content] of Object.entries(files)) {
    const packed = new Uint8Array(deflateRawSync(content))
    const head = new DataView(new ArrayBuffer(46))
    head.setUint32(0, 0x02014b50, true)
    head.setUint16(4, 20, true)
    head.setUint16(6, 20, true)
    head.setUint16(10, 8, true)
    head.setUint32(16, crc32(content), true)
    head.setUint32(20, packed.length, true)
    head.setUint32(24, content.length, true)
    head.setUint16(28, bytes(name).length, true)
    head.setUint32(42, at, true)
    const local = new Uint8Array(30)
    local.set([0x50, 0x4b, 3, 4])
    local.set(new Uint8Array(head.buffer, 6, 26), 4)
    parts.push(local, bytes(name), packed)
    directory.push(new Uint8Array(head.buffer), bytes(name))
    at += local.length + bytes(name).length + packed.length
  }
  const end = new DataView(new ArrayBuffer(22))
  const length = directory.reduce((sum, part) => sum + part.length, 0)
  end.setUint32(0, 0x06054b50, true)
  for (const k of [8, 10]) end.setUint16(k, Object.keys(files).length, true)
  end.setUint32(12, length, true)
  end.setUint32(16, at, true)
  return new Uint8Array(Buffer.concat([...parts, ...directory, new Uint8Array(end.buffer)]))
}
