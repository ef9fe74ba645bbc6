// What a pointer draws, as polygons.

const NEAR = 0.012 // points closer than this are one

// The points of a stroke that are apart from the one before.
export function thinned(points) {
  const kept = []
  for (const point of points) {
    const last = kept.at(-1)
    if (!last || Math.hypot(point[0] - last[0], point[1] - last[1]) > NEAR) kept.push(point.map(value => +value.toFixed(4)))
  }
  return kept
}

// A rectangle around each segment of a line, `half` wide to every side.
export const strip = (points, half) => points.slice(1).map(([x1, y1], k) => {
  const [x0, y0] = points[k]
  const length = Math.hypot(x1 - x0, y1 - y0)
  const [dx, dy] = [half * (x1 - x0) / length, half * (y1 - y0) / length]
  return [[x0 - dx - dy, y0 - dy + dx], [x0 - dx + dy, y0 - dy - dx], [x1 + dx + dy, y1 + dy - dx], [x1 + dx - dy, y1 + dy + dx]]
})
