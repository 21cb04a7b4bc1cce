//! What a motor does with a packet, and what it answers.

use super::device::Device;
use super::frame::{Arrival, packet};
use super::memory::Refusal;
use super::table;

const PING: u8 = 0x01;
const READ: u8 = 0x02;
const WRITE: u8 = 0x03;
const REG_WRITE: u8 = 0x04;
const ACTION: u8 = 0x05;
const FACTORY_RESET: u8 = 0x06;
const REBOOT: u8 = 0x08;
const CLEAR: u8 = 0x10;
const STATUS: u8 = 0x55;
const SYNC_READ: u8 = 0x82;
const SYNC_WRITE: u8 = 0x83;
const BULK_READ: u8 = 0x92;
const BULK_WRITE: u8 = 0x93;
/// Everybody on the bus.
const BROADCAST: u8 = 0xFE;
/// What a packet that clears the count of turns says.
const CLEAR_TURNS: [u8; 5] = [0x01, 0x44, 0x58, 0x4C, 0x22];

/// How much a motor answers, by the register of that name.
const ANSWERS_READS: i32 = 1;
const ANSWERS_ALL: i32 = 2;

/// Does what a packet says. Returns the answer, if there is to be one.
pub(super) fn answer(device: &mut Device, arrival: &Arrival) -> Option<Vec<u8>> {
    let own = device.memory.get(&table::ID) as u8;
    let level = device.memory.get(&table::STATUS_LEVEL);
    let (id, instruction, parameters) = match arrival {
        Arrival::Broken { id } => {
            let heard = *id == own && device.is_awake() && level == ANSWERS_ALL;
            return heard.then(|| status(device, own, Err(Refusal::Checksum)));
        }
        Arrival::Packet { id, instruction, parameters } => (*id, *instruction, parameters.as_slice()),
    };
    // Answers of other motors are no instructions.
    if !device.is_awake() || instruction == STATUS {
        return None;
    }
    device.hear();
    let shadow = device.memory.get(&table::SHADOW_ID) as u8;
    if id == BROADCAST {
        return broadcast(device, own, instruction, parameters).map(|result| status(device, own, result));
    }
    let is_shadow = shadow <= 252 && id == shadow;
    if id != own && !is_shadow {
        return None;
    }
    let result = single(device, instruction, parameters);
    let needed = match instruction {
        PING => 0,
        READ => ANSWERS_READS,
        _ => ANSWERS_ALL,
    };
    let answer = (level >= needed && !is_shadow).then(|| status(device, own, result));
    if instruction == REBOOT {
        device.restart();
    }
    answer
}

/// The packet that tells how it went.
fn status(device: &Device, id: u8, result: Result<Vec<u8>, Refusal>) -> Vec<u8> {
    let alert = if device.memory.get(&table::HARDWARE_ERROR) == 0 { 0 } else { 0x80 };
    let (error, data) = match result {
        Ok(data) => (0, data),
        Err(refusal) => (refusal as u8, Vec::new()),
    };
    let mut body = vec![STATUS, error | alert];
    body.extend(data);
    packet(id, &body)
}

fn identity(device: &Device) -> Vec<u8> {
    let model = device.memory.get(&table::MODEL_NUMBER) as u16;
    let [low, high] = model.to_le_bytes();
    vec![low, high, device.memory.get(&table::FIRMWARE_VERSION) as u8]
}

/// Two bytes, the low one first, from a place on.
fn word(bytes: &[u8], at: usize) -> Result<usize, Refusal> {
    match bytes.get(at..at + 2) {
        Some(&[low, high]) => Ok(usize::from(u16::from_le_bytes([low, high]))),
        _ => Err(Refusal::Length),
    }
}

/// An instruction for this motor alone.
fn single(device: &mut Device, instruction: u8, parameters: &[u8]) -> Result<Vec<u8>, Refusal> {
    let done = |result: Result<(), Refusal>| result.map(|()| Vec::new());
    match instruction {
        PING => Ok(identity(device)),
        READ if parameters.len() == 4 => device.memory.read(word(parameters, 0)?, word(parameters, 2)?),
        READ => Err(Refusal::Length),
        WRITE => done(device.write(word(parameters, 0)?, &parameters[2..])),
        REG_WRITE => {
            let address = word(parameters, 0)?;
            device.memory.clone().write(address, &parameters[2..])?;
            device.registered = Some((address, parameters[2..].to_vec()));
            device.memory.set(&table::REGISTERED, 1);
            Ok(Vec::new())
        }
        ACTION => done(act(device)),
        // It would take away what calibrations stand on.
        FACTORY_RESET => Err(Refusal::Failed),
        REBOOT => Ok(Vec::new()),
        CLEAR if parameters == CLEAR_TURNS => done(device.clear_turns()),
        CLEAR => Err(Refusal::Range),
        _ => Err(Refusal::Instruction),
    }
}

fn act(device: &mut Device) -> Result<(), Refusal> {
    let (address, data) = device.registered.take().ok_or(Refusal::Instruction)?;
    device.memory.set(&table::REGISTERED, 0);
    device.write(address, &data)
}

/// An instruction for all motors. Only pings and reads of several motors are answered.
fn broadcast(device: &mut Device, own: u8, instruction: u8, parameters: &[u8]) -> Option<Result<Vec<u8>, Refusal>> {
    let reads = device.memory.get(&table::STATUS_LEVEL) >= ANSWERS_READS;
    match instruction {
        PING => Some(Ok(identity(device))),
        SYNC_READ if reads => {
            let (address, count) = (word(parameters, 0).ok()?, word(parameters, 2).ok()?);
            parameters[4..].contains(&own).then(|| device.memory.read(address, count))
        }
        BULK_READ if reads => {
            let mine = parameters.chunks_exact(5).find(|item| item[0] == own)?;
            Some(word(mine, 1).and_then(|address| device.memory.read(address, word(mine, 3)?)))
        }
        _ => {
            // Whoever writes to all is not told how it went.
            let _untold = match instruction {
                SYNC_WRITE => sync_write(device, own, parameters),
                BULK_WRITE => bulk_write(device, own, parameters),
                WRITE | REG_WRITE | ACTION | CLEAR => single(device, instruction, parameters).map(drop),
                _ => Ok(()),
            };
            if instruction == REBOOT {
                device.restart();
            }
            None
        }
    }
}

fn sync_write(device: &mut Device, own: u8, parameters: &[u8]) -> Result<(), Refusal> {
    let (address, count) = (word(parameters, 0)?, word(parameters, 2)?);
    let mine = parameters[4..].chunks_exact(count + 1).find(|item| item[0] == own);
    mine.map_or(Ok(()), |item| device.write(address, &item[1..]))
}

fn bulk_write(device: &mut Device, own: u8, parameters: &[u8]) -> Result<(), Refusal> {
    let mut rest = parameters;
    while let [id, ..] = *rest {
        let (address, count) = (word(rest, 1)?, word(rest, 3)?);
        let data = rest.get(5..5 + count).ok_or(Refusal::Length)?;
        if id == own {
            device.write(address, data)?;
        }
        rest = &rest[5 + count..];
    }
    Ok(())
}
