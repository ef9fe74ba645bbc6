// Mountains by formulas of + - * / and square root alone, which every machine computes to the same bits; metres, x to the east
// and y to the north, the top in the south.

const CELL = 5
const sqrt = Math.sqrt
// 1 at 0, falling to both sides within a width.
const bell = (x, width) => 1 / (1 + (x / width) * (x / width))
// From 0 to 1, steepest at 0, within a width.
const rise = (x, width) => 0.5 + 0.5 * x / sqrt(x * x + width * width)
// A slope that levels out at s = end, over a width.
const fall = (s, grade, end, width) => grade * 0.5 * (end - s + sqrt((end - s) * (end - s) + width * width))

export const MOUNTAINS = {
  demo: { title: 'The mountain of granflow demo', demo: true, crs: 'EPSG:31287' }, // its formula is the program's
  gully: {
    title: 'A bowl, a gully and a fan',
    columns: 200, rows: 300,
    release: [[-62, 92], [-24, 62], [30, 58], [74, 96], [66, 150], [24, 196], [-20, 200], [-58, 158]],
    height(x, s) {
      const winding = 60 * (s - 520) / sqrt((s - 520) * (s - 520) + 250 * 250) - 40
      const d = x - winding * rise(s - 300, 120)
      const width = 70 + 130 * rise(s - 950, 120)
      const depth = 30 + 75 * bell(s - 520, 300)
      return 900 + fall(s, 0.72, 780, 380) + depth * (1 - bell(d, width)) + 12 * bell(s - 620, 45) * (1 - bell(d, 90))
    },
  },
  plane: {
    title: 'A straight slope that runs out on a plain',
    columns: 160, rows: 260,
    release: [[-60, 90], [60, 90], [60, 190], [-60, 190]],
    height: (x, s) => 600 + fall(s, 0.7, 620, 120) + 0.0004 * x * x,
  },
  dam: {
    title: 'A slope with a deflecting dam',
    columns: 180, rows: 260,
    release: [[-70, 80], [70, 80], [60, 170], [-60, 170]],
    height(x, s) {
      const across = (s - 640) - 0.45 * x
      const dam = 16 * bell(across, 9) * rise(x + 150, 8) * rise(170 - x, 8)
      return 600 + fall(s, 0.66, 640, 160) + dam
    },
  },
  cone: {
    title: 'A volcano with a notched rim',
    columns: 220, rows: 220,
    release: [[-45, 455], [45, 455], [55, 540], [0, 575], [-55, 540]],
    height(x, s) {
      const [dx, dy] = [x, s - 480]
      const r = sqrt(dx * dx + dy * dy)
      const notch = 30 * bell(dx, 28) * rise(dy - 20, 30)
      return 500 + 0.62 * (420 - sqrt(r * r + 900)) * rise(520 - r, 60) - 35 * bell(r, 38) - notch
    },
  },
}

// The files of a mountain: its elevation as an ESRI ASCII grid and its release as GeoJSON; heights to the centimetre.
export function files(name) {
  const { columns, rows, release, height } = MOUNTAINS[name]
  const lines = [`ncols ${columns}`, `nrows ${rows}`, 'xllcorner 0', 'yllcorner 0', `cellsize ${CELL}`, 'NODATA_value -9999']
  const middle = 0.5 * columns * CELL
  for (let row = rows - 1; row >= 0; row--) { // the first row in the north
    const s = (row + 0.5) * CELL
    lines.push(Array.from({ length: columns }, (_, k) => height((k + 0.5) * CELL - middle, s).toFixed(2)).join(' '))
  }
  return { dem: lines.join('\n') + '\n', release: polygons([release.map(([x, s]) => [middle + x, s])]) }
}

// Rings as a GeoJSON file, a polygon each.
export const polygons = rings => JSON.stringify({
  type: 'FeatureCollection',
  features: rings.map(ring => ({ type: 'Feature', properties: {}, geometry: { type: 'Polygon', coordinates: [[...ring, ring[0]]] } })),
})
