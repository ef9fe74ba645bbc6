// Sand poured with the pointer on a table, chosen or drawn: both layers from above and in section, the books, the pile at once.
import { DRAWN, TABLES, sand as caseOf } from './cases.js'
import { chart } from './chart.js'
import { colour, hillshade } from './colours.js'
import { button, choice, complain, download, fixed, make, slider } from './dom.js'
import { polygons } from './mountains.js'
import { Player, serial } from './player.js'
import { strip, thinned } from './strokes.js'
import { zip } from './zip.js'

const SAND = [226, 190, 130]
const SIDE = 560 // pixels of the picture
const TOOLS = { pour: 'pours', outline: 'draws the table', hole: 'cuts a hole', wall: 'sets a wall on an edge' }
const BOOKS = [['mass_in', 'poured', '#2b86cc'], ['mass', 'on the table', '#a8772b'], ['mass_out', 'fallen', '#d1495b']]
const LAYERS = ['standing_layer', 'rolling_layer']

export function sand(client, place) {
  const chosen = { table: 'square', cells: 60, scheme: 'adaptive', rate: 4, radius: 0.06, tool: 'pour' }
  const pointer = { x: 0.5, y: 0.5, down: false }
  const drawn = { outline: [], hole: [], wall: [] } // rings
  let stroke = null // points of what is being drawn
  /** @type {import('./types').Run} */
  let run = null
  let books = []
  let poured = [] // the sources at work
  let wanted = null // those that are wanted next
  let equilibrium = null
  const error = make('div', { class: 'error', role: 'alert', hidden: true })
  const picture = make('canvas', { class: 'table', width: SIDE, height: SIDE, tabindex: 0, role: 'img' })
  const pile = make('canvas', { class: 'table', width: SIDE, height: SIDE, role: 'img', 'aria-label': 'The pile at once' })
  const beside = make('figure', { hidden: true }, make('figcaption', {}, 'The pile that it would become, at once'), pile)
  const section = make('canvas', { class: 'chart', role: 'img' })
  const ledger = make('canvas', { class: 'chart', role: 'img' })
  const clock = make('p', { class: 'clock', 'aria-live': 'off' })

  const player = new Player({
    ask: async limits => {
      await changed()
      Object.assign(run, await client.call('advance', run.handle, limits, LAYERS))
      keep()
      // A table at rest waits for more sand.
      const pours = poured.some(source => source.rate > 0)
      if (run.ended && !pours && !wanted) player.playing = false
      return run.ended && pours
    },
    show: draw,
    changed: () => {
      play.textContent = player.playing ? 'Pause' : 'Run'
      play.disabled = player.ended || !run
      clock.setAttribute('aria-live', player.playing ? 'off' : 'polite')
    },
    failed: reason => complain(error, reason),
  })
  const play = button('Run', () => (player.playing ? player.pause() : player.play()), { class: 'main' })

  const kinds = () => Object.keys(drawn).filter(kind => drawn[kind].length)
  const text = (sources, direct) => caseOf({ ...chosen, sources: sources.length ? sources : [{ rate: 0 }], direct, drawn: kinds() })
  const files = () => kinds().map(kind => [DRAWN[kind], new TextEncoder().encode(polygons(drawn[kind]))])

  // An entry of the books for each answer; every second one goes when there are many.
  function keep() {
    if (books.at(-1)?.time === run.time) books.pop()
    books.push({ time: run.time, ...Object.fromEntries(BOOKS.map(([key]) => [key, run[key]])) })
    if (books.length > 1000) books = books.filter((_, k) => k % 2 === 0 || k === books.length - 1)
  }
  // Lets the run go on with the sources that are wanted.
  async function changed() {
    if (!wanted) return
    poured = wanted
    wanted = null
    await client.call('change', run.handle, text(poured))
  }
  const pour = () => {
    wanted = pointer.down ? [{ x: +pointer.x.toFixed(3), y: +pointer.y.toFixed(3), radius: chosen.radius, rate: chosen.rate }] : []
    again()
    if (pointer.down) player.play()
  }
  function forgetPile() {
    equilibrium = null
    beside.hidden = true
  }
  // What was at its end or could not go on goes on.
  function again() {
    forgetPile()
    complain(error)
    player.ended = false
  }

  async function begin(sources = []) {
    await player.stop()
    complain(error)
    if (run) await client.call('close', run.handle)
    run = null
    wanted = null
    poured = sources
    books = []
    forgetPile()
    try {
      for (const [name, content] of files()) await client.call('put', name, content)
      run = await client.call('open', text(sources))
      Object.assign(run, await client.call('advance', run.handle, { steps: 0 }, LAYERS))
      keep()
    } catch (reason) {
      complain(error, reason)
    }
    named()
    player.changed()
    draw()
  }
  const reset = serial(begin)

  // The pile that the sources at work would grow to, without growing it.
  async function atOnce() {
    const sources = poured.some(source => source.rate > 0) ? poured : [{ x: pointer.x, y: pointer.y, radius: chosen.radius, rate: chosen.rate }]
    try {
      complain(error)
      const { handle } = await client.call('open', text(sources, true))
      const layers = await Promise.all(LAYERS.map(name => client.call('field', handle, name)))
      equilibrium = { standing: layers[0], rolling: layers[1] }
      beside.hidden = false
      await client.call('close', handle)
    } catch (reason) {
      complain(error, reason)
    }
    draw()
  }

  // Values of the nodes, at the centres of the cells.
  const centred = (nodes, n) => Float64Array.from({ length: n * n }, (_, k) => {
    const at = k % n + Math.floor(k / n) * (n + 1)
    return (nodes[at] + nodes[at + 1] + nodes[at + n + 1] + nodes[at + n + 2]) / 4
  })

  const small = new OffscreenCanvas(1, 1)
  // Both layers from above: the standing one lit from the side, the rolling one in colour on it.
  function fromAbove(canvas, standing, rolling) {
    const n = Math.round(Math.sqrt(rolling.length))
    const height = centred(standing, n)
    const shade = hillshade(height, n, n, 1 / n)
    const most = rolling.reduce((most, value) => (value > most ? value : most), 1e-9)
    const image = new ImageData(n, n)
    for (let k = 0; k < n * n; k++) {
      const at = 4 * ((n - 1 - Math.floor(k / n)) * n + k % n)
      const off = !Number.isFinite(height[k])
      const rolls = rolling[k] > 1e-4 ? 0.75 * Math.min(1, Math.sqrt(rolling[k] / most)) : 0
      const shown = colour('heat', rolls)
      for (let c = 0; c < 3; c++) {
        const ground = height[k] > 1e-4 ? SAND[c] : 205
        image.data[at + c] = off ? 90 : ((1 - rolls) * ground + rolls * shown[c]) * Math.min(1, 0.25 + shade[k])
      }
      image.data[at + 3] = off ? 40 : 255
    }
    Object.assign(small, { width: n, height: n })
    small.getContext('2d').putImageData(image, 0, 0)
    const context = canvas.getContext('2d')
    context.clearRect(0, 0, SIDE, SIDE)
    context.drawImage(small, 0, 0, SIDE, SIDE)
    return context
  }

  function draw() {
    if (!run?.fields) return
    const { standing_layer: standing, rolling_layer: rolling } = run.fields
    const context = fromAbove(picture, standing, rolling)
    const line = (points, colour) => {
      context.strokeStyle = colour
      context.lineWidth = 2
      context.beginPath()
      points.forEach(([x, y], k) => context[k ? 'lineTo' : 'moveTo'](x * SIDE, (1 - y) * SIDE))
      context.stroke()
    }
    context.fillStyle = '#6b3a1e'
    for (const ring of drawn.wall) {
      context.beginPath()
      ring.forEach(([x, y], k) => context[k ? 'lineTo' : 'moveTo'](x * SIDE, (1 - y) * SIDE))
      context.fill()
    }
    if (stroke) line(stroke, '#b3001e')
    context.strokeStyle = pointer.down ? '#b3001e' : '#0b6fb8'
    context.lineWidth = 2
    context.beginPath()
    context.arc(pointer.x * SIDE, (1 - pointer.y) * SIDE, chosen.tool === 'pour' ? chosen.radius * SIDE : 4, 0, 7)
    context.stroke()
    if (equilibrium) fromAbove(pile, equilibrium.standing, equilibrium.rolling)
    words(standing, rolling)
  }

  function words(standing, rolling) {
    const n = Math.round(Math.sqrt(rolling.length))
    const [row, nodeRow] = [Math.min(n - 1, Math.floor(pointer.y * n)), Math.round(pointer.y * n)]
    const nodes = Array.from({ length: n + 1 }, (_, i) => i / n)
    const centres = Array.from({ length: n }, (_, i) => (i + 0.5) / n)
    const line = values => Array.from(values.slice(nodeRow * (n + 1), (nodeRow + 1) * (n + 1)))
    /** @type {Parameters<typeof chart>[1]} */
    const lines = [
      { x: nodes, y: line(standing), colour: '#a8772b', width: 3 },
      { x: centres, y: Array.from(rolling.slice(row * n, (row + 1) * n)), colour: '#d1495b' },
    ]
    if (equilibrium) lines.push({ x: nodes, y: line(equilibrium.standing), dashed: true, width: 1.5 })
    const top = Math.max(0.1, ...lines.flatMap(({ y }) => Array.from(y).filter(Number.isFinite)))
    chart(section, lines, { range: [0, 1, 0, 1.1 * top], xLabel: `x along y = ${fixed(pointer.y)}`, yLabel: `standing (brown) and rolling (red) layer${equilibrium ? ', at once (dashed)' : ''}` })
    chart(ledger, BOOKS.map(([key, , colour]) => ({ x: books.map(({ time }) => time), y: books.map(entry => entry[key]), colour })), { xLabel: 'time', yLabel: 'poured (blue), on the table (brown), fallen (red)' })
    const [tall, thick] = [standing, rolling].map(values => values.reduce((most, value) => (value > most ? value : most), 0))
    const said = `time ${fixed(run.time)}, ${BOOKS.map(([key, words]) => `${words} ${fixed(run[key], 4)}`).join(', ')}, `
      + `relative error of the mass ${(run.mass_error || 0).toExponential(1)}; ${run.at_rest ? 'at rest' : run.in_words ?? 'moving'}`
    clock.textContent = said
    picture.setAttribute('aria-label', `Table from above. The pile is up to ${fixed(tall)} high, the rolling layer up to ${fixed(thick, 3)} thick; ${said}`)
    section.setAttribute('aria-label', `Section along y = ${fixed(pointer.y)}`)
    ledger.setAttribute('aria-label', `The books over time: ${said}`)
  }

  // What the pointer does where it is: it pours, or draws a stroke that becomes a part of the table when it ends.
  function press() {
    pointer.down = true
    if (chosen.tool === 'pour') return pour()
    stroke = [[pointer.x, pointer.y]]
    return draw()
  }
  function move() {
    if (pointer.down && chosen.tool === 'pour') return pour()
    stroke?.push([pointer.x, pointer.y])
    if (!player.playing || stroke) draw()
  }
  async function release() {
    if (!pointer.down) return
    pointer.down = false
    if (chosen.tool === 'pour') return pour()
    const points = thinned(stroke)
    const [kind, before] = [chosen.tool, drawn[chosen.tool]]
    stroke = null
    if (points.length < (kind === 'wall' ? 2 : 3)) return draw()
    drawn[kind] = kind === 'wall' ? [...before, ...strip(points, 1.2 / chosen.cells)] : kind === 'outline' ? [points] : [...before, points]
    await reset()
    if (run) return
    // A table that cannot be is not kept.
    const said = [...error.childNodes]
    drawn[kind] = before
    await reset()
    error.replaceChildren(...said)
    error.hidden = false
  }

  const limited = value => Math.max(0, Math.min(1, value))
  const moved = event => {
    const box = picture.getBoundingClientRect()
    Object.assign(pointer, { x: limited((event.clientX - box.left) / box.width), y: limited(1 - (event.clientY - box.top) / box.height) })
  }
  picture.addEventListener('pointerdown', event => {
    picture.setPointerCapture(event.pointerId)
    moved(event)
    press()
  })
  picture.addEventListener('pointermove', event => {
    moved(event)
    move()
  })
  for (const name of ['pointerup', 'pointercancel']) picture.addEventListener(name, release)
  picture.addEventListener('keydown', event => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key]
    if (way) {
      Object.assign(pointer, { x: limited(pointer.x + 0.02 * way[0]), y: limited(pointer.y + 0.02 * way[1]) })
      move()
    } else if (event.key === ' ') {
      if (pointer.down) release()
      else press()
    } else return
    event.preventDefault()
    draw()
  })

  const sets = (key, of = value => value) => value => {
    chosen[key] = of(value)
    reset()
  }
  const tables = choice('Table', Object.fromEntries(Object.entries(TABLES).map(([key, { title }]) => [key, title])), chosen.table, value => {
    if (value === 'drawn') return
    chosen.table = value
    drawn.outline = []
    reset()
  })
  // The choice of tables says where the outline was drawn.
  function named() {
    const option = tables.select.querySelector('[value=drawn]')
    if (!drawn.outline.length) option?.remove()
    else if (!option) tables.select.append(make('option', { value: 'drawn' }, 'drawn'))
    tables.select.value = drawn.outline.length ? 'drawn' : chosen.table
  }
  place.append(
    make('div', { class: 'row' },
      tables,
      choice('Cells', { 20: '20 × 20', 40: '40 × 40', 60: '60 × 60', 100: '100 × 100' }, '60', sets('cells', Number)),
      choice('Scheme', { adaptive: 'adaptive', first_order: 'first order', second_order: 'second order' }, chosen.scheme, sets('scheme')),
      choice('The pointer', TOOLS, chosen.tool, value => {
        chosen.tool = value
        draw()
      }),
      button('Erase what was drawn', () => {
        Object.assign(drawn, { outline: [], hole: [], wall: [] })
        return reset()
      })),
    make('div', { class: 'row' },
      play, button('Reset', () => reset()),
      button('Pour everywhere', () => {
        wanted = [{ rate: 0.5 }]
        again()
        player.play()
      }),
      button('The pile at once', atOnce),
      button('case.toml', async () => (kinds().length
        ? download('granflow.zip', await zip([['case.toml', new TextEncoder().encode(text(poured))], ...files()]))
        : download('case.toml', text(poured))))),
    make('div', { class: 'row' },
      slider('pours', 'per area and time', [0.5, 20, 0.5, chosen.rate], value => { chosen.rate = value; if (pointer.down) pour() }),
      slider('radius', '', [0.02, 0.3, 0.01, chosen.radius], value => { chosen.radius = value; if (pointer.down) pour(); draw() })),
    error,
    make('p', { class: 'hint' }, 'Press on the table and hold; or choose it with Tab, move with the arrow keys, and press and release with the space bar.'),
    make('div', { class: 'pair' }, make('div', {}, picture, beside), make('div', {}, section, clock, ledger)))
  return { reset, player, idle: () => reset.waiting === 0, redraw: draw, open: () => run || reset(), run: () => run, text: () => text(poured) }
}
