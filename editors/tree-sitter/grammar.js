// The job language for tree-sitter, after grammar/job.pest. It reads every text that the compiler reads. Where the compiler
// minds blanks and line ends, such as between a number and its unit, it reads more.

/** Comma separated, at least one. */
const list = (rule) => seq(rule, repeat(seq(',', rule)));

/** Sums and products of two operands. */
const arithmetic = (left, right) =>
  choice(
    prec.left(2, seq(left, field('operator', choice('+', '-')), right)),
    prec.left(3, seq(left, field('operator', choice('*', '/')), right)),
  );

const UNITS = [
  '%', 'mm/tooth', 'mm3/min', 'cm3/min', 'mm3', 'cm3', 'mm/min', 'm/min', 'mm', 'um', 'min', 'deg', 'rad', 'rpm', 'in', 's', 'h',
];

// Words that are labels before another name: `vane gap`. Before a number every name is one.
const LABELS = ['vane', 'hub', 'shroud', 'chord', 'rough', 'over'];

module.exports = grammar({
  name: 'impeller',

  word: ($) => $.name,

  extras: ($) => [/[ \t\r\n\uFEFF]/, $.comment],

  rules: {
    source_file: ($) => repeat($._item),

    comment: () => token(seq('//', /[^\n]*/)),

    // ---- items

    _item: ($) =>
      choice(
        $.edition, $.use, $.let, $.part, $.stock, $.tool, $.operation, $.tolerance, $.require, $.allow, $.post,
      ),

    edition: ($) => seq('edition', $.number),
    use: ($) => seq('use', field('kind', $.name), $.text),
    let: ($) => seq('let', field('name', $.name), '=', field('value', $._expression)),
    part: ($) => seq('part', field('name', $.name), $.block),
    stock: ($) => seq('stock', field('kind', $.name), $.block),
    tool: ($) => seq('tool', field('name', $.name), '=', choice($.text, seq(field('kind', $.name), $.block))),
    operation: ($) => seq('operation', field('kind', $.name), optional(field('name', $.name)), $.block),
    tolerance: ($) => seq('tolerance', list($._value)),
    require: ($) =>
      seq(
        'require',
        field('quantity', $.name),
        optional(field('body', $.name)),
        $.relation,
        field('bound', $._expression),
        optional(choice(seq($.outside, optional($.scope)), seq($.scope, optional($.outside)))),
      ),
    allow: ($) =>
      seq('allow', field('quantity', $.name), optional(field('body', $.name)), optional($.scope), field('reason', $.text)),
    post: ($) => seq('post', field('name', $.name), optional($.block)),

    relation: () => choice('<=', '>=', '==', '<', '>', '='),
    outside: ($) => seq('outside', 'of', $.name),
    scope: ($) => seq('on', list($.target)),
    target: ($) => seq(optional('operation'), $.name),

    // ---- blocks

    // Entries stand one after another; commas only join the values of one entry.
    block: ($) => seq('{', repeat($.entry), '}'),

    entry: ($) =>
      seq(
        field('property', $.name),
        choice(
          // `pressure ruled { }` has a name for its block; `span middle { }` has none with a value.
          prec(1, seq(optional(field('name', $._any_name)), $.block)),
          seq(field('at', $._expression), $.block),
          list($._value),
        ),
      ),

    // ---- values

    _value: ($) => choice($.spline, $.loop, $.revolve, $.labelled, $.text, $.list, $._expression),

    // `hub 2 mm`, `elliptic 2`; one of the label words also stands before a name or a sign: `vane gap`, `over -step`.
    labelled: ($) =>
      prec(
        1,
        seq(
          choice(
            seq(field('label', $.name), $._counted),
            seq(field('label', alias(choice(...LABELS), $.name)), $._expression),
          ),
          optional(seq('..', $._expression)),
        ),
      ),

    spline: ($) => seq('spline', choice(seq('from', $.text, 'curve', field('curve', $.name)), $._points), optional(choice($.unit, 'm'))),
    // A closed curve, or all curves of a file, each of them closed.
    loop: ($) => seq(choice(seq('loops', 'from', $.text), seq('loop', $._points)), optional(choice($.unit, 'm'))),
    revolve: ($) => seq('revolve', choice($.spline, $.path)),
    list: ($) => $._points,
    _points: ($) => seq('[', repeat(seq($.point, optional(','))), ']'),
    point: ($) => seq('(', list($._expression), ')'),

    // ---- arithmetic

    _expression: ($) => choice($.binary, $.negative, $.quantity, $.group, $.path),
    binary: ($) => arithmetic($._expression, $._expression),
    // Arithmetic that begins with a number or a bracket.
    _counted: ($) => choice(alias($._counted_binary, $.binary), $.quantity, $.group),
    _counted_binary: ($) => arithmetic($._counted, $._expression),
    negative: ($) => prec(4, seq('-', $._expression)),
    group: ($) => seq('(', $._expression, ')'),

    // ---- words

    quantity: ($) => prec.right(seq($.number, optional($.unit))),
    number: () => /[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?/,
    unit: () => choice(...UNITS),

    path: ($) => prec.right(seq($._any_name, repeat(seq(token.immediate('.'), $.name)))),
    _any_name: ($) => choice($.name, alias(choice(...LABELS), $.name)),
    name: () => /[A-Za-z][A-Za-z0-9_]*(-[A-Za-z0-9_]+)*/,
    text: () => /"[^"\n]*"/,
  },
});
