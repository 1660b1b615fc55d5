//! Text form of the stage values, for `--emit` and the goldens.
