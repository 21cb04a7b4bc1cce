//! The viewer, put together from its files.

/// The viewer: a classic script that defines `hwaspViewer(element, scene, options)`, as `viewer/viewer.js` says.
pub const VIEWER_JS: &str = concat!(
    "\"use strict\";\n{\n",
    include_str!("viewer/numbers.js"),
    include_str!("viewer/shapes.js"),
    include_str!("viewer/scene.js"),
    include_str!("viewer/shot.js"),
    include_str!("viewer/shaders.js"),
    include_str!("viewer/stage.js"),
    include_str!("viewer/draw.js"),
    include_str!("viewer/camera.js"),
    include_str!("viewer/viewer.js"),
    "}\n"
);
/// How the viewer looks; colours are variables.
pub const VIEWER_CSS: &str = include_str!("viewer/viewer.css");
