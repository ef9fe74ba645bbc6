// Plays runs: asks the engine for steps as long as it plays, one request at a time, and shows what comes. How far it asks at a
// time follows from how fast this machine is.

const PAUSE = 12 // milliseconds of computing between two answers, at least; half of a frame where that is longer
const SLACK = 0.1 // seconds of play that may be owed

// The same function, of which one call begins when the one before has ended; `waiting` says how many have not.
export function serial(work) {
  let last = Promise.resolve()
  const call = (...values) => {
    call.waiting++
    const mine = last.then(() => work(...values)).finally(() => { call.waiting-- })
    last = mine.catch(() => {}) // its caller hears of a failure; the next call begins all the same
    return mine
  }
  call.waiting = 0
  return call
}

export class Player {
  /** @type {(limits: import('./types').Limits) => Promise<boolean>} */
  ask
  /** @type {() => void} */
  show
  /** @type {() => void} */
  changed
  /** @type {(reason: import('./types').Reason) => void} */
  failed
  /** @type {() => number} */
  pace
  /** @type {() => number} */
  time
  busy = false

  // `ask(limits)` steps and resolves to true at the end; `show()` draws, at most once a frame; `pace()` says how much of the
  // run's time may pass in a second, of which `time()` is the present one.
  constructor({ ask, show, changed, failed, pace = () => Infinity, time = () => 0 }) {
    Object.assign(this, { ask, show, changed, failed, pace, time, playing: false, ended: false })
  }
  play() {
    if (this.playing || this.ended) return
    this.playing = true
    this.changed()
    this.loop()
  }
  pause() {
    this.playing = false
    this.changed()
  }
  async loop() {
    let last = performance.now()
    let due = this.time()
    while (this.playing && !this.ended) {
      const now = performance.now()
      const passed = Math.max(1, now - last)
      due += this.pace() * passed / 1e3
      last = now
      if (due > this.time()) await this.once({ time: due, milliseconds: Math.max(PAUSE, Math.min(passed / 2, 100)) })
      due = Math.min(due, this.time() + this.pace() * SLACK) // what a slow machine could not do is not caught up
      await new Promise(requestAnimationFrame)
    }
  }
  async step() {
    if (!this.busy && !this.ended) await this.once({ steps: 1 })
  }
  async once(limits) {
    this.busy = true
    try {
      this.ended = await this.ask(limits)
      this.show()
    } catch (error) {
      this.ended = true
      this.failed(error)
    }
    this.busy = false
    if (this.ended) this.playing = false
    this.changed()
  }
  // Resolves when nothing is asked for any more.
  async stop() {
    this.playing = false
    while (this.busy) await new Promise(done => setTimeout(done, 5))
    this.ended = false
  }
}
