// The engine in node against the program: every field and map of every case to the bit, and the time that both take.
//   node test/node.mjs ENGINE.wasm PROGRAM GRANFLOW: the example `checksums` of granflow, which prints those of a case file, and the program
import { execFileSync } from 'node:child_process'
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { Engine, Refused } from '../src/engine.js'
import { files } from '../src/mountains.js'
import { CASES } from './cases.mjs'

const [wasm, program, granflow] = process.argv.slice(2)
const bytes = readFileSync(wasm)
let failed = 0
const check = (holds, words) => {
  if (!holds) failed++
  console.log(`${holds ? 'ok  ' : 'FAIL'}  ${words}`)
}

// What the program prints of a case: lines of a name and a value.
function native(text, files) {
  const folder = mkdtempSync(join(tmpdir(), 'granflow-'))
  try {
    for (const [name, content] of Object.entries(files)) writeFileSync(join(folder, name), content)
    writeFileSync(join(folder, 'case.toml'), text)
    const begun = performance.now()
    const said = execFileSync(program, ['case.toml'], { cwd: folder, env: { ...process.env, RAYON_NUM_THREADS: '1' }, stdio: ['ignore', 'pipe', 'ignore'] })
    const lines = said.toString().trim().split('\n').map(line => line.split(' '))
    return { ...Object.fromEntries(lines), seconds: (performance.now() - begun) / 1e3 }
  } finally {
    rmSync(folder, { recursive: true })
  }
}

const engine = await Engine.of(bytes)
for (const [name, text, needed] of CASES) {
  for (const [file, content] of Object.entries(needed)) engine.put(file, new TextEncoder().encode(content))
  const { summary, checksums } = engine.run(text)
  const expected = native(text, needed)
  const differ = Object.keys(checksums).filter(field => checksums[field] !== expected[field])
  const same = differ.length === 0 && Object.keys(checksums).length > 1 && String(summary.steps) === expected.steps
  check(same, `${name}: ${summary.in_words} after ${summary.steps} steps, ${Object.keys(checksums).length} checksums`
    + (same ? '' : `; other: ${differ.join(', ') || `steps ${expected.steps}`}`)
    + `; here ${summary.wall_seconds.toFixed(2)} s of steps, the program on one thread ${expected.seconds.toFixed(2)} s in all`)
}

// What is wrong is refused with its place and cure, and the engine goes on.
const refused = (text, pattern, words) => {
  try {
    engine.open(text)
    check(false, `${words}: not refused`)
  } catch (error) {
    check(error instanceof Refused && pattern.test([error.message, error.key, ...error.help].join(' ')), `${words}: ${error.message}`)
  }
}
const [, silo] = CASES[0]
refused(silo.replace('boundary', 'boundry'), /boundary/, 'an unknown key')
const [, slide] = CASES[2]
refused(slide.replace('mountain.asc', 'nothing.asc'), /nothing\.asc/, 'an elevation model that is not there')
engine.put('words.asc', new TextEncoder().encode('this is no raster'))
refused(slide.replace('mountain.asc', 'words.asc'), /begins with/, 'a file that is no raster')
const { handle } = engine.open(silo)
check(engine.advance(handle, { steps: 1 }).steps === 1, 'one step is one step')
const saved = engine.field(handle, 'thickness')
check(saved.length === 240 && saved.every(Number.isFinite), 'a field has a number for each cell')
engine.close(handle)

// The mountain of the program's demo, to the byte.
const folder = mkdtempSync(join(tmpdir(), 'granflow-'))
execFileSync(granflow, ['new', 'avalanche', join(folder, 'case.toml')], { stdio: 'ignore' })
engine.demo()
for (const name of ['mountain.asc', 'release.geojson']) check(Buffer.compare(readFileSync(join(folder, name)), engine.get(name)) === 0, `${name} is that of the program`)
rmSync(folder, { recursive: true })

// Every code has its definition, and what is none has none.
const { dem: plain, release: anywhere } = files('plane')
engine.put('mountain.asc', new TextEncoder().encode(plain))
engine.put('release.geojson', new TextEncoder().encode(anywhere))
const inSystem = crs => slide.replace('dem = "mountain.asc"', `dem = "mountain.asc"\ncrs = "${crs}"`)
engine.close(engine.open(inSystem('EPSG:32632')).handle)
refused(inSystem('EPSG:4326'), /degrees|metres/, 'a system in degrees')
refused(inSystem('EPSG:2264'), /foot|feet|metres|unit/, 'a system in feet')

process.exitCode = failed ? 1 : 0
