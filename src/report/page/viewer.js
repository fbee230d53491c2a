// The viewer: the scene in three dimensions with its controls, legend and list of worst elements.
import { category, css, gradient, missing, scaleColour } from './colours.js';
import { element, numberText, onColourScheme } from './dom.js';
import { RunData, unpackText } from './run_data.js';
import { Scene3D } from './scene3d.js';
import { sortableTable } from './table.js';

const playSeconds = 4; // for all frames, but no faster than 25 a second

export async function makeViewer(data) {
  const run = await RunData.read(data);
  const hasWebGL = document.createElement('canvas').getContext('webgl2') !== null;
  const content = hasWebGL ? controlled(run) : [await fallback(data)];
  return element('div', {}, content, element('p', { class: 'faint' }, run.note));
}

/** Without WebGL: the run's last picture, as it is in its folder. */
async function fallback({ picture }) {
  const sentence = element(
    'p',
    { role: 'status' },
    picture
      ? 'This browser offers no WebGL, which the viewer needs; here is the last picture of the run instead.'
      : 'This browser offers no WebGL, which the viewer needs, and the run drew no picture.',
  );
  if (!picture) return sentence;
  const url = URL.createObjectURL(new Blob([await unpackText(picture)], { type: 'image/svg+xml' }));
  return element(
    'div',
    { class: 'viewer' },
    element('img', { src: url, alt: 'The last picture of the run' }),
    sentence,
  );
}

function controlled(run) {
  const canvas = element('canvas', {
    tabindex: 0,
    role: 'img',
    'aria-label':
      'The mesh. Arrow keys turn it, plus and minus zoom, space plays, ' +
      'comma and full stop go from frame to frame, R resets the view.',
  });
  const scene = new Scene3D(canvas, run);
  let frame = run.frames.length - 1,
    field = run.fields[0] ?? null,
    chosen = -1,
    timer = null;
  const readout = element(
    'p',
    { class: 'readout', 'aria-live': 'polite' },
    element('span', { class: 'faint' }, 'Click a triangle for its values.'),
  );
  const legend = element('div', { 'aria-live': 'polite' });

  const slider = element('input', {
    type: 'range',
    min: 0,
    max: run.frames.length - 1,
    value: frame,
    'aria-label': 'Frame',
    input: () => show(Number(slider.value)),
  });
  const label = element('output', {});
  const play = element('button', { type: 'button', click: () => (timer ? pause() : start()) }, 'Play');
  const colours = element('select', { change: recolour }, [
    ...run.fields.map(({ id, title }) => element('option', { value: id }, title)),
    element('option', { value: 'layer' }, 'layer'),
  ]);
  const edges = element('input', {
    type: 'checkbox',
    checked: scene.edges.visible,
    change: () => {
      scene.edges.visible = edges.checked;
      scene.draw();
    },
  });
  const save = () => {
    scene.draw(); // the browser keeps the picture only until the next frame
    element('a', { href: canvas.toDataURL('image/png'), download: 'viewer.png' }).click();
  };

  function pause() {
    clearInterval(timer);
    timer = null;
    play.textContent = 'Play';
  }
  function start() {
    timer = setInterval(
      () => show((frame + 1) % run.frames.length),
      Math.max(40, (1000 * playSeconds) / run.frames.length),
    );
    play.textContent = 'Pause';
  }
  function colourOf(triangle) {
    if (!field) return category(run.layerOf(triangle));
    const value = run.value(field, frame, triangle);
    return Number.isNaN(value) ? missing : scaleColour((value - field.low) / (field.high - field.low || 1));
  }
  function recolour() {
    field = run.fields.find(({ id }) => id === colours.value) ?? null;
    legend.replaceChildren(...legendOf(run, field));
    scene.paint(colourOf);
    scene.draw();
  }
  function show(next) {
    frame = next;
    const { step, time } = run.frames[frame];
    slider.value = frame;
    label.textContent = `step ${step}, ${numberText(time)} ${run.time_unit}`;
    slider.setAttribute('aria-valuetext', label.textContent);
    canvas.dataset.frame = frame;
    scene.showFrame(frame);
    scene.paint(colourOf);
    scene.draw();
    if (chosen >= 0) describe();
  }
  function describe() {
    const values = run.fields.map(
      (one) => `${one.title} ${numberText(run.value(one, frame, chosen))}${one.unit ? ` ${one.unit}` : ''}`,
    );
    readout.textContent = [run.triangleName(chosen), ...values].join(' · ');
  }
  function choose(triangle) {
    chosen = triangle;
    scene.mark(triangle < 0 ? [] : [triangle]);
    if (triangle < 0) readout.textContent = '';
    else describe();
    scene.draw();
  }
  function goTo(worst) {
    pause();
    if (run.fields.some(({ id }) => id === worst.field)) {
      colours.value = worst.field;
      field = run.fields.find(({ id }) => id === worst.field);
      legend.replaceChildren(...legendOf(run, field));
    }
    chosen = worst.triangles[0];
    scene.marked = null;
    show(worst.frame);
    scene.mark(worst.triangles);
    scene.lookAtMarked();
    canvas.scrollIntoView({ block: 'center' });
    canvas.focus({ preventScroll: true });
  }

  let pressed = null;
  canvas.addEventListener('pointerdown', (event) => {
    pressed = [event.offsetX, event.offsetY];
  });
  canvas.addEventListener('pointerup', (event) => {
    // a click, not the end of a turn
    if (pressed && Math.hypot(event.offsetX - pressed[0], event.offsetY - pressed[1]) < 4)
      choose(scene.pick(event.offsetX, event.offsetY));
    pressed = null;
  });
  const keys = {
    ArrowLeft: () => scene.turn(-0.15, 0),
    ArrowRight: () => scene.turn(0.15, 0),
    ArrowUp: () => scene.turn(0, -0.15),
    ArrowDown: () => scene.turn(0, 0.15),
    '+': () => scene.turn(0, 0, 0.85),
    '=': () => scene.turn(0, 0, 0.85),
    '-': () => scene.turn(0, 0, 1 / 0.85),
    ' ': () => (timer ? pause() : start()),
    ',': () => show(Math.max(frame - 1, 0)),
    '.': () => show(Math.min(frame + 1, run.frames.length - 1)),
    r: () => scene.resetView(),
    Escape: () => choose(-1),
  };
  canvas.addEventListener('keydown', (event) => {
    const action = keys[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  });
  onColourScheme(() => scene.draw());

  recolour();
  show(frame);
  const rows = run.worst.map((worst) => [
    worst.what,
    worst.element,
    worst.value,
    worst.unit,
    run.frames[worst.frame].step,
    element(
      'button',
      { type: 'button', 'aria-label': `Show ${worst.element}, ${worst.what}`, click: () => goTo(worst) },
      'Show',
    ),
  ]);
  return [
    element('div', { class: 'viewer' }, canvas, element('div', {}, element('label', {}, 'Colour ', colours), legend)),
    element(
      'div',
      { class: 'controls' },
      play,
      slider,
      label,
      element('label', {}, edges, ' edges'),
      element('button', { type: 'button', click: () => scene.resetView() }, 'Reset view'),
      element('button', { type: 'button', click: save }, 'Save PNG'),
    ),
    readout,
    rows.length > 0 &&
      sortableTable({
        id: 'worst',
        title: 'Worst elements',
        columns: ['what', 'element', 'value', 'unit', 'step', ''],
        rows,
      }),
  ].filter(Boolean);
}

function legendOf(run, field) {
  if (!field) {
    return [
      element(
        'ul',
        { class: 'summary' },
        run.layers.map(({ name }, i) => {
          const swatch = element('span', { class: 'swatch' });
          swatch.style.background = css(category(i));
          return element('li', {}, swatch, name);
        }),
      ),
    ];
  }
  const bar = element('div', { class: 'bar' });
  bar.style.background = gradient;
  const ticks = [4, 3, 2, 1, 0].map((i) =>
    element('span', {}, numberText(field.low + ((field.high - field.low) * i) / 4)),
  );
  return [
    element('p', {}, `${field.title}${field.unit ? `, ${field.unit}` : ''}`),
    element('div', { class: 'scale' }, bar, element('div', { class: 'ticks' }, ticks)),
    element(
      'p',
      { class: 'faint' },
      `from ${numberText(field.least)} to ${numberText(field.most)} in these frames; grey: no value`,
    ),
  ];
}
