// A mountain in three dimensions: the relief with a picture of the field laid over it, turned and zoomed by the pointer.
import {
  BufferAttribute, BufferGeometry, ClampToEdgeWrapping, DataTexture, LinearFilter, Mesh, MeshBasicMaterial,
  PerspectiveCamera, Raycaster, RGBAFormat, Scene, SRGBColorSpace, Vector2, WebGLRenderer,
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { hillshade, paint } from './colours.js'

const FINEST = 160 // nodes of the relief along an axis: the picture over it has every cell

export class Relief {
  constructor(place) {
    this.renderer = new WebGLRenderer({ antialias: false, alpha: true, preserveDrawingBuffer: true })
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
    const loop = () => {
      requestAnimationFrame(loop)
      if (this.stale && place.offsetParent !== null) this.draw()
    }
    loop()
  }

  fit(place) {
    const width = place.clientWidth
    if (!width) return
    const height = Math.max(260, Math.min(0.62 * width, 0.7 * window.innerHeight))
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2))
    this.renderer.setSize(width, height)
    this.camera.aspect = width / height
    this.camera.updateProjectionMatrix()
    this.stale = true
  }

  draw() {
    this.stale = false
    this.controls.update()
    this.renderer.render(this.scene, this.camera)
    this.drawn++
  }

  // A mountain of `columns` x `rows` cells, elevations `z` in rows from the south.
  show({ columns, rows, cell, z }) {
    Object.assign(this, { columns, rows, cell, z })
    let [low, high] = [Infinity, -Infinity]
    for (const value of z) {
      if (value < low) low = value
      if (value > high) high = value
    }
    this.low = low
    this.shade = hillshade(z, columns, rows, cell)
    this.bytes = new Uint8Array(4 * columns * rows)
    this.texture?.dispose()
    this.texture = new DataTexture(this.bytes, columns, rows, RGBAFormat)
    Object.assign(this.texture, {
      colorSpace: SRGBColorSpace, magFilter: LinearFilter, minFilter: LinearFilter, generateMipmaps: false,
      wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping,
    })
    this.build()
    this.colour(null, { scale: 'heat', most: 1, least: Infinity })
    this.lookFrom(high - low)
  }

  lookFrom(drop) {
    const [width, length] = [this.columns * this.cell, this.rows * this.cell]
    const far = 1.05 * Math.max(width, length)
    this.controls.target.set(0, 0.35 * drop * this.exaggeration, 0.05 * length)
    this.camera.position.set(0.45 * far, 0.75 * far + 0.4 * drop, -1.0 * far)
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
    for (let j = 0; j + 1 < ny; j++) {
      for (let i = 0; i + 1 < nx; i++) {
        const n = j * nx + i
        faces.push(n, n + 1, n + nx + 1, n, n + nx + 1, n + nx)
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
    this.mesh = new Mesh(geometry, new MeshBasicMaterial({ map: this.texture }))
    this.scene.add(this.mesh)
    this.stale = true
  }

  exaggerate(factor) {
    this.exaggeration = factor
    this.build()
  }

  // Lays a field over the relief, with lines over it: each a list of [column, row].
  colour(field, how, lines = []) {
    paint(this.bytes, this.shade, field, how)
    for (const points of lines) this.trace(points)
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
