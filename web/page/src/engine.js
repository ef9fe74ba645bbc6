// The engine: WebAssembly behind calls that take and give JavaScript's values. The same in a worker and in node.
import { System } from './wasi.js'

// What the engine refuses, with the place and the cure.
export class Refused extends Error {
  constructor({ message, key, line, column, help }) {
    super(message)
    Object.assign(this, { key, line, column, help: help ?? [] })
  }
}

export class Engine {
  static async of(bytes) {
    const module = await WebAssembly.compile(bytes)
    const engine = new Engine()
    engine.system = new System()
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
  numbers() {
    const { memory, granflow_numbers_start: start, granflow_numbers_length: length } = this.exports
    return new Float64Array(memory.buffer, start(), length()).slice()
  }

  put(name, bytes) { this.system.files.set(name, bytes) }
  // A case, with overrides `key.path=value`.
  open(text, overrides = []) {
    const handle = this.callWith('open', [], [text, ...overrides].join('\0'))
    return { handle, about: this.answer() }
  }
  change(handle, text, overrides = []) { this.callWith('change', [handle], [text, ...overrides].join('\0')) }
  close(handle) { this.exports.granflow_close(handle) }
  advance(handle, { time = Infinity, steps = Infinity, milliseconds = 1e9 } = {}) {
    const ended = this.call('advance', handle, time, steps, milliseconds) === 1
    return { ended, ...this.answer() }
  }
  field(handle, name) {
    this.callWith('field', [handle], name)
    return this.numbers()
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
  raster(name) {
    this.callWith('raster', [], name)
    return { ...this.answer(), values: this.numbers() }
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
