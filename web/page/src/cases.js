// The case texts that the page composes: what it runs, and what it exports for the program.

// Friction laws with the parameters that have a slider: [key, words, unit, least, most, step, value].
export const LAWS = {
  coulomb: { title: 'Coulomb', parameters: [['mu', 'friction coefficient µ', '', 0.05, 0.9, 0.01, 0.4]] },
  voellmy: {
    title: 'Voellmy',
    parameters: [['mu', 'friction coefficient µ', '', 0.05, 0.6, 0.01, 0.25], ['xi', 'turbulent friction ξ', 'm/s²', 300, 5000, 50, 2000]],
  },
  cohesion: {
    title: 'Coulomb with cohesion',
    parameters: [['mu', 'friction coefficient µ', '', 0.05, 0.9, 0.01, 0.35], ['tau0', 'cohesion τ₀', 'Pa', 0, 500, 10, 100]],
  },
  samosat: { title: 'samosAT', parameters: [['mu', 'friction coefficient µ', '', 0.1, 0.3, 0.005, 0.155]] },
  mu_i: {
    title: 'µ(I)',
    parameters: [
      ['mu_s', 'µ at rest', '', 0.2, 0.6, 0.01, 0.38], ['mu_2', 'µ of fast flow', '', 0.4, 1, 0.01, 0.64],
      ['i0', 'inertial number I₀', '', 0.1, 0.5, 0.01, 0.3], ['grain', 'grain size', 'm', 0.001, 0.2, 0.001, 0.05],
    ],
  },
  bingham: {
    title: 'Bingham',
    parameters: [['yield', 'yield stress', 'Pa', 50, 3000, 50, 800], ['viscosity', 'viscosity', 'Pa s', 1, 200, 1, 30]],
  },
}

const number = value => (Number.isInteger(value) ? `${value}.0` : `${value}`)

// An avalanche on a mountain; `density` in kg/m³, `thickness` in metres.
export function mountain({ title, dem, crs, cell, release, thickness, law, parameters, density, scheme, end, curvature }) {
  const inside = Object.entries(parameters).map(([key, value]) => `${key} = ${number(value)}`).join(', ')
  const lines = [
    `title = ${JSON.stringify(title)}`, 'model = "savage_hutter"', '',
    '[terrain]', `dem = ${JSON.stringify(dem)}`,
    ...(crs ? [`crs = ${JSON.stringify(crs)}`] : []), ...(cell ? [`cell = ${number(cell)}`] : []),
    `curvature = { length = "${curvature} m" }`, '',
    '[material]', `density = ${number(density)}`, `friction.${law} = { ${inside} }`, '',
    '[[release]]', `polygons = ${JSON.stringify(release)}`, `thickness = ${number(thickness)}`, '',
    '[scheme]', `name = "${scheme}"`, '',
    '[time]', 'until = "rest"', `end = ${number(end)}`, 'trickle = 0.01', '',
  ]
  return lines.join('\n')
}

// Tables for the sand, in [0, 1] x [0, 1]: the mask, regions cut out, edges with a wall.
export const TABLES = {
  square: { title: 'square' },
  disc: { title: 'disc', mask: 'disc = { centre = [0.5, 0.5], radius = 0.48 }' },
  l: { title: 'L', mask: 'box = [0.0, 1.0, 0.0, 1.0]', cut: ['box = [0.5, 1.0, 0.5, 1.0]'] },
  hole: { title: 'square with a hole', cut: ['disc = { centre = [0.5, 0.5], radius = 0.12 }'] },
  walls: { title: 'square with two walls', walls: ['box = [-0.01, 0.01, 0.0, 1.0]', 'box = [0.0, 1.0, -0.01, 0.01]'] },
}
// Files of what was drawn on a table.
export const DRAWN = { outline: 'table.geojson', hole: 'holes.geojson', wall: 'walls.geojson' }

// Sand on a table; `sources` is a list of { x, y, radius, rate }, a rate everywhere without a radius; `drawn` says which files of
// DRAWN there are.
export function sand({ table, cells, scheme, sources, direct, drawn = [] }) {
  const { mask, cut = [], walls = [] } = TABLES[table]
  const file = kind => (drawn.includes(kind) ? [`file = "${DRAWN[kind]}"`] : [])
  const [holes, edges] = [[...cut, ...file('hole')], [...walls, ...file('wall')]]
  const outline = file('outline')[0] ?? mask
  const poured = sources.flatMap(({ x, y, radius, rate }) => [
    '[[source]]', `rate = ${number(rate)}`,
    ...(radius ? [`on.disc = { centre = [${number(x)}, ${number(y)}], radius = ${number(radius)} }`] : []),
  ])
  return [
    'title = "Sand on a table"', 'model = "hadeler_kuttler"', '',
    '[grid]', `x = { from = 0.0, to = 1.0, cells = ${cells} }`, `y = { from = 0.0, to = 1.0, cells = ${cells} }`, '',
    '[table]', 'open = "all"', ...(outline ? [`mask.${outline}`] : []),
    ...(holes.length ? [`cut = [${holes.map(region => `{ ${region} }`).join(', ')}]`] : []),
    ...edges.flatMap(region => ['[[table.wall]]', `on.${region}`]), '', ...poured, '',
    '[scheme]', `name = "${scheme}"`, '',
    '[time]', ...(direct ? ['until = "steady"', 'method = "direct"'] : ['until = "steady"', 'end = 1000.0']), '',
  ].join('\n')
}
