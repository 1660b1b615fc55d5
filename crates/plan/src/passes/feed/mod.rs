//! Feeds, times and exact stops of the motion.

pub(crate) mod equal_sectors;
pub(crate) mod exact_stops;
pub(crate) mod removal_feeds;
pub(crate) mod time_feeds;
