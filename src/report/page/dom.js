// Small things that every part of the page needs.

/** An element with attributes (functions become listeners) and children (strings become text). */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === 'function') made.addEventListener(key, value);
    else if (value === true) made.setAttribute(key, '');
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...children.flat().filter((child) => child != null && child !== false));
  return made;
}

/** A number for a person: five digits, an exponent and three where it is very large or small. */
export function numberText(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (typeof value !== 'number') return String(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return String(value);
  const size = Math.abs(value);
  const text =
    size < 1e-3 || size >= 1e6 ? value.toExponential(2).replace(/\.?0+e/, 'e') : String(Number(value.toPrecision(5)));
  return text.replace('e+', 'e');
}

/** A command, with a button that copies it. */
export function commandBlock(command) {
  const text = element('pre', { tabindex: 0, 'aria-label': 'Command' }, command);
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(command);
      button.textContent = 'Copied';
    } catch {
      // the browser forbids it to some pages from a file
      getSelection().selectAllChildren(text);
      button.textContent = 'Selected: copy with Ctrl+C';
    }
  };
  const button = element('button', { type: 'button', class: 'copy', click: copy }, 'Copy');
  return element('div', {}, text, button);
}

/** Colours that the style sheet gives, as they are now: they follow dark mode. */
export const styleColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Calls back whenever the system changes between light and dark. */
export const onColourScheme = (callback) =>
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', callback);
