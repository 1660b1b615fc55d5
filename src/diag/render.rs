//! Diagnostics for people (miette) and for tools (JSON).
