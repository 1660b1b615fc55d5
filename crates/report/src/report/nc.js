// The NC text beside the picture: a window of its lines, and the way from a line to its move and back.
const LINE_HEIGHT = 18;
/** Tallest list in pixels that every browser scrolls; a longer text scrolls by more lines to the pixel. */
const TALLEST = 8e6;
const program = { bytes: new Uint8Array(0), starts: [], count: 0, runs: [], line: 0, window: '' };

async function loadProgram() {
  program.bytes = new Uint8Array(await inflated('nc-text'));
  const starts = [0], { bytes: text } = program;
  for (let at = text.indexOf(10); at >= 0; at = text.indexOf(10, at + 1)) starts.push(at + 1);
  if (starts[starts.length - 1] < text.length) starts.push(text.length);
  program.starts = starts;
  program.count = starts.length - 1;
  // Runs of consecutive lines with consecutive moves, by line.
  data.paths.operations.forEach((o, operation) => {
    const last = o.count ? moveIndex(o.first + o.count - 1) : -1;
    o.lines.forEach(([index, line], k) => {
      const end = k + 1 < o.lines.length ? o.lines[k + 1][0] : last + 1;
      program.runs.push({ line, operation, index, count: end - index });
    });
  });
  program.runs.sort((a, b) => a.line - b.line);
  if (!program.count) $('nc-lines').textContent = 'The page holds no NC text.';
  $('nc-lines').style.height = `${Math.min(program.count * LINE_HEIGHT, TALLEST)}px`;
  hints();
}

const decoder = new TextDecoder();
/** Text of a line, from 1. */
function lineText(line) {
  return decoder.decode(program.bytes.subarray(program.starts[line - 1], program.starts[line])).replace(/\r?\n$/, '');
}

/** Operation and move of a line; of a line that moves nothing those of the last one before it. */
function blockOf(line) {
  let low = 0, high = program.runs.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (program.runs[middle].line <= line) low = middle + 1; else high = middle;
  }
  // Of runs that begin with the same line, a subprogram, the first call counts.
  const first = low ? program.runs.findIndex(r => r.line === program.runs[low - 1].line) : 0;
  const run = program.runs[first];
  if (!run) return null;
  const past = line - run.line;
  return { operation: run.operation, index: run.index + Math.min(Math.max(past, 0), run.count - 1), moves: past >= 0 && past < run.count };
}

/** First line in the window, and number of lines in it. */
function windowOfLines() {
  const box = $('nc'), shown = Math.ceil(box.clientHeight / LINE_HEIGHT);
  const way = Math.max($('nc-lines').offsetHeight - box.clientHeight, 1), most = Math.max(program.count * LINE_HEIGHT - box.clientHeight, 0);
  return { top: box.scrollTop / way * most, way, most, shown };
}

/** Draws the lines in the window. */
function drawProgram() {
  if (!program.count) return;
  const { top, shown } = windowOfLines(), first = Math.floor(top / LINE_HEIGHT), shift = $('nc').scrollTop - top;
  const window = [first, shown, shift].join();
  if (program.window === window) { markLine(); return; }
  program.window = window;
  const rows = [];
  for (let line = first + 1; line <= Math.min(first + shown + 1, program.count); line++) {
    const block = blockOf(line), row = make('div', lineText(line), block && block.moves ? '' : 'frame');
    row.dataset.line = line;
    row.setAttribute('role', 'option');
    row.style.top = `${shift + (line - 1) * LINE_HEIGHT}px`;
    row.title = row.textContent;
    rows.push(row);
  }
  $('nc-lines').replaceChildren(...rows);
  markLine();
}

/** Marks the row of the line at which the tool is. */
function markLine() {
  for (const row of $('nc-lines').children) {
    const selected = String(Number(row.dataset.line) === program.line);
    if (row.getAttribute('aria-selected') !== selected) row.setAttribute('aria-selected', selected);
  }
}

/** Marks a line and brings it into the window. */
function showLine(line) {
  if (!program.count || !line) return;
  program.line = line;
  const { top, way, most, shown } = windowOfLines(), at = (line - 1) * LINE_HEIGHT, height = shown * LINE_HEIGHT;
  if (most > 0 && (at < top + LINE_HEIGHT || at > top + height - 4 * LINE_HEIGHT)) {
    $('nc').scrollTop = Math.min(Math.max(at - height / 2, 0), most) / most * way;
  }
  drawProgram();
}

/** Puts the tool at the block of a line, and marks the line itself. */
function goToLine(line) {
  const block = blockOf(line);
  play(false);
  showTool(true);
  if (block && moves.count) setBlock(block.operation, block.index);
  showLine(line);
}
$('nc').addEventListener('scroll', () => requestAnimationFrame(drawProgram));
$('nc').addEventListener('click', event => {
  const row = event.target.closest('[data-line]');
  if (row) goToLine(Number(row.dataset.line));
});
$('nc').addEventListener('keydown', event => {
  const blocks = { ArrowDown: 1, ArrowUp: -1, PageDown: 20, PageUp: -20 }[event.key];
  if (blocks) step(blocks);
  else if (event.key === 'Home') goToLine(1);
  else if (event.key === 'End') goToLine(program.count);
  else return;
  event.preventDefault();
});
