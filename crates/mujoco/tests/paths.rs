//! Names of numbers of a model.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_mujoco::engine::{Element, FieldPath, Kind};

#[test]
fn paths_are_read_and_written() {
    for (text, shown) in [
        ("geom.shin.size[0]", "geom.shin.size[0]"),
        ("body.foot.pos.z", "body.foot.pos[2]"),
        ("body.foot.pos[2]", "body.foot.pos[2]"),
        ("body.foot.quat.w", "body.foot.quat[0]"),
        ("joint.knee.stiffness", "joint.knee.stiffness"),
        ("joint.knee.stiffness[0]", "joint.knee.stiffness"),
        ("joint.knee.damping[2]", "joint.knee.damping[2]"),
        ("actuator.#2.gear", "actuator.#2.gear"),
        ("actuator.motor.gear[5]", "actuator.motor.gear[5]"),
        ("geom.\"left.shin\".size[0]", "geom.\"left.shin\".size[0]"),
        ("geom.left.shin.size[0]", "geom.\"left.shin\".size[0]"),
        ("geom.left shin.pos.x", "geom.\"left shin\".pos[0]"),
        ("geom.\"a\\\"b\\\\c\".mass", "geom.\"a\\\"b\\\\c\".mass"),
        ("geom.\"#2\".mass", "geom.\"#2\".mass"),
        ("body.pos.pos.z", "body.pos.pos[2]"),
        ("body.a.pos.z.pos.z", "body.\"a.pos.z\".pos[2]"),
        ("option.gravity[2]", "option.gravity[2]"),
        ("option.gravity.z", "option.gravity[2]"),
        ("option.timestep", "option.timestep"),
        ("equality.loop.data[0]", "equality.loop.data[0]"),
    ] {
        let path: FieldPath = text.parse().unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(path.to_string(), shown, "{text}");
        assert_eq!(shown.parse(), Ok(path), "{text}");
    }
    let path: FieldPath = "geom.shin.size[1]".parse().unwrap();
    assert_eq!((path.kind(), path.field(), path.index()), (Kind::Geom, "size", 1));
    assert_eq!(path.element(), &Element::Name("shin".to_owned()));
}

#[test]
fn what_is_no_path_is_told() {
    for (text, said) in [
        ("", "names no field: it has no `.`"),
        ("shin", "names no field: it has no `.`"),
        ("geom.shin", "names no field: no field follows the name"),
        ("geom.\"shin.size[0]", "a quote is not closed"),
        ("geom.\"shin\"size[0]", "no field follows the name"),
        ("geom..size[0]", "the name is empty; elements without a name go by their index"),
        ("geom.\"\".size[0]", "the name is empty"),
        ("geom.#x.size[0]", "`#` is not followed by an index"),
        ("geom.shin.size[a]", "the index is no number in `[]`"),
        ("geom.shin.size[-1]", "the index is no number in `[]`"),
        ("geom.shin.size[0", "the index is no number in `[]`"),
        ("gom.shin.size[0]", "there is no kind `gom`; did you mean `geom`?; there are: body, geom, joint, site"),
        ("geom.shin.sise[0]", "the kind `geom` has no field `sise`; did you mean `size`?; it has: pos, quat"),
        ("geom.shin.stiffness", "the kind `geom` has no field `stiffness`; it has: pos"),
        ("geom.shin.size", "`size` of the kind `geom` has 3 numbers: write `size[0]` to `size[2]`"),
        ("geom.shin.size[3]", "`size` of the kind `geom` has 3 numbers"),
        ("geom.shin.size[99999999999999999999999]", "the index is no number in `[]`"),
        ("geom.shin.mass[1]", "`mass` of the kind `geom` has 1 number: write `mass[0]`"),
        ("geom.shin.size.x", "the kind `geom` has no field `x`"),
        ("geom.\"shin\".size.x", "`size` of the kind `geom` has 3 numbers"),
        ("option.gravety[2]", "did you mean `gravity`?"),
    ] {
        let error = text.parse::<FieldPath>().unwrap_err().to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
}
