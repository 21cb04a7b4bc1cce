//! What the engine is told about itself: solver, pictures.

use super::super::description::HandDescription;
use super::super::xml::Element;

/// Settings that hold a grasp: with an elliptic cone and `impratio` 10 an object creeps 0.8 mm in 3.5 s, with pyramids and 1
/// it is 10 to 20 mm. The tolerances and the dense Jacobian save a quarter of the time and cost nothing that was seen.
/// Newton's iterations have no cap of ours: with one, contacts blow up.
pub(super) fn option(hand: &HandDescription, gravity: bool) -> Element {
    let fall = if gravity { hand.gravity } else { 0.0 };
    Element::new("option")
        .set("timestep", hand.time_step)
        .set_all("gravity", &[0.0, 0.0, if fall == 0.0 { 0.0 } else { -fall }])
        .set("integrator", "implicitfast")
        .set("solver", "Newton")
        .set("cone", "elliptic")
        .set("impratio", 10)
        .set("jacobian", "dense")
        .set("tolerance", "1e-6")
        .set("ccd_tolerance", "1e-4")
        .set("ccd_iterations", 12)
        .with(Element::new("flag").set("island", "disable"))
}

/// Pictures of up to 640 × 640 with antialiasing, and with shadows about the hand alone, which sharpens them. All this is
/// for the renderer; training never draws.
pub(super) fn visual() -> Element {
    Element::new("visual")
        .with(Element::new("global").set("offwidth", 640).set("offheight", 640))
        .with(Element::new("quality").set("offsamples", 4).set("shadowsize", 2048))
        .with(Element::new("map").set("shadowclip", 0.5))
        .with(Element::new("headlight").set("ambient", "0.45 0.45 0.45").set("diffuse", "0.25 0.25 0.25"))
}

/// A plain sky, and a floor with squares, so that pictures show distances.
pub(super) fn asset() -> Element {
    let texture = Element::new("texture")
        .set("name", "squares")
        .set("type", "2d")
        .set("builtin", "checker")
        .set("rgb1", "0.80 0.82 0.84")
        .set("rgb2", "0.70 0.72 0.75")
        .set("width", 64)
        .set("height", 64);
    let material = Element::new("material")
        .set("name", "squares")
        .set("texture", "squares")
        .set("texrepeat", "10 10")
        .set("texuniform", true);
    let sky = Element::new("texture")
        .set("type", "skybox")
        .set("builtin", "flat")
        .set("rgb1", "0.93 0.94 0.96")
        .set("width", 8)
        .set("height", 48);
    Element::new("asset").with(sky).with(texture).with(material)
}
