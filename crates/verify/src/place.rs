//! A place of the program in words.

use super::proof::piece::At;
use ir::{Motion, Program};

/// A place of the program in words.
pub fn describe(program: &Program, motion: &Motion, at: Option<At>) -> String {
    let Some(at) = at else { return "no cutter comes near".to_owned() };
    let Some(operation) = motion.operations.get(at.operation as usize) else { return String::new() };
    let name = &program.operations[operation.operation].name;
    let label = operation
        .moves
        .get(at.index as usize)
        .and_then(|m| operation.labels.get(m.pass as usize))
        .map_or("", String::as_str);
    format!("{name}, {label}, move {}", at.index)
}
