//! What the control table holds, and who may read and write what.

use super::table::{self, Access, Indirect, LENGTH, Register};

/// Why an instruction is not followed: the error numbers of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It cannot be done now.
    Failed = 1,
    /// There is no such instruction, or nothing was registered for it.
    Instruction = 2,
    /// The packet's checksum is wrong.
    Checksum = 3,
    /// A value beyond the register's range.
    Range = 4,
    /// Fewer bytes than the register has, or than the instruction needs.
    Length = 5,
    /// A value beyond the limit that another register sets.
    Limit = 6,
    /// There is nothing there, it is not to be written, or not while torque is on.
    Access = 7,
}

/// The modes that an XM430 has.
pub(super) const CURRENT_MODE: i32 = 0;
pub(super) const VELOCITY_MODE: i32 = 1;
pub(super) const POSITION_MODE: i32 = 3;
pub(super) const EXTENDED_MODE: i32 = 4;
pub(super) const CURRENT_BASED_MODE: i32 = 5;
pub(super) const PWM_MODE: i32 = 16;
const MODES: [i32; 6] = [CURRENT_MODE, VELOCITY_MODE, POSITION_MODE, EXTENDED_MODE, CURRENT_BASED_MODE, PWM_MODE];

/// What the bus watchdog reads after it has stopped the motor.
pub(super) const TRIPPED: i32 = 255;
/// The farthest goal over several turns, ticks: 256 turns.
const FARTHEST: i32 = 1_048_575;

/// The control table's bytes.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    bytes: [u8; LENGTH],
}

impl Memory {
    /// A motor as it leaves the factory.
    pub(super) fn new() -> Self {
        let mut memory = Self { bytes: [0; LENGTH] };
        memory.start(0);
        memory
    }

    /// What was not kept is as it is after power comes on.
    pub(super) fn restart(&mut self) {
        self.start(table::EEPROM);
    }

    fn start(&mut self, from: usize) {
        self.bytes[from..].fill(0);
        for register in table::REGISTERS.iter().filter(|register| register.at >= from) {
            self.set(register, register.first);
        }
        for (pointer, data) in table::pointers() {
            self.bytes[pointer..][..2].copy_from_slice(&data.to_le_bytes());
        }
        // Goals begin at their limits.
        self.set(&table::GOAL_PWM, self.get(&table::PWM_LIMIT));
        self.set(&table::GOAL_CURRENT, self.get(&table::CURRENT_LIMIT));
    }

    /// The value of a register; one byte has no sign.
    pub(super) fn get(&self, register: &Register) -> i32 {
        let bytes = &self.bytes[register.at..][..register.size];
        match *bytes {
            [a] => i32::from(a),
            [a, b] => i32::from(i16::from_le_bytes([a, b])),
            [a, b, c, d] => i32::from_le_bytes([a, b, c, d]),
            _ => 0,
        }
    }

    /// Sets a register, whoever may write it.
    pub(super) fn set(&mut self, register: &Register, value: i32) {
        self.bytes[register.at..][..register.size].copy_from_slice(&value.to_le_bytes()[..register.size]);
    }

    /// Where a byte of the indirect part really is.
    fn resolve(&self, address: usize) -> usize {
        match table::indirect(address) {
            Some(Indirect::Data(pointer)) => {
                usize::from(u16::from_le_bytes([self.bytes[pointer], self.bytes[pointer + 1]]))
            }
            _ => address,
        }
    }

    /// So many bytes from an address on. Gaps between registers read zero.
    pub(super) fn read(&self, address: usize, count: usize) -> Result<Vec<u8>, Refusal> {
        let end = address.checked_add(count).filter(|end| *end <= LENGTH).ok_or(Refusal::Access)?;
        let known = |address| table::at(address).is_some() || table::indirect(address).is_some();
        if count == 0 {
            return Err(Refusal::Length);
        }
        if !(address..end).any(known) {
            return Err(Refusal::Access);
        }
        Ok((address..end).map(|address| self.bytes[self.resolve(address)]).collect())
    }

    /// Writes bytes from an address on, all or none. Returns the registers that were written.
    pub(super) fn write(&mut self, address: usize, data: &[u8]) -> Result<Vec<&'static Register>, Refusal> {
        let places = self.places(address, data)?;
        let mut after = self.clone();
        for &(place, byte) in &places {
            after.bytes[place] = byte;
        }
        let mut written = Vec::new();
        let mut bytes = places.iter().map(|&(place, _)| place).peekable();
        while let Some(place) = bytes.next() {
            let (at, size) = match (table::at(place), table::indirect(place)) {
                (Some(register), _) => {
                    self.check(register, &after)?;
                    written.push(register);
                    (register.at, register.size)
                }
                (None, Some(Indirect::Pointer(pointer))) => {
                    let target = u16::from_le_bytes([after.bytes[pointer], after.bytes[pointer + 1]]);
                    if !(table::EEPROM..LENGTH).contains(&usize::from(target)) {
                        return Err(Refusal::Range);
                    }
                    (pointer, 2)
                }
                (None, Some(Indirect::Data(_))) => (place, 1),
                (None, None) => return Err(Refusal::Access),
            };
            // A register is written as a whole.
            if place != at || (1..size).any(|i| bytes.next_if_eq(&(at + i)).is_none()) {
                return Err(Refusal::Length);
            }
        }
        *self = after;
        Ok(written)
    }

    /// Where each byte goes, in the order of places.
    fn places(&self, address: usize, data: &[u8]) -> Result<Vec<(usize, u8)>, Refusal> {
        if data.is_empty() {
            return Err(Refusal::Length);
        }
        let end = address.checked_add(data.len()).filter(|end| *end <= LENGTH).ok_or(Refusal::Access)?;
        let mut places: Vec<_> =
            (address..end).map(|address| self.resolve(address)).zip(data.iter().copied()).collect();
        places.sort_by_key(|&(place, _)| place);
        Ok(places)
    }

    /// Whether a register may become what it is in `after`.
    fn check(&self, register: &Register, after: &Self) -> Result<(), Refusal> {
        let value = after.get(register);
        let torque = self.get(&table::TORQUE_ENABLE) != 0;
        if register.access == Access::Read || (register.is_kept() && torque) {
            return Err(Refusal::Access);
        }
        let tripped = self.get(&table::BUS_WATCHDOG) == TRIPPED;
        let goals = [table::GOAL_PWM, table::GOAL_CURRENT, table::GOAL_VELOCITY, table::GOAL_POSITION];
        if tripped && (goals.contains(register) || (*register == table::BUS_WATCHDOG && value != 0)) {
            return Err(Refusal::Range);
        }
        match register.access {
            Access::Read => Err(Refusal::Access),
            Access::Between(least, most) if !(least..=most).contains(&value) => Err(Refusal::Range),
            Access::Between(..) if *register == table::OPERATING_MODE && !MODES.contains(&value) => Err(Refusal::Range),
            Access::Within(limit) if value.abs() > after.get(limit) => Err(Refusal::Limit),
            Access::Position if after.get(&table::OPERATING_MODE) == POSITION_MODE => {
                let range = after.get(&table::MIN_POSITION)..=after.get(&table::MAX_POSITION);
                if range.contains(&value) { Ok(()) } else { Err(Refusal::Limit) }
            }
            Access::Position if value.abs() > FARTHEST => Err(Refusal::Range),
            Access::Between(..) | Access::Within(_) | Access::Position => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_not_be_written_is_refused_by_number() {
        let mut memory = Memory::new();
        let refused = |memory: &mut Memory, at: usize, data: &[u8]| {
            let before = memory.bytes;
            let refusal = memory.write(at, data).unwrap_err();
            assert_eq!(memory.bytes, before);
            refusal
        };
        assert_eq!(refused(&mut memory, 11, &[2]), Refusal::Range);
        assert_eq!(refused(&mut memory, 38, &1194_u16.to_le_bytes()), Refusal::Range);
        assert_eq!(refused(&mut memory, 102, &1194_u16.to_le_bytes()), Refusal::Limit);
        assert_eq!(refused(&mut memory, 102, &(-1194_i16).to_le_bytes()), Refusal::Limit);
        assert_eq!(refused(&mut memory, 116, &4096_i32.to_le_bytes()), Refusal::Limit);
        assert_eq!(refused(&mut memory, 116, &[0, 0]), Refusal::Length);
        assert_eq!(refused(&mut memory, 118, &[0, 0]), Refusal::Length);
        assert_eq!(refused(&mut memory, 116, &[]), Refusal::Length);
        assert_eq!(refused(&mut memory, 132, &[0; 4]), Refusal::Access);
        assert_eq!(refused(&mut memory, 66, &[0]), Refusal::Access);
        assert_eq!(refused(&mut memory, 661, &[0, 0]), Refusal::Access);
        assert_eq!(refused(&mut memory, 168, &63_u16.to_le_bytes()), Refusal::Range);
        assert_eq!(memory.write(11, &[5]).unwrap(), [&table::OPERATING_MODE]);
        assert_eq!(refused(&mut memory, 116, &1_048_576_i32.to_le_bytes()), Refusal::Range);
        memory.write(116, &(-1_048_575_i32).to_le_bytes()).unwrap();
        memory.write(64, &[1]).unwrap();
        assert_eq!(refused(&mut memory, 11, &[5]), Refusal::Access);
        memory.set(&table::BUS_WATCHDOG, TRIPPED);
        assert_eq!(refused(&mut memory, 116, &[0; 4]), Refusal::Range);
        assert_eq!(refused(&mut memory, 98, &[5]), Refusal::Range);
        memory.write(98, &[0]).unwrap();
        memory.write(116, &[0; 4]).unwrap();
        assert_eq!((memory.read(66, 1), memory.read(660, 3)), (Err(Refusal::Access), Err(Refusal::Access)));
        assert_eq!(memory.read(64, 3), Ok(vec![1, 0, 0]));
    }

    #[test]
    fn indirect_bytes_are_those_they_point_at() {
        let mut memory = Memory::new();
        memory.write(11, &[5]).unwrap();
        // Goal current, then goal position, through data 1 to 6.
        let pointers: Vec<u8> = [102_u16, 103, 116, 117, 118, 119].into_iter().flat_map(u16::to_le_bytes).collect();
        memory.write(168, &pointers).unwrap();
        let goal = [0x2C, 0x01, 0xFF, 0xFF, 0xFD, 0xFF];
        assert_eq!(memory.write(224, &goal).unwrap(), [&table::GOAL_CURRENT, &table::GOAL_POSITION]);
        assert_eq!((memory.get(&table::GOAL_CURRENT), memory.get(&table::GOAL_POSITION)), (300, -131_073));
        assert_eq!(memory.read(224, 6).unwrap(), goal);
        assert_eq!(memory.write(224, &goal[..3]), Err(Refusal::Length));
        memory.write(230, &[7]).unwrap();
        assert_eq!(memory.read(230, 1).unwrap(), [7]);
        memory.restart();
        assert_eq!((memory.get(&table::OPERATING_MODE), memory.read(224, 6).unwrap()), (5, vec![0; 6]));
    }
}
