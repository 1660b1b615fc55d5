// `impellerc lsp`, by the messages that Visual Studio Code sends, in the order in which it sends them.
'use strict';
const assert = require('node:assert/strict');
const { spawn } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const test = require('node:test');
const { pathToFileURL } = require('node:url');
const protocol = require('vscode-languageserver-protocol/node');

const PROGRAM = process.env.IMPELLERC ?? 'impellerc';
const JOBS = path.join(__dirname, '..', '..', '..', 'jobs');

// What the editor says of itself, as far as the service could ask for it.
const CAPABILITIES = {
  workspace: {
    applyEdit: true,
    workspaceEdit: { documentChanges: true, failureHandling: 'textOnlyTransactional' },
    configuration: true,
    didChangeConfiguration: { dynamicRegistration: true },
    didChangeWatchedFiles: { dynamicRegistration: true, relativePatternSupport: true },
    workspaceFolders: true,
    diagnostics: { refreshSupport: true },
  },
  textDocument: {
    publishDiagnostics: { relatedInformation: true, versionSupport: false, tagSupport: { valueSet: [1, 2] }, codeDescriptionSupport: true, dataSupport: true },
    synchronization: { dynamicRegistration: true, willSave: true, willSaveWaitUntil: true, didSave: true },
    completion: {
      dynamicRegistration: true,
      contextSupport: true,
      completionItem: { snippetSupport: true, commitCharactersSupport: true, documentationFormat: ['markdown', 'plaintext'], insertReplaceSupport: true },
      insertTextMode: 2,
      completionList: { itemDefaults: ['commitCharacters', 'editRange', 'insertTextFormat', 'insertTextMode', 'data'] },
    },
    hover: { dynamicRegistration: true, contentFormat: ['markdown', 'plaintext'] },
    definition: { dynamicRegistration: true, linkSupport: true },
    documentSymbol: { dynamicRegistration: true, hierarchicalDocumentSymbolSupport: true },
    codeAction: { dynamicRegistration: true, isPreferredSupport: true, dataSupport: true, codeActionLiteralSupport: { codeActionKind: { valueSet: ['', 'quickfix'] } } },
    formatting: { dynamicRegistration: true },
    foldingRange: { dynamicRegistration: true, rangeLimit: 5000, lineFoldingOnly: true },
    diagnostic: { dynamicRegistration: true, relatedDocumentSupport: false },
  },
  window: { showMessage: { messageActionItem: { additionalPropertiesSupport: true } }, showDocument: { support: true }, workDoneProgress: true },
  general: {
    staleRequestSupport: { cancel: true, retryOnContentModified: [] },
    regularExpressions: { engine: 'ECMAScript', version: 'ES2020' },
    markdown: { parser: 'marked', version: '1.1.0' },
    positionEncodings: ['utf-16'],
  },
};

// The place of a word in a text; columns are counted in units of UTF-16, as strings of JavaScript are.
function placeOf(text, word, offset = 0) {
  const at = text.indexOf(word) + offset;
  assert.ok(at >= offset, `no ${word}`);
  const before = text.slice(0, at).split('\n');
  return { line: before.length - 1, character: before.at(-1).length };
}

function rangeOf(text, word) {
  return { start: placeOf(text, word), end: placeOf(text, word, word.length) };
}

function applied(text, edits) {
  const byte = ({ line, character }) => text.split('\n').slice(0, line).reduce((sum, l) => sum + l.length + 1, 0) + character;
  return [...edits].sort((a, b) => byte(b.range.start) - byte(a.range.start))
    .reduce((sum, { range, newText }) => sum.slice(0, byte(range.start)) + newText + sum.slice(byte(range.end)), text);
}

test('service: a job in the manner of Visual Studio Code', { timeout: 60_000 }, async (whole) => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'impellerc lsp-'));
  whole.after(() => fs.rmSync(folder, { recursive: true, force: true }));
  fs.copyFileSync(path.join(JOBS, 'small', 'vane_curves.csv'), path.join(folder, 'vane_curves.csv'));
  const good = fs.readFileSync(path.join(JOBS, 'small', 'small.imp'), 'utf8');
  let text = good.replace('feed 150 mm/min', 'fed 150 mm/min');
  assert.notEqual(text, good);
  const file = path.join(folder, 'a job.imp');
  fs.writeFileSync(file, text);
  const uri = pathToFileURL(file).href;

  const child = spawn(PROGRAM, ['lsp'], { stdio: ['pipe', 'pipe', 'inherit'] });
  whole.after(() => child.kill());
  const ended = new Promise((resolve, reject) => child.on('exit', resolve).on('error', reject));
  ended.catch(() => {});
  const connection = protocol.createProtocolConnection(
    new protocol.StreamMessageReader(child.stdout), new protocol.StreamMessageWriter(child.stdin));
  const published = [];
  let wake = () => {};
  connection.onNotification('textDocument/publishDiagnostics', (params) => {
    published.push(params);
    wake();
  });
  connection.listen();
  // The first publication that fits, of those that came or will come.
  async function publication(what, fits) {
    for (;;) {
      const found = published.find(fits);
      if (found) return found;
      const came = await Promise.race([new Promise((resolve) => (wake = () => resolve(true))), new Promise((resolve) => setTimeout(resolve, 20_000).unref())]);
      assert.ok(came, `no publication: ${what}; last ${JSON.stringify(published.at(-1))}`);
    }
  }
  let version = 1;
  const change = (range, words) => {
    version += 1;
    text = applied(text, [{ range, newText: words }]);
    return connection.sendNotification('textDocument/didChange', { textDocument: { uri, version }, contentChanges: [{ range, text: words }] });
  };
  const at = (word, offset) => ({ textDocument: { uri }, position: placeOf(text, word, offset) });

  await whole.test('service: initialize', async () => {
    const { capabilities, serverInfo } = await connection.sendRequest('initialize', {
      processId: process.pid,
      clientInfo: { name: 'Visual Studio Code', version: '1.100.0' },
      locale: 'en',
      rootUri: pathToFileURL(folder).href,
      workspaceFolders: [{ uri: pathToFileURL(folder).href, name: 'jobs' }],
      capabilities: CAPABILITIES,
      trace: 'off',
    });
    assert.equal(serverInfo.name, 'impellerc');
    assert.ok(capabilities.completionProvider && capabilities.hoverProvider && capabilities.documentFormattingProvider);
    await connection.sendNotification('initialized', {});
    await connection.sendNotification('workspace/didChangeConfiguration', { settings: null });
  });

  await whole.test('service: a fault is at its place when a job is opened', async () => {
    await connection.sendNotification('textDocument/didOpen', { textDocument: { uri, languageId: 'impeller', version, text } });
    const { diagnostics } = await publication('opened', (p) => p.uri === uri);
    const fault = diagnostics.find((d) => d.message.includes('`fed`'));
    assert.ok(fault, JSON.stringify(diagnostics));
    assert.deepEqual(fault.range, rangeOf(text, 'fed'));
    assert.equal(fault.severity, 1);
    assert.match(fault.code, /^IMP\d{4}$/);
    assert.equal(fault.source, 'impellerc');
  });

  await whole.test('service: the quick fix writes the word that was meant', async () => {
    const range = rangeOf(text, 'fed');
    const context = { diagnostics: published.at(-1).diagnostics, triggerKind: 2 };
    const actions = await connection.sendRequest('textDocument/codeAction', { textDocument: { uri }, range, context });
    const fixes = actions.filter((action) => action.kind === 'quickfix').map((action) => applied(text, action.edit.changes[uri]));
    assert.ok(fixes.includes(good), JSON.stringify(actions));
  });

  await whole.test('service: hover explains the fault', async () => {
    const { contents, range } = await connection.sendRequest('textDocument/hover', at('fed', 1));
    assert.match(contents.value, /^\*\*IMP\d{4}: /);
    assert.deepEqual(range, rangeOf(text, 'fed'));
  });

  await whole.test('service: an edit removes the fault', async () => {
    await change(rangeOf(text, 'fed'), 'feed');
    assert.equal(text, good);
    const { diagnostics } = await publication('edited', (p) => p.version === version);
    assert.deepEqual(diagnostics.filter((d) => d.severity === 1), []);
  });

  await whole.test('service: completion of a property, a value, a unit and a tool', async () => {
    for (const [word, offset, due] of [['strips', 2, 'strips'], ['two-point', 2, 'two-point'], ['mm/min', 4, 'mm/min'], ['tool t2  speed', 6, 't2']]) {
      const found = await connection.sendRequest('textDocument/completion', { ...at(word, offset), context: { triggerKind: 1 } });
      const items = Array.isArray(found) ? found : found.items;
      assert.ok(items.some((item) => item.label === due), `${word}: ${items.map((item) => item.label)}`);
    }
  });

  await whole.test('service: hover and definition of a tool', async () => {
    const { contents } = await connection.sendRequest('textDocument/hover', at('tool t2  speed', 6));
    assert.match(contents.value, /tool t2 = ball/);
    const found = await connection.sendRequest('textDocument/definition', at('tool t2  speed', 6));
    assert.deepEqual((Array.isArray(found) ? found[0] : found).range.start, placeOf(text, 'tool t2 = ball', 5));
  });

  await whole.test('service: format gives a displaced line its indentation back', async () => {
    await change({ start: placeOf(text, 'vanes 8'), end: placeOf(text, 'vanes 8') }, '       ');
    const options = { tabSize: 2, insertSpaces: true };
    const edits = await connection.sendRequest('textDocument/formatting', { textDocument: { uri }, options });
    assert.equal(applied(text, edits), good);
  });

  await whole.test('service: columns are counted in units of UTF-16', async () => {
    await change(rangeOf(text, '"carbide"'), '"\u{1f600}"');
    const { diagnostics } = await publication('emoji', (p) => p.version === version);
    const fault = diagnostics.find((d) => d.message.includes('\u{1f600}'));
    assert.deepEqual(fault?.range, rangeOf(text, '\u{1f600}'), JSON.stringify(diagnostics));
  });

  await whole.test('service: what is asked in vain is refused, and the service goes on', async () => {
    await assert.rejects(connection.sendRequest('textDocument/rename', { ...at('vanes'), newName: 'x' }));
    await connection.sendNotification('$/setTrace', { value: 'off' });
    const symbols = await connection.sendRequest('textDocument/documentSymbol', { textDocument: { uri } });
    assert.ok(symbols.some((symbol) => symbol.name === 'operation flank'));
  });

  await whole.test('service: closed files have no faults, and the service ends in order', async () => {
    const before = published.length;
    await connection.sendNotification('textDocument/didClose', { textDocument: { uri } });
    assert.equal(await connection.sendRequest('shutdown'), null);
    assert.deepEqual(published.slice(before).at(-1)?.diagnostics, []);
    await connection.sendNotification('exit');
    assert.equal(await ended, 0);
  });
});
