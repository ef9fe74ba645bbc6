// What an avalanche stands on: an elevation model and a release among the engine's files, built in, given or drawn.
import { isBeside, isElevation, isRelease, read, rings } from './drop.js'
import { MOUNTAINS, files, polygons } from './mountains.js'
import { PICTURE } from './relief.js'

const bytes = text => new TextEncoder().encode(text)

export class Site {
  constructor(client) {
    this.client = client
    this.mountain = null // key of the built-in one, or 'given'
    this.dem = null // name of the elevation model
    this.cell = 0 // size of its cells
    this.crs = null // what the case says of its system
    /** @type {{ name: string, rings: number[][][] }} */
    this.release = null // { name, rings }
    this.beside = new Set() // names of the files that were given
  }

  async put(name, content) {
    await this.client.call('put', name, content)
    this.beside.add(name)
  }
  async forget(name) {
    await this.client.call('forget', name)
    const kept = await this.client.call('names')
    for (const other of this.beside) if (!kept.includes(other)) this.beside.delete(other)
  }

  // One of the mountains of the page; gives where it lies and its elevation.
  async builtIn(key) {
    for (const name of ['mountain.asc', 'release.geojson']) await this.forget(name)
    if (MOUNTAINS[key].demo) await this.client.call('demo')
    else {
      const made = files(key)
      await this.client.call('put', 'mountain.asc', bytes(made.dem))
      await this.client.call('put', 'release.geojson', bytes(made.release))
    }
    for (const name of ['mountain.asc', 'release.geojson']) this.beside.add(name)
    this.crs = MOUNTAINS[key].crs ?? null
    this.outline('release.geojson', await this.client.call('get', 'release.geojson'))
    return this.ground('mountain.asc')
  }

  // Files that were dropped or chosen: a mountain, a release, or both. Gives the ground where there is a new one, and what brings
  // back the files that were there; what is refused leaves everything as it was.
  async take(list) {
    const all = await read(list)
    const dem = all.find(([name]) => isElevation(name))
    const outline = all.find(([name]) => isRelease(name))
    if (!dem && !outline) {
      throw { message: `${all.map(([name]) => name).join(', ')}: no elevation model and no release`, help: ['drop a GeoTIFF or an ESRI ASCII grid, and polygons as GeoJSON or a shapefile (a zip of .shp, .dbf and .prj)'] }
    }
    const mains = [dem, outline].filter(Boolean).map(([name]) => name)
    const before = new Map()
    for (const name of await this.client.call('names')) {
      if (mains.some(main => isBeside(name, main)) || all.some(([given]) => given === name)) before.set(name, await this.client.call('get', name))
    }
    for (const main of mains) await this.forget(main)
    for (const [name, content] of all) await this.put(name, content)
    const { release, dem: former } = this
    const undo = async () => {
      for (const [name] of all) await this.forget(name)
      for (const [name, content] of before) await this.put(name, content)
      this.release = release
    }
    let ground = null
    try {
      if (dem) ground = await this.ground(dem[0])
    } catch (reason) {
      await undo()
      throw reason
    }
    if (ground) {
      // Nothing that stood before is needed any more.
      for (const name of [former, release?.name]) if (name && !all.some(([given]) => isBeside(given, name))) await this.forget(name)
      Object.assign(this, { crs: null, release: null })
    }
    if (outline) this.outline(...outline)
    return { ground, undo }
  }

  async ground(name) {
    const ground = await this.client.call('raster', name, PICTURE)
    Object.assign(this, { dem: name, cell: ground.cell })
    return ground
  }
  outline(name, content) { this.release = { name, rings: rings(name, content) } }

  // A ring that was drawn, in the coordinates of the mountain.
  async drawn(ring) {
    const content = bytes(polygons([ring]))
    await this.forget('release.geojson')
    await this.put('release.geojson', content)
    this.outline('release.geojson', content)
  }

  // The files that a case of this site needs.
  async files() {
    const found = []
    for (const name of this.beside) {
      if ([this.dem, this.release?.name].some(main => main && isBeside(name, main))) found.push([name, await this.client.call('get', name)])
    }
    return found
  }
}
