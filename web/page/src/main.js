// The page: its tabs, light and dark, and what tests ask of it.
import wasm from '../../target/engine.wasm.gz'
import worker from 'worker-script'
import { Client, unpacked } from './client.js'
import { complain } from './dom.js'
import { mountain } from './mountain.js'
import { papers } from './papers.js'
import { sand } from './sand.js'

const client = new Client(worker)
const started = unpacked(wasm).then(bytes => client.call('start', bytes))
const tabs = {}

const buttons = () => /** @type {HTMLElement[]} */ ([...document.querySelectorAll('[role=tab]')])

async function show(name) {
  for (const tab of buttons()) {
    const here = tab.dataset.tab === name
    tab.setAttribute('aria-selected', String(here))
    tab.tabIndex = here ? 0 : -1
    document.getElementById(tab.dataset.tab).hidden = !here
    if (!here) tabs[tab.dataset.tab]?.player.pause()
  }
  await started
  await tabs[name].open()
  tabs[name].redraw()
}

function listen() {
  const all = buttons()
  for (const [k, tab] of all.entries()) {
    tab.addEventListener('click', () => show(tab.dataset.tab))
    tab.addEventListener('keydown', event => {
      const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key]
      if (!way) return
      const next = all[(k + way + all.length) % all.length]
      next.focus()
      next.click()
    })
  }
  const theme = document.getElementById('theme')
  theme.addEventListener('click', () => {
    const dark = getComputedStyle(document.documentElement).getPropertyValue('--dark').trim() === '1'
    document.documentElement.dataset.theme = dark ? 'light' : 'dark'
    for (const tab of Object.values(tabs)) tab.redraw()
  })
  addEventListener('resize', () => Object.values(tabs).forEach(tab => tab.redraw()))
}

const place = name => document.querySelector(`#${name} .content`)
Object.assign(tabs, { papers: papers(client, place('papers')), sand: sand(client, place('sand')), mountain: mountain(client, place('mountain')) })
listen()

window.granflow = {
  ready: false,
  // A case to its end: its summary and the checksums of all fields and maps.
  run: (text, overrides) => started.then(() => client.call('run', text, overrides)),
  // Puts a file where a case finds it.
  put: (name, bytes) => started.then(() => client.call('put', name, bytes)),
  // The same of texts [name, text], one of which is case.toml.
  runFiles: async files => {
    for (const [name, text] of files) await window.granflow.put(name, new TextEncoder().encode(text))
    return window.granflow.run(files.find(([name]) => name === 'case.toml')[1])
  },
  // The same of the run that stands in a tab.
  checksums: name => client.call('checksums', tabs[name].run().handle),
  memory: () => client.call('memory'),
  tabs, show,
}

show('mountain').then(() => { window.granflow.ready = true }, error => {
  complain(document.getElementById('failed'), { message: `the engine did not start: ${error.message}`, help: ['a browser of 2023 or newer is needed: Firefox 113, Chrome 111, Safari 16.4'] })
})
