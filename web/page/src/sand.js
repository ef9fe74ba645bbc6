// Sand poured with the pointer on a table: the standing layer as a lit surface, the rolling layer on it, a section, the books.
import { TABLES, sand as caseOf } from './cases.js'
import { chart } from './chart.js'
import { colour, hillshade } from './colours.js'
import { button, choice, complain, download, fixed, make, slider } from './dom.js'
import { Player, serial } from './player.js'

const SAND = [226, 190, 130]
const SIDE = 560 // pixels of the picture

export function sand(client, place) {
  const chosen = { table: 'square', cells: 60, scheme: 'adaptive', rate: 4, radius: 0.06 }
  const pointer = { x: 0.5, y: 0.5, down: false }
  let run = null
  let poured = [] // the sources at work
  let wanted = null // those that are wanted next
  let equilibrium = null
  const error = make('div', { class: 'error', role: 'alert', hidden: true })
  const picture = make('canvas', { class: 'table', width: SIDE, height: SIDE, tabindex: 0, role: 'img' })
  const section = make('canvas', { class: 'chart', role: 'img' })
  const clock = make('p', { class: 'clock', 'aria-live': 'polite' })

  const player = new Player({
    ask: async limits => {
      await changed()
      const state = await client.call('advance', run.handle, limits, ['standing_layer', 'rolling_layer'])
      Object.assign(run, state)
      // A table at rest waits for more sand.
      const pours = poured.some(source => source.rate > 0)
      if (state.ended && !pours && !wanted) player.playing = false
      return state.ended && pours
    },
    show: draw,
    changed: () => {
      play.textContent = player.playing ? 'Pause' : 'Run'
      play.disabled = player.ended || !run
    },
    failed: reason => complain(error, reason),
  })
  const play = button('Run', () => (player.playing ? player.pause() : player.play()), { class: 'main' })

  const text = (sources, direct) => caseOf({ ...chosen, sources: sources.length ? sources : [{ rate: 0 }], direct })

  // Lets the run go on with the sources that are wanted.
  async function changed() {
    if (!wanted) return
    poured = wanted
    wanted = null
    await client.call('change', run.handle, text(poured))
  }
  const pour = () => {
    wanted = pointer.down ? [{ x: +pointer.x.toFixed(3), y: +pointer.y.toFixed(3), radius: chosen.radius, rate: chosen.rate }] : []
    equilibrium = null
    if (player.ended) player.ended = false
    if (pointer.down) player.play()
  }

  const reset = serial(async (sources = []) => {
    await player.stop()
    complain(error)
    if (run) await client.call('close', run.handle)
    run = null
    wanted = null
    poured = sources
    equilibrium = null
    try {
      run = await client.call('open', text(sources))
      Object.assign(run, await client.call('advance', run.handle, { steps: 0 }, ['standing_layer', 'rolling_layer']))
    } catch (reason) {
      complain(error, reason)
    }
    player.changed()
    draw()
  })

  // The pile that the sources at work would grow to, without growing it.
  async function atOnce() {
    const sources = poured.some(source => source.rate > 0) ? poured : [{ x: pointer.x, y: pointer.y, radius: chosen.radius, rate: chosen.rate }]
    try {
      complain(error)
      const { handle } = await client.call('open', text(sources, true))
      equilibrium = await client.call('field', handle, 'standing_layer')
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

  function draw() {
    if (!run?.fields) return
    const n = chosen.cells
    const { standing_layer: standing, rolling_layer: rolling } = run.fields
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
    const small = draw.canvas ??= new OffscreenCanvas(1, 1)
    Object.assign(small, { width: n, height: n })
    small.getContext('2d').putImageData(image, 0, 0)
    const context = picture.getContext('2d')
    context.clearRect(0, 0, SIDE, SIDE)
    context.imageSmoothingEnabled = true
    context.drawImage(small, 0, 0, SIDE, SIDE)
    context.strokeStyle = pointer.down ? '#b3001e' : '#0b6fb8'
    context.lineWidth = 2
    context.beginPath()
    context.arc(pointer.x * SIDE, (1 - pointer.y) * SIDE, chosen.radius * SIDE, 0, 7)
    context.stroke()
    words(standing, rolling, n)
  }

  function words(standing, rolling, n) {
    const [row, nodeRow] = [Math.min(n - 1, Math.floor(pointer.y * n)), Math.round(pointer.y * n)]
    const nodes = Array.from({ length: n + 1 }, (_, i) => i / n)
    const centres = Array.from({ length: n }, (_, i) => (i + 0.5) / n)
    const line = values => Array.from(values.slice(nodeRow * (n + 1), (nodeRow + 1) * (n + 1)))
    const lines = [
      { x: nodes, y: line(standing), colour: '#a8772b', width: 3 },
      { x: centres, y: Array.from(rolling.slice(row * n, (row + 1) * n)), colour: '#d1495b' },
    ]
    if (equilibrium) lines.push({ x: nodes, y: line(equilibrium), dashed: true, width: 1.5 })
    const top = Math.max(0.1, ...lines.flatMap(({ y }) => y.filter(Number.isFinite)))
    chart(section, lines, { range: [0, 1, 0, 1.1 * top], xLabel: `x along y = ${fixed(pointer.y)}`, yLabel: 'standing (brown) and rolling (red) layer' })
    const [tall, thick] = [standing, rolling].map(values => values.reduce((most, value) => (value > most ? value : most), 0))
    const said = `time ${fixed(run.time)}, poured ${fixed(run.mass_in, 4)}, on the table ${fixed(run.mass, 4)}, fallen off ${fixed(run.mass_out, 4)}, `
      + `relative error of the mass ${(run.mass_error || 0).toExponential(1)}; ${run.at_rest ? 'at rest' : run.in_words ?? 'moving'}`
    clock.textContent = said
    picture.setAttribute('aria-label', `Table from above. The pile is up to ${fixed(tall)} high, the rolling layer up to ${fixed(thick, 3)} thick; ${said}`)
    section.setAttribute('aria-label', `Section along y = ${fixed(pointer.y)}`)
  }

  const moved = event => {
    const box = picture.getBoundingClientRect()
    pointer.x = Math.max(0, Math.min(1, (event.clientX - box.left) / box.width))
    pointer.y = Math.max(0, Math.min(1, 1 - (event.clientY - box.top) / box.height))
  }
  picture.addEventListener('pointerdown', event => {
    picture.setPointerCapture(event.pointerId)
    moved(event)
    pointer.down = true
    pour()
  })
  picture.addEventListener('pointermove', event => {
    moved(event)
    if (pointer.down) pour()
    else if (!player.playing) draw()
  })
  for (const name of ['pointerup', 'pointercancel']) {
    picture.addEventListener(name, () => {
      pointer.down = false
      pour()
    })
  }
  picture.addEventListener('keydown', event => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key]
    if (way) {
      pointer.x = Math.max(0, Math.min(1, pointer.x + 0.02 * way[0]))
      pointer.y = Math.max(0, Math.min(1, pointer.y + 0.02 * way[1]))
    } else if (event.key === ' ') pointer.down = !pointer.down
    else return
    event.preventDefault()
    if (pointer.down || event.key === ' ') pour()
    draw()
  })

  place.append(
    make('div', { class: 'row' },
      choice('Table', Object.fromEntries(Object.entries(TABLES).map(([key, { title }]) => [key, title])), chosen.table, value => {
        chosen.table = value
        reset()
      }),
      choice('Cells', { 20: '20 × 20', 40: '40 × 40', 60: '60 × 60', 100: '100 × 100' }, '60', value => {
        chosen.cells = +value
        reset()
      }),
      choice('Scheme', { adaptive: 'adaptive', first_order: 'first order', second_order: 'second order' }, chosen.scheme, value => {
        chosen.scheme = value
        reset()
      }),
      play, button('Reset', () => reset()),
      button('Pour everywhere', () => {
        wanted = [{ rate: 0.5 }]
        equilibrium = null
        player.ended = false
        player.play()
      }),
      button('The pile at once', atOnce),
      button('case.toml', () => download('case.toml', text(poured)))),
    make('div', { class: 'row' },
      slider('pours', 'per area and time', [0.5, 20, 0.5, chosen.rate], value => { chosen.rate = value; if (pointer.down) pour() }),
      slider('radius', '', [0.02, 0.3, 0.01, chosen.radius], value => { chosen.radius = value; if (pointer.down) pour(); draw() })),
    error,
    make('p', { class: 'hint' }, 'Press on the table and hold to pour; or choose it with Tab, move with the arrow keys, and pour with the space bar.'),
    make('div', { class: 'pair' }, picture, make('div', {}, section, clock)))
  return { reset, player, idle: () => reset.waiting === 0, redraw: draw, open: () => run || reset(), run: () => run, pourEverywhere: rate => { wanted = [{ rate }] } }
}
