//! Functions of the controller that programs call, by the manual of its language.

use nalgebra::Isometry3;

use super::controller::{Controller, REGISTERS};
use super::kinematics::{frame_of, pose_of};
use super::script::{Answer, Arguments, Controller as Functions, Value, Wait};
use hwasp_drivers::Pose;

/// Nothing to hand back, nothing to wait for.
fn done() -> Answer {
    Answer(Value::Nothing, Wait::No)
}

fn value(value: Value) -> Answer {
    Answer(value, Wait::No)
}

fn six(pose: &Pose) -> [f64; 6] {
    let ([x, y, z], [a, b, c]) = (pose.position, pose.rotation);
    [x, y, z, a, b, c]
}

fn frame(value: &Value) -> Result<Isometry3<f64>, String> {
    let [x, y, z, a, b, c] = value.six()?;
    Ok(frame_of(&Pose { position: [x, y, z], rotation: [a, b, c] }))
}

fn register(arguments: &Arguments) -> Result<usize, String> {
    let number = arguments.need(0, "address")?.number()?;
    if number >= 0.0 && number < REGISTERS as f64 {
        Ok(number as usize)
    } else {
        Err(format!("there is no register {number}"))
    }
}

impl Functions for Controller {
    fn over(&self, motion: u64) -> bool {
        self.body.count != motion || self.body.still()
    }

    fn call(&mut self, name: &str, arguments: &Arguments) -> Result<Answer, String> {
        if let Some(answer) = self.registers(name, arguments)? {
            return Ok(answer);
        }
        if let Some(answer) = self.moves(name, arguments)? {
            return Ok(answer);
        }
        if let Some(answer) = self.tells(name, arguments)? {
            return Ok(answer);
        }
        match name {
            "sync" => Ok(Answer(Value::Nothing, Wait::Period)),
            "sleep" => Ok(Answer(Value::Nothing, Wait::Time(arguments.need(0, "t")?.number()?))),
            "textmsg" | "popup" => {
                self.say(arguments.text());
                Ok(done())
            }
            "set_tcp" => {
                let pose = arguments.need(0, "pose")?.six()?;
                self.set_tcp(&pose);
                Ok(done())
            }
            "set_payload" => {
                self.payload.0 = arguments.need(0, "m")?.number()?;
                if let Some(Value::List(center)) = arguments.get(1, "cog") {
                    for (axis, part) in center.iter().take(3).enumerate() {
                        self.payload.1[axis] = part.number()?;
                    }
                }
                Ok(done())
            }
            "protective_stop" => {
                self.protective_stop();
                Ok(Answer(Value::Nothing, Wait::Period))
            }
            // The arm feels no force: there is nothing to scale.
            "force_mode_set_gain_scaling" | "force_mode_set_damping" | "end_force_mode" => Ok(done()),
            _ => Err("this function is not emulated".to_owned()),
        }
    }
}

impl Controller {
    fn registers(&mut self, name: &str, arguments: &Arguments) -> Result<Option<Answer>, String> {
        Ok(Some(match name {
            "read_input_float_register" => value(Value::Number(self.inputs.reals[register(arguments)?])),
            "read_input_integer_register" => value(Value::Number(f64::from(self.inputs.wholes[register(arguments)?]))),
            "read_input_boolean_register" => value(Value::Truth(self.inputs.bits[register(arguments)?])),
            "read_output_float_register" => value(Value::Number(self.outputs.reals[register(arguments)?])),
            "read_output_integer_register" => {
                value(Value::Number(f64::from(self.outputs.wholes[register(arguments)?])))
            }
            "write_output_float_register" => {
                self.outputs.reals[register(arguments)?] = arguments.need(1, "value")?.number()?;
                done()
            }
            "write_output_integer_register" => {
                self.outputs.wholes[register(arguments)?] = arguments.need(1, "value")?.number()? as i32;
                done()
            }
            "write_output_boolean_register" => {
                self.outputs.bits[register(arguments)?] = arguments.need(1, "value")?.truth()?;
                done()
            }
            _ => return Ok(None),
        }))
    }

    fn moves(&mut self, name: &str, arguments: &Arguments) -> Result<Option<Answer>, String> {
        let period = self.period();
        Ok(Some(match name {
            "servoj" => {
                let target = arguments.need(0, "q")?.six()?;
                let time = arguments.number_or(3, "t", period)?.max(period);
                let lag = within(arguments.number_or(4, "lookahead_time", 0.1)?, 0.03, 0.2, "lookahead_time")?;
                within(arguments.number_or(5, "gain", 300.0)?, 100.0, 2000.0, "gain")?;
                self.body.follow(target, lag, time, period);
                let wait = if time > period { Wait::Time(time) } else { Wait::Period };
                Answer(Value::Nothing, wait)
            }
            "movel" | "movej" => {
                let straight = name == "movel";
                let target = arguments.need(0, "pose")?;
                let acceleration = arguments.number_or(1, "a", if straight { 1.2 } else { 1.4 })?;
                let speed = arguments.number_or(2, "v", if straight { 0.25 } else { 1.05 })?;
                if !(speed > 0.0 && acceleration > 0.0) {
                    return Err(format!("a = {acceleration} and v = {speed} have to be above 0"));
                }
                let joints = match target {
                    Value::Pose(pose) => self.reach(pose, &self.body.q).ok_or("the pose is out of reach")?,
                    list => list.six()?,
                };
                if straight {
                    let to = self.body.lengths.forward(&joints);
                    self.body.straight(to, speed, acceleration).ok_or("the pose is out of reach")?;
                } else {
                    self.body.joints(joints, speed, acceleration);
                }
                Answer(Value::Nothing, Wait::Motion(self.body.count))
            }
            "stopl" | "stopj" => {
                let mut deceleration = within(arguments.number_or(0, "a", 10.0)?, 1e-3, 1e3, "a")?;
                let speed = self.speed();
                if name == "stopl" && speed > 1e-6 {
                    // Of the tool, m/s²; its joints come to rest with it.
                    deceleration *= self.body.qd.iter().fold(0.0_f64, |most, qd| most.max(qd.abs())) / speed;
                }
                self.body.stop(deceleration);
                Answer(Value::Nothing, Wait::Motion(self.body.count))
            }
            _ => return Ok(None),
        }))
    }

    fn tells(&mut self, name: &str, arguments: &Arguments) -> Result<Option<Answer>, String> {
        let pose = |frame: &Isometry3<f64>| value(Value::Pose(six(&pose_of(frame))));
        Ok(Some(match name {
            "get_inverse_kin" => {
                let target = arguments.need(0, "x")?.six()?;
                let near = arguments.get(1, "qnear").map_or(Ok(self.body.q), Value::six)?;
                value(Value::list(&self.reach(&target, &near).ok_or("the pose is out of reach")?))
            }
            "get_forward_kin" => {
                let q = arguments.get(0, "q").map_or(Ok(self.body.q), Value::six)?;
                let tcp = arguments.get(1, "tcp").map_or(Ok(self.tcp), frame)?;
                pose(&(self.body.lengths.forward(&q) * tcp))
            }
            "get_actual_tcp_pose" | "get_target_tcp_pose" => pose(&self.frame()),
            "get_actual_tool_flange_pose" => pose(&self.body.lengths.forward(&self.body.q)),
            "get_tcp_offset" => pose(&self.tcp),
            "get_actual_joint_positions" | "get_target_joint_positions" => value(Value::list(&self.body.q)),
            "get_actual_joint_speeds" => value(Value::list(&self.body.qd)),
            "get_target_payload" => value(Value::Number(self.payload.0)),
            "get_target_payload_cog" => value(Value::list(&self.payload.1)),
            "get_steptime" => value(Value::Number(self.period())),
            "is_steady" => value(Value::Truth(self.body.still())),
            "is_within_safety_limits" => {
                let reached = match arguments.need(0, "pose")? {
                    Value::Pose(target) => self.reach(target, &self.body.q).is_some(),
                    _ => true,
                };
                value(Value::Truth(reached))
            }
            "pose_trans" => pose(&(frame(arguments.need(0, "p_from")?)? * frame(arguments.need(1, "p_from_to")?)?)),
            "pose_inv" => pose(&frame(arguments.need(0, "p_from")?)?.inverse()),
            "norm" => match arguments.need(0, "a")? {
                Value::List(list) => {
                    let squares = list.iter().map(|part| part.number().map(|number| number * number));
                    value(Value::Number(squares.sum::<Result<f64, String>>()?.sqrt()))
                }
                other => value(Value::Number(other.number()?.abs())),
            },
            _ => return Ok(None),
        }))
    }
}

fn within(value: f64, lowest: f64, highest: f64, name: &str) -> Result<f64, String> {
    if value >= lowest && value <= highest {
        Ok(value)
    } else {
        Err(format!("{name} = {value} is not {lowest} to {highest}"))
    }
}
