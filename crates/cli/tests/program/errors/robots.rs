//! Robots of one's own: model files, formulas, designs.

use super::Given::{Made, Nothing};
use super::{Case, case};
use crate::sandbox::Sandbox;

/// A leg of two links on a slide.
const LEG: &str = r#"<mujoco model="leg">
  <option timestep="0.005"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <body name="torso" pos="0 0 1">
      <joint name="lift" type="slide" axis="0 0 1"/>
      <geom name="torso" type="sphere" size="0.1"/>
      <body name="thigh">
        <joint name="hip" type="hinge" axis="0 1 0" range="-90 90"/>
        <geom name="thigh" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03"/>
        <body name="shin" pos="0 0 -0.4">
          <joint name="knee" type="hinge" axis="0 1 0"/>
          <geom name="shin" type="capsule" size="0.03 0.2" pos="0 0 -0.2"/>
          <site name="toe" pos="0 0 -0.4"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="flexor"><joint joint="knee" coef="0.02"/></fixed></tendon>
  <actuator>
    <motor name="hip" joint="hip" ctrllimited="true" ctrlrange="-1 1" gear="50"/>
    <motor name="knee" joint="knee"/>
  </actuator>
  <sensor><gyro name="gyro" site="toe"/></sensor>
</mujoco>
"#;

/// Nothing holds it, and nothing drives it.
const FLYING: &str = "<mujoco>\n<worldbody>\n<body name='frame'><freejoint name='root'/><geom size='0.1'/></body>\n</worldbody>\n</mujoco>";

/// Two rods that a constraint joins, and that hang apart.
const LOOP: &str = r#"<mujoco>
  <worldbody>
    <body name="torso"><joint name="hip" axis="0 1 0"/><geom size="0.1"/><site name="left" pos="0 0 -0.2"/></body>
    <body name="rod" pos="0.1 0 0"><joint name="knee" axis="0 1 0"/><geom size="0.1"/><site name="right" pos="0 0 -0.2"/></body>
  </worldbody>
  <equality><connect name="tips" site1="left" site2="right"/></equality>
  <actuator><motor name="knee" joint="knee"/></actuator>
</mujoco>
"#;

/// A shank that is designed.
const SHANK: &str =
    "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], sets = [\"geom.shin.size[1] = shank / 2\"] }\n";

/// An experiment with the leg: keys of `[task]`, and tables behind them. What they do not say is sound.
fn put(sandbox: &Sandbox, keys: &str, tables: &str) {
    sandbox.write("robot.xml", LEG);
    let or = |there: bool, text: &'static str| if there { "" } else { text };
    let model = or(keys.contains("model ="), "model = \"robot.xml\"\n");
    let commands = or(tables.contains("[task.commands"), "[task.commands]\nknee = { limits = [-1, 1] }\n");
    let reward = or(tables.contains("[task.reward"), "[task.reward]\nup = \"body.torso.pos.z\"\n");
    let text = format!("name = \"mine\"\n[task]\nproblem = \"model\"\n{model}{keys}{commands}{reward}{tables}");
    sandbox.write("mine.toml", text);
}

macro_rules! robot {
    ($what:literal, $keys:literal) => {
        robot!($what, $keys, "")
    };
    ($what:literal, $keys:literal, $tables:literal) => {
        case($what, Made(|s| put(s, $keys, $tables)), "hwasp check mine.toml")
    };
}

/// One with another model.
macro_rules! model {
    ($what:literal, $model:expr) => {
        model!($what, $model, "", "")
    };
    ($what:literal, $model:expr, $keys:literal, $tables:literal) => {
        case(
            $what,
            Made(|s| {
                put(s, $keys, $tables);
                s.write("robot.xml", $model);
            }),
            "hwasp check mine.toml",
        )
    };
}

pub(super) const CASES: &[Case] = &[
    // The model's files.
    case(
        "A robot without a model",
        Made(|s| s.write("mine.toml", "name = \"mine\"\n[task]\nproblem = \"model\"\n")),
        "hwasp check mine.toml",
    ),
    robot!("A model that is not there", "model = \"robto.xml\"\n"),
    robot!("A model in a folder above", "model = \"../robot.xml\"\n"),
    robot!("A model from the root of the disk", "model = \"/etc/passwd\"\n"),
    robot!("A model that is another kind of file", "model = \"mine.toml\"\n"),
    model!("An empty model", ""),
    model!("A model that is no robot", "<html><body/></html>"),
    model!("A model that ends in the middle", "<mujoco><worldbody>"),
    model!(
        "A model with a word that the engine does not know",
        "<mujoco>\n<worldbody>\n<bdoy/>\n</worldbody>\n</mujoco>"
    ),
    model!("A model in which nothing moves", "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"),
    model!(
        "A joint without mass",
        "<mujoco>\n<worldbody>\n<body>\n<joint name='a'/>\n</body>\n</worldbody>\n</mujoco>"
    ),
    model!("A mesh that is missing", "<mujoco><asset><mesh file='arm.stl'/></asset></mujoco>"),
    model!("A mesh outside of the folder", "<mujoco><asset><mesh file='../../arm.stl'/></asset></mujoco>"),
    model!("A model that includes itself", "<mujoco><include file='robot.xml'/></mujoco>"),
    model!("A file included that is missing", "<mujoco><include file='common.xml'/></mujoco>"),
    model!(
        "A link of a URDF without inertia",
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>"
    ),
    model!("Entities that grow", "<!DOCTYPE x [<!ENTITY a 'aaaa'>]><mujoco>&a;</mujoco>"),
    model!("A size of zero", "<mujoco>\n<worldbody>\n<body><joint/><geom size='0'/></body>\n</worldbody>\n</mujoco>"),
    case(
        "A model that is no text",
        Made(|s| {
            put(s, "", "");
            s.write("robot.xml", [0xff, 0xfe, 0, 1]);
        }),
        "hwasp check mine.toml",
    ),
    case(
        "A model that was changed since it was trained",
        Made(|s| put(s, "model_sha256 = \"00\"\n", "")),
        "hwasp check mine.toml",
    ),
    // Names.
    robot!("A misspelt joint", "observe = [\"joint.nee.pos\"]\n"),
    robot!("A joint that is a body", "observe = [\"joint.torso.pos\"]\n"),
    robot!("A misspelt attribute", "observe = [\"joint.knee.position\"]\n"),
    robot!("A joint without an attribute", "observe = [\"joint.knee\"]\n"),
    robot!("A part of the names of joints", "observe = [\"joint.k*.pos\"]\n"),
    robot!("A kind that there is not", "observe = [\"muscle.knee.pos\"]\n"),
    robot!("A name of one's own that was not defined", "observe = [\"radius * 2\"]\n"),
    robot!("A number of an element beyond the last", "observe = [\"joint.#7.pos\"]\n"),
    robot!("A sensor that there is not", "observe = [\"sensor.gyroscope\"]\n"),
    robot!("A contact with a body", "observe = [\"contact.shin.ground\"]\n"),
    robot!("A command that nobody gives", "observe = [\"command.ankle\"]\n"),
    robot!("A keyframe that there is not", "keyframe = \"home\"\n"),
    // Formulas.
    robot!("An empty formula", "observe = [\"\"]\n"),
    robot!("A bracket that is not closed", "observe = [\"(joint.knee.pos + 1\"]\n"),
    robot!("A comparison with one sign", "ends = \"joint.lift.pos = 0\"\n"),
    robot!("Comparisons in a chain", "ends = \"0 < joint.lift.pos < 1\"\n"),
    robot!("A function that there is not", "observe = [\"sqr(joint.knee.pos)\"]\n"),
    robot!("Too few arguments", "observe = [\"clip(joint.knee.pos, 1)\"]\n"),
    robot!("A component beyond the last", "observe = [\"body.torso.pos[3]\"]\n"),
    robot!("Vectors of different lengths", "observe = [\"body.torso.pos + body.torso.quat\"]\n"),
    robot!("A unit that there is not", "ends = \"body.torso.pos.z < 3 furlongs\"\n"),
    robot!("A number beyond all numbers", "ends = \"body.torso.pos.z < 1e999\"\n"),
    robot!("A vector where a number belongs", "ends = \"body.torso.pos < 1\"\n"),
    robot!("A list where a formula belongs", "ends = [1, 2]\n"),
    robot!("A date where a formula belongs", "ends = 2024-01-01\n"),
    robot!("A fault in a text of several lines", "observe = [\"\"\"\n  joint.knee.pos\n  + joint.nee.pos\"\"\"]\n"),
    // Purpose.
    robot!("No reward", "", "[task.reward]\n"),
    robot!("A term of the reward that cannot name a curve", "", "[task.reward]\n\"how far\" = \"1\"\n"),
    robot!(
        "A definition that is wrong, and named",
        "observe = [\"bent\"]\n",
        "[task.define]\nbent = \"2 * knee\"\nknee = \"joint.nee.pos\"\n"
    ),
    robot!("Definitions in a circle", "", "[task.define]\na = \"b + 1\"\nb = \"a + 1\"\n"),
    robot!("A definition with the name of a word", "", "[task.define]\njoint = \"1\"\n"),
    robot!("A definition with the name of a unit", "", "[task.define]\nkg = \"1\"\n"),
    robot!("A definition with a space in its name", "", "[task.define]\n\"a b\" = \"1\"\n"),
    // Functions and laws of the library.
    robot!(
        "A function with too few arguments",
        "observe = [\"spring(joint.knee.pos)\"]\n",
        "[task.define]\n\"spring(angle, rest)\" = \"rest - angle\"\n"
    ),
    robot!("A function that calls itself", "", "[task.define]\n\"power(x)\" = \"x * power(x - 1)\"\n"),
    robot!(
        "Functions that lead back to each other",
        "",
        "[task.define]\n\"a(x)\" = \"2 * b(x)\"\n\"b(x)\" = \"2 * a(x)\"\n"
    ),
    robot!(
        "A law that the library has not",
        "",
        "[task.law]\n\"joint.knee\" = \"torsion_sprng(joint.knee.pos, 1, 2)\"\n"
    ),
    robot!(
        "An argument in another unit",
        "",
        "[task.law]\n\"joint.knee\" = \"torsion_spring(joint.knee.pos, 300 N/m, 0)\"\n"
    ),
    robot!(
        "A function whose units do not go together where it is called",
        "",
        "[task.define]\n\"stretch(now, rest)\" = \"now - rest\"\n[task.law]\n\"joint.knee\" = \"stretch(joint.knee.pos, 1 m)\"\n"
    ),
    robot!("A function with the name of one of the language", "", "[task.define]\n\"sin(x)\" = \"x\"\n"),
    robot!("A parameter with the name of a word", "", "[task.define]\n\"twice(joint)\" = \"2 * joint\"\n"),
    robot!("A function without parameters", "", "[task.define]\n\"half()\" = \"0.5\"\n"),
    robot!("A parameter in another unit than SI", "", "[task.define]\n\"twice(x: deg)\" = \"2 * x\"\n"),
    robot!("Two functions of one name", "", "[task.define]\n\"f(x)\" = \"x\"\n\"f(x, y)\" = \"x + y\"\n"),
    robot!("A name that a function does not know", "", "[task.define]\n\"twice(x)\" = \"2 * y\"\n"),
    robot!("A start of what is no state", "", "[task.start]\n\"body.torso.pos\" = \"[0, 0, 1]\"\n"),
    robot!("A start of as many values as do not fit", "", "[task.start]\n\"qpos\" = \"[1, 2]\"\n"),
    robot!("Two starts of one joint", "", "[task.start]\n\"joint.*.pos\" = \"0\"\n\"joint.knee.pos\" = \"1\"\n"),
    robot!("A step before the start", "", "[task.start]\n\"joint.knee.pos\" = \"previous(joint.hip.pos)\"\n"),
    robot!("A draw in the law", "", "[task.law]\n\"joint.knee\" = \"uniform(0, 1)\"\n"),
    robot!("A state for a quantity of the model", "", "[task.random]\nload = \"joint.knee.pos\"\n"),
    robot!("A force on nothing", "", "[task.forces]\n\"body.trunk\" = \"[0, 0, 1]\"\n"),
    robot!("A force of two components", "", "[task.forces]\n\"body.torso\" = \"[0, 1]\"\n"),
    robot!("A delay that is no time", "observation_delay = \"3 mm\"\n"),
    robot!("A delay before the time", "command_delay = \"-20 ms\"\n"),
    robot!("A delay that is drawn before the time", "observation_delay = \"uniform(-10 ms, 20 ms)\"\n"),
    // The law and its design.
    robot!("An effort on a body", "", "[task.law]\n\"body.torso\" = \"1\"\n"),
    robot!("An effort on a joint that there is not", "", "[task.law]\n\"joint.nee\" = \"1\"\n"),
    robot!("An effort in another unit", "", "[task.law]\n\"joint.knee\" = \"3 N\"\n"),
    robot!("A sum of what does not go together", "", "[task.law]\n\"joint.knee\" = \"3 N*m + joint.knee.pos\"\n"),
    robot!("The sine of a length", "", "[task.law]\n\"joint.knee\" = \"3 N*m * sin(joint.lift.pos)\"\n"),
    robot!("A command that nobody limits", "", "[task.commands]\n"),
    robot!("Limits of a command that are none", "", "[task.commands]\nknee = { limits = [1, -1] }\n"),
    robot!("A design without limits", "", "[task.design]\nshank = { initial = \"0.5 m\" }\n"),
    robot!("Limits the wrong way round", "", "[task.design]\nshank = { limits = [\"0.7 m\", \"0.3 m\"] }\n"),
    robot!("Limits of two units", "", "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 N\"] }\n"),
    robot!("One limit", "", "[task.design]\nshank = { limits = [\"0.3 m\"] }\n"),
    robot!("A limit that is no quantity", "", "[task.design]\nshank = { limits = [\"short\", \"0.7 m\"] }\n"),
    robot!("A limit that is not finite", "", "[task.design]\nshank = { limits = [0, inf] }\n"),
    robot!(
        "A start beyond the limits",
        "",
        "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], initial = \"0.9 m\" }\n"
    ),
    robot!("A misspelt key of a parameter", "", "[task.design]\nshank = { limit = [\"0.3 m\", \"0.7 m\"] }\n"),
    robot!("A parameter with the name of a unit", "", "[task.design]\nm = { limits = [1, 2] }\n"),
    robot!(
        "A field that there is not",
        "",
        "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], sets = [\"geom.shin.length = shank\"] }\n"
    ),
    robot!(
        "A field of an element that there is not",
        "",
        "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], sets = [\"geom.shank.size[1] = shank / 2\"] }\n"
    ),
    robot!(
        "A field without a formula",
        "",
        "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], sets = [\"geom.shin.size[1]\"] }\n"
    ),
    robot!(
        "A field that follows the state",
        "",
        "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], sets = [\"geom.shin.size[1] = joint.knee.pos\"] }\n"
    ),
    robot!(
        "A model that cannot be made at a corner of the design",
        "",
        "[task.design]\nshank = { limits = [\"0.3 m\", \"0.7 m\"], sets = [\"geom.shin.size[1] = shank - 0.4 m\"] }\n"
    ),
    robot!("A field that becomes no number", "set = [\"body.torso.pos.z = 1 / 0\"]\n"),
    robot!(
        "A field in another unit",
        "",
        "[task.design]\nshank = { limits = [\"0.3 kg\", \"0.7 kg\"], sets = [\"geom.shin.size[1] = shank / 2\"] }\n"
    ),
    robot!("A motor for a joint that there is not", "motors = { ankle = { limits = [-1, 1] } }\n"),
    robot!("A motor that does nothing", "motors = { lift = { limits = [-1, 1], gear = 0 } }\n"),
    robot!("A free base for a model that says how its base is held", "base = \"free\"\n"),
    model!("A fixed base for a model that frees it", FLYING, "base = \"fixed\"\n", "[task.reward]\nup = 1\n"),
    model!("A model of a free joint without actuators", FLYING, "", "[task.commands]\n[task.reward]\nup = 1\n"),
    model!("A loop that is open at the start", LOOP),
    robot!("A floor for a model that has one", "floor = true\n"),
    robot!("A name with dots that has no quotes", "", "[task.law]\njoint.knee = \"3 N*m\"\n"),
    case(
        "A model that is called like a file of runs",
        Made(|s| {
            put(s, "model = \"metrics.csv\"\n", "");
            s.write("metrics.csv", LEG);
        }),
        "hwasp check mine.toml",
    ),
    // What is drawn.
    robot!("Limits of a draw the wrong way round", "", "[task.random]\nload = \"uniform(2 kg, 1 kg)\"\n"),
    robot!("A draw between logarithms of what has none", "", "[task.random]\nload = \"log_uniform(-3, -1)\"\n"),
    robot!("A negative standard deviation", "", "[task.start]\n\"joint.*.vel\" = \"normal(0, -1)\"\n"),
    robot!(
        "A draw whose limits are in order by chance",
        "",
        "[task.random]\nfirst = \"uniform(0, 1)\"\nload = \"uniform(2, 1 + 0.1 * first)\"\n"
    ),
    robot!("An observation that becomes no number", "observe = [\"log(joint.knee.pos - 10)\"]\n"),
    // What another design changes.
    case("A design parameter that there is not", Made(|s| put(s, "", "")), "hwasp design mine.toml --at shank=1"),
    case(
        "A value of a design beyond its limits",
        Made(|s| put(s, "", SHANK)),
        "hwasp design mine.toml --at 'shank=0.9 m'",
    ),
    case("A value of a design without a unit", Made(|s| put(s, "", SHANK)), "hwasp design mine.toml --at shank=0.5"),
    case("A value of a design without a name", Made(|s| put(s, "", SHANK)), "hwasp design mine.toml --at 0.5"),
    case("A design that shapes nothing", Made(|s| put(s, "", "")), "hwasp design mine.toml"),
    case("A design without a model", Nothing, "hwasp design reach --at gear=1"),
    // An experiment to begin with.
    case("A model to begin with that is not there", Nothing, "hwasp init robot.xml"),
    case(
        "A model to begin with that has an experiment",
        Made(|s| put(s, "", "")),
        "hwasp init robot.xml --out mine.toml",
    ),
    case("An experiment with another ending", Made(|s| put(s, "", "")), "hwasp init robot.xml --out mine.json"),
    case(
        "An experiment that cannot see the model",
        Made(|s| {
            put(s, "", "");
            std::fs::create_dir(s.path("deep")).unwrap();
        }),
        "hwasp init robot.xml --out deep/mine.toml",
    ),
    case("A project for a model", Made(|s| put(s, "", "")), "hwasp init robot.xml --template mjcf"),
    case("A folder with an experiment", Nothing, "hwasp init lamp --out lamp.toml"),
    case(
        "A model to begin with in which nothing moves",
        Made(|s| s.write("robot.xml", "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")),
        "hwasp init robot.xml",
    ),
    case(
        "A model to begin with that nothing drives",
        Made(|s| {
            s.write("robot.xml", "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>");
        }),
        "hwasp init robot.xml",
    ),
];
