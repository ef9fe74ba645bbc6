// What the engine answers, and what the build puts in place of imports.

/** What a run is. */
export interface About {
  title: string
  model: string
  scheme: string
  cells: number[]
  origin: number[]
  size: number[]
  dimensions: number
  outlets: string[]
  quantities: { name: string; long_name: string; units: string; kind: string; values: number }[]
  remarks: string[]
  bytes: number
}

/** Where a run stands. */
export interface State {
  ended: boolean
  time: number
  steps: number
  mass: number
  mass_in: number
  out: number[]
  mass_out: number
  mass_error: number
  wet_cells: number
  moving_cells: number
  max_speed: number
  kinetic_energy: number
  at_rest: boolean
  stop_reason: string | null
  in_words: string | null
  wall_seconds: number
  source_rate: number
}

/** A run that the page holds: what it is, where it stands, what was asked of its fields. */
export interface Run extends Partial<State> {
  handle: number
  about: About
  fields?: Record<string, Float64Array>
  picture?: Float64Array
  probed?: number[]
}

/** How far a run goes before it answers. */
export interface Limits {
  time?: number
  steps?: number
  milliseconds?: number
}

/** What was refused, where, and the cure. */
export interface Reason {
  message: string
  key?: string
  line?: number
  column?: number
  help?: string[]
}

/** An elevation model, thinned to `stride` cells for each value of `z`. */
export interface Ground {
  columns: number
  rows: number
  west: number
  south: number
  cell: number
  crs?: string
  stride: number
  z: Float64Array
}

declare global {
  interface Window {
    granflow: any
  }
}
