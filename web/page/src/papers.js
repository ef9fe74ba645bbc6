// Published examples in one dimension: schemes side by side, the exact solution over them, and what each keeps or breaks.
import constant from '../../../cases/constant.toml'
import inclined from '../../../cases/inclined_silo.toml'
import parabola from '../../../cases/parabola.toml'
import riemann from '../../../cases/riemann.toml'
import roof from '../../../cases/sandpile_1d.toml'
import silo from '../../../cases/silo.toml'
import sine from '../../../cases/sine.toml'
import { chart } from './chart.js'
import { button, choice, complain, fixed, make } from './dom.js'
import { Player, serial } from './player.js'
import { LANGUAGES, TEXTS } from './texts.js'

const FLOW = {
  energy_stable: 'energy_stable', balanced: 'balanced', verfahren_5: 'Verfahren 5', verfahren_4: 'Verfahren 4',
  verfahren_3: 'Verfahren 3', verfahren_2: 'Verfahren 2', verfahren_1: 'Verfahren 1',
}
const PILES = { adaptive: 'adaptive', first_order: 'first order', second_order: 'second order' }

// Titles stand in texts.js by the same keys.
const EXAMPLES = {
  silo: { text: silo }, inclined: { text: inclined }, parabola: { text: parabola }, riemann: { text: riemann, exact: [0.4, 1, 0.5] },
  sine: { text: sine }, constant: { text: constant }, roof: { text: roof, pile: true },
}

// What can be followed over time.
const FOLLOWED = {
  variation: run => variation(Array.from(run.values[0])),
  mass: run => run.mass,
  speed: run => run.max_speed ?? NaN,
}

const fields = example => (example.pile ? ['standing_layer', 'rolling_layer'] : ['thickness', 'velocity_x'])
// The last time of a case text, in its own units.
const end = text => {
  const [steps, step, time] = [/^steps = (\d+)/m, /^step = ([\d.]+)/m, /^end = ([\d.]+)/m].map(pattern => +(text.match(pattern)?.[1] ?? NaN))
  return Number.isFinite(time) ? time : steps * step
}
const variation = values => values.reduce((sum, value, k) => (k ? sum + Math.abs(value - values[k - 1]) : 0), 0)

export function papers(client, place) {
  const colours = ['#0b6fb8', '#d1495b', '#2f8f4e']
  const chosen = { example: 'silo', schemes: ['verfahren_5', 'energy_stable', ''], followed: 'variation', language: navigator.language.startsWith('de') ? 'de' : 'en' }
  const said = key => TEXTS[chosen.language][key]
  let runs = []
  const error = make('div', { class: 'error', role: 'alert', hidden: true })
  const upper = make('canvas', { class: 'chart', role: 'img' })
  const lower = make('canvas', { class: 'chart', role: 'img' })
  const followed = make('canvas', { class: 'chart', role: 'img' })
  const table = make('table', {})
  const clock = make('p', { class: 'clock', 'aria-live': 'off' })
  const schemes = make('div', { class: 'row' })
  const controls = make('div', { class: 'row' })

  const player = new Player({
    ask: async ({ milliseconds, steps }) => {
      const example = EXAMPLES[chosen.example]
      const going = runs.filter(run => !run.ended)
      if (steps) await Promise.all(going.map(run => advanced(run, { steps })))
      else {
        // All go to one time, a hundred and fiftieth of the whole at most, and no farther than the slowest can.
        const time = Math.min(...going.map(run => run.time)) + end(example.text) / (example.pile ? 2000 : 150)
        await Promise.all(going.map(run => advanced(run, { time, milliseconds: 4 * milliseconds })))
      }
      return runs.every(run => run.ended)
    },
    show,
    changed: () => {
      play.textContent = said(player.playing ? 'pause' : 'run')
      play.disabled = player.ended || !runs.length
      step.disabled = play.disabled || player.playing
    },
    failed: reason => complain(error, reason),
  })
  const play = button(said('run'), () => (player.playing ? player.pause() : player.play()), { class: 'main' })
  const step = button(said('step'), () => player.step())

  // Steps one run; one that fails stays as it was and says why.
  async function advanced(run, limits) {
    try {
      const { fields: kept, ...state } = await client.call('advance', run.handle, limits, run.names)
      Object.assign(run, state, { values: run.names.map(name => kept[name]) })
      note(run)
    } catch (reason) {
      run.failed = reason.message
      run.ended = true
    }
  }

  // What is followed over time; every second entry goes when there are many.
  function note(run) {
    if (run.history.at(-1)?.time === run.time) run.history.pop()
    run.history.push({ time: run.time, ...Object.fromEntries(Object.entries(FOLLOWED).map(([key, of]) => [key, of(run)])) })
    if (run.history.length > 600) run.history = run.history.filter((_, k) => k % 2 === 0)
  }

  const reset = serial(async () => {
    await player.stop()
    await Promise.all(runs.map(run => client.call('close', run.handle)))
    runs = []
    complain(error)
    const example = EXAMPLES[chosen.example]
    try {
      for (const [k, scheme] of chosen.schemes.entries()) {
        if (!scheme || chosen.schemes.indexOf(scheme) < k) continue
        const overrides = [`scheme.name=${scheme}`]
        const { handle, about } = await client.call('open', example.text, overrides)
        const run = { handle, about, scheme, colour: colours[k], names: fields(example), time: 0, history: [] }
        run.x = Array.from({ length: about.cells[0] }, (_, i) => about.origin[0] + (i + 0.5) * about.size[0])
        run.nodes = Array.from({ length: about.cells[0] + 1 }, (_, i) => about.origin[0] + i * about.size[0])
        await advanced(run, { steps: 0 })
        run.first = { mass: run.mass, variation: variation(Array.from(run.values[0])) }
        runs.push(run)
      }
      await exact()
    } catch (reason) {
      complain(error, reason)
    }
    player.changed()
    show()
  })

  // The exact solution at the time of the first run.
  let solution
  let asking = false
  async function exact() {
    const example = EXAMPLES[chosen.example]
    solution = null
    if (example.exact && runs.length && runs[0].time > 0) {
      solution = [await client.call('exactDamBreak', runs[0].handle, ...example.exact)]
    }
    if (example.pile) {
      const { handle } = await client.call('open', example.text, ['time.method="direct"'])
      solution = [await client.call('field', handle, 'standing_layer'), await client.call('field', handle, 'rolling_layer')]
      await client.call('close', handle)
    }
  }

  function show() {
    if (!runs.length) return
    const example = EXAMPLES[chosen.example]
    if (example.exact && !asking) {
      asking = true
      exact().catch(() => {}).finally(() => { asking = false; draw() })
    }
    draw()
  }

  function draw() {
    if (!runs.length) return
    const example = EXAMPLES[chosen.example]
    const x = (run, k) => (run.values[k].length > run.x.length ? run.nodes : run.x)
    for (const [k, canvas] of [upper, lower].entries()) {
      /** @type {Parameters<typeof chart>[1]} */
      const lines = runs.filter(run => run.values).map(run => ({ x: x(run, k), y: run.values[k], colour: run.colour }))
      if (solution?.[k] && runs[0]) lines.unshift({ x: x(runs[0], k), y: solution[k], dashed: true, width: 1.5 })
      const words = said(runs[0].names[k])
      chart(canvas, lines, { yLabel: words, xLabel: k ? 'x' : '' })
      canvas.setAttribute('aria-label', `${words} (x), ${said('time')} ${fixed(runs[0].time)}: ${runs.map(run => run.scheme).join(', ')}`)
    }
    const lines = runs.map(({ history, colour }) => ({ x: history.map(({ time }) => time), y: history.map(entry => entry[chosen.followed]), colour }))
    chart(followed, lines, { xLabel: said('time'), yLabel: said(chosen.followed) })
    followed.setAttribute('aria-label', `${said(chosen.followed)}, ${said('over')}: ${runs.map(run => `${run.scheme} ${fixed(run.history.at(-1)?.[chosen.followed], 4)}`).join(', ')}`)
    clock.textContent = `${said('time')} ${fixed(Math.min(...runs.map(run => run.time)), 3)}${solution ? `; ${said('exact')}` : ''}`
    table.replaceChildren(
      make('thead', {}, row('th', said('columns'))),
      make('tbody', {}, ...runs.map(run => row('td', numbers(run), run.colour))))
  }

  const row = (tag, cells, colour) => make('tr', {}, ...cells.map((cell, k) => make(tag, {}, !k && colour ? make('span', { class: 'swatch', style: `background: ${colour}` }) : '', cell)))
  function numbers(run) {
    const lost = (run.mass - run.first.mass - run.mass_in + run.mass_out) / (run.first.mass || run.mass_in || 1)
    const least = run.values[0].reduce((least, value) => Math.min(least, value), Infinity)
    const ended = run.in_words && (said(run.stop_reason === 'steps' ? 'all_steps' : run.stop_reason) ?? run.in_words)
    const state = run.failed ? `${said('failed')}: ${run.failed}`
      : [ended ?? said('runs'), least < 0 ? `${said('negative')} ${least.toExponential(1)}` : ''].filter(Boolean).join('; ')
    return [
      run.scheme, fixed(run.time, 3), String(run.steps), fixed(run.mass, 5), `${(100 * lost).toPrecision(3)} %`,
      fixed(variation(Array.from(run.values[0])), 3), run.max_speed == null ? '–' : run.max_speed.toPrecision(3), state,
    ]
  }

  const scheme = (names, k) => choice(`${said('scheme')} ${k + 1}`, { ...(k ? { '': said('none') } : {}), ...names }, chosen.schemes[k], value => {
    chosen.schemes[k] = value
    reset()
  })
  const over = make('div', { class: 'row' })
  // Everything that one chooses or presses, in the language that is chosen.
  function offered() {
    const names = EXAMPLES[chosen.example].pile ? PILES : FLOW
    if (!chosen.schemes.some(scheme => scheme in names)) chosen.schemes = Object.keys(names).slice(0, 2).concat('')
    place.lang = chosen.language
    step.textContent = said('step')
    controls.replaceChildren(
      choice(said('example'), Object.fromEntries(Object.keys(EXAMPLES).map(key => [key, said(key)])), chosen.example, value => {
        chosen.example = value
        offered()
        reset()
      }),
      play, step, button(said('reset'), reset),
      choice(said('language'), LANGUAGES, chosen.language, value => {
        chosen.language = value
        offered()
        draw()
        controls.querySelector('label:last-child select').focus()
      }))
    schemes.replaceChildren(...[0, 1, 2].map(k => scheme(names, k)))
    over.replaceChildren(choice(said('over'), Object.fromEntries(Object.keys(FOLLOWED).map(key => [key, said(key)])), chosen.followed, value => {
      chosen.followed = value
      draw()
    }))
    wide.setAttribute('aria-label', said('region'))
    player.changed()
  }

  const wide = make('div', { class: 'wide', tabindex: 0, role: 'region' }, table)
  place.append(controls, schemes, error, upper, lower, clock, wide, over, followed)
  offered()
  return { reset, player, idle: () => reset.waiting === 0, redraw: draw, open: () => runs.length || reset(), runs: () => runs }
}
