// Bundles the page into one HTML text and writes it as a C++ source file or as HTML:
//   node bundle.mjs SOURCE_FOLDER OUT.cpp|OUT.html
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const [, , source, out] = process.argv;
if (!out) {
  console.error('usage: node bundle.mjs SOURCE_FOLDER OUT.cpp|OUT.html');
  process.exit(2);
}

const shared = {
  bundle: true,
  minify: true,
  write: false,
  logLevel: 'warning',
  // In a build, the sources are in a different folder than the packages.
  nodePaths: [join(dirname(fileURLToPath(import.meta.url)), 'node_modules')],
};
const script = await build({
  ...shared,
  entryPoints: [join(source, 'main.js')],
  format: 'iife',
  target: 'es2021',
  legalComments: 'inline',
});
const style = await build({ ...shared, entryPoints: [join(source, 'style.css')] });

// A script element ends at the first "</script", even inside a string.
const code = script.outputFiles[0].text.replaceAll('</script', '<\\/script');
const page = readFileSync(join(source, 'page.html'), 'utf8')
  .replace('/*krok-style*/', () => style.outputFiles[0].text.trim())
  .replace('/*krok-script*/', () => code.trim());
if (page.split('<!--krok-data-->').length !== 2) {
  throw new Error('page.html must contain the data marker exactly once');
}

// Bytes outside printable ASCII as three octal digits, which cannot merge with the next character.
function literal(bytes) {
  let text = '';
  for (const byte of bytes) {
    if (byte === 0x22 || byte === 0x5c || byte === 0x3f) text += '\\' + String.fromCharCode(byte);
    else if (byte >= 0x20 && byte < 0x7f) text += String.fromCharCode(byte);
    else text += '\\' + byte.toString(8).padStart(3, '0');
  }
  return `    "${text}"`;
}

if (out.endsWith('.html')) {
  writeFileSync(out, page);
} else {
  const bytes = Buffer.from(page, 'utf8');
  const lines = [];
  for (let at = 0; at < bytes.length; at += 4000) lines.push(literal(bytes.subarray(at, at + 4000)));
  writeFileSync(
    out,
    `#include "draw/page_text_internal.h"

namespace krok::draw {

namespace {

constexpr char kText[] =
${lines.join('\n')};

}  // namespace

std::string_view page_text() { return {kText, sizeof(kText) - 1}; }

}  // namespace krok::draw
`,
  );
}
