// Puts the page into one file: scripts, style, the worker and the engine, which is gzip in letters.
import { build } from 'esbuild'
import { readFileSync, writeFileSync } from 'node:fs'
import { encoded } from './src/base85.js'

const common = { bundle: true, minify: true, write: false, format: 'iife', target: 'es2022', legalComments: 'inline' }
const source = new URL('src/', import.meta.url).pathname
const script = async (file, plugins = []) => {
  const { outputFiles: [{ text }] } = await build({
    ...common, entryPoints: [source + file], plugins, loader: { '.toml': 'text' },
  })
  return text
}
const worker = await script('worker.js')
const page = await script('main.js', [{
  name: 'engine',
  setup({ onLoad }) {
    onLoad({ filter: /\.gz$/ }, ({ path }) => ({ contents: encoded(readFileSync(path)), loader: 'text' }))
  },
}, {
  name: 'worker-script',
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^worker-script$/ }, () => ({ path: 'worker-script', namespace: 'worker' }))
    onLoad({ filter: /.*/, namespace: 'worker' }, () => ({ contents: worker, loader: 'text' }))
  },
}])
const html = readFileSync(source + 'index.html', 'utf8')
  .replace('/* STYLE */', () => readFileSync(source + 'style.css', 'utf8'))
  .replace('/* SCRIPT */', () => page.replaceAll('</script', '<\\/script'))
writeFileSync(process.argv[2], html)
