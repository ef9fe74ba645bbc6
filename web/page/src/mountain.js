// A mountain slides: built-in or dropped, with a release from a file or drawn, to its rest.
import { LAWS, mountain as caseOf } from './cases.js'
import { chart } from './chart.js'
import { gradient } from './colours.js'
import { button, choice, complain, download, fixed, make, slider } from './dom.js'
import { isElevation, isRelease, read, rings } from './drop.js'
import { MOUNTAINS, files, polygon } from './mountains.js'
import { Player, serial } from './player.js'
import { Relief } from './relief.js'

// What can be laid over the relief: field, words, unit, colours.
const SHOWN = {
  thickness: ['Thickness', 'm', 'heat'], speed: ['Speed', 'm/s', 'blue'], peak_thickness: ['Greatest thickness so far', 'm', 'heat'],
  peak_speed: ['Greatest speed so far', 'm/s', 'blue'], deposit: ['Deposit', 'm', 'heat'],
}
const MAPS = ['peak_thickness', 'peak_speed', 'deposit']
const LEAST = { thickness: 0.01, peak_thickness: 0.01, deposit: 0.01, speed: 0.1, peak_speed: 0.1 }

export function mountain(client, place) {
  const chosen = { mountain: 'gully', law: 'coulomb', thickness: 1, scheme: 'energy_stable_2', end: 400, shown: 'thickness', cell: 0, pace: 10 }
  const parameters = {}
  let given = null // a dropped elevation model: { name, raster }
  let release = null // { name, ring lines in coordinates }
  let drawing = null // vertices of a release under way, in cells
  let run = null
  let field = null
  let gauge = null // { cell: [i, j], times, thickness, speed }

  const error = make('div', { class: 'error', role: 'alert', hidden: true })
  const view = make('div', { class: 'relief' })
  const clock = make('p', { class: 'clock', 'aria-live': 'polite' })
  const notes = make('ul', { class: 'notes' })
  const series = make('canvas', { class: 'chart', role: 'img', 'aria-label': 'No place was chosen yet' })
  const legend = make('div', { class: 'legend' })
  const sliders = make('div', { class: 'row' })
  let relief = null

  const player = new Player({
    ask: async limits => {
      const state = await client.call('advance', run.handle, limits, names())
      Object.assign(run, state)
      combine(state.fields)
      return state.ended
    },
    show: draw,
    changed: () => {
      play.textContent = player.playing ? 'Pause' : 'Run'
      play.disabled = player.ended || !run
      step.disabled = play.disabled || player.playing
    },
    failed: reason => complain(error, reason),
    pace: () => chosen.pace,
    time: () => run.time,
  })
  const play = button('Run', () => (player.playing ? player.pause() : player.play()), { class: 'main' })
  const step = button('One step', () => player.step())
  const draws = button('Draw a release', toggleDrawing, { 'aria-pressed': 'false' })

  // The fields to ask for, and from them the one that is shown.
  const names = () => ['thickness', 'speed', ...(MAPS.includes(chosen.shown) ? [chosen.shown] : [])]
  function combine(fields) {
    field = fields[chosen.shown]
    if (!gauge) return
    const k = gauge.cell[1] * run.about.cells[0] + gauge.cell[0]
    if (gauge.times.at(-1) === run.time) return
    gauge.times.push(run.time)
    gauge.thickness.push(fields.thickness[k])
    gauge.speed.push(fields.speed[k])
  }

  function text() {
    const title = given ? `An avalanche on ${given.name}` : MOUNTAINS[chosen.mountain].title
    return caseOf({
      title, dem: given?.name ?? 'mountain.asc', cell: chosen.cell, release: release?.name ?? 'release.geojson', thickness: chosen.thickness,
      law: chosen.law, parameters: parameters[chosen.law], density: 200, scheme: chosen.scheme, end: chosen.end,
      curvature: Math.max(20, 3 * (chosen.cell || given?.cell || 0)), // over a few cells
    })
  }

  // Puts the built-in mountain and its release among the files.
  async function builtIn() {
    given = null
    const made = files(chosen.mountain)
    await client.call('put', 'mountain.asc', new TextEncoder().encode(made.dem))
    await putRelease('release.geojson', new TextEncoder().encode(made.release))
    const { values, ...where } = await client.call('raster', 'mountain.asc')
    showGround(where, values)
  }
  async function putRelease(name, bytes) {
    release = { name, rings: rings(name, bytes) }
    await client.call('put', name, bytes)
  }
  function showGround(where, values) {
    relief ??= new Relief(view)
    relief.show({ ...where, z: values })
    Object.assign(relief, { west: where.west, south: where.south })
  }

  async function begin() {
    await player.stop()
    complain(error)
    if (run) await client.call('close', run.handle)
    run = null
    gauge = null
    field = null
    try {
      if (!relief || (!given && !relief.named?.startsWith(chosen.mountain))) {
        await builtIn()
        relief.named = chosen.mountain
      }
      if (release) {
        run = await client.call('open', text())
        await showCells()
        const state = await client.call('advance', run.handle, { steps: 0 }, names())
        Object.assign(run, state)
        combine(state.fields)
      }
    } catch (reason) {
      run = null
      complain(error, reason)
    }
    notes.replaceChildren(...(run?.about.remarks ?? []).map(remark => make('li', {}, remark)))
    player.changed()
    draw()
  }

  const reset = serial(begin)

  // Shows the cells of the run, where the case resamples the elevation.
  async function showCells() {
    const { cells: [columns, rows], origin: [west, south], size: [cell] } = run.about
    if (columns === relief.columns && rows === relief.rows) return
    showGround({ columns, rows, west, south, cell }, await client.call('field', run.handle, 'bed'))
  }

  // Where a coordinate lies, in cells.
  const cellOf = ([x, y]) => [(x - relief.west) / relief.cell, (y - relief.south) / relief.cell]

  function draw() {
    if (!relief) return
    const [words, unit, scale] = SHOWN[chosen.shown]
    const least = LEAST[chosen.shown]
    const most = field ? field.reduce((most, value) => (value > most ? value : most), 5 * least) : 1
    const fits = field && field.length === relief.columns * relief.rows
    const lines = drawing ? [drawing.length > 1 ? [...drawing, drawing[0]] : drawing.concat(drawing)] : (release?.rings ?? []).map(ring => ring.map(cellOf))
    relief.colour(fits ? field : null, { scale, most, least }, lines)
    legend.style.setProperty('--scale', gradient(scale))
    legend.textContent = `${words}: 0 to ${fixed(most)} ${unit}`
    said(words, most, unit)
    if (gauge) {
      const lines = [{ x: gauge.times, y: gauge.thickness, colour: '#d1495b' }, { x: gauge.times, y: gauge.speed, colour: '#0b6fb8' }]
      chart(series, lines, { xLabel: 'time [s]', yLabel: 'thickness [m] (red), speed [m/s] (blue)' })
      series.setAttribute('aria-label', `At column ${gauge.cell[0]}, row ${gauge.cell[1]}: thickness ${fixed(gauge.thickness.at(-1))} m after ${fixed(run?.time)} s`)
    }
  }
  function said(words, most, unit) {
    if (!run) {
      clock.textContent = release ? '' : 'Draw a release, or drop one as GeoJSON or a shapefile.'
      return
    }
    const rests = run.stop_reason === 'at_rest' || run.stop_reason === 'trickle'
    clock.textContent = `${fixed(run.time)} s, ${run.steps} steps; ${fixed(run.mass, 0)} m³, greatest speed now ${fixed(run.max_speed)} m/s, `
      + `relative error of the mass ${(run.mass_error || 0).toExponential(1)}`
      + (run.in_words ? `. ${rests ? `It is ${run.in_words}: in every cell the momentum is exactly 0${run.stop_reason === 'trickle' ? ', but for a trickle' : ''}.` : `Ended: ${run.in_words}.`}` : '.')
    clock.classList.toggle('rest', rests)
    relief.canvas.setAttribute('aria-label', `Relief of ${relief.columns} × ${relief.rows} cells with ${words.toLowerCase()} up to ${fixed(most)} ${unit}. ${clock.textContent}`)
  }

  // A press that does not turn the view chooses a place: of a gauge, or of a vertex while a release is drawn.
  function listen() {
    let pressed = null
    view.addEventListener('pointerdown', event => { pressed = [event.clientX, event.clientY] }, true)
    view.addEventListener('pointerup', event => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return
      const at = relief?.under(event)
      if (!at) return
      if (drawing) drawing.push(at)
      else if (run) {
        gauge = { cell: at.map(Math.floor), times: [], thickness: [], speed: [] }
        client.call('advance', run.handle, { steps: 0 }, names()).then(state => { combine(state.fields); draw() })
      }
      draw()
    }, true)
  }
  async function toggleDrawing() {
    if (drawing) {
      const ring = drawing
      drawing = null
      draws.textContent = 'Draw a release'
      draws.setAttribute('aria-pressed', 'false')
      if (ring.length < 3) return complain(error, { message: `a release needs at least three corners, ${ring.length} were set`, help: ['press Draw a release, click the corners on the mountain, press it again'] })
      const corners = [...ring, ring[0]].map(([i, j]) => [+(relief.west + i * relief.cell).toFixed(2), +(relief.south + j * relief.cell).toFixed(2)])
      await putRelease('release.geojson', new TextEncoder().encode(polygon(corners)))
      return reset()
    }
    await player.stop()
    drawing = []
    draws.textContent = 'Done: use this release'
    draws.setAttribute('aria-pressed', 'true')
    draw()
  }

  const take = serial(async list => {
    try {
      complain(error)
      await player.stop()
      const all = await read(list)
      for (const [name, bytes] of all) await client.call('put', name, bytes)
      const dem = all.find(([name]) => isElevation(name))
      const outline = all.find(([name]) => isRelease(name))
      if (!dem && !outline) throw { message: `${all.map(([name]) => name).join(', ')}: no elevation model and no release`, help: ['drop a GeoTIFF or an ESRI ASCII grid, and polygons as GeoJSON or a shapefile (a zip of .shp, .dbf and .prj)'] }
      if (dem) {
        const { values, ...where } = await client.call('raster', dem[0])
        given = { name: dem[0], cell: where.cell }
        release = null
        if (run) await client.call('close', run.handle)
        run = field = gauge = null
        showGround(where, values)
      }
      if (outline) release = { name: outline[0], rings: rings(...outline) }
      await begin()
    } catch (reason) {
      complain(error, reason)
    }
  })

  function offerParameters() {
    parameters[chosen.law] ??= Object.fromEntries(LAWS[chosen.law].parameters.map(([key, , , , , , value]) => [key, value]))
    sliders.replaceChildren(
      ...LAWS[chosen.law].parameters.map(([key, words, unit, least, most, step]) =>
        slider(words, unit, [least, most, step, parameters[chosen.law][key]], value => { parameters[chosen.law][key] = value; settle() })),
      slider('release thickness', 'm', [0.1, 5, 0.1, chosen.thickness], value => { chosen.thickness = value; settle() }),
      slider('exaggeration', '×', [1, 3, 0.1, 1], value => relief?.exaggerate(value)))
  }
  // A slider that moved takes effect when it rests.
  const settle = () => {
    clearTimeout(settle.timer)
    settle.timer = setTimeout(reset, 250)
  }

  const picker = make('input', { type: 'file', multiple: true, 'aria-label': 'Elevation model and release', onchange: () => take(picker.files) })
  const drop = make('label', { class: 'drop' }, 'Your own mountain: drop a GeoTIFF or ASCII grid, and a release as GeoJSON or zipped shapefile, here or ', picker)
  place.addEventListener('dragover', event => { event.preventDefault(); drop.classList.add('over') })
  place.addEventListener('dragleave', () => drop.classList.remove('over'))
  place.addEventListener('drop', event => {
    event.preventDefault()
    drop.classList.remove('over')
    take(event.dataTransfer.files)
  })
  async function saveMap() {
    if (run) download(`${chosen.shown}.tif`, await client.call('geotiff', run.handle, chosen.shown), 'image/tiff')
  }
  async function shownNow(value) {
    chosen.shown = value
    if (run && !player.busy) combine((await client.call('advance', run.handle, { steps: 0 }, names())).fields)
    draw()
  }

  place.append(
    make('div', { class: 'row' },
      choice('Mountain', Object.fromEntries(Object.entries(MOUNTAINS).map(([key, { title }]) => [key, title])), chosen.mountain, value => {
        chosen.mountain = value
        given = null
        if (relief) relief.named = ''
        reset()
      }),
      choice('Friction', Object.fromEntries(Object.entries(LAWS).map(([key, { title }]) => [key, title])), chosen.law, value => {
        chosen.law = value
        offerParameters()
        reset()
      }),
      choice('Scheme', { energy_stable_2: 'energy_stable_2', energy_stable: 'energy_stable (first order, faster)' }, chosen.scheme, value => {
        chosen.scheme = value
        reset()
      }),
      choice('Cells', { 0: 'as given', 10: '10 m', 20: '20 m' }, '0', value => {
        chosen.cell = +value
        reset()
      })),
    sliders,
    make('div', { class: 'row' }, play, step, button('Reset', reset), draws,
      choice('Speed', { 1: 'as it happens', 5: '5 times', 10: '10 times', 40: '40 times', Infinity: 'as fast as it goes' }, '10', value => { chosen.pace = +value }),
      choice('Shown', Object.fromEntries(Object.entries(SHOWN).map(([key, [words]]) => [key, words])), chosen.shown, shownNow)),
    error, view, legend, clock,
    make('p', { class: 'hint' }, 'Drag to turn, scroll or pinch to come closer; click a place to see thickness and speed there over time.'),
    series, notes, drop,
    make('div', { class: 'row' },
      button('case.toml', () => download('case.toml', text())),
      button('GeoTIFF of what is shown', () => saveMap().catch(reason => complain(error, reason))),
      button('PNG of the view', () => relief?.canvas.toBlob(blob => download('mountain.png', blob))),
      button('Files of the mountain', () => {
        const made = files(chosen.mountain)
        download('mountain.asc', made.dem)
        download('release.geojson', made.release)
      })))
  listen()
  offerParameters()
  return { reset, player, take, idle: () => reset.waiting + take.waiting === 0, redraw: draw, open: () => relief || reset(), run: () => run, relief: () => relief, text }
}
