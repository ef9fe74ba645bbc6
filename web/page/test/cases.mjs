// The cases by which page, node and program are compared: no angle and no power is among them, since the maths libraries of two
// systems round those differently (docs/determinism.md).
import { files } from '../src/mountains.js'
import { mountain, sand } from '../src/cases.js'

const SILO = `title = "A silo breaks"
model = "savage_hutter"
[grid]
x = { from = -6.0, to = 6.0, cells = 240 }
boundary = "open"
[material]
epsilon = 0.4
slope = "0 deg"
friction.coulomb = { mu = 0.325 }
[initial]
thickness.steps = { at = [-1.0, 1.0], values = [0.3, 2.3, 0.3] }
[scheme]
name = "energy_stable"
[time]
until = "rest"
end = 100.0
`
const small = name => {
  const { dem, release } = files(name)
  return { 'mountain.asc': dem, 'release.geojson': release }
}
const slide = (name, law, parameters, cell = 0) => mountain({
  title: name, dem: 'mountain.asc', release: 'release.geojson', thickness: 1, law, parameters, density: 200, scheme: 'energy_stable_2', end: 400,
  curvature: 20, cell,
})
const pile = (table, scheme) => sand({ table, cells: 24, scheme, sources: [{ rate: 0.5 }] })

// Name, text, and the files it names.
export const CASES = [
  ['silo', SILO, {}],
  ['silo, kinetic', SILO.replace('energy_stable', 'verfahren_5').replace('until = "rest"\nend = 100.0', 'steps = 2000')
    .replace('name = "verfahren_5"', 'name = "verfahren_5"\nstep = 0.001'), {}],
  ['mountain, Coulomb', slide('gully', 'coulomb', { mu: 0.4 }, 10), small('gully')],
  ['mountain, Voellmy', slide('plane', 'voellmy', { mu: 0.25, xi: 2000 }, 10), small('plane')],
  ['sandpile', pile('square', 'first_order'), {}],
  ['sandpile on an L', pile('l', 'second_order').replace('end = 1000.0', 'end = 2.0'), {}],
]
