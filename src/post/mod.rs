//! Dialects: from a verified motion to NC text.
