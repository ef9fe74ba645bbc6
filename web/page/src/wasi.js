// The system that the engine sees: files in memory, a clock, nothing else. WASI preview 1, as far as Rust's library asks.

const OK = 0, BAD_FILE = 8, EXISTS = 20, INVALID = 28, NO_ENTRY = 44, NOT_SUPPORTED = 52
const DIRECTORY = 3, REGULAR = 4, CHARACTERS = 2
const ROOT = 3
const CREATE = 1, EXCLUSIVE = 4, TRUNCATE = 8

export class System {
  constructor() {
    this.files = new Map() // name -> Uint8Array
    this.open = new Map([[ROOT, { name: '', at: 0 }]])
    this.said = '' // what was written to standard output and error
  }

  // The imports of a module; what is asked for and not had answers that it is not supported.
  imports(module) {
    const functions = {}
    for (const { module: from, name } of WebAssembly.Module.imports(module)) {
      functions[from] ??= {}
      functions[from][name] = this[name]?.bind(this) ?? (() => NOT_SUPPORTED)
    }
    return functions
  }

  start(instance) {
    this.memory = instance.exports.memory
    instance.exports._initialize?.()
  }

  view() { return new DataView(this.memory.buffer) }
  bytes(at, length) { return new Uint8Array(this.memory.buffer, at, length) }
  name(at, length) {
    return new TextDecoder().decode(this.bytes(at, length)).split('/').filter(part => part && part !== '.').join('/')
  }

  clock_time_get(_clock, _precision, out) {
    this.view().setBigUint64(out, BigInt(Math.round((performance.timeOrigin + performance.now()) * 1e6)), true)
    return OK
  }
  random_get(at, length) { crypto.getRandomValues(this.bytes(at, length)); return OK }
  environ_sizes_get(count, size) { return this.nothing(count, size) }
  environ_get() { return OK }
  args_sizes_get(count, size) { return this.nothing(count, size) }
  args_get() { return OK }
  nothing(count, size) {
    this.view().setUint32(count, 0, true)
    this.view().setUint32(size, 0, true)
    return OK
  }
  proc_exit(code) { throw new Error(`the engine ended with status ${code}: ${this.said}`) }
  sched_yield() { return OK }

  fd_prestat_get(fd, out) {
    if (fd !== ROOT) return BAD_FILE
    this.view().setUint32(out, 0, true)
    this.view().setUint32(out + 4, 1, true)
    return OK
  }
  fd_prestat_dir_name(fd, at) {
    if (fd !== ROOT) return BAD_FILE
    this.bytes(at, 1)[0] = '/'.charCodeAt(0)
    return OK
  }
  fd_fdstat_get(fd, out) {
    const kind = fd < ROOT ? CHARACTERS : fd === ROOT ? DIRECTORY : REGULAR
    if (fd >= ROOT && !this.open.has(fd)) return BAD_FILE
    const view = this.view()
    view.setBigUint64(out, BigInt(kind), true)
    view.setBigUint64(out + 8, 0xffffffffffffffffn, true)
    view.setBigUint64(out + 16, 0xffffffffffffffffn, true)
    return OK
  }
  stat(out, name) {
    const view = this.view()
    for (let k = 0; k < 64; k += 8) view.setBigUint64(out + k, 0n, true)
    view.setUint8(out + 16, name === '' ? DIRECTORY : REGULAR)
    view.setBigUint64(out + 24, 1n, true)
    view.setBigUint64(out + 32, BigInt(this.files.get(name)?.length ?? 0), true)
    return OK
  }
  fd_filestat_get(fd, out) {
    const file = this.open.get(fd)
    return file ? this.stat(out, file.name) : BAD_FILE
  }
  path_filestat_get(_fd, _flags, at, length, out) {
    const name = this.name(at, length)
    return name === '' || this.files.has(name) ? this.stat(out, name) : NO_ENTRY
  }
  path_open(_fd, _lookup, at, length, how, _rights, _inherited, _flags, out) {
    const name = this.name(at, length)
    const known = name === '' || this.files.has(name)
    if (!known && !(how & CREATE)) return NO_ENTRY
    if (known && how & EXCLUSIVE) return EXISTS
    if (name !== '' && (!known || how & TRUNCATE)) this.files.set(name, new Uint8Array(0))
    let fd = ROOT + 1
    while (this.open.has(fd)) fd++
    this.open.set(fd, { name, at: 0 })
    this.view().setUint32(out, fd, true)
    return OK
  }
  path_rename(_from, at, length, _to, newAt, newLength) {
    const [name, renamed] = [this.name(at, length), this.name(newAt, newLength)]
    if (!this.files.has(name)) return NO_ENTRY
    this.files.set(renamed, this.files.get(name))
    this.files.delete(name)
    return OK
  }
  path_unlink_file(_fd, at, length) {
    return this.files.delete(this.name(at, length)) ? OK : NO_ENTRY
  }
  fd_close(fd) { return this.open.delete(fd) ? OK : BAD_FILE }
  fd_sync() { return OK }

  fd_seek(fd, offset, whence, out) {
    const file = this.open.get(fd)
    if (!file) return BAD_FILE
    const from = [0, file.at, this.files.get(file.name)?.length ?? 0][whence]
    const at = from + Number(offset)
    if (at < 0) return INVALID
    file.at = at
    this.view().setBigUint64(out, BigInt(at), true)
    return OK
  }
  // The pieces of memory that a call names.
  *pieces(list, count) {
    for (let k = 0; k < count; k++) {
      const view = this.view()
      yield this.bytes(view.getUint32(list + 8 * k, true), view.getUint32(list + 8 * k + 4, true))
    }
  }
  fd_read(fd, list, count, out) {
    const file = this.open.get(fd)
    if (!file) return BAD_FILE
    const start = file.at
    const content = this.files.get(file.name) ?? new Uint8Array(0)
    for (const piece of this.pieces(list, count)) {
      const part = content.subarray(file.at, file.at + piece.length)
      piece.set(part)
      file.at += part.length
    }
    this.view().setUint32(out, file.at - start, true)
    return OK
  }
  fd_pread(fd, list, count, offset, out) {
    const file = this.open.get(fd)
    if (!file) return BAD_FILE
    const before = file.at
    file.at = Number(offset)
    const answer = this.fd_read(fd, list, count, out)
    file.at = before
    return answer
  }
  fd_write(fd, list, count, out) {
    let written = 0
    for (const piece of this.pieces(list, count)) {
      if (fd < ROOT) this.said += new TextDecoder().decode(piece)
      else if (!this.append(fd, piece)) return BAD_FILE
      written += piece.length
    }
    this.view().setUint32(out, written, true)
    return OK
  }
  append(fd, piece) {
    const file = this.open.get(fd)
    if (!file || file.name === '') return false
    const old = this.files.get(file.name)
    const end = file.at + piece.length
    const content = end > old.length ? new Uint8Array(end) : old
    if (content !== old) content.set(old)
    content.set(piece, file.at)
    file.at = end
    this.files.set(file.name, content)
    return true
  }
  fd_readdir(fd, at, length, cookie, out) {
    if (fd !== ROOT && this.open.get(fd)?.name !== '') return BAD_FILE
    let used = 0
    const names = [...this.files.keys()].map(name => new TextEncoder().encode(name))
    for (let k = Number(cookie); k < names.length && used < length; k++) {
      const entry = new Uint8Array(24 + names[k].length)
      const view = new DataView(entry.buffer)
      view.setBigUint64(0, BigInt(k + 1), true)
      view.setBigUint64(8, BigInt(k + 1), true)
      view.setUint32(16, names[k].length, true)
      view.setUint8(20, REGULAR)
      entry.set(names[k], 24)
      const part = entry.subarray(0, length - used)
      this.bytes(at + used, part.length).set(part)
      used += part.length
    }
    this.view().setUint32(out, used, true)
    return OK
  }
}
