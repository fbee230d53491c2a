// Heat maps: methods down, values of a knob across, an outcome in each cell. A sign says it as well as the colour.
import { commandBlock, element } from './dom.js';

const outcomes = {
  solved: ['✓', 'solved'],
  honest_failure: ['○', 'not solved, and says so'],
  false_success: ['✗', 'says solved, is not'],
  crash: ['!', 'crash'],
  timeout: ['…', 'out of time'],
  not_applicable: ['–', 'does not apply'],
};

export function heatMap({ id, title, knob, values, methods, cells }) {
  const readout = element('div', { class: 'readout', 'aria-live': 'polite' });
  const show = (method, value, { outcome, text, command }) =>
    readout.replaceChildren(
      element('p', {}, `${method}, ${knob} ${value}: ${outcomes[outcome]?.[1] ?? outcome}. ${text ?? ''}`),
      ...(command ? [commandBlock(command)] : []),
    );
  const button = (method, value, given) =>
    element(
      'button',
      {
        type: 'button',
        'data-outcome': given.outcome,
        title: given.text,
        'aria-label': `${method}, ${knob} ${value}: ${outcomes[given.outcome]?.[1] ?? given.outcome}`,
        click: () => show(method, value, given),
      },
      outcomes[given.outcome]?.[0] ?? '?',
    );

  const head = element(
    'tr',
    {},
    element('th', { scope: 'col' }, knob),
    values.map((value) => element('th', { scope: 'col' }, value)),
  );
  const rows = methods.map((method, i) =>
    element(
      'tr',
      {},
      element('th', { scope: 'row' }, method),
      values.map((value, j) => element('td', {}, button(method, value, cells[i][j]))),
    ),
  );
  const present = new Set(cells.flat().map((given) => given.outcome));
  const legend = element(
    'p',
    { class: 'faint' },
    Object.entries(outcomes)
      .filter(([outcome]) => present.has(outcome))
      .map(([, [sign, meaning]]) => `${sign} ${meaning}`)
      .join(' · '),
  );
  return element(
    'figure',
    { id: `heat-${id}`, class: 'heat' },
    element('h3', {}, title),
    element(
      'div',
      { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': title },
      element('table', {}, element('thead', {}, head), element('tbody', {}, rows)),
    ),
    legend,
    readout,
    element('figcaption', {}, element('a', { href: `${id}.svg` }, 'SVG')),
  );
}
