declare module '*.gz' {
  const text: string
  export default text
}
declare module '*.toml' {
  const text: string
  export default text
}
declare module 'worker-script' {
  const text: string
  export default text
}
