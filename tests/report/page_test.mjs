// node page_test.mjs TAUT, in the folder that holds node_modules: reports of real runs in a headless Chromium. Exits with
// 77 where there is no Chromium.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';

const chromiumPath = ['chromium', 'chromium-browser', 'google-chrome'].find(
  (name) => spawnSync(name, ['--version']).status === 0,
);
if (!chromiumPath) {
  console.log('skipped: there is no Chromium here; apt-get install chromium');
  process.exit(77);
}
const { chromium } = createRequire(join(process.cwd(), 'node_modules', 'index.js'))('playwright-core');
const program = process.argv[2],
  folder = mkdtempSync(join(tmpdir(), 'taut_page_'));
const small = ['--set', 'bodies.cloth.mesh.grid.cells=[8,8]', '--quiet'];
execFileSync(
  program,
  [
    'solve',
    'hanging_cloth',
    '--set',
    'time.steps=20',
    ...small.slice(0, 2),
    '--report',
    join(folder, 'solve'),
    '--quiet',
  ],
  { stdio: 'pipe' },
);
execFileSync(
  program,
  [
    'compare',
    'hanging_cloth',
    '--solvers',
    'augmented_lagrangian,multiplier_loop',
    '--steps',
    '3',
    ...small,
    '--report',
    join(folder, 'compare'),
  ],
  { stdio: 'pipe' },
);

const executablePath = execFileSync('which', [chromiumPath], { encoding: 'utf8' }).trim();
const browser = await chromium.launch({
  executablePath,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
after(async () => {
  await browser.close();
  rmSync(folder, { recursive: true });
});

/** The report as the page holds it. */
const reportOf = (name) =>
  JSON.parse(
    readFileSync(join(folder, name, 'index.html'), 'utf8').match(
      /<script type="application\/json" id="report">(.*?)<\/script>/s,
    )[1],
  );

/** Opens a report, lets `look` look at it, and fails for any error on the console and any request to a network. */
async function open(name, look, { init, ...options } = {}) {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 }, ...options });
  const complaints = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(request.url());
  });
  if (init) await page.addInitScript(init);
  await page.goto(`file://${join(folder, name, 'index.html')}`);
  await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 20000 });
  await look(page);
  // Chromium itself remarks on reading pixels back from a software renderer.
  assert.deepEqual(
    complaints.filter((text) => !text.includes('GPU stall due to ReadPixels')),
    [],
  );
  await page.close();
}

/** Of a PNG, the share of pixels unlike the one in the corner, and the number of colours. */
const pixelsOf = (page, png) =>
  page.evaluate(
    async (source) => {
      const image = new Image();
      image.src = source;
      await image.decode();
      const canvas = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height });
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      const pixels = new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
      const corner = pixels[20 * image.width + 20]; // inside the rounded corner
      return {
        drawn: pixels.filter((pixel) => pixel !== corner).length / pixels.length,
        colours: new Set(pixels).size,
      };
    },
    `data:image/png;base64,${png.toString('base64')}`,
  );

const mesh = (page) => page.locator('#viewer canvas');

test('a report has its title, its sections and its command', () =>
  open('solve', async (page) => {
    assert.equal(await page.title(), 'hanging_cloth');
    assert.deepEqual(await page.locator('nav a').allTextContents(), [
      'Summary',
      'Viewer',
      'Charts',
      'Tables',
      'Reproduce',
      'Settings',
      'Environment',
    ]);
    assert.match(
      await page.locator('#reproduce pre').textContent(),
      /^taut solve hanging_cloth .*'bodies\.cloth\.mesh\.grid\.cells=\[8,8\]'/,
    );
  }));

test('every chart draws all of its points', () =>
  open('solve', async (page) => {
    const { charts } = reportOf('solve');
    assert.ok(charts.length >= 4);
    for (const { id, series } of charts) {
      const expected = series.reduce((sum, { points }) => sum + points.length, 0);
      assert.equal(await page.locator(`#chart-${id}`).getAttribute('data-points'), String(expected), id);
      const { drawn, colours } = await pixelsOf(page, await page.locator(`#chart-${id} .plot`).screenshot());
      assert.ok(drawn > 0.01 && colours > series.length, `${id}: ${drawn} of the pixels, ${colours} colours`);
    }
  }));

test('a chart goes from point to point by keyboard and hides a series', () =>
  open('solve', async (page) => {
    const figure = page.locator('#chart-residuals');
    await figure.locator('.plot').focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    assert.match(await figure.locator('.readout').textContent(), /stationarity · step 2 · .* · solved/);
    await figure.getByRole('button', { name: 'feasibility' }).click();
    assert.equal(await figure.getByRole('button', { name: 'feasibility' }).getAttribute('aria-pressed'), 'false');
    assert.equal(await figure.getAttribute('data-points'), '40');
  }));

test('the mouse finds a point of a chart', () =>
  open('solve', async (page) => {
    const over = page.locator('#chart-residuals .u-over');
    const { width, height } = await over.boundingBox();
    for (
      let y = 0;
      y < height && !/step \d/.test(await page.locator('#chart-residuals .readout').textContent());
      y += 15
    ) {
      await over.hover({ position: { x: width / 2, y } });
    }
    assert.match(await page.locator('#chart-residuals .readout').textContent(), /step \d+/);
  }));

test('the viewer shows the mesh, in each frame another one', () =>
  open('solve', async (page) => {
    const last = await mesh(page).screenshot();
    const { drawn, colours } = await pixelsOf(page, last);
    assert.ok(drawn > 0.03 && drawn < 0.9, `${drawn} of the pixels are drawn`);
    assert.ok(colours > 100, `${colours} colours`);
    await page.locator('#viewer input[type=range]').fill('0');
    assert.equal(await mesh(page).getAttribute('data-frame'), '0');
    assert.ok(!last.equals(await mesh(page).screenshot()));
  }));

test('the viewer plays, and changes its colours with their legend', () =>
  open('solve', async (page) => {
    const before = await mesh(page).screenshot();
    await page.locator('#viewer select').selectOption('layer');
    assert.ok(!before.equals(await mesh(page).screenshot()));
    assert.match(await page.locator('.viewer').textContent(), /cloth/);
    await page.getByRole('button', { name: 'Play' }).click();
    await page.waitForFunction(() => document.querySelector('#viewer canvas').dataset.frame === '3');
    await page.getByRole('button', { name: 'Pause' }).click();
  }));

test('the mesh is turned, zoomed and stepped by keyboard', () =>
  open('solve', async (page) => {
    await mesh(page).focus();
    let before = await mesh(page).screenshot();
    for (const key of ['ArrowLeft', 'ArrowUp', '+', 'r']) {
      await page.keyboard.press(key);
      const now = await mesh(page).screenshot();
      assert.ok(!before.equals(now), key);
      before = now;
    }
    const last = Number(await mesh(page).getAttribute('data-frame'));
    await page.keyboard.press(',');
    assert.equal(await mesh(page).getAttribute('data-frame'), String(last - 1));
  }));

test('a click on the mesh names the triangle and its values', () =>
  open('solve', async (page) => {
    await mesh(page).click();
    assert.match(
      await page.locator('#viewer .readout').textContent(),
      /^triangle \d+ of cloth · largest singular value 1\.\d+/,
    );
  }));

test('a worst element of the table is shown in its frame', () =>
  open('solve', async (page) => {
    const { worst } = reportOf('solve').viewer;
    const before = await mesh(page).screenshot();
    await page.locator('#table-worst tbody button').first().press('Enter');
    assert.equal(await mesh(page).getAttribute('data-frame'), String(worst[0].frame));
    assert.ok(!before.equals(await mesh(page).screenshot()));
    assert.match(await page.locator('#viewer .readout').textContent(), /^triangle \d+ of cloth/);
  }));

test('a table sorts in both directions, by keyboard too', () =>
  open('solve', async (page) => {
    const header = page.locator('#table-steps th', { hasText: 'stationarity' });
    const values = async () =>
      await page
        .locator('#table-steps tbody td:nth-child(4)')
        .evaluateAll((cells) => cells.map((cell) => Number(cell.title)));
    const original = await values();
    assert.equal(original.length, 20);
    await header.getByRole('button').click();
    assert.equal(await header.getAttribute('aria-sort'), 'ascending');
    assert.deepEqual(
      await values(),
      [...original].sort((a, b) => a - b),
    );
    await header.getByRole('button').press('Enter');
    assert.equal(await header.getAttribute('aria-sort'), 'descending');
    assert.deepEqual(
      await values(),
      [...original].sort((a, b) => b - a),
    );
  }));

test('a dark system gets a dark page, also while it is open', () =>
  open(
    'solve',
    async (page) => {
      const brightness = () =>
        page.evaluate(() =>
          Math.max(...getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).map(Number)),
        );
      assert.ok((await brightness()) < 60);
      const dark = await page.locator('#chart-residuals canvas').screenshot();
      await page.emulateMedia({ colorScheme: 'light' });
      assert.ok((await brightness()) > 200);
      assert.ok(!dark.equals(await page.locator('#chart-residuals canvas').screenshot()));
    },
    { colorScheme: 'dark' },
  ));

test('without WebGL the last picture of the run is shown, with a sentence', () =>
  open(
    'solve',
    async (page) => {
      assert.match(await page.locator('#viewer').textContent(), /no WebGL/);
      assert.ok(
        await page.locator('#viewer img').evaluate(async (image) => {
          await image.decode();
          return image.naturalWidth > 100;
        }),
      );
    },
    {
      init: () => {
        const original = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
          return kind.startsWith('webgl') ? null : original.call(this, kind, ...rest);
        };
      },
    },
  ));

test('a comparison maps every step of every solver and says how to repeat it', () =>
  open('compare', async (page) => {
    const cells = page.locator('figure.heat td button');
    assert.equal(await cells.count(), 6);
    await cells.first().click();
    assert.match(
      await page.locator('figure.heat pre').textContent(),
      /^taut compare .*hanging_cloth.json --solvers augmented_lagrangian /,
    );
    assert.equal(await page.locator('[id^=chart-error]').getAttribute('data-points'), '2');
    assert.equal(await page.locator('[id^=chart-accuracy]').getAttribute('data-points'), '2');
    assert.equal(await page.locator('[id^=table-entries] tbody tr').count(), 2);
  }));

test('a comparison shows the mesh of the reference and where another solver ends elsewhere', () =>
  open('compare', async (page) => {
    assert.match(await page.locator('#viewer').textContent(), /hanging_cloth as augmented_lagrangian solved it/);
    assert.equal(await mesh(page).getAttribute('data-frame'), '3');
    const stretch = await mesh(page).screenshot();
    const { drawn } = await pixelsOf(page, stretch);
    assert.ok(drawn > 0.03, `${drawn} of the pixels are drawn`);
    await page.locator('#viewer select').selectOption({ label: 'distance to multiplier_loop' });
    assert.ok(!stretch.equals(await mesh(page).screenshot()), 'another colour');
  }));
