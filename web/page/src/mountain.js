// A mountain slides: built-in or given, with a release from a file or drawn, to its rest.
import { LAWS, mountain as caseOf } from './cases.js'
import { chart } from './chart.js'
import { gradient } from './colours.js'
import { button, choice, complain, download, fixed, make, slider } from './dom.js'
import { MOUNTAINS } from './mountains.js'
import { Player, serial } from './player.js'
import { PICTURE, Relief } from './relief.js'
import { Site } from './site.js'
import { zip } from './zip.js'

// What can be laid over the relief: words, unit, colours, and the least that is seen.
const SHOWN = {
  thickness: ['Thickness', 'm', 'heat', 0.01], speed: ['Speed', 'm/s', 'blue', 0.1], peak_thickness: ['Greatest thickness so far', 'm', 'heat', 0.01],
  peak_speed: ['Greatest speed so far', 'm/s', 'blue', 0.1], deposit: ['Deposit', 'm', 'heat', 0.01],
}
const titles = all => Object.fromEntries(Object.entries(all).map(([key, { title }]) => [key, title]))

export function mountain(client, place) {
  const chosen = { mountain: 'gully', law: 'coulomb', thickness: 1, scheme: 'energy_stable_2', end: 400, shown: 'thickness', cell: 0, pace: 10 }
  const parameters = {}
  const site = new Site(client)
  let drawing = null // corners of a release under way, in coordinates
  /** @type {import('./types').Run} */
  let run = null
  let stride = 1 // cells for each point of the picture
  let gauge = null // { at: [x, y], cell, times, thickness, speed }
  let relief = null
  let spoken = 0 // when the words were last written

  const error = make('div', { class: 'error', role: 'alert', hidden: true })
  const view = make('div', { class: 'relief' })
  const clock = make('p', { class: 'clock', 'aria-live': 'off' })
  const notes = make('ul', { class: 'notes' })
  const series = make('canvas', { class: 'chart', role: 'img', hidden: true })
  const legend = make('div', { class: 'legend' })
  const sliders = make('div', { class: 'row' })

  const player = new Player({
    ask: async limits => {
      Object.assign(run, await client.call('watch', run.handle, limits, watched()))
      note()
      return run.ended
    },
    show: draw,
    changed: () => {
      play.textContent = player.playing ? 'Pause' : 'Run'
      play.disabled = player.ended || !run
      step.disabled = play.disabled || player.playing
      if (relief) relief.plays = player.playing
      clock.setAttribute('aria-live', player.playing ? 'off' : 'polite')
    },
    failed: reason => complain(error, reason),
    pace: () => chosen.pace,
    time: () => run.time,
  })
  const play = button('Run', () => (player.playing ? player.pause() : player.play()), { class: 'main' })
  const step = button('One step', () => player.step())

  const watched = () => ({ field: chosen.shown, columns: run.about.cells[0], stride, probes: ['thickness', 'speed'], cell: gauge?.cell })
  // Takes up what the gauge reads.
  function note() {
    if (!gauge || run.probed.length < 2 || gauge.times.at(-1) === run.time) return
    gauge.times.push(run.time)
    gauge.thickness.push(run.probed[0])
    gauge.speed.push(run.probed[1])
  }

  const builtIn = () => chosen.mountain !== 'given'
  const text = () => caseOf({
    title: builtIn() ? MOUNTAINS[chosen.mountain].title : `An avalanche on ${site.dem}`,
    dem: site.dem, crs: site.crs, cell: chosen.cell, release: site.release?.name, thickness: chosen.thickness,
    law: chosen.law, parameters: parameters[chosen.law], density: 200, scheme: chosen.scheme, end: chosen.end,
    curvature: Math.max(20, 3 * (chosen.cell || site.cell)), // over a few cells
  })

  /** @param {import('./types').Ground} ground */
  function showGround({ columns, rows, west, south, cell, stride: thinned, z }) {
    relief ??= new Relief(view)
    stride = thinned
    relief.show({ columns: Math.ceil(columns / stride), rows: Math.ceil(rows / stride), cell: cell * stride, z })
    Object.assign(relief, { west, south })
  }

  async function close() {
    await player.stop()
    if (run) await client.call('close', run.handle)
    run = null
    gauge = null
    series.hidden = true
  }

  async function begin() {
    const watched = site.mountain === chosen.mountain ? gauge?.at : null
    await close()
    complain(error)
    try {
      if (builtIn() && site.mountain !== chosen.mountain) {
        showGround(await site.builtIn(chosen.mountain))
        site.mountain = chosen.mountain
      }
      if (site.release) await open()
    } catch (reason) {
      run = null
      complain(error, reason)
    }
    const memory = await client.call('memory')
    notes.replaceChildren(
      ...(run?.about.remarks ?? []).map(remark => make('li', {}, remark)),
      make('li', {}, `Memory: ${run ? `${megabytes(run.about.bytes)} for this run of ${run.about.cells.join(' × ')} cells, ` : ''}${megabytes(memory)} of the engine in all; a browser gives 4096 MB at most.`))
    player.changed()
    if (run && watched) choose(watched)
    else draw()
  }
  async function open() {
    run = await client.call('open', text())
    const { cells: [columns, rows], origin: [west, south], size: [cell] } = run.about
    // The cells of the run, where the case resamples the elevation.
    if (Math.ceil(columns / stride) !== relief.columns || cell * stride !== relief.cell) {
      showGround({ columns, rows, west, south, cell, ...await client.call('ground', run.handle, { columns, rows }, PICTURE) })
    }
    Object.assign(run, await client.call('watch', run.handle, { steps: 0 }, watched()))
  }
  const reset = serial(begin)

  // Coordinates of a point of the picture, and back.
  const placeOf = ([i, j]) => [+(relief.west + i * relief.cell).toFixed(2), +(relief.south + j * relief.cell).toFixed(2)]
  const pointOf = ([x, y]) => [(x - relief.west) / relief.cell, (y - relief.south) / relief.cell]

  function draw() {
    if (!relief) return
    const [words, unit, scale, least] = SHOWN[chosen.shown]
    const field = run?.picture?.length === relief.columns * relief.rows ? run.picture : null
    const most = field ? field.reduce((most, value) => (value > most ? value : most), 5 * least) : 1
    const rings = drawing ? [drawing.length === 1 ? [...drawing, ...drawing] : [...drawing, ...drawing.slice(0, 1)]] : site.release?.rings ?? []
    relief.colour(field, { scale, most, least }, rings.map(ring => ring.map(pointOf)), gauge ? pointOf(gauge.at) : null)
    // Words are read slower than a picture is seen, and cost more to draw.
    const now = performance.now()
    if (player.playing && !player.ended && now - spoken < 200) return
    spoken = now
    legend.style.setProperty('--scale', gradient(scale))
    legend.textContent = `${words}: 0 to ${fixed(most)} ${unit}`
    say(words, most, unit)
    if (!gauge) return
    const lines = [{ x: gauge.times, y: gauge.thickness, colour: '#d1495b' }, { x: gauge.times, y: gauge.speed, colour: '#2b86cc' }]
    chart(series, lines, { xLabel: 'time [s]', yLabel: `at ${gauge.at.join(', ')}: thickness [m] (red), speed [m/s] (blue)` })
    series.setAttribute('aria-label', `At ${gauge.at.join(', ')}: thickness ${fixed(gauge.thickness.at(-1))} m, speed ${fixed(gauge.speed.at(-1))} m/s after ${fixed(run?.time)} s`)
  }
  function say(words, most, unit) {
    clock.classList.remove('rest')
    if (!run) {
      clock.textContent = site.release || !error.hidden ? '' : 'Draw a release, or drop one as GeoJSON or a shapefile.'
      return
    }
    const rests = run.stop_reason === 'at_rest' || run.stop_reason === 'trickle'
    const end = rests ? `It is ${run.in_words}: in every cell the momentum is exactly 0${run.stop_reason === 'trickle' ? ', but for a trickle' : ''}.` : `Ended: ${run.in_words}.`
    clock.textContent = `${fixed(run.time)} s, ${run.steps} steps; ${fixed(run.mass, 0)} m³, greatest speed now ${fixed(run.max_speed)} m/s, `
      + `relative error of the mass ${(run.mass_error || 0).toExponential(1)}. ${run.in_words ? end : ''}`
    clock.classList.toggle('rest', rests)
    relief.canvas.setAttribute('aria-label', `Relief of ${run.about.cells.join(' × ')} cells with ${words.toLowerCase()} up to ${fixed(most)} ${unit}. ${clock.textContent}`)
  }

  // A release is drawn by clicks on the relief, or its corners are written: x and y of each, a line each.
  const corners = make('textarea', { rows: 4, 'aria-label': 'Corners of the release, x and y of one on each line', oninput: () => { drawing = written(corners.value); draw() } })
  const done = button('Use this release', () => finish(), { class: 'main' })
  const tools = make('div', { class: 'drawing', hidden: true },
    make('label', {}, 'Click the corners on the relief, or write x and y of each on a line of its own:', corners),
    make('div', { class: 'row' }, done, button('Cancel', cancel)))
  const draws = button('Draw a release', start)
  const written = words => words.split('\n').map(line => line.trim().split(/[\s,;]+/).map(Number)).filter(pair => pair.length === 2 && pair.every(Number.isFinite))
  async function start() {
    await player.stop()
    drawing = []
    corners.value = ''
    tools.hidden = false
    corners.focus({ preventScroll: true })
    draw()
  }
  function cancel() {
    drawing = null
    tools.hidden = true
    complain(error)
    draws.focus()
    draw()
  }
  const finish = serial(async () => {
    if (drawing.length < 3) return complain(error, { message: `a release needs three corners or more, ${drawing.length} are set`, help: ['click more corners on the mountain'] })
    const ring = drawing
    drawing = null
    tools.hidden = true
    await site.drawn(ring)
    await reset()
  })
  tools.addEventListener('keydown', event => { if (event.key === 'Escape') cancel() })

  // A press that does not turn the view chooses a place: a corner while a release is drawn, else that of the gauge.
  function listen() {
    let pressed = null
    view.addEventListener('pointerdown', event => { pressed = [event.clientX, event.clientY] }, true)
    view.addEventListener('pointerup', event => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return
      const point = relief?.under(event)
      if (point) choose(placeOf(point))
    }, true)
  }
  const where = make('input', { size: 16, placeholder: 'x y', 'aria-label': 'Place of the time series, x and y', onchange: () => { for (const at of written(where.value)) choose(at) } })
  function choose(at) {
    if (drawing) {
      drawing.push(at)
      corners.value += `${at.join(' ')}\n`
    } else if (run) {
      const { cells: [columns, rows], origin, size } = run.about
      const [i, j] = [0, 1].map(k => Math.floor((at[k] - origin[k]) / size[k]))
      if (i < 0 || j < 0 || i >= columns || j >= rows) return
      where.value = at.join(' ')
      gauge = { at, cell: j * columns + i, times: [], thickness: [], speed: [] }
      series.hidden = false
      look().catch(reason => complain(error, reason))
    }
    draw()
  }
  // Asks for what is shown now, where no step brings it.
  async function look() {
    if (!run || player.busy) return
    Object.assign(run, await client.call('watch', run.handle, { steps: 0 }, watched()))
    note()
    draw()
  }

  const take = serial(async list => {
    if (!list.length) return
    try {
      complain(error)
      await player.stop()
      const { ground, undo } = await site.take(list)
      if (ground) {
        await close()
        chosen.mountain = site.mountain = 'given'
        given()
        showGround(ground)
      }
      await begin()
      if (run || !site.release || ground) return
      // The release before it stays where the new one cannot be had.
      const said = [...error.childNodes]
      await undo()
      await begin()
      error.replaceChildren(...said)
      error.hidden = false
    } catch (reason) {
      complain(error, reason)
    }
  })
  // The choice of mountains names the given one.
  function given() {
    const option = mountains.select.querySelector('[value=given]') ?? mountains.select.appendChild(make('option', { value: 'given' }))
    option.textContent = `yours: ${site.dem}`
    mountains.select.value = 'given'
  }

  function offerParameters() {
    parameters[chosen.law] ??= Object.fromEntries(LAWS[chosen.law].parameters.map(([key, , , , , , value]) => [key, value]))
    sliders.replaceChildren(
      ...LAWS[chosen.law].parameters.map(([key, words, unit, least, most, step]) =>
        slider(words, unit, [least, most, step, parameters[chosen.law][key]], value => { parameters[chosen.law][key] = value; settle() })),
      slider('release thickness', 'm', [0.1, 5, 0.1, chosen.thickness], value => { chosen.thickness = value; settle() }),
      slider('exaggeration', '×', [1, 3, 0.1, relief?.exaggeration ?? 1], value => relief?.exaggerate(value)))
  }
  // A slider that moved takes effect when it rests.
  let settling = 0
  const settle = () => {
    clearTimeout(settling)
    settling = setTimeout(reset, 250)
  }
  const sets = (key, of = value => value) => value => {
    chosen[key] = of(value)
    reset()
  }

  // Everything that the program needs to repeat the run, and the maps of it as they are.
  async function archive() {
    const files = [['case.toml', new TextEncoder().encode(text())], ...await site.files()]
    for (const name of run ? Object.keys(SHOWN) : []) files.push([`${name}.tif`, await client.call('geotiff', run.handle, name)])
    download('granflow.zip', await zip(files))
  }
  const saves = (words, work) => button(words, () => work()?.catch?.(reason => complain(error, reason)))

  const picker = make('input', { type: 'file', multiple: true, 'aria-label': 'Elevation model and release', onchange: () => take([...picker.files]).then(() => { picker.value = '' }) })
  const drop = make('label', { class: 'drop' }, 'Your own mountain: drop a GeoTIFF or ASCII grid, and a release as GeoJSON or zipped shapefile, anywhere on this tab, or ', picker)
  place.addEventListener('dragover', event => { event.preventDefault(); drop.classList.add('over') })
  place.addEventListener('dragleave', () => drop.classList.remove('over'))
  place.addEventListener('drop', event => {
    event.preventDefault()
    drop.classList.remove('over')
    take([...event.dataTransfer.files])
  })

  const mountains = choice('Mountain', titles(MOUNTAINS), chosen.mountain, value => {
    if (value === 'given') return
    mountains.select.querySelector('[value=given]')?.remove()
    chosen.mountain = value
    reset()
  })
  place.append(
    make('div', { class: 'row' },
      mountains,
      choice('Friction', titles(LAWS), chosen.law, value => {
        chosen.law = value
        offerParameters()
        reset()
      }),
      choice('Scheme', { energy_stable_2: 'energy_stable_2', energy_stable: 'energy_stable (first order, faster)' }, chosen.scheme, sets('scheme')),
      choice('Cells', { 0: 'as given', 10: '10 m', 20: '20 m', 50: '50 m' }, '0', sets('cell', Number))),
    sliders,
    make('div', { class: 'row' }, play, step, button('Reset', reset), draws,
      choice('Speed', { 1: 'as it happens', 5: '5 times', 10: '10 times', 40: '40 times', Infinity: 'as fast as it goes' }, '10', value => { chosen.pace = +value }),
      choice('Shown', Object.fromEntries(Object.entries(SHOWN).map(([key, [words]]) => [key, words])), chosen.shown, value => {
        chosen.shown = value
        look().catch(reason => complain(error, reason))
      })),
    error, tools, view, legend, clock,
    make('p', { class: 'hint' }, 'Drag to turn, scroll or pinch to come closer. Click a place, or write it here, to see thickness and speed there from then on: ', where),
    series, notes, drop,
    make('div', { class: 'row' },
      saves('case.toml', () => download('case.toml', text())),
      saves('All as a zip: case, files, maps', archive),
      saves('GeoTIFF of what is shown', async () => run && download(`${chosen.shown}.tif`, await client.call('geotiff', run.handle, chosen.shown), 'image/tiff')),
      saves('PNG of the view', async () => relief && download('mountain.png', await relief.png()))))
  listen()
  offerParameters()
  return { reset, player, take, idle: () => reset.waiting + take.waiting + finish.waiting === 0, redraw: draw, open: () => relief || reset(), run: () => run, site: () => site, relief: () => relief, text }
}

const megabytes = bytes => `${fixed(bytes / 1e6, 1)} MB`
