// The page for those who use no mouse, see little, or hold a phone: axe's rules on every tab, light and dark, wide and narrow; the
// keyboard alone; less motion.
//   node test/access.mjs PAGE.html CHROMIUM PICTURES PROGRAM
import { readFileSync } from 'node:fs'
import { check, opened } from './browser.mjs'

const axe = readFileSync(new URL('../node_modules/axe-core/axe.min.js', import.meta.url), 'utf8')

await opened(process.argv.slice(2), async ({ page, idle, picture }) => {
  await page.evaluate(axe)
  for (const scheme of ['light', 'dark']) {
    for (const width of [1100, 390]) {
      await page.emulateMedia({ colorScheme: scheme, reducedMotion: width === 390 ? 'reduce' : 'no-preference' })
      await page.setViewportSize({ width, height: 844 })
      for (const tab of ['mountain', 'sand', 'papers']) {
        await page.click(`[data-tab=${tab}]`)
        await idle(tab)
        await page.waitForTimeout(300)
        const found = await page.evaluate(async () => (await window.axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice'] })).violations
          .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 80)).join(' | ')}`))
        check(found.length === 0, `${tab}, ${scheme}, ${width} pixels wide: ${found.join('; ') || 'nothing against it'}`)
        check(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), `${tab}: nothing is wider than ${width} pixels`)
        await picture(`${tab}-${scheme}-${width}`)
      }
    }
  }

  // By keyboard alone: a tab, a run, a release by its corners, sand.
  await page.emulateMedia({ colorScheme: 'light', reducedMotion: 'no-preference' })
  await page.setViewportSize({ width: 1100, height: 844 })
  const focus = async (name, limit = 40) => {
    for (let k = 0; k < limit; k++) {
      await page.keyboard.press('Tab')
      if (await page.evaluate(() => document.activeElement.textContent || document.activeElement.getAttribute('aria-label')).then(text => text?.startsWith(name))) return true
    }
    return false
  }
  await page.click('[data-tab=papers]')
  await page.keyboard.press('ArrowRight')
  await idle('mountain')
  check(await page.isVisible('#mountain') && await focus('Draw a release'), 'the arrow keys choose a tab, Tab comes to its buttons')
  await page.keyboard.press('Enter')
  await page.keyboard.type('400 100\n600 100\n600 200\n400 200\n')
  check(await focus('Use this release'), 'corners are written, Tab comes to the button')
  await page.keyboard.press('Space')
  await idle('mountain')
  const mass = await page.evaluate(() => window.granflow.tabs.mountain.run()?.mass)
  check(mass > 24_000 && mass < 26_000, `a release by keyboard: ${mass?.toFixed(0)} m³`)
  await page.focus('[data-tab=mountain]')
  await page.keyboard.press('ArrowRight')
  await idle('sand')
  check(await focus('Table from above'), 'Tab comes to the table')
  await page.keyboard.press('ArrowLeft')
  await page.keyboard.press('Space')
  await page.waitForFunction(() => window.granflow.tabs.sand.run().mass > 0.001, null, { polling: 100 })
  await page.keyboard.press('Space')
  check(true, 'the space bar pours')
})
