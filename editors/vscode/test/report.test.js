// The part of the extension that runs the compiler, with the real program.
'use strict';
const assert = require('node:assert/strict');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const test = require('node:test');
const { makeReport, forEditor } = require('../report');

const program = process.env.IMPELLERC ?? 'impellerc';
const SMALL = path.join(__dirname, '..', '..', '..', 'jobs', 'small');

// A folder with a job; the extension's own folder lies in it too, so that what is left there is seen.
function folderWith(context, text) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'a job-'));
  fs.copyFileSync(path.join(SMALL, 'vane_curves.csv'), path.join(folder, 'vane_curves.csv'));
  const job = path.join(folder, 'wheel.imp');
  fs.writeFileSync(job, text);
  const before = process.env.TMPDIR;
  process.env.TMPDIR = folder;
  context.after(() => {
    if (before === undefined) delete process.env.TMPDIR;
    else process.env.TMPDIR = before;
    fs.rmSync(folder, { recursive: true, force: true });
  });
  return { job, left: () => fs.readdirSync(folder).sort() };
}

// The small job with its first operation alone, which takes few seconds.
function quickJob() {
  return fs.readFileSync(path.join(SMALL, 'small.imp'), 'utf8').replace(/operation (flank|channel) \{[^}]*\}\n/g, '').replace(/tool t2 .*\n/, '');
}

test('report: a job gives a report, which the editor shows with scripts and without a network', { timeout: 120_000 }, async (context) => {
  const { job, left } = folderWith(context, quickJob());
  const { code, printed, html } = await makeReport({ program, job });
  assert.equal(code, 0, printed);
  assert.match(html, /<title>wheel|<title>small/);
  assert.match(html, /webgl2/);
  assert.deepEqual(left(), ['vane_curves.csv', 'wheel.imp']);

  const shown = forEditor(html, true);
  assert.match(shown, /^<!DOCTYPE html>\s*<html[^>]* data-theme="dark">\s*<head><meta http-equiv="Content-Security-Policy"/);
  // Nothing in the report needs more than the policy allows.
  assert.doesNotMatch(shown, /<(script|img|iframe|video|object|embed)\b[^>]*\bsrc=["']?(?!data:)|<link\b/);
  assert.equal(shown.length - forEditor(html, false).length, 'dark'.length - 'light'.length);
});

test('report: a job with a fault gives none, but says why', { timeout: 60_000 }, async (context) => {
  const { job, left } = folderWith(context, quickJob().replace('feed 150', 'fed 150'));
  const { code, printed, html } = await makeReport({ program, job });
  assert.equal(code, 2);
  assert.equal(html, undefined);
  assert.match(printed, /`fed`/);
  assert.deepEqual(left(), ['vane_curves.csv', 'wheel.imp']);
});

test('report: who cancels waits no longer, and nothing is left', { timeout: 60_000 }, async (context) => {
  const { job, left } = folderWith(context, fs.readFileSync(path.join(SMALL, 'small.imp'), 'utf8'));
  const ending = new AbortController();
  const made = makeReport({ program, job, signal: ending.signal });
  setTimeout(() => ending.abort(), 500);
  const start = Date.now();
  await assert.rejects(made, { name: 'AbortError' });
  assert.ok(Date.now() - start < 5000, `${Date.now() - start} ms`);
  assert.deepEqual(left(), ['vane_curves.csv', 'wheel.imp']);
});

test('report: a program that is not there is told apart', async (context) => {
  const { job, left } = folderWith(context, quickJob());
  await assert.rejects(makeReport({ program: 'no-such-program', job }), { code: 'ENOENT' });
  assert.deepEqual(left(), ['vane_curves.csv', 'wheel.imp']);
});
