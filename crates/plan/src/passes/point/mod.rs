//! Point milling of faces, fillets and edges.

mod axes;
pub(crate) mod plan;
mod spiral;
mod vane_surface;

pub(crate) use axes::vane_points;
