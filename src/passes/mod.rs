//! From the program to the motion, one file a pass; the order stands in `pipeline`.
