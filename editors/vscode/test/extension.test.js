// The bundled extension, with an editor that only notes what is asked of it. The language client is not started here: it needs
// the whole editor.
'use strict';
const assert = require('node:assert/strict');
const fs = require('node:fs');
const Module = require('node:module');
const os = require('node:os');
const path = require('node:path');
const test = require('node:test');

const SMALL = path.join(__dirname, '..', '..', '..', 'jobs', 'small');
const BUNDLE = path.join(__dirname, '..', 'dist', 'extension.js');

// An editor with `document` open, whose setting names a program that is not there, and whose user answers every message with
// `answer`.
function editor({ document, answer }) {
  const noted = { messages: [], commands: [], panels: [], output: '', saved: 0 };
  const setting = { path: 'no-such-program' };
  const registered = {};
  const say = async (message, ...buttons) => {
    noted.messages.push(message);
    return buttons.find((button) => button === answer);
  };
  const known = {
    workspace: {
      getConfiguration: () => ({ get: (name) => setting[name] }),
      onDidChangeConfiguration: () => ({}),
    },
    window: {
      activeTextEditor: document && { document: { ...document, save: async () => ((noted.saved += 1), true) } },
      activeColorTheme: { kind: 2 },
      showErrorMessage: say,
      showWarningMessage: say,
      createOutputChannel: () => ({
        append: (text) => (noted.output += text),
        appendLine: (line) => noted.messages.push(line),
        clear: () => (noted.output = ''),
        show: () => noted.commands.push('output'),
      }),
      withProgress: (_, task) => task({}, { onCancellationRequested() {} }),
      createWebviewPanel: (...words) => {
        const panel = { webview: {}, onDidDispose() {}, reveal() {} };
        noted.panels.push({ words, panel });
        return panel;
      },
    },
    commands: {
      registerCommand: (name, run) => ((registered[name] = run), {}),
      executeCommand: async (...words) => void noted.commands.push(words),
    },
    env: {},
    ViewColumn: { Beside: -2 },
    ProgressLocation: { Notification: 15 },
    ColorThemeKind: { Dark: 2, HighContrast: 3 },
  };
  // The client derives classes from those of the editor when it is loaded.
  const vscode = new Proxy(known, { get: (target, name) => target[name] ?? class {} });
  const load = Module._load;
  Module._load = (name, ...rest) => (name === 'vscode' ? vscode : load(name, ...rest));
  try {
    delete require.cache[BUNDLE];
    return { extension: require(BUNDLE), registered, noted, setting };
  } finally {
    Module._load = load;
  }
}

const MISSING = 'The program "no-such-program" was not found. Install impellerc, or give its path in the setting impellerc.path.';

test('extension: a program that is not there is told at the start, with a button to the setting', async () => {
  const { extension, noted } = editor({ answer: 'Open Setting' });
  await extension.activate({ subscriptions: [] });
  await new Promise(setImmediate);
  assert.deepEqual(noted.messages, [MISSING]);
  assert.deepEqual(noted.commands, [['workbench.action.openSettings', { query: 'impellerc.path' }]]);
  await extension.deactivate();
});

test('extension: the command saves the job and shows its report beside it, and once more in the same panel', { timeout: 120_000 }, async (context) => {
  const text = fs.readFileSync(path.join(SMALL, 'small.imp'), 'utf8');
  // Few seconds are enough for one operation.
  const quick = text.replace(/operation (flank|channel) \{[^}]*\}\n/g, '').replace(/tool t2 .*\n/, '');
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'a job-'));
  context.after(() => fs.rmSync(folder, { recursive: true, force: true }));
  fs.copyFileSync(path.join(SMALL, 'vane_curves.csv'), path.join(folder, 'vane_curves.csv'));
  const job = path.join(folder, 'wheel.imp');
  const document = { languageId: 'impeller', isDirty: true, uri: { scheme: 'file', fsPath: job } };

  const { extension, registered, noted, setting } = editor({ document, answer: 'Show Output' });
  await extension.activate({ subscriptions: [] });
  noted.messages.length = 0;
  setting.path = process.env.IMPELLERC ?? 'impellerc';

  fs.writeFileSync(job, quick);
  await registered['impellerc.showReport']();
  assert.deepEqual(noted.messages, []);
  assert.equal(noted.saved, 1);
  const [{ words, panel }] = noted.panels;
  assert.deepEqual(words.slice(1, 3), ['Report wheel', { viewColumn: -2, preserveFocus: true }]);
  assert.match(panel.webview.html, /data-theme="dark"/);

  // A contract that fails has a report too.
  panel.webview.html = '';
  fs.writeFileSync(job, `${quick}\nrequire time <= 1 s\n`);
  await registered['impellerc.showReport']();
  assert.equal(noted.panels.length, 1);
  assert.match(panel.webview.html, /fails/);
  assert.deepEqual(noted.messages, ['wheel: the program ended with code 1; the report says what fails.']);

  // A fault has none; the report that is shown stays, and what the program printed is a button away.
  noted.messages.length = 0;
  noted.commands.length = 0;
  const shown = panel.webview.html;
  fs.writeFileSync(job, quick.replace('feed 150', 'fed 150'));
  await registered['impellerc.showReport']();
  assert.deepEqual(noted.messages, ['wheel: no report, the program ended with code 2.']);
  assert.deepEqual(noted.commands, ['output']);
  assert.match(noted.output, /`fed`/);
  assert.equal(panel.webview.html, shown);
});
