// Bundles the extension into one file, and puts its licences and those of what it bundles into another.
'use strict';
const esbuild = require('esbuild');
const fs = require('node:fs');
const path = require('node:path');

process.chdir(__dirname);
const built = esbuild.buildSync({
  entryPoints: ['extension.js'],
  outfile: 'dist/extension.js',
  bundle: true,
  minify: true,
  platform: 'node',
  target: 'node20',
  // The editor itself provides this module.
  external: ['vscode'],
  metafile: true,
  logLevel: 'warning',
});

const packages = new Set();
for (const input of Object.keys(built.metafile.inputs)) {
  const found = /^(?:.*\/)?node_modules\/(?:@[^/]+\/)?[^/]+/.exec(input);
  if (found) packages.add(found[0]);
}
const root = path.join('..', '..');
const texts = ['LICENSE', 'LICENSE-MIT', 'LICENSE-APACHE'].map((name) => fs.readFileSync(path.join(root, name), 'utf8'));
for (const folder of [...packages].sort()) {
  const file = fs.readdirSync(folder).find((name) => /^licen[cs]e/i.test(name));
  if (!file) throw new Error(`${folder} has no licence text`);
  texts.push(`The file dist/extension.js contains ${path.basename(folder)}:\n\n${fs.readFileSync(path.join(folder, file), 'utf8')}`);
}
fs.writeFileSync('LICENSE.txt', texts.map((text) => text.trim()).join('\n\n----\n\n') + '\n');
