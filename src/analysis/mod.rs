//! Facts about the part before planning: channel width, twist, noisy data.
