// Charts: uPlot gives axes, scales and zoom; points are drawn here, because a method's points need not ascend in x.
import uPlot from 'uplot';
import { commandBlock, element, numberText, onColourScheme, styleColour } from './dom.js';

// The same as in the static SVG beside the page, and lighter ones for a dark page.
const colours = {
  light: ['#721f7f', '#d1453f', '#2a788e', '#b07d00', '#3b528b', '#555555', '#1f8a4c', '#b0307a', '#7a5230', '#007fa3'],
  dark: ['#d58ae0', '#ff8a80', '#5cc4dd', '#f0c04a', '#93a8f0', '#bbbbbb', '#6fd39a', '#f48fc6', '#d0a67a', '#4fc3f7'],
};
const isDark = () => matchMedia('(prefers-color-scheme: dark)').matches;
const colour = (index) => {
  const list = isDark() ? colours.dark : colours.light;
  return list[index % list.length];
};
const usable = (value, log) => Number.isFinite(value) && (!log || value > 0);

/** The range of all values with some room around them. */
function rangeOf(values, log) {
  const good = values.filter((value) => usable(value, log));
  if (good.length === 0) return log ? [0.1, 10] : [0, 1];
  let low = Math.min(...good),
    high = Math.max(...good);
  if (log) return low === high ? [low / 3, high * 3] : [low / (high / low) ** 0.06, high * (high / low) ** 0.06];
  const room = 0.06 * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

/** Marks of a logarithmic axis: powers of ten; 1, 2 and 5 over two decades or fewer; even steps within one. */
function logTicks(low, high) {
  const ticks = [];
  if (high < 10 * low) {
    const raw = (high - low) / 5,
      power = 10 ** Math.floor(Math.log10(raw)),
      step = [1, 2, 5, 10].find((factor) => raw <= factor * power) * power;
    for (let i = Math.ceil(low / step); i * step <= high; ++i) ticks.push(i * step);
    return ticks;
  }
  const first = Math.floor(Math.log10(low)),
    last = Math.ceil(Math.log10(high)),
    every = Math.max(1, Math.ceil((last - first) / 8));
  for (let power = first; power <= last; power += every) {
    for (const factor of last - first <= 2 ? [1, 2, 5] : [1]) ticks.push(factor * 10 ** power);
  }
  return ticks.filter((tick) => tick >= low && tick <= high);
}

function describe(chart, { series, point }) {
  const y = point.y === null || point.y === undefined ? 'no value' : numberText(point.y);
  return [series.name, point.label, `${chart.x.label} ${numberText(point.x)}`, `${chart.y.label} ${y}`, point.status]
    .filter(Boolean)
    .join(' · ');
}

export function drawChart(chart) {
  const logX = Boolean(chart.x.log),
    logY = Boolean(chart.y.log);
  const shown = chart.series.map(() => true);
  const every = chart.series.flatMap((series, index) => series.points.map((point) => ({ series, index, point })));
  const front = chart.front ?? [];
  const fullX = rangeOf([...every.map(({ point }) => point.x), ...front.map(([x]) => x)], logX);
  const fullY = rangeOf([...every.map(({ point }) => point.y), ...front.map(([, y]) => y)], logY);
  let viewX = fullX,
    viewY = fullY,
    chosen = null;

  // A value that the axis cannot show stands at its edge: none or infinite at the top, zero on a logarithmic axis at
  // the bottom.
  const placeX = (u, x) => (usable(x, logX) ? u.valToPos(x, 'x', true) : u.bbox.left);
  const placeY = (u, y) => {
    if (usable(y, logY)) return u.valToPos(y, 'y', true);
    return y <= 0 && y !== null ? u.bbox.top + u.bbox.height : u.bbox.top;
  };

  function draw(u) {
    const { ctx } = u,
      ratio = devicePixelRatio || 1;
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left - 8 * ratio, u.bbox.top - 8 * ratio, u.bbox.width + 16 * ratio, u.bbox.height + 16 * ratio);
    ctx.clip();
    const path = (points) => {
      ctx.beginPath();
      points.forEach(([x, y], i) =>
        i ? ctx.lineTo(placeX(u, x), placeY(u, y)) : ctx.moveTo(placeX(u, x), placeY(u, y)),
      );
      ctx.stroke();
    };
    if (front.length > 0) {
      Object.assign(ctx, { strokeStyle: styleColour('faint'), lineWidth: 1.5 * ratio });
      ctx.setLineDash([6 * ratio, 5 * ratio]);
      path(front);
      ctx.setLineDash([]);
    }
    let drawn = 0;
    chart.series.forEach((series, index) => {
      if (!shown[index]) return;
      Object.assign(ctx, { strokeStyle: colour(index), fillStyle: colour(index), lineWidth: 1.6 * ratio });
      if (series.line) path(series.points.filter((point) => usable(point.x, logX)).map((point) => [point.x, point.y]));
      const radius = (series.points.length > 60 ? 2 : 4) * ratio;
      for (const point of series.points) {
        ctx.beginPath();
        ctx.arc(placeX(u, point.x), placeY(u, point.y), radius, 0, 2 * Math.PI);
        const hollow = point.status && point.status !== 'solved';
        ctx.fillStyle = hollow ? styleColour('raised') : colour(index);
        ctx.fill();
        ctx.stroke();
        ++drawn;
      }
    });
    if (chosen) {
      ctx.beginPath();
      ctx.arc(placeX(u, chosen.point.x), placeY(u, chosen.point.y), 8 * ratio, 0, 2 * Math.PI);
      Object.assign(ctx, { strokeStyle: styleColour('text'), lineWidth: 2 * ratio });
      ctx.stroke();
    }
    ctx.restore();
    figure.dataset.points = drawn;
  }

  const holder = element('div', {
    class: 'plot',
    tabindex: 0,
    role: 'group',
    'aria-label': `${chart.title}: arrow keys go from point to point`,
  });
  const readout = element(
    'div',
    { class: 'readout', 'aria-live': 'polite' },
    element(
      'span',
      { class: 'faint' },
      'Point at a mark, or use the arrow keys. Drag to zoom, double-click to see all.',
    ),
  );
  const legend = element('div', { class: 'legend' });
  const figure = element(
    'figure',
    { id: `chart-${chart.id}` },
    element('h3', {}, chart.title),
    legend,
    holder,
    readout,
    element(
      'figcaption',
      {},
      element('a', { href: `${chart.id}.svg` }, 'SVG'),
      front.length > 0 ? ' · dashed: Pareto front' : '',
      every.some(({ point }) => point.status && point.status !== 'solved') ? ' · hollow: not solved' : '',
    ),
  );

  const axis = ({ label, log }, size) => ({
    label,
    size,
    stroke: () => styleColour('faint'),
    ticks: { stroke: () => styleColour('rule'), width: 1 },
    grid: { stroke: () => styleColour('rule'), width: 1 },
    values: (u, ticks) => ticks.map(numberText),
    ...(log && { splits: (u, index, low, high) => logTicks(low, high), filter: (u, ticks) => ticks }),
  });
  const scale = (log, view) => ({ time: false, distr: log ? 3 : 1, range: () => view() });
  const options = {
    width: 560,
    height: 340,
    legend: { show: false },
    scales: { x: scale(logX, () => viewX), y: scale(logY, () => viewY) },
    axes: [axis(chart.x, 44), axis(chart.y, 60)],
    series: [{}, { show: true, points: { show: false }, stroke: 'transparent' }],
    cursor: { points: { show: false }, drag: { x: true, y: true, uni: 20, setScale: false } },
    hooks: { draw: [draw], setSelect: [zoom] },
  };
  // uPlot wants ascending data; two corners serve to give it scales.
  const plot = new uPlot(options, [fullX, fullY], holder);

  const redraw = () => plot.setData([viewX, viewY]);
  function zoom(u) {
    const { left, top, width, height } = u.select;
    if (width < 5 || height < 5) return;
    viewX = [u.posToVal(left, 'x'), u.posToVal(left + width, 'x')];
    viewY = [u.posToVal(top + height, 'y'), u.posToVal(top, 'y')];
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    redraw();
  }
  plot.over.addEventListener('dblclick', () => {
    viewX = fullX;
    viewY = fullY;
    redraw();
  });

  const visible = () => every.filter(({ index }) => shown[index]);
  function choose(entry) {
    if (!entry || entry === chosen) return;
    chosen = entry;
    readout.replaceChildren(
      element('span', {}, describe(chart, entry)),
      ...(entry.point.command ? [commandBlock(entry.point.command)] : []),
    );
    plot.redraw(false);
  }
  plot.over.addEventListener('mousemove', (event) => {
    const ratio = devicePixelRatio || 1,
      box = plot.over.getBoundingClientRect();
    const x = (event.clientX - box.left) * ratio + plot.bbox.left,
      y = (event.clientY - box.top) * ratio + plot.bbox.top;
    let nearest = null,
      least = (20 * ratio) ** 2;
    for (const entry of visible()) {
      const distance = (placeX(plot, entry.point.x) - x) ** 2 + (placeY(plot, entry.point.y) - y) ** 2;
      if (distance < least) [nearest, least] = [entry, distance];
    }
    choose(nearest);
  });
  holder.addEventListener('keydown', (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const list = visible();
    if (!step || list.length === 0) return;
    event.preventDefault();
    const at = list.indexOf(chosen);
    choose(list[at < 0 ? 0 : (at + step + list.length) % list.length]);
  });

  chart.series.forEach((series, index) => {
    const swatch = element('span', { class: 'swatch' });
    const paint = () => {
      swatch.style.background = colour(index);
    };
    const toggle = () => {
      shown[index] = !shown[index];
      button.setAttribute('aria-pressed', shown[index]);
      plot.redraw(false);
    };
    const button = element('button', { type: 'button', 'aria-pressed': 'true', click: toggle }, swatch, series.name);
    paint();
    onColourScheme(paint);
    legend.append(button);
  });
  onColourScheme(() => plot.redraw(false, true));
  new ResizeObserver(() => {
    const width = Math.floor(holder.clientWidth);
    if (width > 0 && width !== plot.width) plot.setSize({ width, height: options.height });
  }).observe(holder);
  return figure;
}
