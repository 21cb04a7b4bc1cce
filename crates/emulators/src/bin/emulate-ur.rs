//! `emulate-ur [cb3|e-series] [ADDRESS] [vendor]`: an emulated arm as a process of its own.
//!
//! It listens at the vendor's ports, or at any free ones, and writes one line with its ports as JSON. Each line that it reads is
//! an order: a fault, `clear`, `tool` (it answers with pose, speed and joints as JSON) or `messages`. It ends with its input.

use std::io::{BufRead, Write};
use std::process::ExitCode;

use hwasp_emulators::ur::{Alone, Generation, Ports, UrEmulatorSettings};

fn main() -> ExitCode {
    match serve(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(cause) => {
            let _ = writeln!(std::io::stderr(), "emulate-ur: {cause}");
            ExitCode::FAILURE
        }
    }
}

fn serve(words: &[String]) -> Result<(), String> {
    let mut settings = UrEmulatorSettings::new(Generation::Cb3);
    for word in words {
        match word.as_str() {
            "cb3" => {}
            "e-series" => {
                settings = UrEmulatorSettings {
                    address: settings.address,
                    ports: settings.ports,
                    ..UrEmulatorSettings::new(Generation::ESeries)
                }
            }
            "vendor" => settings.ports = Ports::VENDOR,
            address => {
                settings.address = address
                    .parse()
                    .map_err(|_| format!("{address:?} is none of cb3, e-series, vendor, and no address"))?;
            }
        }
    }
    let alone = Alone::start(&settings).map_err(|cause| cause.to_string())?;
    let ports = alone.emulator().ports();
    let say = |text: &str| writeln!(std::io::stdout(), "{text}").map_err(|cause| cause.to_string());
    say(&format!(r#"{{"rtde": {}, "dashboard": {}, "script": {}}}"#, ports.rtde, ports.dashboard, ports.script))?;
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|cause| cause.to_string())?;
        match line.trim() {
            "" => {}
            "tool" => {
                let emulator = alone.emulator();
                let (tool, speed, joints) = (emulator.tool(), emulator.tool_speed(), emulator.joints());
                drop(emulator);
                let pose = [tool.position, tool.rotation].concat();
                say(&format!(r#"{{"tool": {pose:?}, "speed": {speed:?}, "joints": {joints:?}}}"#))?;
            }
            "messages" => say(&format!("{:?}", alone.emulator().messages()))?,
            fault => match alone.emulator().inject(fault) {
                Ok(()) => say("ok")?,
                Err(cause) => say(&format!("error: {cause}"))?,
            },
        }
    }
    Ok(())
}
