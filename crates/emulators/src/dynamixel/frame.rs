//! Packets of Dynamixel protocol 2.0: header, stuffing and checksum. Written from ROBOTIS' description of the protocol
//! (emanual.robotis.com/docs/en/dxl/protocol2), and apart from what the driver has.

/// What every packet begins with, the reserved byte included.
const HEADER: [u8; 4] = [0xFF, 0xFF, 0xFD, 0x00];
/// The three bytes that a packet's body must not have; they are followed by one more 0xFD there.
const FORBIDDEN: [u8; 3] = [0xFF, 0xFF, 0xFD];
/// Header, identity and length.
const PREFIX: usize = 7;
/// More than any packet of one device needs; what claims to be longer is noise.
const MOST_LENGTH: usize = 1024;

/// The checksum: polynomial 0x8005, start 0, nothing reflected.
pub(super) fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc: u16, byte| (crc << 8) ^ TABLE[usize::from((crc >> 8) as u8 ^ byte)])
}

const TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        let mut crc = (i as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x8005 };
            bit += 1;
        }
        table[i] = crc;
        i += 1;
    }
    table
};

/// A body with 0xFD after each 0xFF 0xFF 0xFD.
fn stuff(body: &[u8]) -> Vec<u8> {
    let mut stuffed = Vec::with_capacity(body.len() + 2);
    for (i, &byte) in body.iter().enumerate() {
        stuffed.push(byte);
        if i >= 2 && body[i - 2..=i] == FORBIDDEN {
            stuffed.push(0xFD);
        }
    }
    stuffed
}

/// The body that was stuffed. A forbidden pattern that nobody stuffed stays: ROBOTIS' own client for Python sends such packets,
/// and its reader takes them so.
fn unstuff(stuffed: &[u8]) -> Vec<u8> {
    let mut body: Vec<u8> = Vec::with_capacity(stuffed.len());
    let mut bytes = stuffed.iter().peekable();
    while let Some(&byte) = bytes.next() {
        body.push(byte);
        if body.ends_with(&FORBIDDEN) {
            bytes.next_if_eq(&&0xFD);
        }
    }
    body
}

/// A packet of the device with this identity, whose body is the instruction and what belongs to it.
pub(super) fn packet(id: u8, body: &[u8]) -> Vec<u8> {
    let stuffed = stuff(body);
    let length = (stuffed.len() + 2) as u16;
    let mut bytes = Vec::with_capacity(PREFIX + stuffed.len() + 2);
    bytes.extend(HEADER);
    bytes.push(id);
    bytes.extend(length.to_le_bytes());
    bytes.extend(stuffed);
    bytes.extend(crc(&bytes).to_le_bytes());
    bytes
}

/// What arrived.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Arrival {
    /// A packet whose checksum fits.
    Packet {
        /// Whom it is for.
        id: u8,
        /// The instruction.
        instruction: u8,
        /// What belongs to it.
        parameters: Vec<u8>,
    },
    /// One whose checksum does not.
    Broken {
        /// Whom it is for, if that is not what broke.
        id: u8,
    },
}

/// Finds packets among the bytes that arrive.
#[derive(Debug, Default)]
pub(super) struct Framer {
    bytes: Vec<u8>,
}

impl Framer {
    /// Takes bytes as they come.
    pub(super) fn take(&mut self, bytes: &[u8]) {
        self.bytes.extend(bytes);
    }

    /// Forgets the beginning of a packet that never went on.
    pub(super) fn forget(&mut self) {
        self.bytes.clear();
    }

    /// The next packet, as soon as all of it is there.
    pub(super) fn next(&mut self) -> Option<Arrival> {
        loop {
            self.seek();
            let length = match self.bytes.get(5..PREFIX) {
                Some(&[low, high]) => usize::from(u16::from_le_bytes([low, high])),
                _ => return None,
            };
            // An instruction and a checksum at least. The header is no header then: look behind it.
            if !(3..=MOST_LENGTH).contains(&length) {
                self.bytes.drain(..1);
                continue;
            }
            let end = PREFIX + length;
            if self.bytes.len() < end {
                return None;
            }
            let packet: Vec<u8> = self.bytes.drain(..end).collect();
            let (checked, told) = packet.split_at(end - 2);
            if told != crc(checked).to_le_bytes() {
                return Some(Arrival::Broken { id: packet[4] });
            }
            let body = unstuff(&checked[PREFIX..]);
            if let [instruction, parameters @ ..] = body.as_slice() {
                return Some(Arrival::Packet {
                    id: packet[4],
                    instruction: *instruction,
                    parameters: parameters.into(),
                });
            }
        }
    }

    /// Throws away what comes before the first header, or before what could become one.
    fn seek(&mut self) {
        let begins = |bytes: &[u8]| {
            let seen = bytes.len().min(HEADER.len());
            bytes[..seen] == HEADER[..seen]
        };
        let at = (0..self.bytes.len()).find(|&i| begins(&self.bytes[i..])).unwrap_or(self.bytes.len());
        self.bytes.drain(..at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<Arrival> {
        let mut framer = Framer::default();
        framer.take(bytes);
        std::iter::from_fn(|| framer.next()).collect()
    }

    /// The examples of the protocol's description: ping, its answer, a read, a write.
    #[test]
    fn packets_of_the_description() {
        let known: [(u8, &[u8], [u8; 2]); 6] = [
            (1, &[0x01], [0x19, 0x4E]),
            (0xFE, &[0x01], [0x31, 0x42]),
            (1, &[0x55, 0x00, 0x06, 0x04, 0x26], [0x65, 0x5D]),
            (2, &[0x55, 0x00, 0x06, 0x04, 0x26], [0x6F, 0x6D]),
            (1, &[0x02, 0x84, 0x00, 0x04, 0x00], [0x1D, 0x15]),
            (1, &[0x03, 0x74, 0x00, 0x00, 0x02, 0x00, 0x00], [0xCA, 0x89]),
        ];
        for (id, body, checksum) in known {
            let bytes = packet(id, body);
            assert_eq!(bytes[bytes.len() - 2..], checksum, "{body:02X?}");
            let parameters = body[1..].to_vec();
            assert_eq!(all(&bytes), [Arrival::Packet { id, instruction: body[0], parameters }]);
        }
    }

    #[test]
    fn headers_within_are_stuffed() {
        for body in [
            &[3, 0xFF, 0xFF, 0xFD][..],
            &[3, 0xFF, 0xFF, 0xFD, 0x00, 1],
            &[3, 0xFF, 0xFF, 0xFD, 0xFD],
            &[3, 0xFF, 0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFD],
            &[3, 0xFF, 0xFD, 0xFF, 0xFF, 0xFE, 0xFD],
        ] {
            let bytes = packet(1, body);
            let inside = &bytes[PREFIX..bytes.len() - 2];
            let headers = body.windows(3).filter(|three| three == &FORBIDDEN).count();
            assert_eq!(inside.len(), body.len() + headers, "{inside:02X?}");
            assert!(inside.windows(4).all(|four| four[..3] != FORBIDDEN || four[3] == 0xFD), "{inside:02X?}");
            let parameters = body[1..].to_vec();
            assert_eq!(all(&bytes), [Arrival::Packet { id: 1, instruction: 3, parameters }]);
        }
    }

    /// Noise around packets, packets in pieces, lengths that cannot be, and a broken checksum.
    #[test]
    fn packets_are_found_in_noise() {
        let ping = packet(1, &[1]);
        let mut noise = vec![0x00, 0xFF, 0xFF, 0xFD, 0x00, 1, 0x02, 0x00, 0xFF, 0xFF];
        noise.extend(&ping);
        noise.extend([0xFF, 0xFF, 0xFD, 0x00, 1, 0xFF, 0xFF, 0x7F]);
        noise.extend(&ping);
        let mut broken = ping.clone();
        broken[8] ^= 1;
        noise.extend(broken);
        noise.extend(&ping);
        let whole = Arrival::Packet { id: 1, instruction: 1, parameters: Vec::new() };
        let wanted = [whole.clone(), whole.clone(), Arrival::Broken { id: 1 }, whole];
        assert_eq!(all(&noise), wanted);
        let mut framer = Framer::default();
        let mut found = Vec::new();
        for byte in noise {
            framer.take(&[byte]);
            found.extend(std::iter::from_fn(|| framer.next()));
        }
        assert_eq!(found, wanted);
    }
}
