//! The program that runs on the controller, in its own language.
//!
//! It follows or moves only while its heart beats, and begins nothing by itself: what stands in the registers when it starts is
//! old, and only a new number makes it a command.

use super::registers as r;
use super::registers::{Command, Doing};
use super::settings::UrSettings;
use crate::arm::Pose;

/// An order that the program gives itself when the heart has stopped.
const LOST: i32 = 99;

/// What it says, with names in braces for what it depends on.
const TEXT: &str = "\
def hwasp_arm():
  # hwasp arm {version}
  global goal = p[0, 0, 0, 0, 0, 0]
  global pace = 0
  global arrived = 0
  def target():
    return p[{target}]
  end
  thread straight():
    movel(goal, a={acceleration}, v=pace)
    arrived = 1
  end
{setup}  number = read_input_integer_register({number})
  beat = read_input_integer_register({beat})
  silence = 0
  doing = {standing}
  mover = 0
  write_output_integer_register({program}, {version})
  write_output_integer_register({heard}, beat)
  write_output_integer_register({taken}, number)
  write_output_integer_register({out}, doing)
  while doing < {deserted}:
    if read_input_integer_register({beat}) != beat:
      beat = read_input_integer_register({beat})
      silence = 0
    else:
      silence = silence + 1
    end
    order = -1
    if read_input_integer_register({number}) != number:
      number = read_input_integer_register({number})
      order = read_input_integer_register({command})
    end
    if silence > {silence} and doing > {standing}:
      order = {lost}
    end
    if order >= 0 and doing == {moving}:
      kill mover
      stopl({acceleration})
      doing = {standing}
    end
    if order == {follow}:
      doing = {following}
    elif order == {straight}:
      goal = target()
      pace = read_input_float_register({speed})
      arrived = 0
      doing = {moving}
      mover = run straight()
    elif order >= 0:
      if doing == {following}:
        stopj({deceleration})
      end
      doing = {standing}
      if order == {end}:
        doing = {ended}
      elif order == {lost}:
        doing = {deserted}
      end
    end
    if doing == {moving} and arrived == 1:
      doing = {standing}
    end
    write_output_integer_register({heard}, beat)
    write_output_integer_register({taken}, number)
    write_output_integer_register({out}, doing)
    if doing == {following}:
      servoj(get_inverse_kin(target()), t={period}, lookahead_time={lookahead}, gain={gain})
    else:
      sync()
    end
  end
end
";

/// The program for an arm whose controller computes once in `period` s (0.008 on CB3, 0.002 on e-Series).
pub fn program(settings: &UrSettings, period: f64) -> String {
    let silence = (settings.watchdog.as_secs_f64() / period).ceil() as u64;
    let target: Vec<String> = (r::TARGET..r::TARGET + 6).map(|at| format!("read_input_float_register({at})")).collect();
    let real = |value: f64| format!("{value:.4}");
    let whole = |value: i32| value.to_string();
    let register = |at: u8| at.to_string();
    let named = [
        ("setup", setup(settings)),
        ("target", target.join(", ")),
        ("acceleration", real(settings.acceleration)),
        ("deceleration", real(settings.deceleration)),
        ("lookahead", real(settings.lookahead)),
        ("gain", real(settings.gain)),
        ("period", real(period)),
        ("silence", silence.to_string()),
        ("number", register(r::NUMBER)),
        ("beat", register(r::BEAT)),
        ("command", register(r::COMMAND)),
        ("speed", register(r::SPEED)),
        ("program", register(r::PROGRAM)),
        ("heard", register(r::HEARD)),
        ("taken", register(r::TAKEN)),
        ("out", register(r::DOING)),
        ("version", whole(r::VERSION)),
        ("standing", whole(Doing::Standing as i32)),
        ("following", whole(Doing::Following as i32)),
        ("moving", whole(Doing::Moving as i32)),
        ("deserted", whole(Doing::Deserted as i32)),
        ("ended", whole(Doing::Ended as i32)),
        ("follow", whole(Command::Follow as i32)),
        ("straight", whole(Command::Move as i32)),
        ("end", whole(Command::End as i32)),
        ("lost", whole(LOST)),
    ];
    named.iter().fold(TEXT.to_owned(), |text, (name, value)| text.replace(&format!("{{{name}}}"), value))
}

/// What is told to the controller before anything else.
fn setup(settings: &UrSettings) -> String {
    let tcp = settings.tcp.as_ref().map(|tcp| format!("  set_tcp({})\n", pose(tcp)));
    let payload = settings.payload.as_ref().map(|payload| {
        let [x, y, z] = payload.center;
        format!("  set_payload({:.4}, [{x:.5}, {y:.5}, {z:.5}])\n", payload.mass)
    });
    [tcp, payload].into_iter().flatten().collect()
}

fn pose(pose: &Pose) -> String {
    let [x, y, z] = pose.position;
    let [a, b, c] = pose.rotation;
    format!("p[{x:.6}, {y:.6}, {z:.6}, {a:.6}, {b:.6}, {c:.6}]")
}
