; Of two patterns that fit, the first one counts for `tree-sitter highlight` of old versions and the last one for Neovim, so
; that no two fit the same name.

(comment) @comment
(text) @string
(number) @number
(unit) @type.builtin

[
  "edition" "use" "let" "part" "stock" "tool" "operation" "tolerance" "require" "allow" "post"
  "outside" "of" "on"
] @keyword

["spline" "loop" "loops" "revolve" "from" "curve"] @function.builtin

(use kind: (name) @type)
(part name: (name) @type)
(stock kind: (name) @type)
(post name: (name) @type)
(tool name: (name) @variable)
(tool kind: (name) @type)
(operation kind: (name) @function)
(operation name: (name) @variable)
(let name: (name) @variable)

(require quantity: (name) @property)
(require body: (name) @property)
(allow quantity: (name) @property)
(allow body: (name) @property)
(target (name) @constant)
(outside (name) @constant)

(entry property: (name) @property)
(entry name: (name) @type)
(labelled label: (name) @attribute)
(spline curve: (name) @constant)
(path (name) @constant)

[(relation) "=" "+" "-" "*" "/" ".."] @operator
["{" "}" "[" "]" "(" ")"] @punctuation.bracket
["," "."] @punctuation.delimiter
