// The extension: starts the language service of impellerc, and shows the report of a job beside its text.
'use strict';
const path = require('node:path');
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');
const { makeReport, forEditor, run } = require('./report');

// What the program printed for reports.
let output;
let client;
// Starting and stopping come one after the other.
let turn = Promise.resolve();
// The panel of each job, by its address.
const panels = new Map();

function setting(name) {
  return vscode.workspace.getConfiguration('impellerc').get(name);
}

function program() {
  return setting('path') || 'impellerc';
}

// The folder of the library, as arguments of the program; none where the setting is empty.
function library() {
  return setting('library') ? ['--library', setting('library')] : [];
}

// Texts that the service knows: jobs, files of a library, and NC text with its source map beside it.
const TEXTS = [
  { scheme: 'file', language: 'impeller' },
  { scheme: 'file', pattern: '**/{machines,tools,posts}/*.toml' },
  { scheme: 'file', pattern: '**/*.{nc,ngc,mpf,spf,tap}' },
];

// Says why the program does not start, and offers the setting that names it.
async function tellNotStarted(error) {
  const why = error.code === 'ENOENT' ? 'was not found' : `cannot be started (${error.message})`;
  const open = 'Open Setting';
  const message = `The program "${program()}" ${why}. Install impellerc, or give its path in the setting impellerc.path.`;
  if ((await vscode.window.showErrorMessage(message, open)) === open) {
    // The program runs where the files are: in a remote window the setting is one of the remote machine.
    const page = vscode.env.remoteName ? 'openRemoteSettings' : 'openSettings';
    await vscode.commands.executeCommand(`workbench.action.${page}`, { query: 'impellerc.path' });
  }
}

async function start() {
  const command = program();
  try {
    // The client would only say that a connection broke.
    await run(command, ['--version'], {});
  } catch (error) {
    // Who waits for the answer would keep the next start waiting.
    void tellNotStarted(error);
    return;
  }
  const server = { command, args: ['lsp', ...library()] };
  const options = {
    documentSelector: TEXTS,
    initializationOptions: { verifyOnSave: setting('verifyOnSave') !== false },
  };
  client = new LanguageClient('impellerc', 'impellerc', server, options);
  await client.start();
}

async function stop() {
  const stopped = client;
  client = undefined;
  await stopped?.stop();
}

function inTurn(...steps) {
  for (const step of steps) {
    turn = turn.then(step).catch((error) => output.appendLine(String(error)));
  }
  return turn;
}

async function showReport() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== 'impeller' || document.uri.scheme !== 'file') {
    void vscode.window.showErrorMessage('Open a job (a file *.imp on the disk) to show its report.');
    return;
  }
  // The compiler reads the file on the disk.
  if (document.isDirty && !(await document.save())) return;
  const job = document.uri.fsPath;
  const title = path.basename(job, '.imp');
  let made;
  try {
    made = await vscode.window.withProgress(
      { location: vscode.ProgressLocation.Notification, title: `impellerc: plans and verifies ${title}`, cancellable: true },
      (_, cancelled) => {
        const ending = new AbortController();
        cancelled.onCancellationRequested(() => ending.abort());
        return makeReport({ program: program(), library: library(), job, signal: ending.signal });
      },
    );
  } catch (error) {
    if (error.name !== 'AbortError') await tellNotStarted(error);
    return;
  }
  output.clear();
  output.append(made.printed);
  if (made.html) show(document.uri, title, made.html);
  if (made.code !== 0) await tellFailure(title, made);
}

async function tellFailure(title, { code, html }) {
  const open = 'Show Output';
  const answer = html
    ? await vscode.window.showWarningMessage(`${title}: the program ended with code ${code}; the report says what fails.`, open)
    : await vscode.window.showErrorMessage(`${title}: no report, the program ended with code ${code}.`, open);
  if (answer === open) output.show(true);
}

function show(uri, title, html) {
  const key = uri.toString();
  let panel = panels.get(key);
  if (!panel) {
    const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
    // A hidden report keeps its view: it takes seconds to build.
    const options = { enableScripts: true, retainContextWhenHidden: true, localResourceRoots: [] };
    panel = vscode.window.createWebviewPanel('impellerc.report', `Report ${title}`, place, options);
    panel.onDidDispose(() => panels.delete(key));
    panels.set(key, panel);
  }
  const { kind } = vscode.window.activeColorTheme;
  const dark = kind === vscode.ColorThemeKind.Dark || kind === vscode.ColorThemeKind.HighContrast;
  panel.webview.html = forEditor(html, dark);
  panel.reveal(undefined, true);
}

exports.activate = async (context) => {
  output = vscode.window.createOutputChannel('impellerc report');
  context.subscriptions.push(
    output,
    vscode.commands.registerCommand('impellerc.showReport', showReport),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration('impellerc')) inTurn(stop, start);
    }),
  );
  await inTurn(start);
};

exports.deactivate = () => inTurn(stop);
