//! Point milling of faces, fillets and edges.

mod axes;
mod ground;
pub(crate) mod plan;
mod spiral;

pub(crate) use axes::vane_points;
