//! Feeds, times and exact stops of the motion.

pub(crate) mod exact_stops;
pub(crate) mod time_feeds;
