// The TextMate grammar, by the engine of the editor: scopes of a few lines, and all jobs of the repository.
'use strict';
const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const test = require('node:test');
const oniguruma = require('vscode-oniguruma');
const textmate = require('vscode-textmate');

const FILE = path.join(__dirname, '..', 'syntaxes', 'impeller.tmLanguage.json');
const JOBS = path.join(__dirname, '..', '..', '..', 'jobs');

async function grammar() {
  const engine = path.join(path.dirname(require.resolve('vscode-oniguruma')), 'onig.wasm');
  await oniguruma.loadWASM(fs.readFileSync(engine));
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(fs.readFileSync(FILE, 'utf8'), FILE),
  });
  return registry.loadGrammar('source.impeller');
}
const loaded = grammar();

// Pieces of a text that are not blank, with their innermost scope and their line.
async function pieces(text) {
  const rules = await loaded;
  let state = textmate.INITIAL;
  return text.split('\n').flatMap((line, number) => {
    const found = rules.tokenizeLine(line, state);
    state = found.ruleStack;
    return found.tokens
      .map(({ startIndex, endIndex, scopes }) => ({ text: line.slice(startIndex, endIndex).trim(), scope: scopes.at(-1), line: number + 1 }))
      .filter((piece) => piece.text !== '');
  });
}

// `word:scope` of each piece, with the scope cut to what tells it apart.
async function said(text) {
  const short = {
    'keyword.control.item.impeller': 'item',
    'support.type.property-name.impeller': 'property',
    'support.constant.property-value.impeller': 'value',
    'variable.parameter.label.impeller': 'label',
    'entity.name.type.block.impeller': 'block',
    'constant.numeric.impeller': 'number',
    'keyword.other.unit.impeller': 'unit',
    'invalid.illegal.unit.impeller': 'no-unit',
    'keyword.other.curve.impeller': 'curve',
    'keyword.other.scope.impeller': 'scope',
    'string.quoted.double.impeller': 'text',
    'comment.line.double-slash.impeller': 'comment',
    'keyword.operator.arithmetic.impeller': 'sign',
    'support.function.operation.impeller': 'operation',
    'entity.name.function.operation.impeller': 'name',
    'variable.other.constant.impeller': 'name',
    'entity.name.type.tool.impeller': 'name',
    'support.type.tool.impeller': 'cutter',
  };
  return (await pieces(text))
    .filter((piece) => !/^(punctuation|keyword\.operator\.(assignment|relation))/.test(piece.scope))
    .map((piece) => `${piece.text}:${short[piece.scope] ?? piece.scope}`)
    .join(' ');
}

const lines = [
  ['a number with its unit, glued or not', 'let a = 2.5e-1 mm/min + 3mm', 'let:item a:name 2.5e-1:number mm/min:unit +:sign 3:number mm:unit'],
  ['letters behind a number that are no unit', 'let a = 2inch', 'let:item a:name 2:number inch:no-unit'],
  ['a comment to the end of the line', 'post fanuc // not { this', 'post:item fanuc:support.type.impeller // not { this:comment'],
  [
    'properties and their values',
    'operation flank first { tool t1  speed 8000 rpm, 9000 rpm  faces pressure, suction  method two-point }',
    'operation:item flank:operation first:name tool:property t1:value speed:property 8000:number rpm:unit ' +
      '9000:number rpm:unit faces:property pressure:value suction:value method:property two-point:value',
  ],
  [
    'labels before numbers, names and signs',
    'stock turned { allowance vane gap, hub 0.5 mm .. top  over shroud -1 mm  edge elliptic 2 }',
    'stock:item turned:support.type.impeller allowance:property vane:label gap:value hub:label 0.5:number mm:unit ..:sign top:value ' +
      'over:property shroud:label -:sign 1:number mm:unit edge:property elliptic:label 2:number',
  ],
  [
    'a value on the line behind its property',
    'operation rough {\n  tool // this one\n    t1\n  depth\n    2 * step\n}',
    'operation:item rough:operation tool:property // this one:comment t1:value depth:property 2:number *:sign step:value',
  ],
  [
    'curves',
    'part p {\n  hub revolve main.pressure.root\n  vane main { tip spline from "a.csv" curve up mm  root spline [(1, -r) (2, 3)] mm }\n}',
    'part:item p:entity.name.type.part.impeller hub:property revolve:curve main.pressure.root:value vane:property main:block tip:property ' +
      'spline:curve from:curve "a.csv":text curve:curve up:value mm:unit root:property spline:curve 1:number -:sign r:value 2:number 3:number mm:unit',
  ],
  [
    'contracts',
    'require clearance holder >= 2 mm on flank, operation hub outside of slots\nallow excess on fillet "by hand"',
    'require:item clearance:property holder:property 2:number mm:unit on:scope flank:value operation:scope hub:value outside:scope of:scope ' +
      'slots:value allow:item excess:property on:scope fillet:value "by hand":text',
  ],
  [
    'the item behind a block that is not closed',
    'part p {\n  vane main {\n    tip spline [(1, 2)\ntool t1 = ball { reach 3 mm }',
    'part:item p:entity.name.type.part.impeller vane:property main:block tip:property spline:curve 1:number 2:number ' +
      'tool:item t1:name ball:cutter reach:property 3:number mm:unit',
  ],
];
for (const [what, text, due] of lines) {
  test(`colours: ${what}`, async () => assert.equal(await said(text), due));
}

test('colours: every word and number of every job has a scope of its own', async () => {
  const files = fs.readdirSync(JOBS).filter((folder) => !folder.startsWith('_'))
    .flatMap((folder) => fs.readdirSync(path.join(JOBS, folder)).map((name) => path.join(JOBS, folder, name)))
    .filter((file) => file.endsWith('.imp'));
  assert.ok(files.length >= 20, `only ${files.length} jobs`);
  for (const file of files) {
    const text = fs.readFileSync(file, 'utf8');
    const plain = (await pieces(text)).filter((piece) => /^(source|meta)\./.test(piece.scope) || piece.scope.startsWith('invalid'));
    assert.deepEqual(plain, [], file);
    // A word that begins a line outside of brackets is an item, and nothing else is.
    const heads = (await pieces(text)).filter((piece) => piece.scope === 'keyword.control.item.impeller').map((piece) => `${piece.line} ${piece.text}`);
    const due = text.split('\n').flatMap((line, at) => (/^[a-z]/.test(line) ? [`${at + 1} ${/^\w+/.exec(line)}`] : []));
    assert.deepEqual(heads, due, file);
  }
});
