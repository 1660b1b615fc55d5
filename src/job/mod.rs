//! The job: units as types, names resolved, every default explicit, libraries merged.
