// Colours of numbers, and pictures of fields with the shadow of a hill.

// Stops of colour scales, dark to light, all readable on grey terrain; from ColorBrewer's YlOrRd and Blues.
const SCALES = {
  heat: [[255, 255, 178], [254, 217, 118], [254, 178, 76], [253, 141, 60], [240, 59, 32], [150, 0, 30]],
  blue: [[222, 235, 247], [158, 202, 225], [107, 174, 214], [49, 130, 189], [8, 81, 156], [4, 40, 90]],
}

// The colour at share t of a scale.
export function colour(scale, t) {
  const stops = SCALES[scale]
  const at = Math.max(0, Math.min(1, t)) * (stops.length - 1)
  const k = Math.min(stops.length - 2, Math.floor(at))
  return stops[k].map((value, n) => value + (at - k) * (stops[k + 1][n] - value))
}

export const gradient = scale => `linear-gradient(to right, ${SCALES[scale].map(stop => `rgb(${stop})`).join(', ')})`

// Brightness 0 .. 1 of every cell under light from the north-west; `z` in rows from the south.
export function hillshade(z, columns, rows, cell) {
  const shade = new Float32Array(columns * rows)
  const light = [-0.5, 0.5, Math.SQRT1_2]
  for (let j = 0; j < rows; j++) {
    for (let i = 0; i < columns; i++) {
      const [w, e] = [Math.max(0, i - 1), Math.min(columns - 1, i + 1)]
      const [s, n] = [Math.max(0, j - 1), Math.min(rows - 1, j + 1)]
      // Beside a gap the slope is that of the other side, or none.
      const here = z[j * columns + i]
      const at = k => (Number.isFinite(z[k]) ? z[k] : here)
      const gx = (at(j * columns + e) - at(j * columns + w)) / ((e - w) * cell)
      const gy = (at(n * columns + i) - at(s * columns + i)) / ((n - s) * cell)
      const lit = (-gx * light[0] - gy * light[1] + light[2]) / Math.sqrt(1 + gx * gx + gy * gy)
      shade[j * columns + i] = Number.isFinite(lit) ? 0.35 + 0.65 * Math.max(0, lit) : 0
    }
  }
  return shade
}

// Shaded ground as RGBA bytes; nothing is there without an elevation.
export function shaded(shade, ground = [222, 219, 211]) {
  const bytes = new Uint8Array(4 * shade.length)
  shade.forEach((bright, k) => bytes.set([...ground.map(value => value * bright), bright > 0 ? 255 : 0], 4 * k))
  return bytes
}

const LEVELS = 256
const tables = Object.fromEntries(Object.keys(SCALES).map(scale => [scale, Array.from({ length: LEVELS }, (_, k) => colour(scale, k / (LEVELS - 1)))]))

// Paints a field over shaded ground into RGBA bytes, where it is above `least`.
export function paint(bytes, ground, shade, field, { scale, most, least }) {
  bytes.set(ground)
  if (!field) return
  for (let k = 0; k < shade.length; k++) {
    const value = field[k]
    if (!(value > least) || !shade[k]) continue
    const t = Math.min(1, value / most)
    const share = 0.55 + 0.4 * t
    const stop = tables[scale][Math.round(t * (LEVELS - 1))]
    for (let c = 0, at = 4 * k; c < 3; c++, at++) bytes[at] += share * (stop[c] * shade[k] - bytes[at])
  }
}
