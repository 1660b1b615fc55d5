//! Independent checks of a motion; the only maker of [`Verified`].
