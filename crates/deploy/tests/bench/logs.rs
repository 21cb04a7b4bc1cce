//! Logs are written, read back, and lost where a disk is full.

use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use hwasp_deploy::log::{About, LogWriter, read};
use hwasp_deploy::record::{Event, Phase, Sink, Step};
use hwasp_deploy::safety::{Cause, Response};
use hwasp_drivers::{ArmMode, Safety};
use hwasp_tasks::grasp::ShapeKind;

fn about() -> About {
    About {
        what: "run".to_owned(),
        run: "results/z-grasp".to_owned(),
        experiment: "z-grasp".to_owned(),
        observation: ["palm_z", "motor_travel"].map(str::to_owned).to_vec(),
        command: vec!["motor".to_owned()],
        period: 0.01,
        design: vec![0.01, 0.02],
        torque_per_current: 1.3,
        spool_radius: 0.008,
        winding_sign: 1.0,
        object: "carried".to_owned(),
        motor: "0".repeat(64),
        version: "0".to_owned(),
    }
}

fn step(i: u32) -> Step {
    let mut seen = [f64::NAN; 16];
    (seen[0], seen[1]) = (0.2, 1e-3 * f64::from(i));
    let mut commanded = [f64::NAN; 8];
    commanded[0] = 1e-4;
    Step {
        time: 0.01 * f64::from(i),
        episode: 3,
        phase: Phase::Grasp,
        step: i,
        late: 1e-4,
        seen,
        commanded,
        palm: [0.0, 0.01, 0.2],
        palm_target: [0.0, 0.01, 0.199],
        tool_speed: [0.0, 0.0, -0.1],
        arm_clock: 5.0,
        arm_age: 0.002,
        arm_mode: ArmMode::Running,
        arm_safety: Safety::Normal,
        wound: 0.004,
        goal: f64::NAN,
        travel: 0.005,
        velocity: 0.1,
        current: 0.2,
        torque: 0.26,
        voltage: 12.0,
        temperature: 40.0,
        motor_age: 0.003,
        response: Response::GoOn,
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("hwasp-log-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn write(name: &str) -> PathBuf {
    let mut log = LogWriter::create(&folder(name), "log", &about()).unwrap();
    log.event(0.0, 3, Event::Episode { size: [0.06; 3], place: [0.0, 0.0, 0.03], shape: Some(ShapeKind::Box) });
    for i in 0..250 {
        log.step(&step(i));
        // As the loop does, not all at once: the queue is as long as a disk may be slow.
        if i % 50 == 0 {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
    log.event(2.5, 3, Event::Decided(Response::SetDown, Cause::Heat));
    log.finish().unwrap()
}

#[test]
fn what_was_written_is_read() {
    let path = write("whole");
    let logged = read(&path).unwrap();
    assert_eq!(logged.about, about());
    assert_eq!(logged.rows.len(), 250);
    let row = &logged.rows[7];
    assert_eq!((row.episode, row.phase.as_str(), row.response.as_str()), (3, "grasp", "go on"));
    assert_eq!((row.seen.clone(), row.commanded.clone()), (vec![0.2, 7e-3], vec![1e-4]));
    assert!((row.time - 0.07).abs() < 1e-6 && row.goal.is_nan(), "{row:?}");
    assert_eq!(
        (row.palm, row.palm_target, row.wound, row.motor_age),
        ([0.0, 0.01, 0.2], [0.0, 0.01, 0.199], 0.004, 0.003)
    );
    let object = logged.episodes[&3];
    assert_eq!((object.size, object.shape), ([0.06; 3], Some(ShapeKind::Box)));
    assert_eq!(logged.events[1].3, "set down: the motor is too hot");
    let csv = std::fs::read_to_string(path.with_extension("csv")).unwrap();
    assert_eq!(csv.lines().count(), 251);
    let columns = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == columns || line.ends_with('"')), "{csv}");
    // A name that is taken is not overwritten.
    let taken = LogWriter::create(path.parent().unwrap(), "log", &about()).unwrap_err().to_string();
    assert!(taken.contains("log.mcap") && taken.contains("cannot be written"), "{taken}");
}

#[test]
fn a_log_that_was_cut_off_is_read_up_to_there() {
    let path = write("cut");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..2 * bytes.len() / 3]).unwrap();
    let logged = read(&path).unwrap();
    assert!(logged.rows.len() >= 50 && logged.rows.len() < 250, "{} steps", logged.rows.len());
    for nonsense in [&b"no log"[..], b"", &bytes[..20]] {
        std::fs::write(&path, nonsense).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("no log of `hwasp deploy`"), "{error}");
    }
}

/// A disk with room for so many bytes.
struct Full {
    inner: Cursor<Vec<u8>>,
    left: Arc<Mutex<usize>>,
}

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut left = self.left.lock().unwrap();
        if bytes.len() > *left {
            return Err(io::Error::new(io::ErrorKind::StorageFull, "No space left on device"));
        }
        *left -= bytes.len();
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Full {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

#[test]
fn a_full_disk_is_told() {
    let disk = |bytes| Box::new(Full { inner: Cursor::default(), left: Arc::new(Mutex::new(bytes)) });
    for (mcap, csv) in [(60_000, usize::MAX), (usize::MAX, 3000)] {
        let mut log = LogWriter::to(disk(mcap), disk(csv), &about(), "log.mcap".into()).unwrap();
        let begin = Instant::now();
        let mut i = 0;
        while !log.lost() && begin.elapsed() < Duration::from_secs(10) {
            log.step(&step(i));
            i += 1;
            std::thread::sleep(Duration::from_micros(100));
        }
        assert!(log.lost(), "after {i} steps");
        let error = log.finish().unwrap_err().to_string();
        assert!(error.contains("No space left"), "{error}");
    }
}
