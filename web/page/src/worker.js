// The thread that computes: one engine, asked by messages { id, name, values }.
import { Engine } from './engine.js'

let engine

const calls = {
  async start(bytes) { engine = await Engine.of(bytes) },
  put(name, bytes) { engine.put(name, bytes) },
  get: name => engine.get(name),
  forget(name) { engine.forget(name) },
  names: () => engine.names(),
  demo() { engine.demo() },
  open: (text, overrides) => engine.open(text, overrides),
  change: (handle, text, overrides) => engine.change(handle, text, overrides),
  close: handle => engine.close(handle),
  // Steps a run and gives its state with fields of it.
  advance(handle, limits, fields = []) {
    const state = engine.advance(handle, limits)
    return { ...state, fields: Object.fromEntries(fields.map(name => [name, engine.field(handle, name)])) }
  },
  // The same with a picture of one field, and values of others in a cell where one is asked for.
  watch(handle, limits, { field, columns, stride, probes, cell }) {
    const state = engine.advance(handle, limits)
    return { ...state, picture: engine.picture(handle, field, { columns, stride }), probed: cell == null ? [] : engine.probe(handle, probes, cell) }
  },
  field: (handle, name) => engine.field(handle, name),
  exactDamBreak: (handle, beta, left, right) => engine.exactDamBreak(handle, beta, left, right),
  geotiff: (handle, name) => engine.geotiff(handle, name),
  checksums: handle => engine.checksums(handle),
  raster: (name, most) => engine.raster(name, most),
  ground: (handle, cells, most) => engine.ground(handle, cells, most),
  run: (text, overrides) => engine.run(text, overrides),
  memory: () => engine.exports.memory.buffer.byteLength,
}

// The buffers in an answer, which change hands instead of being copied.
function buffers(value) {
  if (ArrayBuffer.isView(value)) return [value.buffer]
  return value && typeof value === 'object' ? Object.values(value).flatMap(buffers) : []
}

self.onmessage = async ({ data: { id, name, values } }) => {
  try {
    const result = await calls[name](...values)
    self.postMessage({ id, result }, buffers(result))
  } catch ({ message, key, line, column, help }) {
    self.postMessage({ id, error: { message, key, line, column, help } })
  }
}
