// Files of a user, dropped as a user drops them, and what is drawn with the mouse: shown, run, refused with a cure, repeated by the
// program.
//   node test/given.mjs PAGE.html CHROMIUM PICTURES PROGRAM
import { check, differing, opened } from './browser.mjs'
import { asciiGrid, geotiff, heights, shapefile, zip } from './files.mjs'
import { polygons } from '../src/mountains.js'

const PLACE = { columns: 100, rows: 160, cell: 10, west: 600000, south: 5200000 }
const dem = { ...PLACE, z: heights(100, 160, 10) }
const ring = (x, y) => [[-60, 90], [-60, 190], [60, 190], [60, 90]].map(([dx, dy]) => [x + dx, y + dy])
const release = polygons([ring(600500, 5200000)])
const bytes = text => new TextEncoder().encode(text)
const UTM = 'PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]]'

await opened(process.argv.slice(2), async tools => {
  const { page, idle, click, choose, picture, drop, error, stroke, saved, native, checksums, ended } = tools
  const notes = () => page.textContent('#mountain .notes')
  const outlines = () => page.evaluate(() => window.granflow.tabs.mountain.site().release?.rings.length ?? 0)
  const holds = () => page.evaluate(() => window.granflow.tabs.mountain.run()?.about.title)
  // Runs what stands to its end and has the program repeat it.
  async function repeated(words) {
    await choose('Speed', 'Infinity')
    await click('Run')
    await ended('mountain')
    const files = await saved('All as a zip: case, files, maps')
    const differ = differing((await checksums('mountain')).checksums, native(files))
    check(differ.length === 0, `${words}: the program repeats what was saved, ${Object.keys(files).join(', ')}${differ.map(field => `; other: ${field}`).join('')}`)
  }

  await drop({ 'projected.tif': geotiff({ ...dem, epsg: 32632 }), 'release.geojson': bytes(release) })
  check(await error('mountain') === '' && /EPSG:32632 \(WGS 84/.test(await notes()), `a GeoTIFF whose system is a bare code: ${await notes()}`)
  await repeated('GeoTIFF and GeoJSON')
  await drop({ 'plain.tif': geotiff(dem), 'release.geojson': bytes(release) })
  check(await error('mountain') === '' && /says no coordinate reference system/.test(await notes()), `a GeoTIFF without a system: ${await notes()}`)

  const { shp, dbf } = shapefile([...ring(600500, 5200000), ring(600500, 5200000)[0]])
  await drop({ 'grid.asc': asciiGrid(dem) })
  check(/Draw a release/.test(await page.textContent('#mountain .clock')), 'a mountain without a release asks for one')
  await drop({ 'slide.zip': zip({ 'folder/slide.shp': shp, 'folder/slide.dbf': dbf, 'folder/slide.prj': bytes(UTM) }) })
  check(await error('mountain') === '' && await outlines() === 1 && /slide\.shp: it is in WGS 84/.test(await notes()), `a zipped shapefile: ${await notes()}`)
  await repeated('grid and shapefile')
  await drop({ 'slide.shp': shp, 'slide.dbf': dbf })
  check(!/slide\.shp: it is in/.test(await notes()), 'a file given again does not keep what stood beside the one before')

  const holed = { ...dem, z: dem.z.map((z, k) => (Math.hypot(k % 100 - 75, Math.floor(k / 100) - 45) < 15 ? -9999 : z)) }
  await drop({ 'holed.tif': geotiff({ ...holed, nodata: -9999, epsg: 32632 }), 'release.geojson': bytes(release) })
  check(await error('mountain') === '' && /holed/.test(await holds()), 'a mountain with cells without an elevation')
  await picture('given-holes')

  // What is refused, with its cure; what was there stays.
  const refusals = [
    [{ 'degrees.tif': geotiff({ ...dem, cell: 0.0001, west: 10, south: 47, degrees: true }) }, /in degrees.*gdalwarp/s, 'an elevation model in degrees'],
    [{ 'words.tif': bytes('this is no raster') }, /neither a GeoTIFF nor/, 'a file that is no raster'],
    [{ 'photo.jpg': bytes('') }, /no elevation model.*drop a GeoTIFF/s, 'a file of another kind'],
    [{ 'cut.zip': bytes('PK') }, /cut\.zip cannot be unpacked.*unpack it/s, 'a zip that is none'],
    [{ 'far.geojson': bytes(polygons([ring(6000, 52000)])) }, /beyond the terrain.*ogr2ogr/s, 'a release off the raster'],
    [{ 'cut.geojson': bytes('{') }, /cut\.geojson cannot be read/, 'a GeoJSON that is cut off'],
  ]
  for (const [files, pattern, words] of refusals) {
    await drop(files)
    const said = await error('mountain')
    check(pattern.test(said) && /holed/.test(await holds()), `${words}: ${said.replace(/\s+/g, ' ')}`)
  }
  await picture('given-refused')

  // A large one: shown soon, and the page answers while it runs.
  const steep = (x, s) => 400 + 0.3 * (6000 - s + Math.sqrt((6000 - s) ** 2 + 1500 ** 2)) + 0.00008 * x * x
  const large = { columns: 2000, rows: 2000, cell: 5, west: 600000, south: 5200000, z: heights(2000, 2000, 5, steep) }
  const shown = await drop({ 'large.tif': geotiff({ ...large, epsg: 32632 }) })
  // Two seconds on processors of its own; the bound is for shared ones.
  check(shown.milliseconds < 20_000, `2000 x 2000 cells shown after ${shown.milliseconds.toFixed(0)} ms, the page stood still for ${shown.longest.toFixed(0)} ms at most`)
  const started = await drop({ 'release.geojson': bytes(polygons([ring(605000, 5200000)])) })
  await click('Run')
  await page.waitForFunction(() => window.granflow.tabs.mountain.run().steps > 20, null, { polling: 100 })
  check(started.longest < 5000, `its run began after ${started.milliseconds.toFixed(0)} ms, the page stood still for ${started.longest.toFixed(0)} ms at most`)
  await click('Pause')
  await picture('given-large')

  // A release drawn with the mouse and finished by its button; then corners written by keyboard.
  await choose('Mountain', 'gully')
  await idle('mountain')
  await choose('Cells', '20')
  await idle('mountain')
  await click('Draw a release')
  const canvas = await page.locator('#mountain .relief canvas').boundingBox()
  for (const [x, y] of [[0.42, 0.3], [0.5, 0.28], [0.5, 0.36], [0.42, 0.38]]) await page.mouse.click(canvas.x + x * canvas.width, canvas.y + y * canvas.height)
  check((await page.inputValue('#mountain textarea')).trim().split('\n').length === 4, 'four clicks are four corners')
  await picture('given-drawing')
  await click('Use this release')
  await idle('mountain')
  check(await error('mountain') === '' && await page.evaluate(() => window.granflow.tabs.mountain.run().mass) > 1000, `a drawn release: ${await page.textContent('#mountain .clock')}`)
  await repeated('a drawn release')
  await click('Draw a release')
  await page.fill('#mountain textarea', '400 100\n600 100')
  await click('Use this release')
  check(/three corners/.test(await error('mountain')), 'two corners are no release')
  await page.fill('#mountain textarea', '400 100\n600 100\n600, 200\n400; 200')
  await click('Use this release')
  await idle('mountain')
  const mass = await page.evaluate(() => window.granflow.tabs.mountain.run().mass)
  check(mass > 24_000 && mass < 26_000, `a release that was written: ${mass.toFixed(0)} m³`)

  // A table drawn by the pointer: its outline, a hole, a wall.
  await page.click('[data-tab=sand]')
  await idle('sand')
  await choose('Cells', '20')
  await choose('Scheme', 'first_order')
  const part = async (tool, points) => {
    await choose('The pointer', tool)
    await stroke('canvas.table', points)
    await page.waitForTimeout(100)
    await idle('sand')
  }
  await part('outline', Array.from({ length: 24 }, (_, k) => [0.5 + 0.42 * Math.cos(0.26 * k), 0.5 + 0.38 * Math.sin(0.26 * k)]))
  await part('hole', [[0.6, 0.5], [0.72, 0.5], [0.72, 0.62], [0.6, 0.62]])
  await part('wall', [[0.08, 0.4], [0.2, 0.2], [0.45, 0.1]])
  check(await error('sand') === '', `a drawn table: ${await page.textContent('#sand .clock')}`)
  await part('hole', [[0.02, 0.02], [0.98, 0.02], [0.98, 0.98], [0.02, 0.98]])
  check(/none of the .* cells belongs to the table/.test(await error('sand')) && await page.evaluate(() => window.granflow.tabs.sand.run() !== null), 'a hole as large as the table is not taken')
  await choose('The pointer', 'pour')
  await click('The pile at once')
  await click('Pour everywhere')
  await ended('sand')
  check(/steady/.test(await page.textContent('#sand .clock')), `sand on it: ${await page.textContent('#sand .clock')}`)
  await picture('given-table')
  // Distances to drawn lines come from the maths library, which is another one here (docs/determinism.md): not the same bits.
  const table = await saved('case.toml')
  const { summary } = await page.evaluate(files => window.granflow.runFiles(files), Object.entries(table).map(([name, content]) => [name, Buffer.from(content).toString()]))
  const there = native(table)
  const close = Math.abs(summary.time / +there.time - 1) < 1e-9 && String(summary.steps) === there.steps
  check(close && Object.keys(table).length === 4, `the program repeats it to the last places: ${Object.keys(table).join(', ')}; ${summary.steps} and ${there.steps} steps to ${summary.time} and ${there.time}`)
})
