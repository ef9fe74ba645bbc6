// The page's side of the worker: every call of the engine as a promise.
import { decoded } from './base85.js'
import { Refused } from './engine.js'

export class Client {
  constructor(script) {
    this.waiting = new Map()
    this.next = 0
    this.worker = new Worker(URL.createObjectURL(new Blob([script], { type: 'text/javascript' })))
    this.worker.onmessage = ({ data: { id, result, error } }) => {
      const { done, fail } = this.waiting.get(id)
      this.waiting.delete(id)
      if (error) fail(new Refused(error))
      else done(result)
    }
    this.worker.onerror = event => {
      for (const { fail } of this.waiting.values()) fail(new Refused({ message: event.message }))
    }
  }
  call(name, ...values) {
    const id = this.next++
    return new Promise((done, fail) => {
      this.waiting.set(id, { done, fail })
      this.worker.postMessage({ id, name, values })
    })
  }
}

// Bytes from the text that the build put into the page: gzip in letters.
export async function unpacked(text) {
  const stream = new Blob([decoded(text)]).stream().pipeThrough(new DecompressionStream('gzip'))
  return new Uint8Array(await new Response(stream).arrayBuffer())
}
