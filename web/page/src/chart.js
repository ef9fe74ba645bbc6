// Lines over one axis on a canvas, with axes that the eye can read; colours from the page's style.

const nice = span => {
  const power = 10 ** (Math.floor(Math.log10(span)) - 1)
  return [1, 2, 5, 10, 20, 50].map(step => step * power).find(step => span / step <= 8)
}

// `lines`: [{ x, y, colour, width, dashed }]; `range`: [x0, x1, y0, y1], or what the lines span; marks: [{ x, colour }].
/**
 * @param {HTMLCanvasElement} canvas
 * @param {{ x: ArrayLike<number>, y: ArrayLike<number>, colour?: string, width?: number, dashed?: boolean }[]} lines
 * @param {{ range?: number[], xLabel?: string, yLabel?: string, marks?: { x: number, colour: string }[] }} how
 */
export function chart(canvas, lines, { range, xLabel = '', yLabel = '', marks = [] } = {}) {
  const scale = window.devicePixelRatio || 1
  const [width, height] = [canvas.clientWidth, canvas.clientHeight]
  if (!width || !height) return
  if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale)
  if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale)
  const context = canvas.getContext('2d')
  const style = getComputedStyle(canvas)
  const [ink, faint] = [style.color, style.getPropertyValue('--faint') || '#8888']
  const [x0, x1, y0, y1] = range ?? spanned(lines)
  const box = { left: 52, right: width - 10, top: 10, bottom: height - 34 }
  const px = x => box.left + (x - x0) / (x1 - x0) * (box.right - box.left)
  const py = y => box.bottom - (y - y0) / (y1 - y0) * (box.bottom - box.top)
  context.setTransform(scale, 0, 0, scale, 0, 0)
  context.clearRect(0, 0, width, height)
  context.font = '12px system-ui, sans-serif'
  context.lineWidth = 1
  context.strokeStyle = faint
  context.fillStyle = ink
  context.textAlign = 'center'
  ticks(x0, x1).forEach(x => {
    line(context, [px(x), px(x)], [box.top, box.bottom])
    context.fillText(short(x, x1 - x0), px(x), box.bottom + 15)
  })
  context.textAlign = 'right'
  ticks(y0, y1).forEach(y => {
    line(context, [box.left, box.right], [py(y), py(y)])
    context.fillText(short(y, y1 - y0), box.left - 6, py(y) + 4)
  })
  context.textAlign = 'center'
  context.fillText(xLabel, (box.left + box.right) / 2, height - 5)
  context.textAlign = 'left'
  context.fillText(yLabel, box.left + 4, box.top + 11)
  context.save()
  context.beginPath()
  context.rect(box.left, box.top, box.right - box.left, box.bottom - box.top)
  context.clip()
  for (const { x, colour } of marks) {
    context.strokeStyle = colour
    line(context, [px(x), px(x)], [box.top, box.bottom])
  }
  for (const { x, y, colour, width: thick = 2, dashed } of lines) {
    context.strokeStyle = colour ?? ink
    context.lineWidth = thick
    context.setLineDash(dashed ? [6, 4] : [])
    line(context, Array.from(x, px), Array.from(y, py))
  }
  context.restore()
}

function line(context, x, y) {
  context.beginPath()
  x.forEach((at, k) => (k ? context.lineTo(at, y[k]) : context.moveTo(at, y[k])))
  context.stroke()
}

function ticks(low, high) {
  const step = nice(high - low)
  const first = Math.ceil(low / step - 1e-9)
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => (first + k) * step)
}

// A number at a tick of an axis of that length.
const short = (value, span) =>
  (Math.abs(value) < 1e-9 * span ? '0' : Math.abs(value) < 1e-3 ? (+value.toPrecision(3)).toExponential() : String(+value.toPrecision(4)))

function spanned(lines) {
  const all = key => lines.flatMap(one => Array.from(one[key])).filter(Number.isFinite)
  const ends = values => [Math.min(...values), Math.max(...values)]
  const [x, y] = [ends(all('x')), ends([0, ...all('y')])]
  const margin = 0.05 * (y[1] - y[0] || 1)
  return [x[0], x[1] > x[0] ? x[1] : x[0] + 1, y[0] - (y[0] < 0 ? margin : 0), y[1] + margin]
}
