//! Errors of drawing: data that no picture can show; not the points that are merely left out.

/// Data that cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A chart without a point that can be drawn.
    #[error(
        "the chart {title:?} has no point to draw: coordinates must be finite, and positive along a logarithmic axis"
    )]
    NoPoints {
        /// Title of the chart.
        title: String,
    },
    /// An axis that does not run upwards over finite values, positive ones if it is logarithmic,
    /// or over more of them than can be told apart.
    #[error("the axis {label:?} cannot run from {} to {}", .range[0], .range[1])]
    Range {
        /// Label of the axis.
        label: String,
        /// Its ends.
        range: [f64; 2],
    },
    /// A list that should have an entry for every node of the mesh.
    #[error("{what} has {found} entries for {nodes} nodes")]
    Length {
        /// What is listed.
        what: String,
        /// Its length.
        found: usize,
        /// Nodes of the mesh.
        nodes: usize,
    },
    /// A displacement, or its product with the magnification, that is NaN, infinite or so large that
    /// the size of the body overflows.
    #[error("node {node} is displaced by {displacement:?} times {magnification}")]
    Displacement {
        /// The node.
        node: usize,
        /// Its displacement \[mm\].
        displacement: Vec<f64>,
        /// The magnification.
        magnification: f64,
    },
    /// A field without a finite value, or of a range that overflows.
    #[error("the field {label:?} has no range of finite values")]
    NoValues {
        /// Label of the field.
        label: String,
    },
    /// A picture that cannot be made into pixels.
    #[cfg(feature = "png")]
    #[error("no PNG: {reason}")]
    Raster {
        /// Why not.
        reason: String,
    },
}
