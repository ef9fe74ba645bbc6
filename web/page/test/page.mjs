// The page in Chromium from file://: every tab run to its end, no request, no error, and something to see.
//   node test/page.mjs PAGE.html CHROMIUM PICTURES PROGRAM
import { check, differing, opened } from './browser.mjs'
import { CASES } from './cases.mjs'

const BUILT_IN = ['demo', 'gully', 'plane', 'dam', 'cone']

await opened(process.argv.slice(2), async ({ page, idle, ended, click, choose, picture, colours, extent, saved, native, checksums, error }) => {
  // A mountain that runs, and how often the page draws meanwhile.
  await choose('Speed', '5')
  await page.evaluate(() => { window.drawn = 0; const count = () => { window.drawn++; requestAnimationFrame(count) }; count() })
  const drawn = () => page.evaluate(() => [window.drawn, window.granflow.tabs.mountain.relief().drawn])
  const [before, begun] = [await drawn(), Date.now()]
  await click('Run')
  await page.waitForTimeout(8000)
  const after = await drawn()
  const rate = k => (1e3 * (after[k] - before[k]) / (Date.now() - begun)).toFixed(1)
  // The renderer here is software on shared processors: the number is for the eye, the bound for a page that hangs.
  check(+rate(0) >= 2, `while a mountain of 200 x 300 cells runs: ${rate(0)} frames a second of the page, ${rate(1)} of the relief`)
  await picture('mountain-running')

  // Every built-in mountain to its end, on coarse cells.
  await choose('Cells', '20')
  await choose('Speed', 'Infinity')
  for (const name of BUILT_IN) {
    await choose('Mountain', name)
    await idle('mountain')
    await click('Run')
    await ended('mountain')
    const said = await page.textContent('#mountain .clock')
    check(/at rest/.test(said) && await error('mountain') === '', `${name}: ${said}`)
    check(await colours('#mountain .relief canvas') > 12, `${name}: the relief is not blank`)
    const [left, right, top, bottom] = await extent()
    check(left > 0 && right < 1 && top > 0 && bottom < 1 && Math.max(right - left, bottom - top) > 0.5, `${name}: all of it is seen, from ${left} to ${right} and ${top} to ${bottom} of the picture`)
    const files = await saved('All as a zip: case, files, maps')
    const { checksums: here } = await checksums('mountain')
    const differ = differing(here, native(files))
    check(differ.length === 0 && files['deposit.tif'].length > 100, `${name}: the program repeats what was saved, ${Object.keys(files).join(', ')}${differ.map(field => `; other: ${field}`).join('')}`)
  }
  const canvas = await page.locator('#mountain .relief canvas').boundingBox()
  await page.mouse.click(canvas.x + 0.5 * canvas.width, canvas.y + 0.5 * canvas.height)
  check(await page.isVisible('#mountain canvas.chart'), `a click shows what passes there: ${await page.getAttribute('#mountain canvas.chart', 'aria-label')}`)
  const png = await saved('PNG of the view')
  check(png['mountain.png'].length > 20_000, `the view as a PNG of ${png['mountain.png'].length} bytes`)
  await choose('Shown', 'deposit')
  await page.waitForTimeout(500)
  await picture('mountain')

  // Sand, poured by the pointer.
  await page.click('[data-tab=sand]')
  await idle('sand')
  await page.locator('canvas.table').first().scrollIntoViewIfNeeded()
  const box = await page.locator('canvas.table').first().boundingBox()
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
  await picture('sand')
  await choose('Cells', '20')
  await choose('Scheme', 'first_order')
  for (const table of ['square', 'disc', 'l', 'hole', 'walls']) {
    await choose('Table', table)
    await idle('sand')
    await click('The pile at once')
    await click('Pour everywhere')
    await ended('sand')
    check(/steady/.test(await page.textContent('#sand .clock')) && await error('sand') === '', `sand, ${table}: ${await page.textContent('#sand .clock')}`)
  }
  await picture('sand-steady')

  // The papers: each example to its end, with two schemes.
  await page.click('[data-tab=papers]')
  await idle('papers')
  for (const example of ['silo', 'inclined', 'parabola', 'riemann', 'sine', 'constant', 'roof']) {
    await choose('Example', example)
    await idle('papers')
    await click('Run')
    await ended('papers')
    const states = await page.$$eval('#papers tbody td:last-child', cells => cells.map(cell => cell.textContent))
    check(states.length === 2 && states.every(state => !state.startsWith('runs')), `papers, ${example}: ${states.join('; ')}`)
    await page.waitForTimeout(300)
    await picture(`papers-${example}`)
  }
  await choose('Example', 'sine')
  await idle('papers')
  await choose('Scheme 1', 'verfahren_3')
  await idle('papers')
  await click('Run')
  await ended('papers')
  const failure = await page.textContent('#papers tbody tr:first-child td:last-child')
  check(/failed|negative/.test(failure), `Verfahren 3 on the steep slope: ${failure}`)
  await choose('Language', 'de')
  check(/Totalvariation/.test(await page.textContent('#papers table')), 'the papers speak German')
  await picture('papers-german')

  // The same bits as the program, by the function that the page offers.
  const [name, text] = CASES[0]
  const { checksums: here } = await page.evaluate(text => window.granflow.run(text), text)
  check(differing(here, native({ 'case.toml': text })).length === 0, `${name}: the page's bits are the program's`)
  console.log(`memory of the engine: ${await page.evaluate(() => window.granflow.memory())} bytes`)
})
