//! In which order solids are painted: what is behind first.

use hwasp_core::{Form, Solid};

use super::eye::{Eye, World, along, cross, inner};
use super::outline::reach;

/// The numbers of solids from the back to the front, ground left out.
///
/// Of two solids that are seen one over the other, the one is in front that has to be moved less towards the eye to be wholly in
/// front: not at all, mostly, but links of a robot run into each other at their joints.
pub(super) fn painted(eye: &Eye, solids: &[Solid]) -> Vec<usize> {
    let mut left: Vec<usize> = (0..solids.len()).filter(|&i| !is_ground(&solids[i].form)).collect();
    let boxes: Vec<[f64; 4]> = solids.iter().map(|solid| seen_box(eye, solid)).collect();
    let apart = |a: [f64; 4], b: [f64; 4]| a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
    // How many of those that are left each one hides, and which ones hide it.
    let mut hidden = vec![0; solids.len()];
    let mut over: Vec<Vec<usize>> = vec![Vec::new(); solids.len()];
    for (k, &a) in left.iter().enumerate() {
        for &b in &left[k + 1..] {
            if apart(boxes[a], boxes[b]) {
                continue;
            }
            let (back, front) = if in_front(eye, &solids[b], &solids[a]) { (a, b) } else { (b, a) };
            hidden[front] += 1;
            over[back].push(front);
        }
    }
    // The farthest one of those that hide nothing that is left; where all hide something, the farthest of all.
    left.sort_by(|&a, &b| {
        inner(eye.towards, solids[a].at).total_cmp(&inner(eye.towards, solids[b].at)).then(a.cmp(&b))
    });
    let mut order = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let next = left.iter().position(|&i| hidden[i] == 0).unwrap_or(0);
        let next = left.remove(next);
        over[next].iter().for_each(|&front| hidden[front] -= 1);
        order.push(next);
    }
    order
}

/// Whether a form is ground, which lies below everything.
pub(super) fn is_ground(form: &Form) -> bool {
    matches!(form, Form::Plane(_) | Form::Field(_))
}

/// Left, top, right, bottom of what is seen of a solid.
pub(super) fn seen_box(eye: &Eye, solid: &Solid) -> [f64; 4] {
    let side = |flat: [f64; 2]| eye.length(reach(solid, eye.lift(flat)));
    [-side([-1.0, 0.0]), -side([0.0, -1.0]), side([1.0, 0.0]), side([0.0, 1.0])]
}

/// Whether a solid is in front of another one. Where they run through each other alike, the one that stands out more: what chance
/// decides would flicker.
fn in_front(eye: &Eye, front: &Solid, back: &Solid) -> bool {
    let ((forth, normal), (over, _)) = (shift(eye, back, front), shift(eye, front, back));
    if forth.min(over) > 0.0 && (forth - over).abs() < 0.25 * (forth + over) {
        return reach(front, normal) >= reach(back, normal);
    }
    forth <= over
}

/// How far a solid has to be moved towards the eye to be in front of another one, m: the least over the planes that may part
/// them, with the normal of that plane, towards the eye. Negative where there is room.
fn shift(eye: &Eye, back: &Solid, front: &Solid) -> (f64, World) {
    let normals = back.axes.iter().chain(&front.axes).copied();
    let more = [cross(back.axes[2], front.axes[2]), along(front.at, -1.0, back.at), eye.towards];
    let needed = |normal: World| {
        let length = inner(normal, normal).sqrt();
        let slope = inner(normal, eye.towards) / length;
        // A plane that the eye looks along parts nothing that is seen one over the other; axes that are parallel give no plane.
        if slope.abs() > 1e-3 {
            let normal = normal.map(|part| slope.signum() * part / length);
            ((reach(back, normal) + reach(front, normal.map(|part| -part))) / slope.abs(), normal)
        } else {
            (f64::INFINITY, normal)
        }
    };
    let least = |a: (f64, World), b: (f64, World)| if b.0 < a.0 { b } else { a };
    normals.chain(more).map(needed).fold((f64::INFINITY, eye.towards), least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid(form: Form, at: World) -> Solid {
        Solid::new(form, at, [0; 3])
    }

    /// From the south: a ball north of a long wall whose centre is nearer to the eye's plane than the ball's, and one south of it.
    #[test]
    fn a_wall_hides_what_is_behind_it() {
        let eye = Eye::new(-std::f64::consts::FRAC_PI_2, 0.3, 100.0);
        let wall = solid(Form::Box([5.0, 0.1, 1.0]), [3.0, 0.0, 0.0]);
        let ball = |y: f64, z: f64| solid(Form::Ellipsoid([0.3; 3]), [0.0, y, z]);
        let floor = solid(Form::Plane([0.0; 2]), [0.0; 3]);
        assert_eq!(painted(&eye, &[floor, ball(-0.5, -0.8), wall.clone(), ball(0.5, 0.8)]), [3, 2, 1]);
        // A ball on a large plate whose centre is far in front of it.
        let plate = solid(Form::Box([5.0, 5.0, 0.1]), [0.0, -4.0, -0.1]);
        assert_eq!(painted(&eye, &[ball(0.5, 0.3), plate]), [1, 0]);
    }

    /// A motor that stands out of both sides of its housing was seen at one moment and hidden at the next.
    #[test]
    fn what_runs_through_another_thing_is_seen_where_it_stands_out() {
        let eye = Eye::new(-1.2, 0.28, 100.0);
        for jitter in [-1e-9, 0.0, 1e-9] {
            let housing = solid(Form::Box([0.2, 0.1, 0.08]), [0.0, jitter, 0.0]);
            let motor = solid(Form::Box([0.05, 0.12, 0.05]), [0.0, 0.0, jitter]);
            assert_eq!(painted(&eye, &[motor.clone(), housing.clone()]), [1, 0]);
            assert_eq!(painted(&eye, &[housing, motor]), [0, 1]);
        }
    }

    /// Three bars, each over the next, have no order; every one is painted all the same.
    #[test]
    fn what_has_no_order_is_painted_once() {
        let eye = Eye::new(-std::f64::consts::FRAC_PI_2, 1.5, 100.0);
        let balls: Vec<Solid> =
            (0..5).map(|i| solid(Form::Ellipsoid([1.0; 3]), [0.1 * f64::from(i), 0.0, 0.0])).collect();
        let mut order = painted(&eye, &balls);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn the_box_of_a_ball() {
        let eye = Eye::new(-0.4, 0.5, 10.0);
        let ball = solid(Form::Ellipsoid([0.2; 3]), [1.0, 2.0, 3.0]);
        let [x, y] = eye.flat(ball.at);
        for (found, expected) in seen_box(&eye, &ball).into_iter().zip([x - 2.0, y - 2.0, x + 2.0, y + 2.0]) {
            assert!((found - expected).abs() < 1e-9);
        }
    }
}
