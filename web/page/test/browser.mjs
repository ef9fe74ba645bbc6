// The page in Chromium as a user meets it: opened from a file, clicked, given files; with what the tests ask of it.
import { execFileSync } from 'node:child_process'
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { pathToFileURL } from 'node:url'
import { chromium } from 'playwright-core'
import { unzip } from '../src/zip.js'

let failed = 0
export const check = (holds, words) => {
  if (!holds) failed++
  console.log(`${holds ? 'ok  ' : 'FAIL'}  ${words}`)
}

// Opens the page, does the work, and holds it to no request and no complaint. `work` gets what follows.
export async function opened([file, executablePath, pictures, program], work) {
  mkdirSync(pictures, { recursive: true })
  const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] })
  const page = await browser.newPage({ viewport: { width: 1100, height: 900 }, locale: 'en-GB' })
  const [complaints, requests] = [[], []]
  page.on('console', message => { if (message.type() === 'error') complaints.push(message.text()) })
  page.on('pageerror', error => complaints.push(error.message))
  page.on('request', request => { if (!/^(file|data|blob):/.test(request.url())) requests.push(request.url()) })
  page.setDefaultTimeout(600_000)
  await page.goto(pathToFileURL(file).href)
  await page.waitForFunction(() => window.granflow?.ready)
  await work(tools(page, pictures, program))
  check(requests.length === 0, `no request to a network: ${requests.join(' ') || 'none'}`)
  check(complaints.length === 0, `no error on the console: ${complaints.join(' | ') || 'none'}`)
  await browser.close()
  process.exitCode = failed ? 1 : 0
}

function tools(page, pictures, program) {
  const idle = name => page.waitForFunction(name => window.granflow.tabs[name].idle(), name, { polling: 50 })
  return {
    page,
    idle,
    ended: name => page.waitForFunction(name => window.granflow.tabs[name].player.ended, name, { polling: 200 }),
    click: text => page.click(`section:not([hidden]) button:text-is("${text}")`),
    choose: (label, value) => page.selectOption(`section:not([hidden]) label:has-text("${label}") select`, value),
    picture: name => page.screenshot({ path: join(pictures, `${name}.png`), fullPage: true }),
    // What the page says of an error, or nothing.
    error: async tab => (await page.isHidden(`#${tab} .error`) ? '' : page.textContent(`#${tab} .error`)),
    // Drops files { name: bytes } on the mountain; the milliseconds until they are shown, and the longest that the page stood still.
    async drop(files) {
      const list = Object.entries(files).map(([name, content]) => [name, Buffer.from(content).toString('base64')])
      return page.evaluate(async list => {
        const dataTransfer = new DataTransfer()
        for (const [name, base64] of list) dataTransfer.items.add(new File([Uint8Array.from(atob(base64), letter => letter.charCodeAt(0))], name))
        const begun = performance.now()
        let [beats, last, longest] = [true, begun, 0]
        const beat = () => {
          const now = performance.now()
          longest = Math.max(longest, now - last)
          last = now
          if (beats) setTimeout(beat)
        }
        beat()
        const target = document.querySelector('#mountain .relief')
        for (const type of ['dragenter', 'dragover', 'drop']) target.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, dataTransfer }))
        do await new Promise(done => setTimeout(done, 10)); while (!window.granflow.tabs.mountain.idle())
        for (let k = 0; k < 2; k++) await new Promise(requestAnimationFrame)
        beats = false
        return { milliseconds: performance.now() - begun, longest }
      }, list)
    },
    // Draws on a canvas along points in [0, 1] x [0, 1], y to the top.
    async stroke(selector, points) {
      await page.locator(selector).first().scrollIntoViewIfNeeded()
      const box = await page.locator(selector).first().boundingBox()
      const at = ([x, y]) => [box.x + x * box.width, box.y + (1 - y) * box.height]
      await page.mouse.move(...at(points[0]))
      await page.mouse.down()
      for (const point of points.slice(1)) await page.mouse.move(...at(point), { steps: 6 })
      await page.mouse.up()
    },
    // How many colours a canvas shows, by a coarse count: a blank one has one.
    colours: selector => page.$eval(selector, canvas => {
      window.granflow.tabs.mountain.relief().draw() // its picture is kept for one frame
      const small = new OffscreenCanvas(64, 64)
      const context = small.getContext('2d')
      context.drawImage(canvas, 0, 0, 64, 64)
      const { data } = context.getImageData(0, 0, 64, 64)
      return new Set(Array.from({ length: 64 * 64 }, (_, k) => [0, 1, 2].map(c => data[4 * k + c] >> 4).join())).size
    }),
    // Where the mountain lies on its canvas: left, right, top, bottom as shares of it.
    extent: () => page.$eval('#mountain .relief canvas', canvas => {
      window.granflow.tabs.mountain.relief().draw()
      const small = new OffscreenCanvas(100, 100)
      const context = small.getContext('2d')
      context.drawImage(canvas, 0, 0, 100, 100)
      const { data } = context.getImageData(0, 0, 100, 100)
      const at = Array.from({ length: 1e4 }, (_, k) => k).filter(k => data[4 * k + 3] > 0)
      const ends = of => [Math.min(...at.map(of)) / 100, (1 + Math.max(...at.map(of))) / 100]
      return [...ends(k => k % 100), ...ends(k => Math.floor(k / 100))]
    }),
    // The files that a button offers: those in a zip, or the one.
    async saved(text) {
      const [download] = await Promise.all([page.waitForEvent('download'), page.click(`section:not([hidden]) button:text-is("${text}")`)])
      const content = new Uint8Array(readFileSync(await download.path()))
      return Object.fromEntries(download.suggestedFilename().endsWith('.zip') ? await unzip(content) : [[download.suggestedFilename(), content]])
    },
    // What the program says of the case among files { name: bytes }: lines of a name and a value.
    native(files) {
      const folder = mkdtempSync(join(tmpdir(), 'granflow-'))
      try {
        for (const [name, content] of Object.entries(files)) writeFileSync(join(folder, name), content)
        const said = execFileSync(program, ['case.toml'], { cwd: folder, stdio: ['ignore', 'pipe', 'ignore'] }).toString()
        return Object.fromEntries(said.trim().split('\n').map(line => line.split(' ')))
      } finally {
        rmSync(folder, { recursive: true })
      }
    },
    checksums: tab => page.evaluate(tab => window.granflow.checksums(tab), tab),
  }
}

// The fields in which two lists of checksums differ.
export const differing = (here, there) => Object.keys(here).filter(name => here[name] !== there[name])
