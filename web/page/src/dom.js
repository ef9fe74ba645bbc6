// Small helpers for the page's elements.

// An element with attributes, properties by `.name`, listeners by `onname`, and children.
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag)
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value)
    else if (name.startsWith('.')) element[name.slice(1)] = value
    else if (value !== false && value != null) element.setAttribute(name, value === true ? '' : value)
  }
  element.append(...children.filter(child => child != null))
  return element
}

// A labelled choice among { key: title }.
export function choice(label, options, value, changed) {
  const select = make('select', { onchange: () => changed(select.value) },
    ...Object.entries(options).map(([key, title]) => make('option', { value: key, selected: key === value }, title)))
  const element = make('label', { class: 'choice' }, `${label} `, select)
  element.select = select
  return element
}

// A labelled slider that shows its value and unit.
export function slider(label, unit, [least, most, step, value], changed) {
  const output = make('output', {}, `${value} ${unit}`)
  const input = make('input', {
    type: 'range', min: least, max: most, step, '.value': value, 'aria-label': unit ? `${label} in ${unit}` : label,
    oninput: () => {
      output.textContent = `${+input.value} ${unit}`
      changed(+input.value)
    },
  })
  return make('label', { class: 'slider' }, make('span', {}, label), input, output)
}

export const button = (text, pressed, attributes = {}) => make('button', { type: 'button', onclick: pressed, ...attributes }, text)

// Shows an error with its place and cure, or nothing.
export function complain(place, error) {
  place.replaceChildren()
  place.hidden = !error
  if (!error) return
  const where = [error.line ? `line ${error.line}` : '', error.key ? `\`${error.key}\`` : ''].filter(Boolean).join(', ')
  place.append(make('div', {}, make('strong', {}, 'This cannot run. '), where ? `${where}: ` : '', error.message),
    ...(error.help ?? []).map(line => make('div', { class: 'cure' }, line)))
}

// Offers bytes or a text as a file of this name.
export function download(name, content, type = 'text/plain') {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }))
  make('a', { href: url, download: name }).click()
  setTimeout(() => URL.revokeObjectURL(url), 1000)
}

export const fixed = (value, digits = 2) => (Number.isFinite(value) ? value.toFixed(digits) : '–')
