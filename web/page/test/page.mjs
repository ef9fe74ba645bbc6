// The page in Chromium from file://: every tab run to its end, no request, no error, and something to see.
//   node test/page.mjs PAGE.html CHROMIUM PICTURES PROGRAM
import { execFileSync } from 'node:child_process'
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { pathToFileURL } from 'node:url'
import { chromium } from 'playwright-core'
import { CASES } from './cases.mjs'

const [file, executablePath, pictures, program] = process.argv.slice(2)
mkdirSync(pictures, { recursive: true })
let failed = 0
const check = (holds, words) => {
  if (!holds) failed++
  console.log(`${holds ? 'ok  ' : 'FAIL'}  ${words}`)
}

const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] })
const page = await browser.newPage({ viewport: { width: 1100, height: 900 } })
const complaints = []
const requests = []
page.on('console', message => { if (message.type() === 'error') complaints.push(message.text()) })
page.on('pageerror', error => complaints.push(error.message))
page.on('request', request => { if (!/^(file|data|blob):/.test(request.url())) requests.push(request.url()) })
page.setDefaultTimeout(600_000)

await page.goto(pathToFileURL(file).href)
await page.waitForFunction(() => window.granflow?.ready)

// How many colours a canvas shows, by a coarse count: a blank one has one.
const colours = selector => page.$eval(selector, canvas => {
  const small = new OffscreenCanvas(64, 64)
  const context = small.getContext('2d')
  context.drawImage(canvas, 0, 0, 64, 64)
  const { data } = context.getImageData(0, 0, 64, 64)
  return new Set(Array.from({ length: 64 * 64 }, (_, k) => [0, 1, 2].map(c => data[4 * k + c] >> 4).join())).size
})
const click = text => page.click(`section:not([hidden]) button:text-is("${text}")`)
const idle = name => page.waitForFunction(name => window.granflow.tabs[name].idle(), name, { polling: 50 })
const ended = name => page.waitForFunction(name => window.granflow.tabs[name].player.ended, name, { polling: 200 })

// A mountain to rest, and how often the page draws meanwhile.
await page.selectOption('#mountain label:has-text("Cells") select', '0')
await page.selectOption('#mountain label:has-text("Speed") select', '5')
await page.evaluate(() => { window.drawn = 0; const count = () => { window.drawn++; requestAnimationFrame(count) }; count() })
const [before, begun] = [await page.evaluate(() => [window.drawn, window.granflow.tabs.mountain.relief().drawn]), Date.now()]
await click('Run')
await page.waitForTimeout(8000)
const after = await page.evaluate(() => [window.drawn, window.granflow.tabs.mountain.relief().drawn])
const rate = k => (1e3 * (after[k] - before[k]) / (Date.now() - begun)).toFixed(1)
// The renderer here is software on shared processors: the number is for the eye, the bound for a page that hangs.
check(+rate(0) >= 2, `while a mountain of 200 x 300 cells runs: ${rate(0)} frames a second of the page, ${rate(1)} of the relief`)
await page.screenshot({ path: join(pictures, 'mountain-running.png') })
await page.selectOption('#mountain label:has-text("Cells") select', '10')
await idle('mountain')
await click('Run')
await ended('mountain')
check(/at rest/.test(await page.textContent('#mountain .clock')), `mountain: ${await page.textContent('#mountain .clock')}`)
check(await colours('#mountain .relief canvas') > 12, 'the relief is not blank')
await page.click('#mountain .relief canvas', { position: { x: 500, y: 330 } })
await page.selectOption('#mountain label:has-text("Shown") select', 'deposit')
await page.waitForTimeout(500)
await page.screenshot({ path: join(pictures, 'mountain.png') })

// Files: one that is no raster is refused with a cure, and the page goes on.
await page.setInputFiles('#mountain input[type=file]', { name: 'words.asc', mimeType: 'text/plain', buffer: Buffer.from('this is no raster') })
await page.waitForSelector('#mountain .error:not([hidden])')
check(/begins with/.test(await page.textContent('#mountain .error')), `no raster: ${await page.textContent('#mountain .error')}`)
const [, , slideFiles] = CASES[3]
await page.setInputFiles('#mountain input[type=file]', Object.entries(slideFiles).map(([name, content]) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(content) })))
await page.waitForFunction(() => window.granflow.tabs.mountain.run()?.about.title.includes('mountain.asc'))
check(await page.isHidden('#mountain .error'), 'a dropped mountain and its release are taken')

// Sand, poured by the pointer.
await page.click('[data-tab=sand]')
await idle('sand')
const box = await (await page.$('canvas.table')).boundingBox()
await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.4 * box.height)
await page.mouse.down()
await page.waitForFunction(() => window.granflow.tabs.sand.run().mass > 0.003, null, { polling: 100 })
await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.5 * box.height, { steps: 4 })
await page.waitForFunction(() => window.granflow.tabs.sand.run().mass > 0.006, null, { polling: 100 })
await page.mouse.up()
await page.waitForTimeout(500)
const poured = await page.evaluate(() => window.granflow.tabs.sand.run())
check(Math.abs(poured.mass_error) < 1e-12 && poured.mass_in > 0.006, `sand: ${await page.textContent('#sand .clock')}`)
check(await colours('canvas.table') > 6, 'the table is not blank')
await page.screenshot({ path: join(pictures, 'sand.png') })
await page.selectOption('#sand label:has-text("Cells") select', '20')
await page.selectOption('#sand label:has-text("Scheme") select', 'first_order')
await page.selectOption('#sand label:has-text("Table") select', 'l')
await idle('sand')
await click('The pile at once')
await click('Pour everywhere')
await ended('sand')
check(/steady/.test(await page.textContent('#sand .clock')), `sand on an L: ${await page.textContent('#sand .clock')}`)
await page.screenshot({ path: join(pictures, 'sand-steady.png') })

// The papers: each example to its end, with two schemes.
await page.click('[data-tab=papers]')
await idle('papers')
for (const example of ['silo', 'riemann', 'sine', 'constant', 'roof']) {
  await page.selectOption('#papers label:has-text("Example") select', example)
  await idle('papers')
  await click('Run')
  await ended('papers')
  const states = await page.$$eval('#papers tbody td:last-child', cells => cells.map(cell => cell.textContent))
  check(states.length === 2 && states.every(state => state !== 'runs'), `papers, ${example}: ${states.join('; ')}`)
  await page.waitForTimeout(300)
  await page.screenshot({ path: join(pictures, `papers-${example}.png`) })
}

// The same bits as the program, by the function that the page offers.
const [name, text] = CASES[0]
const { checksums } = await page.evaluate(text => window.granflow.run(text), text)
const folder = mkdtempSync(join(tmpdir(), 'granflow-'))
writeFileSync(join(folder, 'case.toml'), text)
const said = execFileSync(program, [join(folder, 'case.toml')], { stdio: ['ignore', 'pipe', 'ignore'] }).toString()
rmSync(folder, { recursive: true })
check(Object.entries(checksums).every(([field, sum]) => said.includes(`${field} ${sum}`)), `${name}: the page's bits are the program's`)

// Dark, on a phone.
await page.emulateMedia({ colorScheme: 'dark' })
await page.setViewportSize({ width: 390, height: 844 })
await page.click('[data-tab=mountain]')
await page.waitForTimeout(800)
check(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'nothing is wider than a phone')
await page.screenshot({ path: join(pictures, 'phone-dark.png') })

check(requests.length === 0, `no request to a network: ${requests.join(' ') || 'none'}`)
check(complaints.length === 0, `no error on the console: ${complaints.join(' | ') || 'none'}`)
console.log(`memory of the engine: ${await page.evaluate(() => window.granflow.memory())} bytes`)
await browser.close()
process.exitCode = failed ? 1 : 0
