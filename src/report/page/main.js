// Builds the page from the report that write_html_report() has put into it.
import { drawChart } from './chart.js';
import { commandBlock, element, numberText } from './dom.js';
import { heatMap } from './heat_map.js';
import { sortableTable } from './table.js';
import { makeViewer } from './viewer.js';

/** Any JSON as nested lists that fold. */
function tree(value) {
  if (value === null || typeof value !== 'object') return element('span', {}, numberText(value));
  const entries = Object.entries(value);
  if (Array.isArray(value) && value.every((entry) => entry === null || typeof entry !== 'object')) {
    return element('span', {}, `[${value.map(numberText).join(', ')}]`);
  }
  const isPlain = ([, entry]) =>
    entry === null || typeof entry !== 'object' || (Array.isArray(entry) && entry.every((e) => typeof e !== 'object'));
  const plain = entries.filter(isPlain),
    nested = entries.filter((entry) => !isPlain(entry));
  return element(
    'div',
    {},
    plain.length > 0 &&
      element(
        'dl',
        {},
        plain.flatMap(([key, entry]) => [element('dt', {}, key), element('dd', {}, tree(entry))]),
      ),
    nested.map(([key, entry]) => element('details', {}, element('summary', {}, key), tree(entry))),
  );
}

function section(id, title, ...content) {
  document.querySelector('#contents').append(element('a', { href: `#${id}` }, title));
  document
    .querySelector('#content')
    .append(element('section', { id, 'aria-label': title }, element('h2', {}, title), ...content));
}

async function build() {
  const report = JSON.parse(document.querySelector('#report').textContent);
  document.querySelector('#title').textContent = report.title;
  if (report.summary?.length > 0)
    section(
      'summary',
      'Summary',
      element(
        'ul',
        { class: 'summary' },
        report.summary.map((line) => element('li', {}, line)),
      ),
    );
  if (report.viewer) section('viewer', 'Viewer', await makeViewer(report.viewer));
  if (report.charts?.length > 0)
    section('charts', 'Charts', element('div', { class: 'grid' }, report.charts.map(drawChart)));
  if (report.heat_maps?.length > 0)
    section('heat_maps', 'Heat maps', element('div', { class: 'grid' }, report.heat_maps.map(heatMap)));
  if (report.tables?.length > 0)
    section(
      'tables',
      'Tables',
      report.tables.flatMap((table) => [sortableTable(table), element('br')]),
    );
  if (report.command)
    section('reproduce', 'Reproduce', element('p', {}, 'This page was made by'), commandBlock(report.command));
  if (report.settings) section('settings', 'Settings', tree(report.settings));
  if (report.machine) section('environment', 'Environment', tree({ taut: report.version, ...report.machine }));
  document.querySelector('#footer').textContent =
    `Taut ${report.version ?? ''}. Charts drawn with uPlot, the mesh with three.js; their licences are in this file.`;
}

build().then(
  () => {
    document.documentElement.dataset.ready = 'true';
  },
  (error) => {
    document
      .querySelector('#content')
      .prepend(element('p', { role: 'alert' }, `The page could not be built: ${error.message}`));
    throw error;
  },
);
