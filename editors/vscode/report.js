// Runs the compiler for a report. Nothing here needs the editor, so that tests run it as it is.
'use strict';
const { spawn } = require('node:child_process');
const fs = require('node:fs/promises');
const os = require('node:os');
const path = require('node:path');

// What a report may do in the editor: its own inline scripts and styles, pictures in its text, no network.
const POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:";

// Compiles `job` into a folder that is removed again. Resolves to the exit code, what the program printed, and the text
// of the report where it wrote one: it does also when a contract fails. Rejects when the program cannot be started
// (`code` is then ENOENT or EACCES), and when `signal` ends it (`name` is then AbortError).
async function makeReport({ program, library = [], job, signal }) {
  const folder = await fs.mkdtemp(path.join(os.tmpdir(), 'impellerc-'));
  try {
    const name = path.basename(job, '.imp');
    const report = path.join(folder, `${name}.html`);
    const words = ['report', job, '-o', report, ...library];
    const { code, printed } = await run(program, words, { cwd: path.dirname(job), signal });
    const html = await fs.readFile(report, 'utf8').catch((error) => {
      if (error.code !== 'ENOENT') throw error;
    });
    return { code, printed, html };
  } finally {
    await fs.rm(folder, { recursive: true, force: true });
  }
}

// Runs the program to its end, also when it was told to stop: a file that it still writes cannot be removed everywhere.
function run(program, words, options) {
  return new Promise((resolve, reject) => {
    const child = spawn(program, words, { ...options, stdio: ['ignore', 'pipe', 'pipe'] });
    let printed = '';
    let failure;
    for (const stream of [child.stdout, child.stderr]) {
      stream.setEncoding('utf8').on('data', (text) => (printed += text));
    }
    child.on('error', (error) => {
      failure = error;
      // A program that was never started does not end.
      if (child.pid === undefined) reject(error);
    });
    child.on('close', (code) => (failure ? reject(failure) : resolve({ code, printed })));
  });
}

// The report with the policy that the editor asks for, in the colours of the editor.
function forEditor(html, dark) {
  const policy = `<meta http-equiv="Content-Security-Policy" content="${POLICY}">`;
  return html
    .replace(/<html[^>]*>/, (tag) => tag.replace('>', ` data-theme="${dark ? 'dark' : 'light'}">`))
    .replace(/<head>/, (tag) => tag + policy);
}

module.exports = { makeReport, forEditor, run };
