// The engine: WebAssembly behind calls that take and give JavaScript's values. The same in a worker and in node.
import { isBeside } from './drop.js'
import { System } from './wasi.js'

// What the engine refuses, with the place and the cure.
export class Refused extends Error {
  /** @param {import('./types').Reason} reason */
  constructor({ message, key, line, column, help }) {
    super(message)
    Object.assign(this, { key, line, column, help: help ?? [] })
  }
}

// The middle value of each block of cells, so that there are `most` rows and columns at most.
function thinned(values, { columns, rows }, most) {
  const stride = Math.max(1, Math.ceil(Math.max(columns, rows) / most))
  const [wide, high] = [columns, rows].map(count => Math.ceil(count / stride))
  const z = new Float64Array(wide * high)
  for (let j = 0, n = 0; j < high; j++) {
    const row = Math.min(rows - 1, j * stride + (stride >> 1)) * columns
    for (let i = 0; i < wide; i++, n++) z[n] = values[row + Math.min(columns - 1, i * stride + (stride >> 1))]
  }
  return { stride, z }
}

function greatest(values, columns, stride) {
  const wide = Math.ceil(columns / stride)
  const found = new Float64Array(wide * Math.ceil(values.length / columns / stride)).fill(NaN)
  for (let k = 0, j = 0; k < values.length; j++) {
    const row = Math.floor(j / stride) * wide
    for (let i = 0; i < columns; i++, k++) {
      const n = row + Math.floor(i / stride)
      if (!(values[k] <= found[n])) found[n] = Number.isNaN(values[k]) ? found[n] : values[k]
    }
  }
  return found
}

/** @typedef {import('./types').State} State */
/** @typedef {import('./types').About} About */
/** @typedef {import('./types').Limits} Limits */

export class Engine {
  system = new System()
  /** @type {any} */
  exports = null

  static async of(bytes) {
    const module = await WebAssembly.compile(bytes)
    const engine = new Engine()
    const instance = await WebAssembly.instantiate(module, engine.system.imports(module))
    engine.exports = instance.exports
    engine.system.start(instance)
    return engine
  }

  // Calls a function of the engine; what is negative is refused with its reason.
  call(name, ...values) {
    let answer
    try {
      answer = this.exports[`granflow_${name}`](...values)
    } catch (error) {
      throw new Refused({ message: `${this.system.said.trim() || error.message}`, help: ['reload the page: the engine cannot go on after this'] })
    }
    if (answer < 0) throw new Refused(this.answer().error)
    return answer
  }
  // The same with a text in front of the other values.
  callWith(name, before, text, ...after) {
    const bytes = new TextEncoder().encode(text)
    const start = this.exports.granflow_allocate(bytes.length)
    new Uint8Array(this.exports.memory.buffer, start, bytes.length).set(bytes)
    try {
      return this.call(name, ...before, start, bytes.length, ...after)
    } finally {
      this.exports.granflow_free(start, bytes.length)
    }
  }
  answer() {
    const { memory, granflow_answer_start: start, granflow_answer_length: length } = this.exports
    return JSON.parse(new TextDecoder().decode(new Uint8Array(memory.buffer, start(), length())))
  }
  // The numbers of the last answer where they lie, until the next call.
  numbersHere() {
    const { memory, granflow_numbers_start: start, granflow_numbers_length: length } = this.exports
    return new Float64Array(memory.buffer, start(), length())
  }
  numbers() { return this.numbersHere().slice() }

  put(name, bytes) { this.system.files.set(name, bytes) }
  // A copy of a file; nothing where there is none.
  get(name) { return this.system.files.get(name)?.slice() }
  // Takes away a file and what stands beside it under the same name: what is put next has sidecars of its own.
  forget(name) {
    for (const other of this.names()) if (isBeside(other, name)) this.system.files.delete(other)
  }
  names() { return [...this.system.files.keys()] }
  // Puts the mountain of `granflow demo` and its release among the files.
  demo() { this.call('demo') }
  // A case, with overrides `key.path=value`.
  /** @returns {{ handle: number, about: About }} */
  open(text, overrides = []) {
    const handle = this.callWith('open', [], [text, ...overrides].join('\0'))
    return { handle, about: this.answer() }
  }
  change(handle, text, overrides = []) { this.callWith('change', [handle], [text, ...overrides].join('\0')) }
  close(handle) { this.exports.granflow_close(handle) }
  /** @param {number} handle @param {Limits} limits @returns {State} */
  advance(handle, { time = Infinity, steps = Infinity, milliseconds = 1e9 } = {}) {
    const ended = this.call('advance', handle, time, steps, milliseconds) === 1
    return { ended, ...this.answer() }
  }
  field(handle, name) {
    this.callWith('field', [handle], name)
    return this.numbers()
  }
  // The greatest value of a field in each block of `stride` x `stride` cells, of rows of `columns`.
  picture(handle, name, { columns, stride }) {
    this.callWith('field', [handle], name)
    return stride === 1 ? this.numbers() : greatest(this.numbersHere(), columns, stride)
  }
  // Values of fields in one cell.
  probe(handle, names, cell) {
    return names.map(name => {
      this.callWith('field', [handle], name)
      return this.numbersHere()[cell]
    })
  }
  // A field or map as the bytes of a GeoTIFF.
  geotiff(handle, name) {
    this.callWith('write', [handle], name)
    const bytes = this.system.files.get(`${name}.tif`)
    this.system.files.delete(`${name}.tif`)
    return bytes
  }
  checksums(handle) {
    this.call('checksums', handle)
    return this.answer()
  }
  // What a raster file holds, `most` rows and columns of it at most.
  /** @returns {import('./types').Ground} */
  raster(name, most = Infinity) {
    this.callWith('raster', [], name)
    const about = this.answer()
    return { ...about, ...thinned(this.numbersHere(), about, most) }
  }
  // The ground of a run in the same way.
  ground(handle, { columns, rows }, most) {
    this.callWith('field', [handle], 'bed')
    return thinned(this.numbersHere(), { columns, rows }, most)
  }
  exactDamBreak(handle, beta, left, right) {
    this.call('exact_dam_break', handle, beta, left, right)
    return this.numbers()
  }
  // A case to its end.
  run(text, overrides = []) {
    const { handle } = this.open(text, overrides)
    try {
      while (!this.advance(handle).ended);
      return this.checksums(handle)
    } finally {
      this.close(handle)
    }
  }
}
