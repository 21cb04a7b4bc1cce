//! Pictures, where there is an OpenGL context to draw them in.

#![cfg(feature = "renderer")]
#![allow(clippy::unwrap_used, clippy::print_stderr)] // a panic is how a test fails, a printed line how it is left out

use hwasp_mujoco::engine::{Painter, PictureError, Simulation};

/// A red ball on the optical axis of the camera, in front of a black nothing.
const BALL: &str =
    "<mujoco><visual><global offwidth='48' offheight='32'/><headlight ambient='1 1 1'/></visual><worldbody>
    <camera name='front' pos='0 -1 0' xyaxes='1 0 0 0 0 1' fovy='45'/>
    <body><freejoint/><geom size='0.1' rgba='1 0 0 1'/></body></worldbody></mujoco>";

/// Says so and gives nothing where there is no OpenGL.
fn painter(simulation: &Simulation, size: [usize; 2]) -> Option<Painter> {
    match Painter::new(simulation, simulation.camera("front").unwrap(), size) {
        Err(error @ PictureError::NoContext(_)) => {
            eprintln!("left out: {error}");
            None
        }
        painter => Some(painter.unwrap()),
    }
}

/// Columns and rows of red pixels, from and to; none of them where nothing is red.
fn red(picture: &[u8], width: usize) -> Option<[usize; 4]> {
    let reds = picture.chunks_exact(3).enumerate().filter(|(_, p)| p[0] > 100 && p[1] < 50);
    reds.map(|(i, _)| [i % width, i / width]).fold(None, |seen, [x, y]| {
        let [left, right, top, bottom] = seen.unwrap_or([x, x, y, y]);
        Some([left.min(x), right.max(x), top.min(y), bottom.max(y)])
    })
}

#[test]
fn a_ball_is_where_the_state_says() {
    let mut simulation = Simulation::from_mjcf(BALL).unwrap();
    simulation.forward().unwrap();
    let Some(mut painter) = painter(&simulation, [48, 32]) else { return };
    // At 1 m half the picture is 0.414 m high: the ball's radius is 3.9 of its 16 rows.
    let [left, right, top, bottom] = red(painter.draw(&mut simulation).unwrap(), 48).unwrap();
    assert_eq!((left + right, top + bottom), (47, 31), "in the middle");
    assert!(
        (7..=9).contains(&(right + 1 - left)) && (7..=9).contains(&(bottom + 1 - top)),
        "{left} {right} {top} {bottom}"
    );
    // Up and to the right.
    simulation.qpos_mut()[0] = 0.2;
    simulation.qpos_mut()[2] = 0.1;
    simulation.forward().unwrap();
    let moved = red(painter.draw(&mut simulation).unwrap(), 48).unwrap();
    assert!(moved[0] > left + 5 && moved[3] < bottom - 2, "{moved:?}");
}

#[test]
fn a_picture_larger_than_the_model_makes_room_for_is_refused() {
    let simulation = Simulation::from_mjcf(BALL).unwrap();
    let camera = simulation.camera("front").unwrap();
    let error = Painter::new(&simulation, camera, [49, 32]).unwrap_err().to_string();
    assert_eq!(error, "a picture of 49 × 32 pixels is outside 1 × 1 to 48 × 32");
    assert!(Painter::new(&simulation, camera, [48, 0]).is_err());
}
