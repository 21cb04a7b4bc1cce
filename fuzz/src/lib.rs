//! What is done with bytes of strangers. The fuzz targets call it, and `crates/runs/tests/fuzz_corpus.rs`, which includes
//! this file, replays all inputs that were kept.

mod formula;
mod robot;

use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use hwasp_algos::{Archive, Array};
use hwasp_core::Serial;
use hwasp_experiment::{Catalogue, Layers, load, resolve};
use hwasp_runs::checkpoint::{Header, decode, encode};
use hwasp_runs::metrics::{Columns, MetricsTable, MetricsWriter};
use hwasp_runs::{read_policy, write_policy};
use hwasp_training::{Assembly, Checkpoint, Event, MetricsRow, Observer, ObserverError, params_at, train_from};

/// The hash that stands for an experiment.
const EXPERIMENT: &str = "experiment";

/// The smallest trainings of every kind of thing that learns: method, what is not as in [`tiny`].
const KINDS: [(&str, &str); 10] = [
    ("hwasp", ""),
    ("hwasp", "learner.algorithm=trpo baseline.kind=linear"),
    ("episode", "controller.sees_design=true"),
    ("cmaes", ""),
    ("cmaes", "cmaes.separable=true cmaes.restarts=3 cmaes.popsize=4"),
    ("ars", "ars.variant=v2-t ars.directions=2"),
    ("cmaes-rl", "cmaes.popsize=4 cmaes.restarts=1 train.env_steps=120"),
    ("ars-rl", "ars.directions=1 baseline.kind=linear train.env_steps=120"),
    ("bo-rl", "bo.popsize=2 bo.initial_points=2 train.env_steps=120"),
    ("random-rl", "random.popsize=2 train.env_steps=120"),
];

static CATALOGUE: LazyLock<Catalogue> = LazyLock::new(hwasp_builtin::catalogue);

/// Steps of an iteration: 2 episodes of 5 steps.
const TINY: &str = "task.horizon=5 train.episodes_per_iteration=2 train.episode_steps=5 train.env_steps=400 \
                    train.evaluation_episodes=1 search.episodes=1 search.inner_env_steps=20 controller.hidden=[2] \
                    baseline.hidden=[2] ppo.epochs=1 ppo.minibatch_rows=0 baseline.epochs=1 baseline.minibatch_rows=0";

fn tiny(method: &str, settings: &str) -> Assembly {
    let layers = load("reach", &CATALOGUE).expect("the reach problem is built in");
    let layers = TINY.split(' ').chain(settings.split_whitespace()).fold(layers, Layers::with_assignment);
    Assembly::new(&resolve(layers, Some(method), &CATALOGUE).expect("sound settings")).expect("a sound experiment")
}

/// Keeps every checkpoint there can be.
#[derive(Default)]
struct Keeper(Vec<Checkpoint>);

impl Observer for Keeper {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if let Event::Checkpoint(checkpoint) = event {
            self.0.push(checkpoint.clone());
        }
        Ok(())
    }

    fn due(&self) -> bool {
        true
    }
}

/// Every tiny training, with all its checkpoints.
static TRAININGS: LazyLock<Vec<(Assembly, Vec<Checkpoint>)>> = LazyLock::new(|| {
    let train = |&(method, settings): &(&str, &str)| {
        let (assembly, mut keeper) = (tiny(method, settings), Keeper::default());
        let trained = train_from(None, &assembly, &Serial, &mut keeper, &AtomicBool::new(false));
        trained.expect("a training that nobody disturbs");
        (assembly, keeper.0)
    };
    KINDS.iter().map(train).collect()
});

/// An experiment file: faults, or an `Experiment` whose own file gives it again.
pub fn experiment(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let read = |text: &str| Layers::from_text("fuzz.toml", text).and_then(|layers| resolve(layers, None, &CATALOGUE));
    match read(text) {
        Ok(experiment) => {
            let written = experiment.to_toml().expect("a resolved experiment can be written");
            assert_eq!(read(&written).expect("what was written resolves"), experiment, "{written}");
        }
        Err(faults) => assert!(!faults.to_string().is_empty()),
    }
}

/// A formula.
pub fn formula(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        formula::formula(text);
    }
}

/// An experiment of a robot of one's own, with its model.
pub fn robot(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        robot::robot(text, &CATALOGUE);
    }
}

/// A checkpoint as a file: refused, or read so that it gives the same bits once it is written and read again.
pub fn checkpoint(bytes: &[u8]) {
    if let Ok(header) = Header::read(bytes)
        && let Ok(read) = decode(bytes, &header.experiment)
    {
        comes_back(&read, header.fault.as_deref());
    }
    let _ = decode(bytes, EXPERIMENT).map_err(|error| error.to_string());
}

fn comes_back(checkpoint: &Checkpoint, fault: Option<&str>) {
    let bytes = encode(checkpoint, EXPERIMENT, fault).expect("a checkpoint can be written");
    let read = decode(&bytes, EXPERIMENT).expect("what was written can be read");
    assert_eq!(encode(&read, EXPERIMENT, fault).expect("and written again"), bytes);
    assert_eq!((read.iteration, read.env_steps), (checkpoint.iteration, checkpoint.env_steps));
    let bits = |archive: &Archive| archive.iter().map(|(name, array)| (name.clone(), bits(array))).collect::<Vec<_>>();
    assert_eq!(bits(&read.archive), bits(&checkpoint.archive));
}

/// The kind of an array, and the bits of its numbers.
fn bits(array: &Array) -> (usize, Vec<u64>) {
    match array {
        Array::F32(v) => (0, v.iter().map(|x| x.to_bits().into()).collect()),
        Array::F64(v) => (1, v.iter().map(|x| x.to_bits()).collect()),
        Array::U64(v) => (2, v.clone()),
    }
}

fn of_bits(kind: usize, bits: Vec<u64>) -> Array {
    match kind % 3 {
        0 => Array::F32(bits.into_iter().map(|x| f32::from_bits(x as u32)).collect()),
        1 => Array::F64(bits.into_iter().map(f64::from_bits).collect()),
        _ => Array::U64(bits),
    }
}

/// What lies behind the checksum: the state of a real training, changed as the bytes say, is resumed. That may be refused,
/// may fail, and may train on; parameters that come out are those of the policy.
pub fn state(bytes: &[u8]) {
    let mut bytes = bytes.iter().copied();
    let mut next = || bytes.next().map(usize::from);
    let (Some(kind), Some(which), Some(stop)) = (next(), next(), next()) else { return };
    let (assembly, checkpoints) = &TRAININGS[kind % TRAININGS.len()];
    let mut checkpoint = checkpoints[which % checkpoints.len()].clone();
    while let (Some(edit), Some(array)) = (next(), next()) {
        let place = [next(), next()].map(Option::unwrap_or_default);
        change(&mut checkpoint.archive, edit, array, place, std::array::from_fn(|_| next().unwrap_or_default() as u8));
    }
    comes_back(&checkpoint, None);
    match params_at(assembly, &checkpoint) {
        Ok(params) => assert_eq!(params.len(), assembly.init().len()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    let stop = AtomicBool::new(stop % 2 == 1);
    if let Ok(trained) = train_from(Some(&checkpoint), assembly, &Serial, &mut Keeper::default(), &stop) {
        assert_eq!(trained.params.len(), assembly.init().len());
    }
}

/// One change of an archive: an array removed, renamed, of another kind, longer or shorter, or with another number.
fn change(archive: &mut Archive, edit: usize, array: usize, [at, more]: [usize; 2], number: [u8; 8]) {
    let Some(name) = archive.keys().nth(array % archive.len().max(1)).cloned() else { return };
    let Some(old) = archive.remove(&name) else { return };
    let (kind, mut values) = bits(&old);
    let number = u64::from_le_bytes(number);
    // In the kind of the array, numbers that the bytes alone would seldom hit.
    let odd = |value: f64| match kind {
        0 => u64::from((value as f32).to_bits()),
        1 => value.to_bits(),
        _ => value as u64,
    };
    let place = (at + 256 * more) % values.len().max(1);
    let mut put = |value: u64| values.iter_mut().skip(place).take(1).for_each(|v| *v = value);
    match edit % 16 {
        0 => return,
        1 => {
            let other = archive.keys().nth(at % archive.len().max(1)).cloned().unwrap_or_default();
            archive.insert(other, old);
            return;
        }
        2 => {
            archive.insert(format!("{name}{number}"), old);
            return;
        }
        3 => {
            archive.insert(name, of_bits(kind + 1 + at, values));
            return;
        }
        4 => values.truncate(at),
        5 => values.resize(at + 4 * more, number),
        6 => values.fill(number),
        7 => put(number),
        8 => put(odd(f64::NAN)),
        9 => put(odd(f64::INFINITY)),
        10 => put(odd(0.0)),
        11 => put(odd(-1.0)),
        12 => put(odd(1e300)),
        13 => values.fill(odd(1e300)),
        14 => put(odd(1e-300)),
        _ => put(number & 7),
    }
    archive.insert(name, of_bits(kind, values));
}

/// A policy file: refused, or parameters that come back with all bits.
pub fn policy(bytes: &[u8]) {
    let policy = &TRAININGS[0].0.policy;
    match read_policy(policy, bytes) {
        Ok(params) => {
            let bytes = write_policy(policy, &params).expect("parameters can be written");
            let again = read_policy(policy, &bytes).expect("what was written can be read");
            let bits = |params: &[f32]| params.iter().map(|p| p.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&again), bits(&params));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A learning curve: refused, or a table that comes back with all bits, and of which every beginning can be had.
pub fn metrics(bytes: &[u8]) {
    let table = match MetricsTable::read(bytes) {
        Ok(table) => table,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            let _ = MetricsTable::read_before(bytes, 1);
            return;
        }
    };
    let learner: Vec<&str> = table.learner.iter().map(String::as_str).collect();
    let columns = Columns { learner: &learner, terms: &table.terms, totals: &table.design_totals };
    let mut writer = MetricsWriter::new(Vec::new(), columns).expect("names that were read");
    table.rows.iter().for_each(|row| writer.append(row).expect("a row that was read"));
    let again = MetricsTable::read(&writer.into_inner()[..]).expect("what was written can be read");
    assert_eq!((again.design_totals, again.unfinished_line), (table.design_totals, None));
    let bits = |rows: &[MetricsRow]| rows.iter().map(bits_of_row).collect::<Vec<_>>();
    assert_eq!(bits(&again.rows), bits(&table.rows));
    for iteration in table.rows.iter().map(|row| row.iteration).chain([0, u64::MAX]).take(8) {
        let before = MetricsTable::read_before(bytes, iteration).expect("a part of what can be read");
        assert!(before.rows.iter().all(|row| row.iteration < iteration));
        assert_eq!(bits(&before.rows), bits(&table.rows[..before.rows.len()]));
    }
}

fn bits_of_row(row: &MetricsRow) -> Vec<u64> {
    let fixed = [row.wall_s, row.discounted_return, row.undiscounted_return];
    let counts = [row.iteration, row.env_steps].into_iter();
    counts
        .chain(fixed.iter().chain(&row.learner).chain(&row.terms).chain(&row.design_totals).map(|v| v.to_bits()))
        .collect()
}
