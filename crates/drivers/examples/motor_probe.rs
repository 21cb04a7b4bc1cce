//! `motor_probe PORT`: our driver of the motor, one line of JSON for each line that it reads: `ping`, `read ADDRESS BYTES`,
//! `write ADDRESS BYTES VALUE`, `prepare`, `torque on`, `torque off`, `goal RAD A`, `state`. For `scripts/dynamixel_peer.py`.

use std::error::Error;
use std::io::{self, Write};
use std::time::Duration;

use hwasp_drivers::{DriverError, Dynamixel, DynamixelSettings, Motor};

fn main() -> Result<(), Box<dyn Error>> {
    let port = std::env::args_os().nth(1).ok_or("motor_probe PORT")?.into();
    let mut motor =
        Dynamixel::open(DynamixelSettings { port, reply: Duration::from_secs(1), ..DynamixelSettings::default() })?;
    let mut output = io::stdout();
    for line in io::stdin().lines() {
        let line = line?;
        let words: Vec<_> = line.split_whitespace().collect();
        match follow(&mut motor, &words)? {
            Ok(answer) => writeln!(output, "{answer}")?,
            Err(error) => writeln!(output, "{{\"error\": {:?}}}", error.to_string())?,
        }
        output.flush()?;
    }
    Ok(())
}

/// The answer as JSON, or what the driver says; the outer error is of whoever wrote the line.
fn follow(motor: &mut Dynamixel, words: &[&str]) -> Result<Result<String, DriverError>, Box<dyn Error>> {
    let done = |result: Result<(), DriverError>| result.map(|()| "{}".to_owned());
    Ok(match *words {
        ["ping"] => motor.identify().map(|who| format!("{{\"value\": {}, \"firmware\": {}}}", who.model, who.firmware)),
        ["read", at, bytes] => {
            motor.register(at.parse()?, bytes.parse()?).map(|value| format!("{{\"value\": {value}}}"))
        }
        ["write", at, bytes, value] => done(motor.set_register(at.parse()?, bytes.parse()?, value.parse()?)),
        ["prepare"] => motor.prepare().map(|changed| format!("{{\"changed\": {}}}", changed.len())),
        ["torque", "on"] => done(motor.torque(true)),
        ["torque", "off"] => done(motor.torque(false)),
        ["goal", position, current] => done(motor.goal(position.parse()?, current.parse()?)),
        ["state"] => motor.state().map(|state| {
            format!(
                "{{\"position\": {}, \"velocity\": {}, \"current\": {}, \"voltage\": {}, \"temperature\": {}, \
                 \"hardware_error\": {}, \"torque\": {}}}",
                state.position,
                state.velocity,
                state.current,
                state.voltage,
                state.temperature,
                state.hardware_error,
                state.torque
            )
        }),
        _ => return Err(format!("no such line: {words:?}").into()),
    })
}
