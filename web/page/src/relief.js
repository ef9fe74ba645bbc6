// A mountain in three dimensions: the relief with a picture of the field laid over it, turned and zoomed by the pointer.
import {
  BufferAttribute, BufferGeometry, ClampToEdgeWrapping, DataTexture, LinearFilter, Mesh, MeshBasicMaterial,
  PerspectiveCamera, Raycaster, RGBAFormat, Scene, SRGBColorSpace, Vector2, Vector3, WebGLRenderer,
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { hillshade, paint, shaded } from './colours.js'

const FINEST = 110 // nodes of the relief along an axis: the picture over it is finer
const SLOW = 50 // milliseconds between two pictures, from which on they have a quarter of the points
const REST = 400 // milliseconds without a new one, after which the picture is sharp again
// Rows and columns of the picture at most; each of its points stands for a block of cells where there are more.
export const PICTURE = 700

export class Relief {
  columns = 1
  rows = 1
  cell = 1
  west = 0
  south = 0
  low = 0
  drop = 0
  sharpness = 1
  pace = 0 // milliseconds between two pictures, smoothed
  last = 0 // time of the last one
  plays = false // more pictures will come
  z = new Float64Array(1)
  shade = new Float32Array(1)
  ground = new Uint8Array(4)
  bytes = new Uint8Array(4)
  /** @type {DataTexture} */
  texture = null
  /** @type {Mesh<BufferGeometry, MeshBasicMaterial>} */
  mesh = null

  constructor(place) {
    this.renderer = new WebGLRenderer({ antialias: false, alpha: true })
    this.renderer.outputColorSpace = SRGBColorSpace
    this.canvas = this.renderer.domElement
    this.canvas.setAttribute('role', 'img')
    this.canvas.tabIndex = 0
    place.append(this.canvas)
    this.scene = new Scene()
    this.camera = new PerspectiveCamera(38, 1, 1, 1e5)
    this.controls = new OrbitControls(this.camera, this.canvas)
    this.controls.maxPolarAngle = 1.5
    this.controls.listenToKeyEvents(this.canvas)
    this.exaggeration = 1
    this.stale = true
    this.drawn = 0
    this.controls.addEventListener('change', () => { this.stale = true })
    new ResizeObserver(() => this.fit(place)).observe(place)
    this.fit(place)
    const loop = now => {
      requestAnimationFrame(loop)
      if (place.offsetParent === null) return
      if (this.stale) {
        const passed = now - this.last
        if (passed < REST) this.pace += 0.2 * (passed - this.pace)
        if (this.pace > SLOW) this.sharpen(0.5)
        this.draw()
        this.last = now
      } else if (this.sharpness < 1 && !this.plays && now - this.last > REST) {
        this.sharpen(1)
        this.draw()
        this.pace = 0
      }
    }
    loop(0)
  }

  fit(place) {
    const width = place.clientWidth
    if (!width) return
    const height = Math.max(260, Math.min(0.62 * width, 0.7 * window.innerHeight))
    this.renderer.setPixelRatio(this.sharpness * Math.min(window.devicePixelRatio || 1, 2))
    this.renderer.setSize(width, height)
    this.camera.aspect = width / height
    this.camera.updateProjectionMatrix()
    this.stale = true
  }

  // Points of the picture for each of the screen: fewer where a machine draws slowly.
  sharpen(sharpness) {
    if (sharpness === this.sharpness) return
    this.sharpness = sharpness
    this.renderer.setPixelRatio(sharpness * Math.min(window.devicePixelRatio || 1, 2))
  }

  // The picture as it is, as a PNG.
  png() {
    this.sharpen(1)
    this.draw()
    return new Promise(done => this.canvas.toBlob(done))
  }

  draw() {
    this.stale = false
    this.controls.update()
    this.renderer.render(this.scene, this.camera)
    this.drawn++
  }

  // A mountain of `columns` x `rows` points, elevations `z` in rows from the south; none where there is no elevation.
  show({ columns, rows, cell, z }) {
    Object.assign(this, { columns, rows, cell, z })
    let [low, high] = [Infinity, -Infinity]
    for (const value of z) {
      if (value < low) low = value
      if (value > high) high = value
    }
    Object.assign(this, { low, drop: high - low })
    this.shade = hillshade(z, columns, rows, cell)
    this.ground = shaded(this.shade)
    this.bytes = new Uint8Array(4 * columns * rows)
    this.texture?.dispose()
    this.texture = new DataTexture(this.bytes, columns, rows, RGBAFormat)
    Object.assign(this.texture, {
      colorSpace: SRGBColorSpace, magFilter: LinearFilter, minFilter: LinearFilter, generateMipmaps: false,
      wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping,
    })
    this.build()
    this.colour(null, { scale: 'heat', most: 1, least: Infinity })
    this.look()
  }

  // Looks at the whole of it from the north-east and above, from as near as its corners allow.
  look() {
    const half = [this.columns * this.cell / 2, this.drop * this.exaggeration / 2, this.rows * this.cell / 2]
    const back = new Vector3(0.45, 0.8, -1).normalize()
    const right = new Vector3(0, 1, 0).cross(back).normalize()
    const up = back.clone().cross(right)
    const high = Math.tan(this.camera.fov * Math.PI / 360)
    let far = 0
    for (let k = 0; k < 8; k++) {
      const corner = new Vector3(...half.map((size, n) => (k >> n & 1 ? size : -size)))
      const across = Math.max(Math.abs(corner.dot(up)) / high, Math.abs(corner.dot(right)) / (high * this.camera.aspect))
      far = Math.max(far, corner.dot(back) + 1.04 * across)
    }
    this.controls.target.set(0, half[1], 0)
    this.camera.position.copy(back.multiplyScalar(far)).add(this.controls.target)
    Object.assign(this.camera, { near: 0.01 * far, far: 20 * far })
    this.camera.updateProjectionMatrix()
    this.stale = true
  }

  // The mesh: nodes at centres of cells, thinned where there are many; x to the east, up, and z to the south.
  build() {
    const { columns, rows, cell, z, low } = this
    const [nx, ny] = [Math.min(columns, FINEST), Math.min(rows, FINEST)]
    const at = (k, count, cells) => Math.round(k * (cells - 1) / (count - 1))
    const positions = new Float32Array(3 * nx * ny)
    const places = new Float32Array(2 * nx * ny)
    for (let j = 0, n = 0; j < ny; j++) {
      for (let i = 0; i < nx; i++, n++) {
        const [ci, cj] = [at(i, nx, columns), at(j, ny, rows)]
        const height = z[cj * columns + ci]
        positions.set([(ci + 0.5 - columns / 2) * cell, ((Number.isFinite(height) ? height : low) - low) * this.exaggeration, (rows / 2 - cj - 0.5) * cell], 3 * n)
        places.set([(ci + 0.5) / columns, (cj + 0.5) / rows], 2 * n)
      }
    }
    const faces = []
    const known = Array.from({ length: nx * ny }, (_, n) => Number.isFinite(z[at(Math.floor(n / nx), ny, rows) * columns + at(n % nx, nx, columns)]))
    for (let j = 0; j + 1 < ny; j++) {
      for (let i = 0; i + 1 < nx; i++) {
        const n = j * nx + i
        for (const face of [[n, n + 1, n + nx + 1], [n, n + nx + 1, n + nx]]) if (face.every(node => known[node])) faces.push(...face)
      }
    }
    const geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(positions, 3))
    geometry.setAttribute('uv', new BufferAttribute(places, 2))
    geometry.setIndex(faces)
    if (this.mesh) {
      this.scene.remove(this.mesh)
      this.mesh.geometry.dispose()
      this.mesh.material.dispose()
    }
    this.mesh = new Mesh(geometry, new MeshBasicMaterial({ map: this.texture, alphaTest: 0.5 }))
    this.scene.add(this.mesh)
    this.stale = true
  }

  exaggerate(factor) {
    this.exaggeration = factor
    this.build()
    this.look()
  }

  // Lays a field over the relief, with lines over it, each a list of [column, row], and a place that is marked by a cross.
  colour(field, how, lines = [], mark = null) {
    paint(this.bytes, this.ground, this.shade, field, how)
    for (const points of lines) this.trace(points)
    if (mark) {
      const arm = Math.max(this.columns, this.rows) / 80
      for (const [dx, dy] of [[arm, 0], [0, arm]]) this.trace([[mark[0] - dx, mark[1] - dy], [mark[0] + dx, mark[1] + dy]])
    }
    this.texture.needsUpdate = true
    this.stale = true
  }
  trace(points) {
    for (let k = 0; k + 1 < points.length; k++) {
      const [[x0, y0], [x1, y1]] = [points[k], points[k + 1]]
      const steps = Math.ceil(2 * Math.hypot(x1 - x0, y1 - y0)) + 1
      for (let n = 0; n <= steps; n++) {
        const [i, j] = [Math.floor(x0 + (x1 - x0) * n / steps), Math.floor(y0 + (y1 - y0) * n / steps)]
        if (i >= 0 && j >= 0 && i < this.columns && j < this.rows) this.bytes.set([20, 20, 20, 255], 4 * (j * this.columns + i))
      }
    }
  }

  // Column and row of the mountain under a place of the canvas, with fractions; null beside it.
  under(event) {
    const box = this.canvas.getBoundingClientRect()
    const at = new Vector2((event.clientX - box.left) / box.width * 2 - 1, 1 - (event.clientY - box.top) / box.height * 2)
    const ray = new Raycaster()
    ray.setFromCamera(at, this.camera)
    const [hit] = ray.intersectObject(this.mesh)
    return hit ? [hit.uv.x * this.columns, hit.uv.y * this.rows] : null
  }
}
