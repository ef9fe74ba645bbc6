// Zip archives, read and written.

const through = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer())

// The files in an archive, stored or deflated: [name without folders, bytes].
export async function unzip(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  let end = bytes.length - 22
  while (end >= 0 && view.getUint32(end, true) !== 0x06054b50) end--
  if (end < 0) throw new Error('it has no directory: it is cut off, or no zip archive')
  const files = []
  let at = view.getUint32(end + 16, true)
  for (let k = view.getUint16(end + 10, true); k > 0; k--) {
    const [how, size] = [view.getUint16(at + 10, true), view.getUint32(at + 20, true)]
    const lengths = [28, 30, 32].map(offset => view.getUint16(at + offset, true))
    const name = new TextDecoder().decode(bytes.subarray(at + 46, at + 46 + lengths[0]))
    const local = view.getUint32(at + 42, true)
    const start = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true)
    const packed = bytes.subarray(start, start + size)
    const hidden = name.endsWith('/') || name.startsWith('__MACOSX')
    if (!hidden && how !== 0 && how !== 8) throw new Error(`${name} is packed in a way that is not read here`)
    if (!hidden) files.push([name.split('/').pop(), how === 0 ? packed : await through(packed, new DecompressionStream('deflate-raw'))])
    at += 46 + lengths[0] + lengths[1] + lengths[2]
  }
  return files
}

const CRC = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ n >>> 1 : n >>> 1
  return n
})
const crc32 = bytes => ~bytes.reduce((sum, byte) => CRC[(sum ^ byte) & 255] ^ sum >>> 8, ~0) >>> 0

// An archive of files [name, bytes], deflated.
export async function zip(files) {
  const [parts, directory] = [[], []]
  const size = list => list.reduce((sum, part) => sum + part.length, 0)
  for (const [name, content] of files) {
    const [packed, title] = [await through(content, new CompressionStream('deflate-raw')), new TextEncoder().encode(name)]
    // Version 2, names in UTF-8, deflated; time and date 0 of 1980; sums and lengths.
    const head = numbers([2, 20], [2, 0x800], [2, 8], [2, 0], [2, 33], [4, crc32(content)], [4, packed.length], [4, content.length], [2, title.length], [2, 0])
    directory.push(numbers([4, 0x02014b50], [2, 20]), head, numbers([2, 0], [2, 0], [2, 0], [4, 0], [4, size(parts)]), title)
    parts.push(numbers([4, 0x04034b50]), head, title, packed)
  }
  const end = numbers([4, 0x06054b50], [2, 0], [2, 0], [2, files.length], [2, files.length], [4, size(directory)], [4, size(parts)], [2, 0])
  return new Blob([...parts, ...directory, end], { type: 'application/zip' })
}

// Numbers of 2 or 4 bytes in a row, the lowest byte first.
const numbers = (...list) => Uint8Array.from(list.flatMap(([width, value]) => Array.from({ length: width }, (_, k) => value >>> 8 * k & 255)))
