//! Experiments and models as nobody would write them: whatever they are, the answer is a robot that moves or a fault.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

#[path = "../../../fuzz/src/robot.rs"]
#[allow(unreachable_pub)] // there it is a library
mod fuzz;

use hwasp_testing::catalogue;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Something of everything.
const MODEL: &str = r#"<mujoco>
  <option timestep="0.002"/>
  <default><geom friction="0.8 0.1 0.1"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <body name="torso" pos="0 0 1">
      <freejoint name="root"/>
      <geom name="torso" type="sphere" size="0.1"/>
      <body name="thigh" euler="0 20 0">
        <joint name="hip" type="hinge" axis="0 1 0" range="-90 90" damping="0.1" stiffness="2"/>
        <geom name="thigh" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" density="500"/>
        <body name="shin" pos="0 0 -0.4">
          <joint name="knee" type="slide" axis="0 1 0"/>
          <geom name="shin" type="capsule" size="0.03 0.2" pos="0 0 -0.2" mass="0.3"/>
          <site name="toe" pos="0 0 -0.4"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="flexor"><joint joint="hip" coef="0.02"/></fixed></tendon>
  <equality><weld body1="torso" body2="world" active="false"/></equality>
  <actuator>
    <motor name="hip" joint="hip" ctrllimited="true" ctrlrange="-1 1" gear="5"/>
    <position name="knee" joint="knee" kp="10" ctrlrange="-0.1 0.1"/>
  </actuator>
  <sensor><gyro name="gyro" site="toe"/></sensor>
  <keyframe><key name="bent" qpos="0 0 1 1 0 0 0 0.4 0.02"/></keyframe>
</mujoco>
"#;

/// The least that an experiment says.
const BASE: &str = "name = \"fuzzed\"\n[task]\nproblem = \"model\"\nmodel = \"robot.xml\"\n[task.reward]\nnone = 0\n";

/// How many of each kind; with `HWASP_EXHAUSTIVE=1` two hundred thousand in all.
fn cases() -> u32 {
    if std::env::var_os("HWASP_EXHAUSTIVE").is_some() { 100_000 } else { 150 }
}

/// What can be read while the robot moves, and what can be before there is a state.
const STATE: [&str; 22] = [
    "joint.hip.pos",
    "joint.*.vel",
    "joint.knee.vel",
    "qpos",
    "qvel",
    "body.torso.pos",
    "body.shin.quat",
    "body.torso.angvel",
    "site.toe.pos.z",
    "tendon.flexor.length",
    "sensor.gyro",
    "contact.shin.floor",
    "contact.torso",
    "com.pos",
    "energy.kinetic",
    "command",
    "command.hip",
    "effort",
    "time",
    "step",
    "pi * dt",
    "actuator.knee.force",
];
const OWN: [&str; 12] =
    ["load", "gear", "shank", "progress", "half", "2", "0.5", "3 N*m", "0.2 m", "45 deg", "-1", "uniform(0.5, 1)"];

/// A formula that is sound more often than not.
fn formula(leaves: Vec<&'static str>) -> impl Strategy<Value = String> {
    select(leaves).prop_map(str::to_owned).prop_recursive(3, 12, 3, |inner| {
        let one =
            select(vec!["sin", "abs", "norm", "sum", "tanh", "sqrt", "previous", "diff", "wrap", "soft", "-", "not "]);
        let two = select(vec!["+", "-", "*", "/", "^", "<", ">=", "==", "and", "or"]);
        let call = select(vec!["max", "atan2", "dot", "normal", "blend", "gear_torque", "cross", "rotate"]);
        let three = select(vec!["clip", "where", "torsion_spring", "tendon_tension", "rod_arm"]);
        prop_oneof![
            (one, inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            (inner.clone(), two, inner.clone()).prop_map(|(a, op, b)| format!("({a}) {op} ({b})")),
            (call, inner.clone(), inner.clone()).prop_map(|(f, a, b)| format!("{f}({a}, {b})")),
            (three, inner.clone(), inner.clone(), inner.clone()).prop_map(|(f, a, b, c)| format!("{f}({a}, {b}, {c})")),
            (inner.clone(), select(vec![".x", "[0]", "[1:]", "[-1]", "[0:3]"]))
                .prop_map(|(a, part)| format!("({a}){part}")),
            prop::collection::vec(inner, 1..4).prop_map(|list| format!("[{}]", list.join(", "))),
        ]
    })
}

/// A line of `[task]` or of one of its tables, by the table that it belongs to.
fn line() -> impl Strategy<Value = (&'static str, String)> {
    let state = || formula([&STATE[..], &OWN[..11]].concat());
    let own = || formula(OWN.to_vec());
    let places = vec![
        ("set", "geom.shin.mass"),
        ("set", "geom.shin.size[1]"),
        ("set", "body.shin.pos.z"),
        ("set", "joint.hip.damping"),
        ("set", "option.gravity.z"),
        ("set", "actuator.hip.gear[0]"),
        ("set", "geom.#1.friction[0]"),
        ("set", "joint.hip.armature"),
    ];
    let named = |table: &'static str, keys: Vec<&'static str>, what: BoxedStrategy<String>| {
        (select(keys), what).prop_map(move |(key, text)| (table, format!("\"{key}\" = \"{text}\"\n"))).boxed()
    };
    prop_oneof![
        // One condition, or one by name.
        state().prop_map(|text| match text.len() % 2 {
            0 => ("", format!("ends = \"{text}\"\n")),
            _ => ("ends", format!("fallen = \"{text}\"\n")),
        }),
        state().prop_map(|text| ("", format!("success = \"{text}\"\n"))),
        own().prop_map(|text| ("", format!("observation_delay = \"{text}\"\n"))),
        (select(vec!["0.01 s", "progress * 4 ms", "9 ms * half", "3"]))
            .prop_map(|text| ("", format!("command_delay = \"{text}\"\n"))),
        (select(places), own()).prop_map(|((_, field), text)| ("", format!("set = [\"{field} = {text}\"]\n"))),
        named("reward", vec!["a", "b"], state().boxed()),
        named("define", vec!["half", "soft(x)", "blend(a: m, b)", "late", "pi"], state().boxed()),
        named("random", vec!["load", "other"], own().boxed()),
        named("start", vec!["joint.hip.pos", "joint.*.vel", "qpos", "qpos[7:]", "time"], own().boxed()),
        named(
            "forces",
            vec!["body.torso", "body.shin"],
            formula([&OWN[..], &["joint.hip.pos", "time"]].concat()).prop_map(|a| format!("[{a}, 0, 1]")).boxed()
        ),
        named("law", vec!["joint.hip", "joint.knee", "tendon.flexor", "actuator.hip", "joint.root"], state().boxed()),
        named("kinds", vec!["far", "near"], state().boxed()),
    ]
}

/// An experiment of some lines, on a sound base.
fn experiment() -> impl Strategy<Value = String> {
    let observe = formula([&STATE[..], &OWN[..]].concat());
    (observe, prop::collection::vec(line(), 0..4), 1..5_u32).prop_map(|(observe, lines, skip)| {
        let mut text = format!("name = \"fuzzed\"\n[task]\nproblem = \"model\"\nmodel = \"robot.xml\"\nframe_skip = {skip}\nobserve = [\"{observe}\"]\n");
        let base = [
            ("reward", "none = 0\n"),
            ("define", "half = 0.5\n\"soft(x)\" = \"x / (1 + abs(x))\"\n\"blend(a, b)\" = \"0.5 * soft(a) + b\"\n"),
            ("random", "load = \"uniform(0.2, 0.4)\"\n"),
            ("design", "gear = { limits = [1, 9] }\nshank = { limits = [\"0.1 m\", \"0.3 m\"] }\n"),
        ];
        let mut known: Vec<String> = Vec::new();
        for table in ["", "reward", "define", "random", "design", "start", "forces", "law", "kinds", "ends"] {
            // One condition stands in the place of the table.
            if table == "ends" && known.iter().any(|key| key == " ends") {
                continue;
            }
            if !table.is_empty() {
                text.extend(["[task.", table, "]\n"]);
            }
            let own = lines.iter().filter(|(of, _)| *of == table).flat_map(|(_, text)| text.lines());
            let base = base.iter().filter(|(of, _)| *of == table).flat_map(|(_, text)| text.lines());
            for line in own.chain(base) {
                // A key stands once in a table.
                let key = format!("{table} {}", line.split(" = ").next().unwrap().trim_matches('"'));
                if !known.contains(&key) {
                    known.push(key);
                    text.extend([line, "\n"]);
                }
            }
        }
        text
    })
}

/// A change of a text: a number by an odd one, a piece left out, said twice, or another word.
fn changed(text: &str, (at, what, with): &(prop::sample::Index, u8, usize)) -> String {
    const ODD: [&str; 14] = [
        "-1",
        "0",
        "1e30",
        "nan",
        "inf",
        "1e-30",
        "99999999",
        "",
        "0 0 0",
        "-0.5",
        "1e300",
        "2147483648",
        "free",
        "ball",
    ];
    let words: Vec<&str> = text.split_inclusive([' ', '"', '\n', '<', '>']).collect();
    let place = at.index(words.len());
    let numbers: Vec<usize> =
        (0..words.len()).filter(|&i| words[i].starts_with(|c: char| c.is_ascii_digit() || c == '-')).collect();
    let mut words = words;
    let odd = format!("{}{}", ODD[with % ODD.len()], if what % 2 == 0 { "\"" } else { " " });
    match what % 6 {
        0..=2 if !numbers.is_empty() => words[numbers[at.index(numbers.len())]] = &odd,
        3 => drop(words.drain(place..(place + 1 + with % 5).min(words.len()))),
        4 => {
            let said: Vec<&str> = words[place..(place + 1 + with % 20).min(words.len())].to_vec();
            words.splice(place..place, said);
        }
        _ => {
            let other = words[with % words.len()];
            words[place] = other;
        }
    }
    words.concat()
}

fn changes() -> impl Strategy<Value = Vec<(prop::sample::Index, u8, usize)>> {
    prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), any::<usize>()), 1..3)
}

fn changed_by(changes: &[(prop::sample::Index, u8, usize)]) -> String {
    changes.iter().fold(MODEL.to_owned(), |text, change| changed(&text, change))
}

fn try_out(experiment: &str, model: &str) -> bool {
    fuzz::robot(&format!("{experiment}{}{model}", fuzz::BETWEEN), catalogue())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases()) })]

    #[test]
    fn any_experiment(experiment in experiment()) {
        try_out(&experiment, MODEL);
    }

    #[test]
    fn any_model(changes in changes()) {
        try_out(BASE, &changed_by(&changes));
    }
}

/// Noise alone would test nothing but the reader.
#[test]
fn enough_of_them_move() {
    let mut runner = TestRunner::deterministic();
    let mut moves = |strategy: BoxedStrategy<(String, String)>| {
        let texts = (0..200).map(|_| strategy.new_tree(&mut runner).unwrap().current());
        texts.filter(|(experiment, model)| try_out(experiment, model)).count()
    };
    let (experiments, models) = (
        moves(experiment().prop_map(|text| (text, MODEL.to_owned())).boxed()),
        moves(changes().prop_map(|changes| (BASE.to_owned(), changed_by(&changes))).boxed()),
    );
    assert!(experiments > 30 && models > 30, "{experiments} of 200 experiments and {models} models");
}
