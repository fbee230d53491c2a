// node build.mjs OUTPUT: bundles the page into one HTML file with the marks @TITLE@ and @REPORT@ left to fill in.
// It is run from the folder that holds node_modules, which need not be this one.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const sources = dirname(fileURLToPath(import.meta.url));
const modules = join(process.cwd(), 'node_modules');
const { build } = createRequire(join(modules, 'index.js'))('esbuild');

const bundle = async (entry) => {
  const result = await build({
    entryPoints: [join(sources, entry)],
    bundle: true,
    minify: true,
    write: false,
    charset: 'utf8',
    target: 'es2022',
    format: 'iife',
    legalComments: 'inline',
    nodePaths: [modules],
    loader: { '.css': 'css' },
    logLevel: 'warning',
  });
  return result.outputFiles[0].text.trim();
};

// A literal closing tag inside the bundle would end it early.
const script = (await bundle('main.js')).replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
const style = await bundle('style.css');
const licence = (name) => `${name}\n${readFileSync(join(modules, name, 'LICENSE'), 'utf8').trim()}`;
const page = readFileSync(join(sources, 'index.html'), 'utf8')
  .replace('@LICENCES@', () => ['three', 'uplot'].map(licence).join('\n\n'))
  .replace('/*@STYLE@*/', () => style)
  .replace('/*@SCRIPT@*/', () => script);
writeFileSync(process.argv[2], page);
