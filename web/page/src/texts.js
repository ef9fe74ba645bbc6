// The words of the papers' tab in both of its languages: the thesis that it follows is German. What the engine says stays English.
export const LANGUAGES = { en: 'English', de: 'Deutsch' }

export const TEXTS = {
  en: {
    language: 'Language', example: 'Example', scheme: 'Scheme', none: 'none', run: 'Run', pause: 'Pause', step: 'One step', reset: 'Reset',
    over: 'Over time', variation: 'total variation', mass: 'mass', speed: 'greatest speed', time: 'time', exact: 'dashed: exact solution',
    columns: ['scheme', 'time', 'steps', 'mass', 'gained or lost', 'total variation', 'greatest speed', 'state'],
    runs: 'runs', negative: 'negative thickness', failed: 'failed', region: 'Numbers of the schemes',
    silo: 'A silo breaks (Kaland & Struckmeier 2007, Fig. 2)', inclined: 'A silo breaks on a slope (Fig. 4)',
    parabola: 'A parabolic heap spreads (Fig. 5)', riemann: 'Riemann problem without friction (Fig. 1)',
    sine: 'A heap splits in two on a steep slope (Fig. 6); Verfahren 2 to 4 fail', constant: 'A constant layer stays (thesis, Abb. 5.1)',
    roof: 'A sandpile between two edges (Aggarwal et al. 2023)',
    thickness: 'thickness', velocity_x: 'velocity', standing_layer: 'standing layer', rolling_layer: 'rolling layer',
  },
  de: {
    language: 'Sprache', example: 'Beispiel', scheme: 'Verfahren', none: 'keines', run: 'Start', pause: 'Halt', step: 'Ein Schritt', reset: 'Von vorn',
    over: 'Über die Zeit', variation: 'Totalvariation', mass: 'Masse', speed: 'größte Geschwindigkeit', time: 'Zeit', exact: 'gestrichelt: exakte Lösung',
    columns: ['Verfahren', 'Zeit', 'Schritte', 'Masse', 'gewonnen oder verloren', 'Totalvariation', 'größte Geschwindigkeit', 'Zustand'],
    runs: 'läuft', negative: 'negative Höhe', failed: 'versagt', region: 'Zahlen der Verfahren',
    silo: 'Ein Silo zerbricht (Kaland und Struckmeier 2007, Bild 2)', inclined: 'Ein Silo zerbricht am Hang (Bild 4)',
    parabola: 'Ein Parabelhaufen breitet sich aus (Bild 5)', riemann: 'Riemannproblem ohne Reibung (Bild 1)',
    sine: 'Ein Haufen teilt sich am steilen Hang (Bild 6); Verfahren 2 bis 4 versagen', constant: 'Eine konstante Schicht bleibt liegen (Diplomarbeit, Abb. 5.1)',
    roof: 'Ein Sandhaufen zwischen zwei Kanten (Aggarwal u. a. 2023)',
    thickness: 'Höhe', velocity_x: 'Geschwindigkeit', standing_layer: 'stehende Schicht', rolling_layer: 'rollende Schicht',
    at_rest: 'in Ruhe', trickle: 'in Ruhe bis auf ein Rinnsal', steady: 'stationär', end_time: 'Ende der Zeit erreicht', all_steps: 'alle Schritte getan',
  },
}
