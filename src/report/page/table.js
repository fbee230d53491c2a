// Tables that sort by any column: the header of each is a button, and aria-sort says what holds.
import { element, numberText } from './dom.js';

/** Numbers by size, text by its letters and the numbers in it; what is missing comes last in either direction. */
function compare(a, b, sign) {
  const missing = (value) => value === null || value === undefined || Number.isNaN(value);
  if (missing(a) || missing(b)) return missing(a) - missing(b);
  if (typeof a === 'number' && typeof b === 'number') return sign * (a - b);
  return sign * String(a).localeCompare(String(b), undefined, { numeric: true });
}

function cell(value, isNumber) {
  if (value instanceof Node) return element('td', {}, value);
  return element('td', isNumber ? { class: 'number', title: value } : {}, numberText(value));
}

/** `columns`: names; `rows`: lists of string, number, null, or an element (which does not sort). */
export function sortableTable({ id, title, columns, rows }) {
  const order = rows.map((_, index) => index);
  const body = element('tbody');
  const isNumber = columns.map((_, column) => rows.some((row) => typeof row[column] === 'number'));
  const lines = rows.map((row) =>
    element(
      'tr',
      {},
      row.map((value, column) => cell(value, isNumber[column])),
    ),
  );
  const fill = () => body.replaceChildren(...order.map((index) => lines[index]));
  const headers = columns.map((name, column) => {
    if (!name) return element('th', { scope: 'col' }, element('span', {}, ''));
    const button = element('button', { type: 'button', click: () => sortBy(column) }, name);
    return element('th', { scope: 'col', 'aria-sort': 'none', class: isNumber[column] && 'number' }, button);
  });
  const sortBy = (column) => {
    const up = headers[column].getAttribute('aria-sort') !== 'ascending';
    order.sort((a, b) => compare(rows[a][column], rows[b][column], up ? 1 : -1) || a - b);
    for (const header of headers) if (header.hasAttribute('aria-sort')) header.setAttribute('aria-sort', 'none');
    headers[column].setAttribute('aria-sort', up ? 'ascending' : 'descending');
    fill();
  };
  fill();
  const table = element(
    'table',
    {},
    element('caption', {}, title),
    element('thead', {}, element('tr', {}, headers)),
    body,
  );
  // A region that scrolls must be reachable by keyboard.
  return element(
    'div',
    { class: 'scroll', id: `table-${id}`, tabindex: 0, role: 'region', 'aria-label': title },
    table,
  );
}
