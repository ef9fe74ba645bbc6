// Files that a user gives: an elevation model, releases, what stands beside them; a zip of them is unpacked.

// The files in a zip archive, stored or deflated: [name, bytes].
async function unzip(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  let end = bytes.length - 22
  while (end >= 0 && view.getUint32(end, true) !== 0x06054b50) end--
  if (end < 0) throw new Error('this zip archive has no directory: it is cut off or no zip')
  const files = []
  let at = view.getUint32(end + 16, true)
  for (let k = view.getUint16(end + 10, true); k > 0; k--) {
    const [how, size] = [view.getUint16(at + 10, true), view.getUint32(at + 20, true)]
    const lengths = [28, 30, 32].map(offset => view.getUint16(at + offset, true))
    const name = new TextDecoder().decode(bytes.subarray(at + 46, at + 46 + lengths[0]))
    const local = view.getUint32(at + 42, true)
    const start = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true)
    const packed = bytes.subarray(start, start + size)
    if (!name.endsWith('/')) files.push([name.split('/').pop(), how === 0 ? packed : await inflated(packed)])
    at += 46 + lengths[0] + lengths[1] + lengths[2]
  }
  return files
}

const inflated = async bytes => new Uint8Array(await new Response(
  new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'))).arrayBuffer())

// Name and bytes of every file that was chosen or dropped.
export async function read(list) {
  const files = []
  for (const file of list) {
    const bytes = new Uint8Array(await file.arrayBuffer())
    if (/\.zip$/i.test(file.name)) files.push(...await unzip(bytes))
    else files.push([file.name, bytes])
  }
  return files
}

export const isElevation = name => /\.(asc|tiff?|txt|grd|agr)$/i.test(name)
export const isRelease = name => /\.(geojson|json|shp)$/i.test(name)

// The rings of a GeoJSON file, to be drawn; none of anything else.
export function rings(name, bytes) {
  if (!/json$/i.test(name)) return []
  try {
    const found = []
    const walk = value => {
      if (value?.type === 'Polygon') found.push(...value.coordinates)
      else if (value?.type === 'MultiPolygon') found.push(...value.coordinates.flat())
      else for (const child of [value?.geometry, ...(value?.features ?? []), ...(value?.geometries ?? [])]) if (child) walk(child)
    }
    walk(JSON.parse(new TextDecoder().decode(bytes)))
    return found
  } catch {
    return [] // the engine will say what is wrong with it
  }
}
