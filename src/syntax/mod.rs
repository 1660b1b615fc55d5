//! Text to syntax tree; nothing else knows the parser.
